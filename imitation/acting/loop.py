"""The match-to-target loop (chapter, Figure 9): believe, compare, choose, act, feel; and again, a little better.

Once per tick: the senses correct the believed state; Eq. (1) is asked for the action that takes it to the next
sub-goal; the efference copy carries the belief on. From attempt to attempt, what was missed shifts the sub-goals.
"""

import time
from typing import NamedTuple, Protocol

import numpy as np

from babbling.axes import FloatArray
from babbling.body import Body
from babbling.mind import Mind
from imitation.acting.attempts import Memory
from imitation.acting.belief import StateEstimate
from imitation.acting.movement import Movement, approach
from imitation.errors import ImitationError
from imitation.inference.bayes import ActionPosterior
from imitation.inference.inverse import BayesianInverse, InverseModel


class Attempt(NamedTuple):
    """One attempt, tick by tick; T ticks of the movement (the approach is not kept)."""

    senses: FloatArray
    """(T, B, S) sensations at each sub-goal's time."""
    believed: FloatArray
    """(T, B, F, 3) posture, rate, bias."""
    commands: FloatArray
    """(T, B, F) commanded postures."""
    truth: FloatArray
    """(T, B, ...) whatever `witness` returned each tick (for those who judge, not for the mind); empty without one."""
    posterior: FloatArray
    """(T, F, A) of copy 0, single precision; (T, F, 0) for inverse models without beliefs."""
    evidence: FloatArray
    """(T, B, F)."""
    entropy: FloatArray
    """(T, B, F) bits."""
    familiarity: FloatArray
    """(T, F) of copy 0: visits that the chosen action's row had while babbling (0: never tried here)."""
    uninformed: int
    """Selections for which the fallback acted."""
    selections: int
    """Selections in all."""
    select_s: FloatArray
    """(T,) wall time of one selection for all factors and copies."""


class Witness(Protocol):
    """Reads something off a body at every tick, for those who judge."""

    def read(self) -> FloatArray:
        """(B, ...)."""


def imitate(
    body: Body,
    movement: Movement,
    mind: Mind,
    *,
    selection: str = "mean",
    attempts: int = 1,
    rng: np.random.Generator,
    inverse: InverseModel | None = None,
    eagerness: FloatArray | float | None = None,
    witness: Witness | None = None,
) -> list[Attempt]:
    """Reproduce a movement, `attempts` times.

    Args:
        body: the body that babbled (any number of copies; they all do the same, each with its own noise).
        movement: what was seen, in the body's senses, at its tick.
        mind: what babbling learned.
        selection: selection rule on Eq. (1)'s posterior.
        attempts: how often; each later one corrects what the one before missed.
        rng: randomness of matching and of ties.
        inverse: another inverse model in the same loop (peers); default is Eq. (1).
        eagerness: (F,) or (B, F) share of the believed error to undo within one tick; None is the mind's own temper.
        witness: read at every tick.

    Raises:
        ImitationError: no attempts, another tick.
        BabblingError: another body's mind.
    """
    if attempts < 1:
        raise ImitationError(f"{attempts} attempts: at least 1 is needed")
    if abs(movement.tick_s - body.tick_s) > 1e-9:
        raise ImitationError(f"{movement.name} has ticks of {movement.tick_s:g} s, the body of {body.tick_s:g} s")
    mind.check(body)
    chosen = inverse or BayesianInverse(mind.forward_model, selection, habit=mind.temper.habit)
    eager = np.asarray(mind.temper.eagerness if eagerness is None else eagerness, float)
    goals = movement.postures(mind.pilot.schema)
    memory = Memory.empty(len(goals), body.copies, goals.shape[1])
    done = []
    for _ in range(attempts):
        attempt = _attempt(body, goals, memory.aim, mind, chosen, rng, eager, witness)
        done.append(attempt)
        memory = memory.after(goals[:, None] - attempt.believed[..., 0])
    return done


def _attempt(
    body: Body,
    goals: FloatArray,
    shift: FloatArray,
    mind: Mind,
    inverse: InverseModel,
    rng: np.random.Generator,
    eagerness: FloatArray,
    witness: Witness | None,
) -> Attempt:
    schema, coasting = mind.pilot.schema, mind.pilot.coasting
    estimate = StateEstimate(schema, mind.pilot.dynamics, inverse.expect)
    felt = body.reset()
    way = approach(felt[:, schema.posture].mean(0), goals, body.tick_s)
    lead = len(way)
    # while approaching, the first sub-goal's shift is taken up gradually
    up = np.linspace(0, 1, lead)[:, None, None]
    targets = np.concatenate([way[:, None] + up * shift[:1], goals[:, None] + shift])
    targets = np.concatenate([targets, 2 * targets[-1:] - targets[-2:-1]])  # one beyond: the movement's own last pace
    pace = np.gradient(targets, body.tick_s, axis=0)
    ticks, copies, factors = len(goals), body.copies, goals.shape[1]
    record: dict[str, list[FloatArray]] = {name: [] for name in Attempt._fields}
    uninformed = 0
    belief = estimate.start(felt[:, schema.posture], felt[:, schema.rate])
    for t in range(lead + ticks):
        if t:
            belief = estimate.correct(belief, felt[:, schema.posture], felt[:, schema.rate])
        posture = targets[t] + eagerness * (belief.mean[..., 0] - targets[t])
        rate = pace[t] + eagerness * (belief.mean[..., 1] - pace[t])
        wanted = targets[t + 1] - posture - coasting * rate - belief.mean[..., 2]
        clock = time.perf_counter()
        choice = inverse.choose(rate, wanted, rng)
        clock = time.perf_counter() - clock
        command = posture + choice.action
        if t >= lead:
            record["senses"].append(felt)
            record["believed"].append(belief.mean)
            record["commands"].append(command)
            record["truth"].append(witness.read().copy() if witness else np.zeros((copies, 0)))
            record["select_s"].append(np.array(clock))
            uninformed += int(choice.uninformed.sum())
            _note_beliefs(record, choice.posterior, mind, rate, choice.action)
        felt = body.act(schema.motors(command))
        belief = estimate.predict(belief, command)
    empty = {"posterior": (ticks, factors, 0), "evidence": (ticks, copies, 0), "entropy": (ticks, copies, 0),
             "familiarity": (ticks, 0)}  # fmt: skip
    arrays = {
        name: np.stack(record[name]) if record[name] else np.zeros(empty[name])
        for name in Attempt._fields
        if name not in ("uninformed", "selections")
    }
    return Attempt(**arrays, uninformed=uninformed, selections=ticks * copies * factors)


def _note_beliefs(
    record: dict[str, list[FloatArray]],
    posterior: ActionPosterior | None,
    mind: Mind,
    rate: FloatArray,
    action: FloatArray,
) -> None:
    if posterior is None:
        return
    record["posterior"].append(posterior.probability[0].astype(np.float32))
    record["evidence"].append(posterior.evidence)
    record["entropy"].append(posterior.entropy)
    visits = mind.forward_model.familiarity((rate[0],))
    nearest = mind.forward_model.action.hard(action[0])
    record["familiarity"].append(np.take_along_axis(visits, nearest[:, None], -1)[:, 0])
