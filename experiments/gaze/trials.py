"""Trials of gaze following: a teacher turns to one of the toys on the table; what is seen, inferred and looked at."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.looking import LookingMind
from experiments.gaze.options import Config
from experiments.shared.caregiver import EYES, FACE, TURN_S, face_numbers, mirrored
from experiments.shared.eyes import open_eyes, retina_of
from imitation.gaze.fixation import Fixation
from imitation.gaze.reader import GazeReader
from imitation.seeing.features import COLOURS
from imitation.seeing.finding import Finder
from imitation.seeing.pose import Appearance, frame_pose
from imitation.seeing.stereo import Geometry
from models.biclops.gaze import BALL_RADIUS, View, lay_out, look_at
from models.biclops.room import Ball, wear_cloth
from models.heads import ASKEW_DEG, CARD, PARKED, TOE_IN_DEG, camera_facts
from models.seeing_body import SeeingBody, still

TOYS = ("orange", "lime", "cyan", "violet")
"""Colours that no part of a face has."""
PAIR = ("orange", "cyan")
LABELS = (*FACE, *TOYS)
WATCH_TILT = 0.14
"""rad: the neck is held so that face and table are both in view."""
COPIES = 20
LESSON_PAN, LESSON_TILT = 0.82, (-0.15, 0.72)
"""rad: postures that are mirrored; looks at a table go down."""


def view(config: Config) -> View:
    """What the imitator can see of the table; only whoever lays it out knows."""
    retina, (fovy_deg, half_baseline) = retina_of(config), camera_facts(config.robot)
    half_v = float(np.tan(np.deg2rad(retina.fovy_deg or fovy_deg) / 2))
    half = np.arctan([half_v * retina.width / retina.height, half_v])
    if config.squint is not None:  # aside, and up or down, both eyes together may see less by so much
        half -= np.deg2rad([TOE_IN_DEG[1] + ASKEW_DEG, 2 * ASKEW_DEG])
    return View(float(np.tan(half[0])), float(np.tan(half[1])), WATCH_TILT, half_baseline)


class Watcher(NamedTuple):
    """Who follows gaze: what it has learned of its own eyes, of heads, and of where others look."""

    config: Config
    eyes: LookingMind
    appearance: Appearance
    head: FloatArray
    """(3,) place of the other's face, in units of the distance between the eyes."""
    gaze: GazeReader


class Trials(NamedTuple):
    """N trials of G toys; for those who judge and for those who infer."""

    target: IntArray
    """(N,) which toy the teacher looks at."""
    things: FloatArray
    """(N, G, 4) where the toys were seen, pixels from the middle; NaN unseen."""
    salience: FloatArray
    """(N, G) contrast times root of area, as seen; a floor for what was not."""
    pose: FloatArray
    """(N, 2) estimated pose of the head; NaN where the face told too little."""
    eyes_seen: BoolArray
    """(N,) whether an eye of the teacher's was made out."""
    tilt: FloatArray
    """(N,) felt tilt of one's own neck."""
    looked: FloatArray
    """(N, 2) which toy stood nearest the middle of the left eye after following, and how far from it, pixels; NaN where
    nobody followed."""

    def rows(self, which: Any) -> "Trials":
        """Some of the trials."""
        return Trials._make(field[which] for field in self)


def table_body(config: Config, copies: int, seed: int, tick_s: float, radius: float = BALL_RADIUS) -> SeeingBody:
    """Heads before a table with four toys of a radius (m) and a teacher behind it."""
    balls = tuple(Ball(name, (0.5, 0.0, radius), COLOURS[name], radius) for name in TOYS)
    body = open_eyes(
        config, Finder(LABELS, areas=True), copies=copies, tick_s=tick_s, seed=seed, rest=(0.0, WATCH_TILT),
        teacher=True, distance=config.distance, balls=balls,
    )  # fmt: skip
    for name in TOYS:
        body.place(name, np.array(PARKED))
    body.place(CARD, np.array(PARKED))
    return body


def toys_seen(
    body: SeeingBody, senses: FloatArray, mind: LookingMind, toys: tuple[str, ...]
) -> tuple[FloatArray, FloatArray]:
    """(..., S) senses to the toys' (..., G, 4) places from the middle of either eye and their (..., G) areas."""
    place = body.senses.read(senses, "place", toys)
    area = np.nan_to_num(body.senses.read(senses, "area", toys)).max(-1)
    return place.reshape(*place.shape[:-2], 4) - mind.pilot.retina.centre, area


def straight(aim: FloatArray, spread: float, rng: np.random.Generator) -> FloatArray:
    """A head that points at what it looks at, (N, 2) rad, but for Gaussian noise on either axis."""
    return aim + spread * rng.standard_normal(aim.shape)


def tilt_of(mind: LookingMind, senses: FloatArray) -> FloatArray:
    """(..., S) senses to the felt posture (...) of the neck that carries things up and down, rad."""
    return mind.pilot.posture(senses)[..., mind.pilot.movers[1]]


def run_trials(
    body: SeeingBody,
    who: Watcher,
    count: int,
    rng: np.random.Generator,
    *,
    toys: tuple[str, ...] = TOYS,
    apart_deg: tuple[float, float] = (15.0, 180.0),
    radius: float = BALL_RADIUS,
    turn: Callable[[FloatArray, float, np.random.Generator], FloatArray] = straight,
    preference: tuple[float, ...] | None = None,
    cloth: str | None = None,
    follow: Callable[[Trials], IntArray] | None = None,
    report: Callable[[float], None] = lambda done: None,
) -> Trials:
    """So many trials, `body.copies` at a time; see `Trials`. `preference` is the teacher's own, over `toys`; to
    look where (N, 2) poses point straight, its head turns to `turn` of them.

    With `follow`, which toy of each trial the teacher is thought to look at, the imitator looks there.
    """
    config = who.config
    wear_cloth(body.model, cloth)
    batches: list[Trials] = []
    copies, share = body.copies, np.full(len(toys), 1 / len(toys)) if preference is None else np.array(preference)
    for done in range(0, count, copies):
        laid = (lay_out(rng, len(toys), config.distance, view(config), apart_deg, radius) for _ in range(copies))
        places = np.stack([*laid])
        target = rng.choice(len(toys), copies, p=share)
        aim = look_at(places[np.arange(copies), target], config.distance)
        for name in TOYS:
            body.place(name, np.array(PARKED))
        for column, name in enumerate(toys):
            body.place(name, places[:, column])
        body.teacher_path = still(turn(aim, float(np.deg2rad(config.aim_deg)), rng))
        body.seed += 1
        senses = body.reset()
        things, area = toys_seen(body, senses, who.eyes, toys)
        batch = Trials(
            target, things, np.sqrt(np.maximum(area, 1.0)),
            pose=np.array([frame_pose(who.appearance, face) for face in face_numbers(body, senses)]),
            eyes_seen=np.asarray(np.isfinite(body.senses.read(senses, "place", EYES)[..., 0]).any((1, 2))),
            tilt=tilt_of(who.eyes, senses),
            looked=np.full((copies, 2), np.nan),
        )  # fmt: skip
        if follow is not None:
            batch = batch._replace(looked=_look(body, who.eyes, follow(batch), toys, senses, rng))
        batches.append(batch)
        report(min((done + copies) / count, 1.0))
    wear_cloth(body.model, None)
    return Trials._make(np.concatenate(column)[:count] for column in zip(*batches, strict=True))


def _look(
    body: SeeingBody,
    mind: LookingMind,
    chosen: IntArray,
    toys: tuple[str, ...],
    senses: FloatArray,
    rng: np.random.Generator,
) -> FloatArray:
    """Two saccades to the chosen toys: (B, 2) toy nearest the middle, its distance."""
    fixation = Fixation(mind)
    every = np.arange(len(chosen))
    for _ in range(2):
        things, posture = toys_seen(body, senses, mind, toys)[0], mind.pilot.posture(senses)
        saccade = fixation.choose(np.nan_to_num(things[every, chosen]), posture, rng)
        senses = body.act(mind.pilot.schema.motors(posture + saccade.change))
    away = np.linalg.norm(toys_seen(body, senses, mind, toys)[0][..., :2], axis=-1)
    away = np.where(np.isfinite(away), away, np.inf)
    return np.stack([away.argmin(1).astype(float), away.min(1)], axis=-1)


def located(trials: Trials, where: Geometry) -> FloatArray:
    """(N, G, 3) places of the toys in units of the distance between the eyes; NaN unseen."""
    return where.locate(trials.things, trials.tilt[:, None])


def shown(who: Watcher, trials: Trials) -> Watcher:
    """One who has learned from trials whose goal was taken up afterwards."""
    places = located(trials, who.gaze.geometry)[np.arange(len(trials.target)), trials.target]
    use = np.isfinite(places).all(1) & np.isfinite(trials.pose).all(1)
    return who._replace(gaze=who.gaze.learned(places[use], trials.pose[use], who.head))


def lesson_for_gaze(
    config: Config, mind: LookingMind, count: int, seed: int, report: Callable[[float], None]
) -> Watcher:
    """Being mirrored while looking at face and table: what heads at postures look like, and where the face is."""
    body = table_body(config, COPIES, seed, TURN_S)
    body.teacher_path = still(np.zeros((COPIES, 2)))
    senses = body.reset()
    tilt = tilt_of(mind, senses)
    where = Geometry.of(mind)
    places = where.locate(toys_seen(body, senses, mind, FACE)[0], tilt[:, None])
    head = np.nanmedian(places.reshape(-1, 3), axis=0)
    low, high = np.array([-LESSON_PAN, LESSON_TILT[0]]), np.array([LESSON_PAN, LESSON_TILT[1]])
    lines = mind.pilot.schema.posture[mind.pilot.movers]
    appearance = mirrored(body, lines, low, high, count, np.random.default_rng([seed, 0x1E6]), report)
    naive = GazeReader((Fixation(mind, eye=0), Fixation(mind, eye=1)), where, WATCH_TILT)
    return Watcher(config, mind, appearance, head, naive)
