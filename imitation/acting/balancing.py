"""Staying on one's feet while doing what was seen: Eq. (1) with two terms, asked ahead of time.

    P(a | s, g) = c P(x = g once settled | lean, a)^w P(a matches the teacher),     a: offset along a synergy

The second term is what an offset costs: N(a; 0, MATCH^2), for the teacher showed none. The first is the table of
`babbling.balance`, w how much more it counts. A bow takes the centre of mass past the toes within a few tenths of a
second, and pressure goes the wrong way first: what was planned is therefore read one tick ahead. What is felt beyond
what was foretold comes too late for that; but what of it stays (a slope, a load) is as if one leaned so much more, and
Eq. (1) is asked again (`Feeling`). Joints that carry the body follow the teacher as far as both soles stay flat.

The sub-goal g is 0, between the soles, unless the teacher's legs shift the weight sideways (`sway`): then it is where
one leg can be lifted (`babbling.one_leg`), and while it is there that leg is free to follow.
"""

from typing import NamedTuple

import numpy as np
from scipy.ndimage import gaussian_filter1d, minimum_filter1d

from babbling.axes import Axis, FloatArray
from babbling.balance import SATURATED, SETTLED, Balance
from babbling.one_leg import SIDES
from babbling.synergies import ALIKE
from imitation.inference.inverse import BayesianInverse, InverseModel, LinearInverse, Term

MATCH = 0.3
"""rad; how far off the teacher's an ankle may be."""
WEIGHT = 4.0
"""w; at 1 the match costs a tenth of every offset, which is a third of a sole in a deep bow."""
SHARES = np.linspace(1, 0, 9)
"""How much of the teacher's legs is followed: the largest share whose posture leans at most `LEANS`."""
LEANS = 1.0
"""Units of pressure: what an offset can surely mend."""
EASING = 12
"""Ticks, standard deviation, over which that share changes."""
SMOOTH = 2.5
"""Ticks: an offset changes no faster than pressure settles."""
BEGIN = 25
"""Ticks over which the offset is taken up at first."""
STAYS = 100.0
"""Ticks over which what stays is told from what passes. Pressure goes the wrong way first: at 30 it shakes itself."""
QUICK, LATELY = 0.2, 10
"""Where pressure changes so much within so many ticks, half as much of it may stay: it is a movement, or a push."""
WHILE = 25
"""Ticks before and after a shift of weight in which nothing of it is heeded."""
MOST = 1.0
"""Units of pressure; more of it cannot be stood."""
SWAY, ON = 0.4, 0.9
"""Pressure that a teacher's legs sway to who puts all weight on one sole; the share of it from which a leg is free."""
LATE = 9
"""Ticks after that, and before the weight goes back, in which it is not."""


class Plan(NamedTuple):
    """Postures to come to, and why; T ticks of B copies."""

    postures: FloatArray
    """(T, B, F) with offsets."""
    planned: FloatArray
    """(T, B, F) what of the movement can be done."""
    lean: FloatArray
    """(T, B, 2) where pressure would settle without an offset."""
    offset: FloatArray
    """(T, B, 2) rad."""
    expected: FloatArray
    """(T, B, 2) pressure foretold with it."""
    goal: FloatArray
    """(T, B, 2) pressure that is wanted."""


class Balancer:
    """See the module.

    Args:
        balance: what was learned of standing.
        weight: w; 0 is a body that does not mind falling.
        linear: the peer: the least-squares line of the same experience instead of Eq. (1).
    """

    def __init__(self, balance: Balance, weight: float = WEIGHT, *, linear: bool = False) -> None:
        self.balance, self.weight, table = balance, weight, balance.forward_model
        free = np.exp(-0.5 * (table.action.points / MATCH) ** 2)
        self.match = free / free.sum(-1, keepdims=True)
        """(2, A) P(a matches the teacher)."""
        self.inverse: InverseModel | None = None  # before anything is counted, the wiggles' line
        if table.transitions:
            self.inverse = LinearInverse(table) if linear else BayesianInverse(table, prior=self.match)

    def terms(self, lean: FloatArray, goal: FloatArray) -> list[Term]:
        """(B, 2) leans should come to pressures (B, 2)."""
        table = self.balance.forward_model
        return [Term(table, (np.clip(lean, *_ends(table.contexts[0])),), goal, self.weight)]

    def choose(self, lean: FloatArray, goal: FloatArray | float = 0.0) -> FloatArray:
        """(..., 2) offsets by Eq. (1) by which (..., 2) leans come to pressures (..., 2)."""
        if not self.weight:
            return np.zeros_like(lean)
        if self.inverse is None:
            chosen = (goal - lean) @ np.linalg.inv(self.gains).T
        else:
            terms = self.terms(lean.reshape(-1, 2), np.broadcast_to(goal, lean.shape).reshape(-1, 2))
            chosen = self.inverse.choose(terms, np.random.default_rng(0)).action.reshape(lean.shape)
        return np.clip(chosen, *_ends(self.balance.forward_model.action))

    def expect(self, lean: FloatArray, offset: FloatArray) -> FloatArray:
        """(..., 2) pressure, once settled, of (..., 2) leans and offsets."""
        if self.inverse is None:
            return np.asarray(lean + offset @ self.gains.T)
        table = self.balance.forward_model
        context, action = np.clip(lean, *_ends(table.contexts[0])), np.clip(offset, *_ends(table.action))
        return self.inverse.expect((context.reshape(-1, 2),), action.reshape(-1, 2)).reshape(lean.shape)

    def offsets(self, lean: FloatArray, goal: FloatArray | float = 0.0) -> FloatArray:
        """(T, B, 2) the same, one tick ahead, as smoothly as pressure settles."""
        smooth = gaussian_filter1d(self.choose(lean, goal), SMOOTH, axis=0, mode="nearest")
        begin = np.minimum(np.arange(len(lean)) / BEGIN, 1)[:, None, None]
        return np.asarray(np.concatenate([smooth[1:], smooth[-1:]]) * begin)

    def plan(self, targets: FloatArray, explore: FloatArray | float = 0.0) -> Plan:
        """For (T, B, F) postures that one would like to come to; `explore` (T, B, 2) is added to the offsets."""
        onto, swayless = self.sway(targets)
        goal = onto @ self.balance.there
        up = _freed(onto) @ self.balance.free
        planned = self.follow(swayless - up * (swayless - self.balance.home))
        lean = self.balance.leaning(planned)
        offset = self.offsets(lean, goal) + explore
        planned = planned + up * (swayless - planned)
        expected = self.expect(lean, offset)
        return Plan(planned + offset @ self.balance.synergy, planned, lean, offset, expected, goal)

    def follow(self, targets: FloatArray) -> FloatArray:
        """(T, B, F) what of postures can be done on both soles; of what carries, only as much as leans little."""
        planned, carries = self.balance.safe(targets), self.balance.carries
        rest = planned + carries * (self.balance.home - planned)
        ways = [np.abs(self.balance.leaning(rest + share * (planned - rest))).max(-1) for share in SHARES]
        share = SHARES[np.argmax(np.stack([*ways[:-1], 0 * ways[0]]) <= LEANS, axis=0)]  # (T, B); none of it at last
        least = minimum_filter1d(share, 4 * EASING + 1, axis=0, mode="nearest")
        eased = gaussian_filter1d(least, EASING, axis=0, mode="nearest")[..., None]
        return np.asarray(rest + eased * (planned - rest))

    def sway(self, targets: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(T, B, 2) how far, from 0 to 1, legs of (T, B, F) postures shift the weight onto the sole of each side, and
        (T, B, F) the postures without that. On a sole is where one's own weight has to be, however far the teacher's
        legs sway; who cannot stand on one leg, or does not mind falling, knows no such place."""
        known, along = self.balance, self.balance.synergy[1]
        if not (self.weight and known.free.any()):
            return np.zeros((*targets.shape[:-1], 2)), targets
        strong = np.abs(along) > ALIKE
        each = (targets - known.home)[..., strong] / along[strong]
        far = np.maximum(each.min(-1), 0) + np.minimum(each.max(-1), 0)  # what all do: a leg aside is no shift
        onto = np.clip(far[..., None] * self.gains[1, 1] / SWAY * np.array(SIDES), 0, 1)
        return onto, targets - far[..., None] * along

    @property
    def gains(self) -> FloatArray:
        """(2, 2) pressure per rad of offset, as wiggling found it."""
        known = self.balance
        return np.asarray(known.pressing @ known.effects @ known.synergy.T)


class Feeling:
    """What pressure says beyond what was foretold of it, tick by tick.

    Args:
        balancer: who planned.
        plan: what, T ticks of B copies, or of one for all.
        copies: B.
    """

    def __init__(self, balancer: Balancer, plan: Plan, copies: int) -> None:
        self.balancer, self.plan = balancer, plan
        self.chosen = balancer.choose(plan.lean, plan.goal)
        """(T, B, 2) offsets if nothing stays."""
        self.stays = np.zeros((copies, 2))
        """(B, 2) units of pressure by which one seems to lean more than planned."""
        self.expected = list[FloatArray]()
        """Of every tick so far, (B, 2) pressure foretold of it once settled."""
        self.lately = list[FloatArray]()
        """(B, 2) pressures of the last `LATELY` ticks, and now."""

    def __call__(self, loads: FloatArray) -> FloatArray:
        """(B, 2) rad of offset beside the plan's, for the next command; (B, L) loads are those before it."""
        balance, tick = self.balancer.balance, len(self.expected)
        felt = balance.pressed(loads)
        self.lately = [*self.lately[-LATELY:], felt]
        if tick >= SETTLED + BEGIN:  # what was foretold is of both soles
            both = not self.plan.goal[max(0, tick - WHILE) : tick + WHILE].any()
            on_soles = both & (loads.sum(-1, keepdims=True) > balance.weight / 2)
            beyond = np.clip(felt - self.expected[tick - SETTLED], -MOST, MOST)
            counts = on_soles * (np.abs(felt) < SATURATED) / (1 + (self._pace(tick) / QUICK) ** 2)
            self.stays = np.clip(self.stays + counts * beyond / STAYS, -MOST, MOST)
        lean = self.plan.lean[tick + 1] + self.stays
        more = self.balancer.choose(lean, self.plan.goal[tick + 1]) - self.chosen[tick + 1]
        self.expected.append(self.balancer.expect(lean, self.plan.offset[tick + 1] + more))
        return np.asarray(more)

    def _pace(self, tick: int) -> FloatArray:
        """(B, 2) how much pressure, or the lean planned, changed of late: the more of both."""
        planned = np.abs(self.plan.lean[tick] - self.plan.lean[max(0, tick - LATELY)])
        return np.asarray(np.maximum(planned, np.abs(self.lately[-1] - self.lately[0])))


def _freed(onto: FloatArray) -> FloatArray:
    """(T, B, 2) how free, from 0 to 1, the leg beside each sole is while the weight is on the sole, `sway`: only well
    after it came there and before it leaves."""
    there = minimum_filter1d((onto > ON).astype(float), 2 * LATE + 1, axis=0, mode="nearest")
    return np.asarray(gaussian_filter1d(there, LATE / 3, axis=0, mode="nearest"))


def _ends(axis: Axis) -> tuple[FloatArray, FloatArray]:
    return axis.low, axis.high
