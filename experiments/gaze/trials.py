"""Trials of gaze following: a teacher turns to one of the toys on the table; what is seen, inferred and looked at."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from babbling.sight import LookingMind
from experiments.shared.caregiver import FACE, NUMBERS, TURN_S, group
from experiments.shared.eyes import retina_of
from experiments.shared.options import EyeOptions
from imitation.gaze.fixation import Fixation
from imitation.gaze.reader import GazeReader, Geometry, Shown
from imitation.seeing.features import COLOURS
from imitation.seeing.finding import Measurer
from imitation.seeing.pose import Appearance, frame_pose
from models.biclops.gaze import View, lay_out, look_at
from models.biclops.room import Ball, wear_cloth
from models.heads import CARD, PARKED, stage
from models.retina import Image
from models.seeing_body import SeeingBody

FloatArray = NDArray[np.float64]

TOYS = ("orange", "lime", "cyan", "violet")
"""Colours that no part of a face has."""
PAIR = ("orange", "cyan")
LABELS = (*FACE, *TOYS)
WATCH_TILT = 0.14
"""rad: the neck is held so that face and table are both in view."""
COPIES = 20
LESSON_PAN, LESSON_TILT = 0.82, (-0.15, 0.72)
"""rad: postures that are mirrored; looks at a table go down."""
EYES_OF_FACE = (1, 2)
"""Rows of `FACE` that are eyes."""
HALF_BASELINE = {"biclops": 0.05, "hoap2": 0.0225}
"""m; only whoever lays out the table knows it."""


@dataclass(frozen=True)
class Scene:
    """Options of a stage for gaze."""

    eyes: EyeOptions
    distance: float
    aim_deg: float
    """Standard deviation of where a teacher's head points beside what it looks at, each axis, degrees."""

    def view(self) -> View:
        """What the imitator can see of the table."""
        retina = retina_of(self.eyes)
        default = {"biclops": 46.826, "hoap2": 55.0}[self.eyes.robot]
        half_v = np.tan(np.deg2rad(retina.fovy_deg or default) / 2)
        return View(
            float(half_v * retina.width / retina.height), float(half_v), WATCH_TILT, HALF_BASELINE[self.eyes.robot]
        )


class Trials(NamedTuple):
    """N trials of G toys; for those who judge and for those who infer."""

    places: FloatArray
    """(N, G, 3) true, m, in the table's frame."""
    target: NDArray[np.int64]
    """(N,) which toy the teacher looks at."""
    angles: FloatArray
    """(N, 2) true pose of the teacher's head."""
    things: FloatArray
    """(N, G, 4) where the toys were seen, pixels from the middle; NaN unseen."""
    salience: FloatArray
    """(N, G) contrast times root of area, as seen; a floor for what was not."""
    pose: FloatArray
    """(N, 2) estimated pose of the head; NaN where the face told too little."""
    eyes_seen: NDArray[np.bool_]
    """(N,) whether an eye of the teacher's was made out."""
    tilt: FloatArray
    """(N,) felt tilt of one's own neck."""
    looked: FloatArray
    """(N, 2) which toy stood nearest the middle of the left eye after following, and how far from it, pixels; NaN where
    nobody followed."""
    image: tuple[Image, Image]
    """Of the first trial."""


def table_body(scene: Scene, copies: int, seed: int, tick_s: float, teacher: bool = True) -> SeeingBody:
    """Heads before a table with four toys and a teacher behind it."""
    balls = tuple(Ball(name, (0.5, 0.0, 0.02), COLOURS[name], 0.022) for name in TOYS)
    model = stage(scene.eyes.robot, teacher=teacher, distance=scene.distance, balls=balls, card=True).compile()
    body = SeeingBody(
        model, scene.eyes.robot, Measurer(LABELS), len(LABELS), numbers=NUMBERS, retina=retina_of(scene.eyes),
        renderer=scene.eyes.renderer, copies=copies, tick_s=tick_s, seed=seed, rest=(0.0, WATCH_TILT),
    )  # fmt: skip
    for name in TOYS:
        body.place(name, np.array(PARKED))
    body.place(CARD, np.array(PARKED))
    return body


def split(senses: FloatArray, mind: LookingMind) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(..., S) senses to the face's (..., M) numbers, the toys' (..., 4, 4) places from the middle, their areas."""
    numbers = senses[..., 2:].reshape(*senses.shape[:-1], len(LABELS), 2, NUMBERS)
    face = numbers[..., : len(FACE), :, :].reshape(*senses.shape[:-1], -1)
    toys = numbers[..., len(FACE) :, :, :]
    things = toys[..., :2].reshape(*toys.shape[:-2], 4) - mind.pilot.retina.centre
    return face, things, np.nanmax(np.nan_to_num(toys[..., 2]), axis=-1)


def run_trials(
    body: SeeingBody,
    scene: Scene,
    mind: LookingMind,
    appearance: Appearance,
    count: int,
    rng: np.random.Generator,
    *,
    toys: tuple[str, ...] = TOYS,
    apart_deg: tuple[float, float] = (15.0, 180.0),
    preference: tuple[float, ...] | None = None,
    cloth: str | None = None,
    follow: tuple[GazeReader, FloatArray] | None = None,
    report: Callable[[float], None] = lambda done: None,
) -> Trials:
    """So many trials, `body.copies` at a time; see `Trials`. `preference` is the teacher's own, over `toys`.

    With `follow`, a reader of gaze and the place of the face, the imitator looks where it thinks the teacher looks.
    """
    wear_cloth(body.model, cloth)
    rows: list[tuple[FloatArray, ...]] = []
    image = None
    indices = [TOYS.index(name) for name in toys]
    share = np.full(len(toys), 1 / len(toys)) if preference is None else np.array(preference)
    done = 0
    while done < count:
        copies = body.copies
        places = np.stack([lay_out(rng, len(toys), scene.distance, scene.view(), apart_deg) for _ in range(copies)])
        target = rng.choice(len(toys), copies, p=share)
        aim = look_at(places[np.arange(copies), target], scene.distance)
        aim = aim + np.deg2rad(scene.aim_deg) * rng.standard_normal((copies, 2))
        for name in TOYS:
            body.place(name, np.array(PARKED))
        for column, name in enumerate(toys):
            body.place(name, places[:, column])
        body.teacher_path = lambda t, aim=aim: aim  # type: ignore[misc]
        body.seed += 1
        senses = body.reset()
        image = image or body.images[0]
        face, things, area = split(senses, mind)
        pose = np.stack([_pose(appearance, one) for one in face])
        seen = np.isfinite(face.reshape(copies, len(FACE), 2, NUMBERS)[:, list(EYES_OF_FACE), :, :][..., 0]).any((1, 2))
        rows.append((
            places, target, body.teacher_angles, things[:, indices], np.sqrt(np.maximum(area[:, indices], 1.0)), pose,
            seen, senses[:, 1], np.full((copies, 2), np.nan),
        ))  # fmt: skip
        if follow is not None:
            rows[-1][-1][:] = _follow(body, mind, Trials(*rows[-1], image), follow, toys, senses, rng)  # type: ignore[arg-type]
        done += copies
        report(min(done / count, 1.0))
    wear_cloth(body.model, None)
    assert image is not None
    merged = [np.concatenate(column)[:count] for column in zip(*rows, strict=True)]
    return Trials(*merged, image)  # type: ignore[arg-type]


def _follow(
    body: SeeingBody,
    mind: LookingMind,
    trials: Trials,
    follow: tuple[GazeReader, FloatArray],
    toys: tuple[str, ...],
    senses: FloatArray,
    rng: np.random.Generator,
) -> FloatArray:
    """Two saccades to the toy that Eq. (2) finds most probable: (B, 2) toy nearest the middle, its distance."""
    from experiments.gaze.infer import infer

    fixation = Fixation(mind.sight, mind.pilot.reach)
    chosen = infer(trials, *follow, toys).argmax(1)
    indices = [TOYS.index(name) for name in toys]
    every = np.arange(len(chosen))
    for _ in range(2):
        things = split(senses, mind)[1][:, indices]
        wanted = np.nan_to_num(things[every, chosen])
        saccade = fixation.choose(wanted, senses[:, :2], rng)
        senses = body.act(mind.pilot.efference.motors(senses[:, :2] + saccade.change))
    away = np.linalg.norm(split(senses, mind)[1][:, indices, :2], axis=-1)
    away = np.where(np.isfinite(away), away, np.inf)
    return np.stack([away.argmin(1).astype(float), away.min(1)], axis=-1)


def _pose(appearance: Appearance, numbers: FloatArray) -> FloatArray:
    pose = frame_pose(appearance, numbers)
    return np.full(2, np.nan) if pose is None else pose


def geometry(mind: LookingMind) -> Geometry:
    """Pixels per radian of turning at the image's middle: what oculomotor babbling says of one's own eyes."""
    model = mind.sight
    step = 0.02
    middle = np.zeros((2, 4))
    change = np.array([[0.0, step], [0.0, -step]])
    moved = model.expect(middle, np.zeros((2, 2)), change)
    return Geometry(float(abs(moved[0, 1] - moved[1, 1]) / (2 * step)))


def reader(mind: LookingMind) -> GazeReader:
    """A reader of gaze that has been shown nothing yet."""
    reach = mind.pilot.reach
    return GazeReader(
        (Fixation(mind.sight, reach, eye=0), Fixation(mind.sight, reach, eye=1)), geometry(mind), WATCH_TILT
    )


def head_place(geometry_: Geometry, face: FloatArray, tilt: FloatArray, centre: FloatArray) -> FloatArray:
    """(3,) the middle of what is seen of a resting face in (N, M) numbers: the mean place of its located features."""
    numbers = face.reshape(len(face), len(FACE), 2, NUMBERS)[..., :2].reshape(len(face), len(FACE), 4) - centre
    places = geometry_.locate(numbers, tilt[:, None])
    return np.asarray(np.nanmedian(places.reshape(-1, 3), axis=0))


def located(trials: Trials, where: Geometry) -> FloatArray:
    """(N, G, 3) places of the toys in units of the distance between the eyes; NaN unseen."""
    return where.locate(trials.things, trials.tilt[:, None])


def shown(trials: Trials, where: Geometry, head: FloatArray) -> Shown:
    """What can be learned from trials whose goal was taken up afterwards."""
    places = located(trials, where)[np.arange(len(trials.target)), trials.target]
    use = np.isfinite(places).all(1) & np.isfinite(trials.pose).all(1)
    return Shown(places[use], np.tile(head, (int(use.sum()), 1)), trials.pose[use])


def lesson_for_gaze(
    scene: Scene, mind: LookingMind, count: int, seed: int, report: Callable[[float], None] = lambda done: None
) -> tuple[Appearance, FloatArray]:
    """Being mirrored while looking at face and table: what heads at postures look like, and where the face is."""
    body = table_body(scene, COPIES, seed, TURN_S)
    rng = np.random.default_rng([seed, 0x1E6])
    low = np.array([-LESSON_PAN, LESSON_TILT[0]])
    high = np.array([LESSON_PAN, LESSON_TILT[1]])
    body.teacher_path = lambda t: np.zeros((COPIES, 2))
    senses = body.reset()
    face, _, _ = split(senses, mind)
    head = head_place(geometry(mind), face, senses[:, 1], mind.pilot.retina.centre)
    rest = body.command_angles(np.tile(body.rest, (COPIES, 1)))
    postures, seen = [], []
    rounds = -(-count // COPIES)
    for turn in range(rounds):
        wanted = low + (high - low) * rng.random((COPIES, 2))
        felt = body.act(body.command_angles(wanted), look=False)[:, :2]
        imitation = felt + np.deg2rad(0.2) * rng.standard_normal((COPIES, 2))
        body.teacher_path = lambda t, imitation=imitation: imitation  # type: ignore[misc]
        senses = body.act(rest)
        postures.append(felt)
        seen.append(split(senses, mind)[0])
        report((turn + 1) / rounds)
    return Appearance.learned(np.concatenate(postures), np.concatenate(seen), group()), head
