"""What one does with things: primitives, each a few places that one's own parts are to come to, one after the other.

Places are told relative to what is seen: the middles a and b of the two parts a thing is known by, and how far it
reaches to the side and up. They become postures, a smooth movement, and sub-goals in `imitation.acting.handling`.
Where exactly a thing is touched is not told: the aim (forward, outwards, up) is added to every place of contact, and
found by play.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray

WAYS_S: Final = (0.9, 0.5, 0.4, 0.3, 1.0, 0.6, 0.5, 0.5, 0.5)
"""Seconds to each of the places."""
LOOK_AGAIN: Final = 6
"""Before this one, one looks again."""
BEYOND: Final = 0.012
"""m that a touch goes on beyond a surface."""
NEAR: Final = 0.025
"""m from a surface at which one waits before touching."""
ABOVE: Final = 0.035
"""m above a thing from where it is approached."""
LIFT: Final = 0.05
CLEAR: Final = 0.012
"""m by which what is carried clears what it is carried over."""
TOUCH: Final = 2
"""The place at which one touches, of the ways of a primitive."""
LEFT, RIGHT, HEAD = 0, 1, 2
ASIDE: Final = np.array([-0.05, 0.27, -0.03])
"""m where the left hand is out of the way of a head that leans forward; the right one's mirror image."""
_UP: Final = np.array([0.0, 0.0, 1.0])
_LEFT: Final = np.array([0.0, 1.0, 0.0])
_FORWARD: Final = np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True)
class Thing:
    """N things as they are seen."""

    a: FloatArray
    """(N, 3) m."""
    b: FloatArray
    half: FloatArray
    """(N, 3) m from the middle of a to its side and to its top, and of b to its top."""
    ends: BoolArray
    """(N,) whether a and b are ends of one thing."""
    floor: FloatArray
    """(N,) m, height at which a hand takes what lies on the table."""

    def only(self, rows: IntArray) -> "Thing":
        """Some of them."""
        return Thing(self.a[rows], self.b[rows], self.half[rows], self.ends[rows], self.floor[rows])


@dataclass
class Plan:
    """Places (9, N, 3 parts, 3), NaN where a part is left alone; how hard palms hold (9, N, 2)."""

    places: FloatArray
    grips: FloatArray

    @classmethod
    def empty(cls, count: int) -> "Plan":
        """Nothing is done."""
        return cls(np.full((len(WAYS_S), count, 3, 3), np.nan), np.zeros((len(WAYS_S), count, 2)))


class View:
    """A thing from the point of view of one who handles it."""

    def __init__(self, thing: Thing, aims: FloatArray) -> None:
        self.thing = thing
        self.where, self.far, self.effort = aims[:, :3], np.maximum(aims[:, 3:4], 0), np.clip(aims[:, 4], 0, 1)
        away = (thing.a - thing.b) * (1, 1, 0)
        length = np.linalg.norm(away, axis=1, keepdims=True)
        self.axis = np.where(thing.ends[:, None] & (length > 0.01), away / np.maximum(length, 1e-9), _LEFT)
        self.width, self.height, self.other = thing.half[:, :1], thing.half[:, 1:2], thing.half[:, 2:]
        self.near = np.where(thing.a[:, 1] > 0, LEFT, RIGHT)
        """The hand on a's side."""
        self.way = (thing.b - thing.a) * (1, 1, 0)

    def out(self, hand: int) -> FloatArray:
        """(N, 3) away from the thing on this hand's side."""
        return np.asarray(self.axis if hand == LEFT else -self.axis)

    def aim(self, hand: int) -> FloatArray:
        """(N, 3) m."""
        forward, out, up = self.where.T[..., None]
        return np.asarray(forward * _FORWARD + out * self.out(hand) + up * _UP)

    def end(self, hand: int) -> FloatArray:
        """(N, 3) what this hand takes of it, at the height at which a hand reaches it."""
        place = np.where(self.thing.ends[:, None] & (hand == RIGHT), self.thing.b, self.thing.a).copy()
        place[:, 2] = np.maximum(place[:, 2], self.thing.floor)
        return np.asarray(place + self.aim(hand))

    def top(self, other: bool = False) -> FloatArray:
        """(N, 3) its top, for the hand that is near; or the other part's."""
        sides = np.where((self.near == LEFT)[:, None], self.aim(LEFT), self.aim(RIGHT))
        return np.asarray((self.thing.b + self.other * _UP if other else self.thing.a + self.height * _UP) + sides)


Primitive = Callable[[View, Plan], None]
PRESS: Final = 0.006
"""m that hands press on what they take from both sides."""
THICK: Final = 0.0125
"""m, half the thickness of one's own hand."""


def _from_outside(view: View, plan: Plan, *, holds: bool, last: Callable[[int], FloatArray]) -> None:
    for hand in (LEFT, RIGHT):
        touch = view.end(hand) + view.out(hand) * (view.width + THICK - PRESS)
        ahead = touch + view.out(hand) * NEAR
        for way, place in enumerate((ahead + ABOVE * _UP, ahead, touch, touch, touch + last(hand), touch + last(hand))):
            plan.places[way, :, hand] = place
        if holds:
            plan.grips[2:5, :, hand] = view.effort[:, None].T


def pull(view: View, plan: Plan) -> None:
    """Take both sides and draw them apart."""
    _from_outside(view, plan, holds=True, last=lambda hand: view.out(hand) * view.far)


def push_together(view: View, plan: Plan) -> None:
    """Press both sides towards each other."""
    _from_outside(view, plan, holds=False, last=lambda hand: -view.out(hand) * NEAR)


def lift_with_both(view: View, plan: Plan) -> None:
    """Take both sides and raise it."""
    _from_outside(view, plan, holds=True, last=lambda hand: LIFT * _UP)


def squeeze(view: View, plan: Plan) -> None:
    """Hold both sides."""
    _from_outside(view, plan, holds=True, last=lambda hand: -view.out(hand) * BEYOND)


def spread(view: View, plan: Plan) -> None:
    """Put both hands between its ends and push outwards."""
    for hand in (LEFT, RIGHT):
        inside = np.where(view.thing.ends[:, None], view.width + THICK, -view.width - THICK)
        touch = view.end(hand) - view.out(hand) * (inside + 0.008)
        apart = touch + view.out(hand) * (view.far + BEYOND)
        for way, place in enumerate((touch + LIFT * _UP, touch + LIFT * _UP, touch, touch, apart, apart)):
            plan.places[way, :, hand] = place


def _with_near_hand(view: View, plan: Plan, ways: tuple[FloatArray, ...], grip: slice | None = None) -> None:
    rows = np.arange(len(view.near))
    for way, place in enumerate(ways):
        plan.places[way, rows, view.near] = place
    if grip is not None:
        plan.grips[grip, rows, view.near] = view.effort


def press(view: View, plan: Plan) -> None:
    """Touch its top with the hand."""
    top = view.top() + THICK * _UP
    deep = top - BEYOND * _UP
    _with_near_hand(view, plan, (top + ABOVE * _UP, top + BEYOND * _UP, deep, deep, top + ABOVE * _UP))


def press_the_other(view: View, plan: Plan) -> None:
    """Touch its other part with the hand."""
    top = view.top(other=True) + THICK * _UP
    deep = top - BEYOND * _UP
    _with_near_hand(view, plan, (top + ABOVE * _UP, top + BEYOND * _UP, deep, deep, top + ABOVE * _UP))


def press_with_the_head(view: View, plan: Plan) -> None:
    """Lean forward and touch its top with the forehead."""
    top = view.thing.a + view.height * _UP + view.where
    deep = top - BEYOND * _UP
    ways = (top + LIFT * _UP, top + BEYOND * _UP, deep, deep, top + LIFT * _UP)
    for way, place in enumerate(ways):
        plan.places[way, :, HEAD] = place
        plan.places[way, :, LEFT], plan.places[way, :, RIGHT] = ASIDE, ASIDE * (1, -1, 1)


def hold(view: View, plan: Plan) -> None:
    """Take it from above and stay."""
    _grasped(view, plan, (0 * _UP, 0 * _UP), slice(2, 6))


def lift(view: View, plan: Plan) -> None:
    """Take it from above and raise it."""
    _grasped(view, plan, (LIFT * _UP, LIFT * _UP), slice(2, 6))


def carry(view: View, plan: Plan) -> None:
    """Take it from above, bring it over the other part, let go."""
    over = np.maximum(view.thing.b - view.thing.a + (view.other + view.height + CLEAR) * _UP, 0) * _UP
    there = over + view.way
    _grasped(view, plan, (over, there, there - CLEAR * _UP, there - CLEAR * _UP, there + ABOVE * _UP), slice(2, 7))


def carry_and_push(view: View, plan: Plan) -> None:
    """Take it from above and push it against the other part."""
    ahead = view.way / np.maximum(np.linalg.norm(view.way, axis=1, keepdims=True), 1e-9)
    there = view.way
    ways = (0 * _UP, there - 0.052 * ahead, there - 0.03 * ahead, there - 0.008 * ahead, there - 0.008 * ahead)
    _grasped(view, plan, ways, slice(2, 9))


def _grasped(view: View, plan: Plan, onwards: tuple[FloatArray, ...], grip: slice) -> None:
    top = view.top() + 0.01 * _UP
    touch = top - 0.004 * _UP
    ways = (top + ABOVE * _UP, top + 0.006 * _UP, touch, touch, *(touch + onward for onward in onwards))
    _with_near_hand(view, plan, ways, grip)


def sweep(view: View, plan: Plan) -> None:
    """Push it sideways across the table."""
    side = np.where((view.near == LEFT)[:, None], _LEFT, -_LEFT)
    low = np.where((view.near == LEFT)[:, None], view.end(LEFT), view.end(RIGHT))
    begin, end = low + side * (view.width + 0.045), low - side * view.far
    _with_near_hand(view, plan, (begin + ABOVE * _UP, begin, begin, end, end))


PRIMITIVES: Final[dict[str, Primitive]] = {
    "pull": pull,
    "spread": spread,
    "push together": push_together,
    "squeeze": squeeze,
    "lift with both": lift_with_both,
    "press": press,
    "press with the head": press_with_the_head,
    "press the other": press_the_other,
    "hold": hold,
    "lift": lift,
    "carry": carry,
    "carry and push": carry_and_push,
    "sweep": sweep,
}
"""All, by name; a primitive is this number along the axis of actions."""
NAMES: Final = tuple(PRIMITIVES)
WITH_ANOTHER: Final = ("press the other", "carry", "carry and push")
"""Those that need another part."""


def possible(alone: bool) -> IntArray:
    """Primitives that can be done with a thing, which has another part or is `alone`."""
    return np.array([number for number, name in enumerate(NAMES) if not (alone and name in WITH_ANOTHER)])


def plan(thing: Thing, which: IntArray, aims: FloatArray) -> Plan:
    """What N do, each one of the primitives, with (N, 5) aims (see `babbling.play`): forward, outwards (for one hand:
    towards its own side), up [m]; how far a thing is moved [m]; how hard a palm holds [0 to 1]."""
    whole = Plan.empty(len(which))
    for number, name in enumerate(NAMES):
        rows = np.flatnonzero(which == number)
        if len(rows):
            some = Plan.empty(len(rows))
            view = View(thing.only(rows), aims[rows])
            PRIMITIVES[name](view, some)
            whole.places[:, rows], whole.grips[:, rows] = some.places, some.grips
    return whole
