"""What a teacher shows: an act done in physics, and how it looks from where somebody watches."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from babbling.axes import BoolArray, FloatArray, IntArray
from experiments.errors import ExperimentError
from experiments.shared.children import Child
from experiments.shared.pixels import film
from experiments.shared.playing import LOOKED_AT, SEEING_M, Tried, at_table
from imitation.acting.aiming import aims
from imitation.acting.primitives import NAMES
from models.objects import TOYS
from models.objects.playing import MIDDLE
from models.objects.retinas import Room
from models.objects.states import STATES

TEACHERS = 5_000_000
"""Specimens from here on are those that teachers handle."""
OUT_OF_REACH_M = 0.03
"""m that an act may miss by, by the teacher's own image of its body."""
SCREEN_PX, FOCAL_PX = 0.5, 300.0
"""Pixels of noise on a screen, and its camera's focal length."""
CAMERA_M = (0.75, 0.35, 0.6)
"""m in the teacher's world: a television camera."""
PIXEL_NOISE_M = 0.006
"""m that places found on two images are off by."""
ROOM = Room(table=(0.45, 0.5, 0.55), wall=(0.6, 0.6, 0.62))
"""Another room: other colours."""
ROOM_TABLE_M = 0.22
"""m, height of the table in another room."""


@dataclass(frozen=True)
class Act:
    """N acts, in the teacher's own frame, by the world's own places at the looks."""

    tracks: FloatArray
    """(N, L, 5, 3) m: hands, forehead, a, b."""
    signal: BoolArray
    """(N, L)."""
    tried: Tried
    """The physics that they come from; copy n is act n's in `rows`."""
    rows: IntArray
    robot: str
    """Whose."""
    table: float | None
    """m, its height where it was not the usual one."""
    toy: str
    further: float

    def only(self, which: IntArray) -> "Act":
        """Some of the acts, or some of them again and again."""
        return replace(self, tracks=self.tracks[which], signal=self.signal[which], rows=self.rows[which])


@dataclass(frozen=True)
class Seen:
    """N acts as they are seen."""

    tracks: FloatArray
    """(N, L, 5, 3) m or (N, L, 5, 2) px."""
    signal: BoolArray
    noise: float
    """Standard deviation, in their unit."""


def performed(
    teacher: Child,
    toy: str,
    which: IntArray,
    first: int,
    *,
    table: float | None = None,
    further: float = 0.0,
    keep: bool = True,
) -> Act:
    """N acts as a teacher does them, each with one of the specimens `first` and following, whatever comes of it."""
    play, rng = teacher.play, np.random.default_rng([first, 0x7EAC])
    kind = play.kinds.index(TOYS[toy].kind)
    body = at_table(toy, len(which), table=table, robot=teacher.robot, further=further)
    body.set_out(first)
    where = aims(play, kind, which, play.practised(kind)[which], "mean", rng)
    tried = teacher.player.tries(body, which, where, rng, keep=keep)
    world = np.concatenate([tried.true.parts, tried.true.handles], 2)[list(LOOKED_AT)].swapaxes(0, 1)
    signal = tried.true.signal[list(LOOKED_AT)].T
    return Act(world, signal, tried, np.arange(len(which)), teacher.robot, table, toy, further)


def demonstrated(
    teacher: Child, toy: str, act: str, state: str | None, count: int, seed: int, **how: Any
) -> Act:  # fmt: skip
    """`count` acts of a teacher who can do it, ending in a state (None: whatever comes of it); see `performed`.

    Raises:
        ExperimentError: the object is out of reach, or what the teacher does never ends so.
    """
    tries = max(count + count // 2, 16)
    shown = performed(teacher, toy, np.full(tries, NAMES.index(act)), TEACHERS + 1000 * seed, **{"keep": False, **how})
    came, short = TOYS[toy].state(shown.tried.true), float(np.median(shown.tried.missed))
    if short > OUT_OF_REACH_M:
        raise ExperimentError(
            f"the {toy} is out of reach for {act!r}: by {100 * short:.0f} cm; bring it nearer, or choose another act"
        )
    rows = np.arange(tries) if state is None else np.flatnonzero(came == STATES.index(state))
    if not len(rows):
        found = ", ".join(sorted({STATES[one] for one in came}))
        raise ExperimentError(f"{act!r} with the {toy} never ended {state!r} in {tries} tries, only {found}")
    return shown.only(np.resize(rows, count))


def watched(act: Act, condition: str, rng: np.random.Generator, seeing: str = "points") -> Seen:
    """How acts look: live and recalled from across the table, in a room from anywhere, on television from one side.

    By pixels, what is seen is found on images of one or two cameras that stand there; acts must have been kept.
    """
    if seeing == "pixels":
        return _filmed(act, condition, rng)
    if condition == "television":
        return _televised(act, rng)
    count = len(act.tracks)
    yaw = np.full(count, np.pi) if condition != "room" else rng.uniform(-np.pi, np.pi, count)
    turn = Rotation.from_rotvec(yaw[:, None] * [0.0, 0.0, 1.0]).as_matrix()
    shift = rng.uniform(-0.3, 0.3, (count, 1, 1, 3)) * (1, 1, 0) if condition == "room" else 0.0
    tracks = np.einsum("nij,nlpj->nlpi", turn, act.tracks) + shift
    return Seen(tracks + SEEING_M * rng.standard_normal(tracks.shape), act.signal, SEEING_M)


def _filmed(act: Act, condition: str, rng: np.random.Generator) -> Seen:
    """By the retinas of somebody across the table, elsewhere in another room with other colours, or of a television
    camera; levelled by how far one looks down, as one's neck feels it. The part of a thing that never shows is taken to
    be where the other is."""
    toy, tracks = act.toy, []
    body = at_table(toy, 1, robot=act.robot, table=act.table, further=act.further)
    for row in act.rows.tolist():
        room = Room() if condition != "room" else replace(ROOM, place=_aside(rng))
        room = room if condition != "television" else Room(CAMERA_M, apart=0.0)
        seen = film(body, act.tried.configurations[list(LOOKED_AT), row], act.tried.laid[row], room, rng)
        if room.apart:
            down = np.subtract(room.place, room.at)
            pitch = float(np.arctan2(down[2], np.hypot(down[0], down[1])))
            seen = seen @ Rotation.from_euler("y", pitch).as_matrix().T
        a, b = seen[:, 3], seen[:, 4]
        seen[:, 3], seen[:, 4] = np.where(np.isnan(a), b, a), np.where(np.isnan(b), a, b)
        tracks.append(seen)
    noise = PIXEL_NOISE_M if condition != "television" else SCREEN_PX / FOCAL_PX
    return Seen(np.array(tracks), act.signal, noise)


def _aside(rng: np.random.Generator) -> tuple[float, float, float]:
    """Where one sits in another room: anywhere from one side of the teacher to the other, m."""
    turn = rng.uniform(-np.pi / 4, np.pi / 4)
    return float(0.75 * np.cos(turn)), float(0.75 * np.sin(turn)), 0.5


def _televised(act: Act, rng: np.random.Generator) -> Seen:
    """A pinhole camera to one side of the table that looks at its middle: columns and rows in pixels, no depth."""
    eye = np.subtract(CAMERA_M, MIDDLE)
    ahead = -eye / np.linalg.norm(eye)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    axes = np.stack([right, -np.cross(right, ahead), ahead])
    there = (act.tracks - eye) @ axes.T
    image = FOCAL_PX * there[..., :2] / there[..., 2:]
    return Seen(image + SCREEN_PX * rng.standard_normal(image.shape), act.signal, SCREEN_PX)
