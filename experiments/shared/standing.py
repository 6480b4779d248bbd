"""On one's own feet: the body that stands, and how it imitates there."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from babbling.axes import BoolArray, FloatArray, fixed
from babbling.exploration import MotorRange, smooth
from babbling.mind import Mind
from experiments.shared.options import BodyOptions
from imitation.acting.balancing import Balancer, Feeling, Plan
from imitation.acting.loop import Imitator, Info, lasting
from imitation.acting.movement import Movement, slowed
from models.body import SimulatedBody
from models.loading import load_standing
from models.standing import Individuals, StandingBody

PACE = 1.0
"""Top speed of moving about, rad/s."""
FARTHEST = 16.0
"""Standard deviations of what babbling did beside its habit; 13 are the most that clips ask of a body on its stand."""
LET_GO_S = 0.1
"""What touched comes free within that; until then it counts as touching."""


def standing_of(
    options: BodyOptions,
    copies: int,
    first: int,
    *,
    individuals: Individuals = Individuals(),  # noqa: B008  (frozen)
    tilt_deg: tuple[float, float] = (0.0, 0.0),
) -> StandingBody:
    """Individuals `first` and following of the robot, on their feet."""
    return load_standing(
        options.robot,
        copies=copies,
        threads=options.threads,
        noise=float(np.deg2rad(options.sensor_noise_deg)),
        scramble=options.scramble,
        seed=options.seed * 1000 + first % 997,
        individuals=replace(individuals, first=first),
        tilt_deg=tilt_deg,
    )


class Joints:
    """What a mind that babbled on its stand feels of a body elsewhere: its joints, on the lines it knows them by."""

    def __init__(self, hung: SimulatedBody, body: SimulatedBody) -> None:
        self.hung, self.body = hung, body

    def felt(self, senses: FloatArray) -> FloatArray:
        """(B, S) senses as on the stand."""
        return self.hung.senses.vector({name: self.body.senses.read(senses, name) for name in ("angle", "speed")})


def wander(
    reach: FloatArray, body: StandingBody, seconds: float, rng: np.random.Generator, pace: float = PACE
) -> FloatArray:
    """(T, B, K) smooth moves about 0 within `reach`, (K,) either way or (2, K) ends; pace in its units a second."""
    low, high = (-reach, reach) if reach.ndim == 1 else reach
    low, high = np.minimum(low, 0.0), np.maximum(high, 0.0)
    nothing = np.zeros(len(low))
    span = MotorRange(low, high, nothing, np.full(len(low), pace), nothing)
    return np.array(
        list(islice(smooth(span, body.copies, body.tick_s, rng, decades=0.9), round(seconds / body.tick_s)))
    )


def paced(angles: FloatArray, speed: float, hung: SimulatedBody) -> Movement:
    """(T, J) joint angles so many times as fast."""
    faster = np.clip(slowed(angles, 1 / speed), *hung.joint_range.T)
    return Movement("standing", hung.tick_s, hung.sensations(faster))


PUSH_S = 0.1
"""How long a push lasts."""


def shove(force: FloatArray, begin: float) -> Callable[[float], FloatArray]:
    """Pushes of (3,) or (B, 3) N from `begin` on, s."""
    return lambda now: force * (begin <= now < begin + PUSH_S)


@dataclass(frozen=True)
class Performance:
    """How B copies did on their feet, at T ticks; for those who judge."""

    plan: Plan
    angles: FloatArray
    """(T, B, J) true joint angles."""
    configurations: FloatArray
    """(T, B, nq)."""
    loads: FloatArray
    """(T, B, L)."""
    upright: BoolArray
    """(T, B)."""
    first: int
    """Tick at which the movement itself begins."""
    pushes: FloatArray
    """(T, B, 3) N."""
    foretold: FloatArray
    """(T, B, 2) pressure of each posture once settled, what stays of what was felt included."""
    stays: FloatArray
    """(T, B, 2) see `Feeling`."""
    resisted: BoolArray
    """(T, B, F) see `StateEstimate.usual`."""
    choice_s: FloatArray
    """(T - 1,) wall time of choosing for all joints of all copies."""
    lifted: FloatArray
    """(T, B, 2) m of each foot."""
    infos: Sequence[Info] = ()
    """Of every choice while somebody was upright; commands as they were sent."""

    @property
    def fell(self) -> BoolArray:
        """(B,)."""
        return np.asarray(~self.upright[-1])


Reflex = Callable[[int, FloatArray, FloatArray], FloatArray]
"""Asked at every tick with its number, (B, L) loads and (B, 3) gyro: (B, 2) more offset, rad."""
REST_S = 1.0
"""How long it is to stand after the movement."""


def perform(
    body: StandingBody,
    hung: SimulatedBody,
    mind: Mind,
    movement: Movement,
    balancer: Balancer,
    *,
    replay: bool = False,
    feels: bool = True,
    reflex: Reflex | None = None,
    push: Callable[[float], FloatArray] | None = None,
) -> Performance:
    """Do a movement on one's feet: what carries as planned, all else by Eq. (1) as on the stand.

    Args:
        body: any number of copies.
        hung: the same robot on its stand: the lines that the mind knows.
        mind: what babbling on the stand taught.
        movement: sub-goals, in the senses of the stand.
        balancer: plans.
        replay: the peer: sub-goals are simply sent, legs and all.
        feels: whether what is felt beyond what was foretold is heeded.
        reflex: another peer: something is done about what is felt.
        push: (B, 3) N at so many seconds of the movement.
    """
    schema, known, tick = mind.pilot.schema, balancer.balance, body.tick_s
    joints, carries = Joints(hung, body), known.carries > 0
    resting = round(REST_S / tick)
    senses = np.concatenate([movement.senses, np.repeat(movement.senses[-1:], resting, 0)])
    imitator = Imitator(mind, replace(movement, senses=senses), farthest=FARTHEST * mind.forward_model.habit[1])
    felt = body.reset()
    state = imitator.start(joints.felt(felt))
    plan = balancer.plan(state.targets[:, :1])
    if replay:
        plan = plan._replace(postures=state.targets[:, :1], planned=state.targets[:, :1], offset=0 * plan.offset)
    state = state._replace(targets=fixed(np.repeat(plan.postures, body.copies, 1)))
    feeling = Feeling(balancer, plan, body.copies)
    rng, first = np.random.default_rng(0), state.left - len(senses)
    rows: list[Sequence[FloatArray | BoolArray]] = []
    infos, choices, resisted = list[Info](), list[float](), np.zeros((body.copies, len(known.carries)), bool)
    while True:
        number, force = state.tick, np.zeros((body.copies, 3))
        if push is not None:
            force[:] = push((number - first) * tick)
            body.push(force)
        loads = body.senses.read(felt, "touch")
        felt_so = (feeling.stays.copy(), resisted, body.lifted)
        rows.append((body.joint_angles.copy(), body.configuration, loads, ~body.fallen, force, *felt_so))
        if not state.left:
            break
        command, clock = state.targets[number + 1], time.perf_counter()
        if replay or body.fallen.all():
            state = state._replace(tick=number + 1)
        else:
            state, _, info = imitator.step(state, joints.felt(felt), rng)
            belief, resisted = imitator.estimate.usual(state.belief)
            state = state._replace(belief=belief)
            if feels:
                command = command + feeling(loads) @ known.synergy
            if reflex is not None:
                command = command + reflex(number, loads, body.senses.read(felt, "gyro")[:, 0]) @ known.synergy
            command = np.clip(np.where(carries, command, info.commands), *mind.pilot.ends.T)
            infos.append(lasting(replace(info, commands=command)))
        choices.append(time.perf_counter() - clock)
        felt = body.act(schema.motors(np.clip(command, *mind.pilot.ends.T)))
    angles, configurations, loads, upright, pushes, stays, met, lifted = map(np.array, zip(*rows, strict=True))
    foretold = np.broadcast_to(plan.expected, (len(rows), body.copies, 2)).copy()
    foretold[1 : len(feeling.expected) + 1] = np.array(feeling.expected).reshape(-1, body.copies, 2)
    spent = np.array(choices)
    return Performance(
        plan, angles, configurations, loads, upright, first, pushes, foretold, stays, met, spent, lifted, infos
    )  # fmt: skip
