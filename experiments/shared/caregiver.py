"""A caregiver opposite: the lesson in which it mirrors the imitator, and the watching of what it does."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.looking import wire_eyes
from experiments.shared.eyes import open_eyes, reach_of
from experiments.shared.options import EyeOptions
from imitation.seeing.finding import Finder
from imitation.seeing.pose import Appearance
from models.heads import CARD, PARKED
from models.retina import Image
from models.robots import EYE_HEIGHT
from models.seeing_body import SeeingBody, still

FACE = ("red", "blue", "green", "yellow", "magenta")
"""Colours of nose, left eye, right eye, left ear, right ear."""
EYES = ("blue", "green")
FIND_FACE = Finder(FACE, areas=True)
NUMBERS = 3
"""u, v and area of each feature in each eye."""
FRAME_S = 0.04
"""s between images: 25 a second."""
LESSON_PAN, LESSON_TILT = 0.62, 0.40
"""rad: postures that are mirrored."""
LESSON_COPIES = 16
TURN_S = 1.4
CARE_DEG = 0.2
"""Standard deviation of how exactly a caregiver repeats a posture."""
LEAST_FACE = 3
"""Features in the left eye that make a face."""
SEARCH_PAN_DEG = (0.0, 35.0, -35.0, 70.0, -70.0)
"""Where to look for a face when there is none where one happens to look."""


def face_numbers(body: SeeingBody, senses: FloatArray) -> FloatArray:
    """(..., S) senses to (..., M) numbers of the face: u, v and area of each feature in each eye."""
    place, area = (body.senses.read(senses, channel, FACE) for channel in ("place", "area"))
    return np.concatenate([place, area[..., None]], axis=-1).reshape(*senses.shape[:-1], -1)


def lesson(
    eyes: EyeOptions, count: int, seed: int, distance: float, report: Callable[[float], None] = lambda done: None
) -> Appearance:
    """Taking turns: the imitator takes a posture and looks back, the caregiver repeats it and is looked at."""
    body = open_eyes(eyes, FIND_FACE, copies=LESSON_COPIES, tick_s=TURN_S, seed=seed, teacher=True, distance=distance)
    reach = reach_of(eyes.robot)
    schema, _ = wire_eyes(body, seed)
    lines = schema.posture[body.wiring.motor]  # by joint: people's order, undone in `experiments.head.recall`
    body.reset()
    low = np.maximum([-LESSON_PAN, -LESSON_TILT], reach.low)
    high = np.minimum([LESSON_PAN, LESSON_TILT], reach.high)
    return mirrored(body, lines, low, high, count, np.random.default_rng([seed, 0x1E5]), report)


def mirrored(
    body: SeeingBody,
    lines: IntArray,
    low: FloatArray,
    high: FloatArray,
    count: int,
    rng: np.random.Generator,
    report: Callable[[float], None],
) -> Appearance:
    """What heads look like at `count` random postures between (2,) `low` and `high`, rad, felt on (2,) sense lines."""
    rest = body.command_angles(np.tile(body.rest, (body.copies, 1)))
    postures, seen = [], []
    rounds = -(-count // body.copies)
    sighting = np.repeat(np.arange(2 * len(FACE)), NUMBERS)  # the feature and eye that each number belongs to
    for turn in range(rounds):
        wanted = low + (high - low) * rng.random((body.copies, 2))
        senses = body.act(body.command_angles(wanted), look=False)
        taken, felt = body.senses.read(senses, "angle"), senses[:, lines]  # what the caregiver sees, what is felt
        body.teacher_path = still(taken + np.deg2rad(CARE_DEG) * rng.standard_normal(taken.shape))
        seen.append(face_numbers(body, body.act(rest)))
        postures.append(felt)
        report((turn + 1) / rounds)
    return Appearance.learned(np.concatenate(postures), np.concatenate(seen), sighting)


@dataclass(frozen=True)
class Occlusion:
    """A card that passes before the face."""

    start_s: float
    hidden_s: float
    distance: float
    """m of the card from the imitator."""

    def place(self, t: float) -> tuple[float, float, float]:
        """Where the card is at time t, in the table's frame: it slides in within 0.1 s, stays, slides on."""
        before, after = self.start_s - 0.1, self.start_s + self.hidden_s + 0.1
        if not before < t < after or self.hidden_s <= 0:
            return PARKED
        slide = np.clip((self.start_s - t) / 0.1, 0, 1) - np.clip((t - self.start_s - self.hidden_s) / 0.1, 0, 1)
        return self.distance, float(0.36 * slide), EYE_HEIGHT + 0.02


class Sequences(NamedTuple):
    """What B imitators saw, T ticks of 20 ms."""

    numbers: FloatArray
    """(T, B, M) NaN on ticks without an image."""
    truth: FloatArray
    """(T, B, 2) the teacher's true angles; NaN on ticks without an image."""
    images: list[tuple[Image, Image]]
    """Copy 0's, one for each frame."""
    hidden: BoolArray
    """(T, B) whether the card was there."""


def watch_teacher(
    body: SeeingBody,
    paths: list[FloatArray],
    occlusions: list[Occlusion],
    report: Callable[[float], None] = lambda done: None,
    *,
    move: Callable[[float], None] = lambda time_s: None,
    note: Callable[[], None] = lambda: None,
) -> Sequences:
    """Every copy watches its own teacher perform one of the (T_b, 2) paths of 20 ms ticks; the shorter ones wait.

    What else is there is moved before each look (`move`, told the time), and what else is found noted after (`note`).
    """
    longest = max(map(len, paths))
    longest += longest % 2
    padded = np.stack([np.pad(p, ((0, longest - len(p)), (0, 0)), mode="edge") for p in paths], axis=1)
    inner = round(body.tick_s / 0.02)
    body.teacher_path = lambda t: padded[min(round(t / 0.02), longest - 1)]
    rest = body.command_angles(np.tile(body.rest, (body.copies, 1)))
    numbers = np.full((longest, body.copies, 2 * len(FACE) * NUMBERS), np.nan)
    truth = np.full((longest, body.copies, 2), np.nan)
    hidden, images = np.zeros((longest, body.copies), bool), []
    for tick in range(0, longest, inner):
        cards = [occlusion.place(tick * 0.02) for occlusion in occlusions]
        body.place(CARD, np.array(cards))
        hidden[tick : tick + inner] = [place != PARKED for place in cards]
        move(tick * 0.02)
        senses = body.act(rest) if tick else body.reset()
        numbers[tick], truth[tick] = face_numbers(body, senses), body.teacher_angles
        images.append(body.images[0])
        note()
        report((tick + 1) / longest)
    body.place(CARD, np.array(PARKED))
    return Sequences(numbers, truth, images, hidden)


class Search(NamedTuple):
    """How a face was looked for."""

    found: bool
    seconds: float
    images: list[tuple[Image, Image]]
    pans: list[float]
    """rad, where each look went."""


def search(body: SeeingBody, start_pan: float, patience_s: float) -> Search:
    """Look for a face, first where one looks anyway; gives up after `patience_s` of looking elsewhere."""
    images, pans, clock = [], [], 0.0
    for pan in dict.fromkeys([start_pan, *np.deg2rad(SEARCH_PAN_DEG)]):
        if clock > 0 and clock + body.tick_s > patience_s:
            break
        goal = np.tile(body.rest + np.array([pan, 0.0]), (body.copies, 1))
        senses = body.act(body.command_angles(goal))
        images.append(body.images[0])
        pans.append(float(body.joint_angles[0, 0]))
        seen = np.isfinite(body.senses.read(senses, "place", FACE)[0, :, 0, 0]).sum()
        if seen >= LEAST_FACE:
            return Search(True, clock, images, pans)
        clock += body.tick_s
    return Search(False, clock, images, pans)
