"""Learning to stand: on both feet, then on one."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.balance import Balance, Stood, find_pressure, settled, wiggled
from babbling.mind import Mind
from babbling.one_leg import SIDES, STAYED, free, lifts, shifts
from experiments.shared.journal import Journal
from experiments.shared.options import BodyOptions
from experiments.shared.standing import Joints, standing_of, wander
from imitation.acting.balancing import Balancer, Plan
from models.body import SimulatedBody
from models.standing import StandingBody

ROCKING, ROCKING_S, ROCKING_N = 8, 8.0, 4.0
"""Copies, seconds, and the strongest push of being rocked."""
WIGGLING, WIGGLING_S = 32, 10.0
STAGE, STAGE_S = 16, 8.0
STAGES = (0.2, 0.4, 0.6, 0.8, 1.0)
"""Shares of the joints' ranges that it moves over, one stage after the other."""
WIGGLE, EXPLORE = np.deg2rad(2.5), np.deg2rad(2.0)
"""How far every joint, then every offset, is moved at random, rad."""
GENTLY = 0.2
"""Top speed of wiggling, rad/s."""
QUIET = 0.3
"""Share of the range for what does not carry, in a quarter of the copies: quiet arms show what legs do."""
BEFORE_S = 0.3
"""What comes so shortly before a fall is part of it."""
LEARNERS = 100_000
"""Individuals from here on learn balance; those judged are others."""
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


@dataclass
class Learner:
    """Someone who learns to stand: mind, bodies, and what happened so far."""

    options: BodyOptions
    mind: Mind
    hung: SimulatedBody
    report: Callable[[float], None]
    journal: Journal
    minutes: list[float] = field(default_factory=list)
    falls: list[float] = field(default_factory=list)

    def bodies(self, copies: int) -> StandingBody:
        """Others than any before."""
        return standing_of(self.options, copies, LEARNERS + 1000 * self.options.seed + 100 * len(self.minutes))

    def lived(
        self, body: StandingBody, postures: FloatArray, pushes: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray, FloatArray, BoolArray]:
        """(T, B, L) loads, (T, B, 3) of gyro and accelerometer and (T, B) who is up, of (T, B, F) postures that are
        asked for and (T, B, 3) pushes; by heart, where the journal has it."""
        felt = self.journal.read(len(self.minutes), len(postures), body.copies)
        if felt is None:
            rows, motors = list[FloatArray](), self.mind.pilot.schema.motors(postures)
            for tick, command in enumerate(motors):
                if pushes is not None:
                    body.push(pushes[tick])
                senses = body.act(command)
                organs = [body.senses.read(senses, name)[:, 0] for name in ("gyro", "accelerometer")]
                rows.append(np.column_stack([body.senses.read(senses, "touch"), *organs, ~body.fallen]))
            felt = np.array(rows)
            self.journal.add(felt)
        up = felt[..., -1] > 0
        self.note(body, len(felt), int((~up[-1]).sum()))
        return felt[..., :-7], felt[..., -7:-4], felt[..., -4:-1], up

    def stand(self, body: StandingBody, plan: Plan) -> Stood:
        """Do what was planned, eyes shut."""
        body.reset()
        loads, turning, _, upright = self.lived(body, np.clip(plan.postures, *self.mind.pilot.ends.T))
        for copy in np.flatnonzero(~upright[-1]):
            upright[max(0, int(np.argmin(upright[:, copy])) - round(BEFORE_S / body.tick_s)) :, copy] = False
        return Stood(plan.planned, plan.offset, plan.postures, loads, turning, upright)

    def note(self, body: StandingBody, ticks: int, falls: int) -> None:
        """Keep how long it took and how often it fell."""
        self.minutes.append(ticks * body.copies * body.tick_s / 60)
        self.falls.append(falls)
        self.report(len(self.minutes) / (2 + len(STAGES)))


def learn_to_stand(
    options: BodyOptions,
    mind: Mind,
    hung: SimulatedBody,
    report: Callable[[float], None],
    journal: Journal | None = None,
) -> Balance:
    """Everything that is learned on one's feet; what the journal has already, by heart."""
    learner = Learner(options, mind, hung, lambda share: report(min(BOTH * share, 1.0)), journal or Journal())
    found = one_leg(learner, learn_balance(learner), np.random.default_rng([options.seed, 31]))
    return replace(found, minutes=np.array(learner.minutes), falls=np.array(learner.falls))


def learn_balance(learner: Learner) -> Balance:
    """Be rocked, wiggle, then move ever further about; see `babbling.balance`."""
    mind, body = learner.mind, learner.bodies(ROCKING)
    tick, rng = body.tick_s, np.random.default_rng([learner.options.seed, 30])
    loads, leaning, home = rocked(learner, body, rng)
    pressure, _ = find_pressure(loads, leaning)
    body = learner.bodies(WIGGLING)
    beside = wander(np.full(len(home), WIGGLE), body, WIGGLING_S, rng, GENTLY)
    still = Plan(home + beside, home + beside, *(np.zeros((*beside.shape[:2], 2)) for _ in range(4)))
    run = learner.stand(body, still)
    reach = np.stack([mind.pilot.low, mind.pilot.high])
    found = wiggled(run, home, reach, pressure, body.senses.lines("touch").ravel(), tick, body.fingerprint)
    runs: list[Stood] = []
    low, high, carries = mind.pilot.low, mind.pilot.high, found.carries > 0
    for share in STAGES:
        body = learner.bodies(STAGE)
        moves = wander(share * np.stack([low - home, high - home]), body, STAGE_S, rng)
        moves[:, ::2, carries] = 0
        moves[:, 1::4, ~carries] *= QUIET
        explore = wander(np.full(2, EXPLORE), body, STAGE_S, rng)
        runs.append(learner.stand(body, Balancer(found).plan(home + moves, explore)))
        lean, table = settled(found, runs, tick)
        found = replace(found, weights=lean, forward_model=table)
    return replace(found, minutes=np.array(learner.minutes), falls=np.array(learner.falls))


def rocked(learner: Learner, body: StandingBody, rng: np.random.Generator) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(T, B, L) loads and (T, B, 3) of the accelerometer while somebody rocks it, the first second left out; and the
    posture it holds."""
    home = Joints(learner.hung, body).felt(body.reset())[:, learner.mind.pilot.schema.posture].mean(0)
    force = wander(np.full(2, ROCKING_N), body, ROCKING_S, rng, ROCKING_N * 3)
    still = np.tile(home, (*force.shape[:2], 1))
    loads, _, leaning, _ = learner.lived(body, still, np.pad(force, ((0, 0), (0, 0), (0, 1))))
    begin = round(1 / body.tick_s)
    return loads[begin:], leaning[begin:], home


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
