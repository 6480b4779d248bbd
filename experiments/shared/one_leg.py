"""Learning to stand: on both feet, then on one."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.balance import Balance, Stood
from babbling.mind import Mind
from babbling.one_leg import SIDES, STAYED, free, lifts, shifts
from experiments.shared.options import BodyOptions
from experiments.shared.standing import GENTLY, Learner, learn_balance, wander
from imitation.acting.balancing import Balancer, Plan
from models.body import SimulatedBody

TRIES, ALONE = 12, 16
"""Copies that try how far to shift the weight, then that stand there on one leg; half of them on each."""
SHIFT_S, LIFT_S, ALONE_S = 1.5, 0.8, 5.8
"""How long the shift, the lift, and standing there takes."""
SHIFTS = (0.35, 0.95)
"""Pressures that the weight is shifted to before the lift."""
TREMBLE = np.deg2rad(2.0)
"""How far every carrying joint is moved at random there, rad."""
BOTH = 0.8
"""About the share of the time that both feet take."""


def learn_to_stand(options: BodyOptions, mind: Mind, hung: SimulatedBody, report: Callable[[float], None]) -> Balance:
    """Everything that is learned on one's feet."""
    found = learn_balance(options, mind, hung, lambda share: report(BOTH * share))
    learner = Learner(options, mind, hung, lambda share: report(1.0), list(found.minutes), list(found.falls))
    found = one_leg(learner, found, np.random.default_rng([options.seed, 31]))
    return replace(found, minutes=np.array(learner.minutes), falls=np.array(learner.falls))


def one_leg(learner: Learner, found: Balance, rng: np.random.Generator) -> Balance:
    """Shift the weight onto one sole, lift the other leg, then wiggle; see `babbling.one_leg`."""
    pilot, tick = learner.mind.pilot, learner.hung.tick_s
    tried, side = (np.arange(copies) % len(SIDES) for copies in (TRIES, ALONE))

    def stand(side: IntArray, goal: FloatArray, seconds: float, wiggles: FloatArray) -> Stood:
        body, up = learner.bodies(len(side)), lifts(found, pilot.low, pilot.high)[side]
        second = np.arange(round((SHIFT_S + LIFT_S + seconds) / tick)) * tick
        shift, lift, late = (
            np.clip((second - begin) / length, 0, 1)[:, None, None]
            for begin, length in ((0, SHIFT_S), (SHIFT_S, LIFT_S), (SHIFT_S + LIFT_S, LIFT_S))
        )
        planned = found.home + lift * up + late * wander(wiggles, body, len(second) * tick, rng, GENTLY)
        lean = np.broadcast_to(found.leaning(found.home), (*planned.shape[:2], 2))
        wanted = shift * goal
        offset = Balancer(found).offsets(lean, wanted)
        return learner.stand(body, Plan(planned + offset @ found.synergy, planned, lean, offset, wanted, wanted))

    far = np.take(SIDES, tried) * np.linspace(*SHIFTS, TRIES)
    there = shifts(found, stand(tried, np.stack([0 * far, far], -1), STAYED * tick, 0 * found.home), tried, far)
    run = stand(side, there[side], ALONE_S, TREMBLE * found.carries)
    return replace(found, there=there, free=free(found, run, side, round((SHIFT_S + 2 * LIFT_S) / tick)))
