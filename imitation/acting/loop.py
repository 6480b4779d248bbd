"""The match-to-target loop (chapter, Figure 9): believe, compare, choose, act, feel; and again, a little better.

Once per tick (`Imitator.step`): the senses correct the believed state; Eq. (1) is asked for the action that takes it to
the next sub-goal; the efference copy carries the belief on. From attempt to attempt (`imitate`), what was missed shifts
the sub-goals.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from babbling.axes import BoolArray, FloatArray, fixed
from babbling.belief import StateEstimate
from babbling.body import Body
from babbling.features import Echo
from babbling.kalman import Belief
from babbling.mind import Mind
from imitation.acting.attempts import SMOOTHING, Practice
from imitation.acting.movement import Movement, approach
from imitation.errors import ImitationError
from imitation.inference.inverse import Term
from imitation.inference.moving import AveragedInverse, Here, MovingInverse


class State(NamedTuple):
    """All that the next step needs; never changed, so that a step can be taken again or another way."""

    tick: int
    """Steps taken, those of the approach included."""
    belief: Belief
    """What the next senses are expected to correct."""
    echo: Echo
    """What earlier commands left."""
    targets: FloatArray
    """(N + 1, B, F) postures of the approach, of the movement, and one beyond."""

    @property
    def left(self) -> int:
        """Steps to the end of the movement."""
        return len(self.targets) - 1 - self.tick


@dataclass(frozen=True, eq=False)
class Info:
    """What people look at, of one step."""

    believed: FloatArray
    """(B, F, 3) posture, rate, bias."""
    missed: FloatArray
    """(B, F, 2) felt posture and rate minus those foretold a tick before: the innovation of the belief."""
    origin: FloatArray
    """(B, F) posture that actions are counted from: a command is this and the action."""
    wanted: FloatArray
    """(B, F) outcome that the inverse model was asked for."""
    commands: FloatArray
    """(B, F) commanded postures."""
    candidates: FloatArray
    """(B, F, A) actions that Eq. (1) weighed; (B, F, 0) for inverse models without beliefs."""
    posterior: FloatArray
    """(B, F, A) Eq. (1) over them."""
    evidence: FloatArray
    """(B, F); (B, 0) without beliefs."""
    entropy: FloatArray
    """(B, F) bits; (B, 0) without beliefs."""
    familiarity: FloatArray
    """(F,) visits that the row of copy 0's action had while babbling (0: never tried here)."""
    uninformed: BoolArray
    """(B, F) where the forward model was asked beyond its table's axes."""
    select_s: FloatArray
    """() wall time of one selection for all factors and copies."""


@dataclass(frozen=True, eq=False)
class Attempt(Info):
    """`Info` over the T ticks of the movement that happened (of the approach, where it went is all that is kept): T in
    front of every shape; candidates, posterior and familiarity of copy 0 alone, single precision."""

    senses: FloatArray
    """(T, B, S) sensations at each sub-goal's time."""
    truth: FloatArray
    """(T, B, ...) whatever `witness` returned each tick (for those who judge, not for the mind); empty without one."""
    way: FloatArray
    """(N, B, F) postures of the approach, before any aiming beside them."""
    approach: FloatArray
    """(N, B, ...) what `witness` returned meanwhile; fewer where it ended there."""
    ended: str | None
    """Why it ended early; None where it came to the end."""
    ended_tick: int
    """Tick of the movement that was not done any more: T, or negative where it ended while approaching."""


def lasting(info: Info) -> Info:
    """What is kept of a step: many copies' posteriors would fill the memory."""
    few = {name: getattr(info, name)[0].astype(np.float32) for name in ("posterior", "candidates")}
    return replace(info, familiarity=info.familiarity.astype(np.float32), **few)


def through_time(infos: Sequence[Info]) -> dict[str, NDArray[Any]]:
    """(T, ...) every field of some steps."""
    return {field.name: np.array([getattr(info, field.name) for info in infos]) for field in fields(Info)}


class Imitator:
    """One movement, to be driven step by step: by `imitate`, by a notebook, by a real robot's own loop.

    Args:
        mind: what babbling learned.
        movement: what was seen, in the body's senses, at its tick.
        selection: selection rule on Eq. (1)'s posterior.
        inverse: another inverse model in the same loop (peers); default is Eq. (1).
        eagerness: (F,) or (B, F) share of the believed error to undo within one tick; None is the mind's own temper.
        terms: what else an action should bring about, to be multiplied into Eq. (1): asked at every tick with (B, S)
            senses and (B, F, 3) believed posture, rate and bias.
        farthest: (F,) rad that a command may be from the believed posture, for a body that may be knocked: told of
            more than any line foretells, a joint swings for a second.

    Raises:
        ImitationError: a posture that the mind needs was not seen.
    """

    def __init__(
        self,
        mind: Mind,
        movement: Movement,
        *,
        selection: str = "map",
        inverse: MovingInverse | None = None,
        eagerness: FloatArray | float | None = None,
        terms: Callable[[FloatArray, FloatArray], Sequence[Term]] = lambda senses, believed: (),
        farthest: FloatArray | float = np.inf,
    ) -> None:
        self.mind, self.tick_s, goals = mind, movement.tick_s, movement.postures(mind.pilot.schema)
        self.goals = goals if goals.ndim == 3 else goals[:, None]  # (T, 1 or B, F)
        self.inverse = inverse or AveragedInverse.of(mind, selection)
        self.eagerness = np.asarray(mind.temper.eagerness if eagerness is None else eagerness, float)
        self.terms = terms
        self.estimate = StateEstimate(mind.pilot.schema, mind.pilot.dynamics)
        self.farthest = farthest

    def start(self, senses: FloatArray, aim: ArrayLike = 0.0) -> State:
        """At rest, feeling (B, S): every copy's own way into the movement.

        Args:
            senses: what is felt before the first step; `step` is to be given it as well.
            aim: (T, B, F) offset of each sub-goal.
        """
        schema, goals = self.mind.pilot.schema, self.goals
        posture, rate = senses[:, schema.posture], senses[:, schema.rate]
        shift = np.broadcast_to(aim, (len(goals), *posture.shape))
        way = approach(posture, self.goals, self.tick_s, self.mind.pilot.low, self.mind.pilot.high)
        # while approaching, the first sub-goal's shift is taken up gradually
        up = np.linspace(0, 1, len(way))[:, None, None]
        targets = np.concatenate([way + up * shift[:1], goals + shift])
        targets = np.concatenate([targets, 2 * targets[-1:] - targets[-2:-1]])  # one beyond: the last own pace
        echo = self.mind.pilot.frame.features.start(posture)
        return State(0, self.estimate.start(posture, rate), echo, fixed(targets))

    def step(self, state: State, senses: FloatArray, rng: np.random.Generator) -> tuple[State, FloatArray, Info]:
        """One tick: feeling (B, S), the state after it, (B, M) motor commands, and what there is to see.

        Raises:
            ImitationError: the movement is over.
        """
        if not state.left:
            raise ImitationError(f"step {state.tick + 1} of a movement that ends with step {state.tick}")
        schema, belief = self.mind.pilot.schema, state.belief
        felt = np.stack([senses[:, schema.posture], senses[:, schema.rate]], -1)
        missed = felt - belief.mean[..., :2]
        if state.tick:  # the first senses made the belief
            belief = self.estimate.correct(belief, felt[..., 0], felt[..., 1])
        before, target, after = (state.targets[max(tick, 0)] for tick in range(state.tick - 1, state.tick + 2))
        pace = (after - before) / ((2 if state.tick else 1) * self.tick_s)
        posture = target + self.eagerness * (belief.mean[..., 0] - target)
        rate = pace + self.eagerness * (belief.mean[..., 1] - pace)
        wanted = after - posture - self.mind.pilot.dynamics.coasting * rate - belief.mean[..., 2]
        ahead = state.targets[state.tick :]
        onward = (ahead[:3][-1] - target) / (len(ahead[:3]) - 1) / self.tick_s
        here, terms = Here(posture, rate, state.echo, onward, ahead[1:]), self.terms(senses, belief.mean)
        clock = time.perf_counter()
        choice = self.inverse.choose(here, wanted, terms, rng)
        clock = time.perf_counter() - clock
        # beyond its ends the drive would cut it, and the belief would be told of a command that was never sent
        command = np.clip(posture + choice.action, *self.mind.pilot.ends.T)
        command = np.clip(command, belief.mean[..., 0] - self.farthest, belief.mean[..., 0] + self.farthest)
        nothing = np.zeros((*rate.shape, 0))
        really = Here(belief.mean[..., 0], belief.mean[..., 1], state.echo, onward, ahead[1:])
        predicted = self.estimate.predict(belief, command, self.inverse.expect(really, command))
        echo = self.mind.pilot.frame.features.after(state.echo, command)
        first = self.mind.forward_model.at(posture[:1], rate[:1], Echo(*(left[:1] for left in state.echo)))
        state = State(state.tick + 1, predicted, echo, state.targets)
        info = Info(
            believed=belief.mean,
            missed=missed,
            origin=posture,
            wanted=wanted,
            commands=command,
            posterior=nothing if choice.posterior is None else choice.posterior.probability,
            evidence=nothing[:, 0] if choice.posterior is None else choice.posterior.evidence,
            entropy=nothing[:, 0] if choice.posterior is None else choice.posterior.entropy,
            candidates=choice.candidates,
            familiarity=first.familiarity(command[:1])[0],
            uninformed=choice.beyond,
            select_s=np.array(clock),
        )
        return state, schema.motors(command), info


def imitate(
    body: Body,
    movement: Movement,
    mind: Mind,
    *,
    selection: str = "map",
    attempts: int = 1,
    rng: np.random.Generator,
    inverse: MovingInverse | None = None,
    eagerness: FloatArray | float | None = None,
    terms: Callable[[FloatArray, FloatArray], Sequence[Term]] = lambda senses, believed: (),
    witness: Callable[[], FloatArray] | None = None,
    ended: Callable[[FloatArray], str | None] = lambda senses: None,
    heed: Callable[[State, FloatArray, Info], None] = lambda state, senses, info: None,
) -> list[Attempt]:
    """Reproduce a movement, `attempts` times: the loop around `Imitator.step`.

    Args:
        body: the body that babbled (any number of copies; they all do the same, each with its own noise).
        movement: what was seen, in the body's senses, at its tick.
        mind: what babbling learned.
        selection: see `Imitator`.
        attempts: how often; each later one corrects what the one before missed.
        rng: randomness of matching and of ties.
        inverse: see `Imitator`.
        eagerness: see `Imitator`.
        terms: see `Imitator`.
        witness: reads (B, ...) something off the body at every tick, for those who judge.
        ended: asked with the (B, S) senses before every tick; why to stop there (fell, dropped, timed out), or None.
        heed: told of every step, before it is done: the state before it, the senses, and what there is to see.

    Raises:
        ImitationError: no attempts, another tick.
        BabblingError: another body's mind.
    """
    if attempts < 1:
        raise ImitationError(f"{attempts} attempts: at least 1 is needed")
    if abs(movement.tick_s - body.tick_s) > 1e-9:
        raise ImitationError(f"{movement.name} has ticks of {movement.tick_s:g} s, the body of {body.tick_s:g} s")
    mind.check(body)
    imitator = Imitator(mind, movement, selection=selection, inverse=inverse, eagerness=eagerness, terms=terms)
    goals = imitator.goals
    practice = Practice.empty(len(goals), body.copies, goals.shape[-1])
    done = list[Attempt]()
    doubt = imitator.estimate.doubt(SMOOTHING) if attempts > 1 else 0.0
    for _ in range(attempts):
        if done:
            missed = goals[: len(done[-1].senses)] - done[-1].believed[..., 0]
            practice = practice.after(missed, doubt)
        done.append(_attempt(body, imitator, practice.aim, rng, witness, ended, heed))
    return done


def _attempt(
    body: Body,
    imitator: Imitator,
    aim: FloatArray,
    rng: np.random.Generator,
    witness: Callable[[], FloatArray] | None,
    ended: Callable[[FloatArray], str | None],
    heed: Callable[[State, FloatArray, Info], None],
) -> Attempt:
    felt = body.reset()
    state, why, way = imitator.start(felt, aim), None, imitator.start(felt).targets
    first, senses, truth, infos = state.left - len(imitator.goals), [], [], list[Info]()
    while state.left and why is None:
        why = ended(felt)
        before, (state, motors, info) = state, imitator.step(state, felt, rng)
        heed(before, felt, info)
        senses.append(felt)
        truth.append(witness().copy() if witness else np.zeros((body.copies, 0)))
        infos.append(lasting(info))
        if why is None:
            felt = body.act(motors)
    end = len(infos) - (why is not None)  # the step that found the end was not done
    seen = {name: values[first:end] for name, values in through_time(infos).items()}
    felt, true = np.stack(senses)[first:end], np.stack(truth)[:end]
    return Attempt(
        **seen,
        senses=felt,
        truth=true[first:],
        way=way[:first],
        approach=true[:first],
        ended=why,
        ended_tick=end - first,
    )
