"""At the table: a thing is seen, something is done with it by the one loop, and what becomes of it is seen."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray, fixed
from babbling.body_image import BodyImage
from babbling.mind import Mind
from experiments.shared.standing import FARTHEST, Joints
from imitation.acting.handling import again, movement, postures
from imitation.acting.loop import Imitator
from imitation.acting.movement import Movement
from imitation.acting.primitives import LOOK_AGAIN, WAYS_S, Thing, plan
from imitation.acting.reaching import places
from imitation.inference.moving import AveragedInverse
from models.body import SimulatedBody
from models.loading import load_body
from models.objects import TOYS
from models.objects.playing import MIDDLE, PlayBody
from models.objects.scene import PARTS
from models.objects.states import Watched
from models.robots import ROBOTS

SEATED = "hoap2-seated"
SEEING_M = 0.003
"""m of noise in every coordinate of every point that is seen."""
LOW = 0.034
"""m over the table at which a palm takes what lies on it: fingers point down a little."""
EVERY = 15
"""Ticks between two looks at what is done."""
CANDIDATES = 13
"""Actions that Eq. (1) weighs for every joint: fewer than in imitating a movement, for hundreds play at once."""
AFTER_S = 0.3
"""How long it waits to see what has become of it."""
TICK_S = 0.02
TICKS = 1 + round((sum(WAYS_S) + AFTER_S) / TICK_S)
LOOKED_AT = tuple(tick for tick in range(TICKS) if tick % EVERY == 0 or tick == TICKS - 1)
"""Ticks at which one looks."""
BESIDE = 0.04
"""m across from b where what vanishes went into it."""
USUAL = (0.03, 0.0, -0.08)
"""m: where something is believed to be that was never seen."""

Look = Callable[[PlayBody, FloatArray, bool, np.random.Generator], FloatArray]
"""Of a body, its (B, F) felt postures, and whether one looks closely, (B, 5, 3) m where hands, forehead, a and b are
seen; NaN for what is hidden."""


def points(noise: float = SEEING_M) -> Look:
    """Everything is seen as a point, with noise."""

    def look(body: PlayBody, felt: FloatArray, closely: bool, rng: np.random.Generator) -> FloatArray:
        true = body.places
        return np.asarray(true + noise * rng.standard_normal(true.shape))

    return look


def at_table(toy: str, copies: int, *, robot: str = SEATED, threads: int = 1, **how: Any) -> PlayBody:
    """So many copies of the robot on its seat before specimens of an object."""
    known = ROBOTS[robot]
    assert known.seat is not None
    return PlayBody(known, known.seat, TOYS[toy], name=robot, copies=copies, threads=threads, **how)


@dataclass(frozen=True)
class Tried:
    """What B of them did, and what came of it."""

    tick_s: float
    which: IntArray
    aims: FloatArray
    """(B, 5) see `babbling.play`."""
    seen: Watched
    """By their eyes, at `LOOKED_AT`, and as their own touch felt it."""
    true: Watched
    """Every tick, for those who judge."""
    missed: FloatArray
    """(B,) m that the image foretold the worst place would be missed by."""
    path: FloatArray
    """(T, B, F) postures that were the sub-goals."""
    angles: FloatArray
    """(T, B, J) true joint angles."""
    grips: FloatArray
    """(T, B, 2) N that palms held with at most."""
    laid: FloatArray
    """(B, pieces, 7) see `PlayBody.laid`."""
    configurations: FloatArray
    """(T, B, nq), only where they were asked for; otherwise of the first and last tick."""

    @property
    def tracks(self) -> FloatArray:
        """(B, L, 5, 3) where hands, forehead, a and b were seen; m."""
        return np.concatenate([self.seen.parts, self.seen.handles], 2).swapaxes(0, 1)

    def strain(self, rest: FloatArray) -> FloatArray:
        """(B,) rad^2 that the posture was from rest, at most."""
        return np.asarray(((self.path - rest) ** 2).sum(-1).max(0))

    @property
    def minutes(self) -> float:
        """Body time."""
        ticks, copies = self.path.shape[:2]
        return float(ticks * copies * self.tick_s / 60)


class Player:
    """Someone with a mind and a learned image of its own hands and head.

    Args:
        mind: what babbling on the seat taught.
        image: where hands and forehead are seen in a posture.
        look: how things are seen.
        robot: on a seat.
    """

    def __init__(self, mind: Mind, image: BodyImage, look: Look | None = None, robot: str = SEATED) -> None:
        self.mind, self.image, self.look = mind, image, look or points()
        self.hung: SimulatedBody = load_body(robot)
        mind.check(self.hung)
        image.check(self.hung)

    def tries(
        self,
        body: PlayBody,
        which: IntArray,
        aims: FloatArray,
        rng: np.random.Generator,
        *,
        keep: bool = False,
        careless: BoolArray | None = None,
    ) -> Tried:
        """Every copy does one primitive with its specimen, from rest, and looks once again half way.

        Args:
            body: at the table.
            which: (B,) primitives.
            aims: (B, 5).
            rng: of what is seen.
            keep: whether every configuration is kept, to draw it.
            careless: (B,) who does not look again.
        """
        schema, tick, joints, toy = self.mind.pilot.schema, body.tick_s, Joints(self.hung, body), body.toy
        assert toy is not None
        felt = body.reset()
        count, begin = body.copies, joints.felt(felt)[:, schema.posture]
        looks, true, signal = [self.look(body, begin, True, rng)], [body.places], [body.signal]
        low, first = np.full(count, body.table - MIDDLE[2] + LOW), remembered(np.array(looks), toy.half[2])[0]
        thing = Thing(*_seen(first), np.tile(toy.half, (count, 1)), np.full(count, toy.ends), low)
        planned = plan(thing, which, aims)
        ways, missed = postures(self.image, planned.places, begin)
        waiting = round(AFTER_S / tick)
        path = np.concatenate([begin[None], movement(ways, WAYS_S, begin, tick)])
        path = np.concatenate([path, np.repeat(path[-1:], waiting, 0)])
        grips = np.repeat(planned.grips, [round(s / tick) for s in WAYS_S], axis=0)
        grips = np.concatenate([grips, np.zeros((waiting, count, 2))])
        half_way = round(sum(WAYS_S[:LOOK_AGAIN]) / tick)
        still = Movement(SEATED, tick, self.hung.sensations(np.tile(self.image.rest, (3, 1))))
        inverse = AveragedInverse.of(self.mind, candidates=CANDIDATES)
        imitator = Imitator(self.mind, still, inverse=inverse, farthest=FARTHEST * self.mind.forward_model.habit[1])
        state = imitator.start(joints.felt(felt))._replace(targets=_onward(path))
        touch, angles, configurations = [body.senses.read(felt, "touch")], [body.joint_angles], [body.configuration]
        for number in range(len(path) - 1):
            if number == half_way:
                now = joints.felt(felt)[:, schema.posture]
                seen = self.look(body, now, True, rng)
                left = again(planned, thing, which, places(self.image, now), seen[:, PARTS:])
                if careless is not None:
                    left[:, careless] = planned.places[LOOK_AGAIN:, careless]
                ways, more = postures(self.image, left, ways[LOOK_AGAIN - 1])
                missed = np.maximum(missed, more)
                path[number + 1 : len(path) - waiting] = movement(ways, WAYS_S[LOOK_AGAIN:], path[number], tick)
                path[len(path) - waiting :] = path[len(path) - waiting - 1]
                state = state._replace(targets=_onward(path))
            state, motors, _ = imitator.step(state, joints.felt(felt), rng)
            state = state._replace(belief=imitator.estimate.usual(state.belief)[0])
            body.grip(grips[number])
            felt = body.act(motors)
            signal.append(body.signal)
            true.append(body.places)
            touch.append(body.senses.read(felt, "touch"))
            angles.append(body.joint_angles)
            if number + 1 in LOOKED_AT:
                now, last = joints.felt(felt)[:, schema.posture], number == len(path) - 2
                looks.append(self.look(body, now, last, rng))
            if keep or number == len(path) - 2:
                configurations.append(body.configuration)
        eyes, world, shone = remembered(np.array(looks), toy.half[2]), np.array(true), np.array(signal)
        newtons = np.array(touch)
        since = np.maximum.reduceat(newtons, [0, *(tick + 1 for tick in LOOKED_AT[:-1])])
        return Tried(
            tick,
            which,
            aims,
            Watched(eyes[:, :, PARTS:], eyes[:, :, :PARTS], shone[list(LOOKED_AT)], since),
            Watched(world[:, :, PARTS:], world[:, :, :PARTS], shone, newtons),
            missed,
            path,
            np.array(angles),
            np.concatenate([grips * body.grip_n[:, None], np.zeros((1, count, 2))]),
            body.laid,
            np.array(configurations),
        )


def remembered(looks: FloatArray, foot: float) -> FloatArray:
    """(T, B, 5, 3) without gaps: what is hidden is believed to be where it was seen last; but what vanished beside
    the other part, once all is done, in it, on its foot (m, half the height of b). What has no other part that shows
    has both where the one is; what was never seen is where things usually are."""
    filled, (a, b) = looks.copy(), (PARTS, PARTS + 1)
    for one, other in ((a, b), (b, a)):
        filled[0, :, one] = np.where(np.isnan(looks[0, :, one]), looks[0, :, other], looks[0, :, one])
    filled[0] = np.where(np.isnan(filled[0]), USUAL, filled[0])
    for before, now in pairwise(filled):
        now[:] = np.where(np.isnan(now), before, now)
    if len(looks) > 1:
        away = np.linalg.norm((filled[-1, :, a] - filled[-1, :, b])[:, :2], axis=1)
        inside = np.isnan(looks[-1, :, a, 0]) & ~np.isnan(looks[:, :, b, 0]).all(0) & (away < BESIDE)
        filled[-1, inside, a] = filled[-1, inside, b] - (0, 0, foot)
    return filled


def _seen(look: FloatArray) -> tuple[FloatArray, FloatArray]:
    return look[:, PARTS], look[:, PARTS + 1]


def _onward(path: FloatArray) -> FloatArray:
    """Sub-goals, and one beyond: it stays."""
    return fixed(np.concatenate([path, path[-1:]]))
