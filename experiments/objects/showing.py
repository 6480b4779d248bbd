"""What a teacher shows: an act done in physics, and how it looks from where somebody watches."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from babbling.axes import BoolArray, FloatArray, IntArray
from experiments.errors import ExperimentError
from experiments.shared.children import Child
from experiments.shared.playing import LOOKED_AT, SEEING_M, Tried, at_table
from imitation.acting.aiming import aims
from imitation.acting.primitives import NAMES
from models.objects import TOYS
from models.objects.states import STATES

TEACHERS = 5_000_000
"""Specimens from here on are those that teachers handle."""
OUT_OF_REACH_M = 0.03
"""m that an act may miss by, by the teacher's own image of its body."""
SCREEN_PX, FOCAL_PX = 0.5, 300.0
"""Pixels of noise on a screen, and its camera's focal length."""
CAMERA_M = (0.75, 0.35, 0.35)
"""m from the middle to a television camera."""
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


@dataclass(frozen=True)
class Seen:
    """N acts as they are seen."""

    tracks: FloatArray
    """(N, L, 5, 3) m or (N, L, 5, 2) px."""
    signal: BoolArray
    noise: float
    """Standard deviation, in their unit."""


def demonstrated(
    teacher: Child,
    toy: str,
    act: str,
    state: str | None,
    count: int,
    seed: int,
    *,
    table: float | None = None,
    further: float = 0.0,
    keep: bool = False,
) -> Act:
    """`count` acts of a teacher who can do it, ending in a state (None: whatever comes of it).

    Raises:
        ExperimentError: the object is out of reach, or what the teacher does never ends so.
    """
    primitive, tries = NAMES.index(act), max(2 * count, 16)
    play, rng = teacher.play, np.random.default_rng([seed, 0x7EAC])
    kind = play.kinds.index(TOYS[toy].kind)
    body = at_table(toy, tries, table=table, robot=teacher.robot, further=further)
    body.set_out(TEACHERS + 1000 * seed)
    which = np.full(tries, primitive)
    goal = np.full(tries, -1 if state is None else STATES.index(state))
    where = aims(play, kind, which, goal, "mean", rng)
    tried = teacher.player.tries(body, which, where, rng, keep=keep)
    came, short = TOYS[toy].state(tried.true), float(np.median(tried.missed))
    if short > OUT_OF_REACH_M:
        raise ExperimentError(
            f"the {toy} is out of reach for {act!r}: by {100 * short:.0f} cm; bring it nearer, or choose another act"
        )
    rows = np.arange(tries) if state is None else np.flatnonzero(came == STATES.index(state))
    if not len(rows):
        found = ", ".join(sorted({STATES[one] for one in came}))
        raise ExperimentError(f"{act!r} with the {toy} never ended {state!r} in {tries} tries, only {found}")
    rows = np.resize(rows, count)
    world = np.concatenate([tried.true.parts, tried.true.handles], 2)[list(LOOKED_AT)]
    return Act(
        world.swapaxes(0, 1)[rows], tried.true.signal[list(LOOKED_AT)].T[rows], tried, rows, teacher.robot, table
    )


def watched(act: Act, condition: str, rng: np.random.Generator) -> Seen:
    """How acts look: live and recalled from across the table, in a room from anywhere, on television from one side."""
    count = len(act.tracks)
    if condition == "television":
        return _televised(act, rng)
    yaw = np.full(count, np.pi) if condition != "room" else rng.uniform(-np.pi, np.pi, count)
    turn = Rotation.from_rotvec(yaw[:, None] * [0.0, 0.0, 1.0]).as_matrix()
    shift = rng.uniform(-0.3, 0.3, (count, 1, 1, 3)) * (1, 1, 0) if condition == "room" else 0.0
    tracks = np.einsum("nij,nlpj->nlpi", turn, act.tracks) + shift
    return Seen(tracks + SEEING_M * rng.standard_normal(tracks.shape), act.signal, SEEING_M)


def _televised(act: Act, rng: np.random.Generator) -> Seen:
    """A pinhole camera to one side of the table that looks at its middle: columns and rows in pixels, no depth."""
    eye = np.array(CAMERA_M)
    ahead = -eye / np.linalg.norm(eye)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    axes = np.stack([right, -np.cross(right, ahead), ahead])
    there = (act.tracks - eye) @ axes.T
    image = FOCAL_PX * there[..., :2] / there[..., 2:]
    return Seen(image + SCREEN_PX * rng.standard_normal(image.shape), act.signal, SCREEN_PX)
