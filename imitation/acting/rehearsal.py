"""Rehearsal: a mind tries itself on movements of its own before it imitates somebody else's.

How eagerly an error may be undone, and how far habit is trusted, depends on the body: a worn joint that is pushed too
hard starts to hunt, a fresh one that is held back lags. The mind performs made-up movements with every candidate and
keeps, joint by joint, what felt closest. It judges by its own senses alone.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray
from babbling.body import Body
from babbling.exploration import smooth
from babbling.mind import Mind, Temper
from imitation.acting.loop import imitate
from imitation.acting.movement import Movement, together
from imitation.inference.moving import CANDIDATES, AveragedInverse, MovingInverse

EAGERNESS = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
"""Candidates, one per copy of the body, the calmest first."""
CALM = 1.15
"""The calmest candidate within this factor of the best is kept: what is eager enough today may hunt tomorrow."""
OTHERWISE = ((1.0, 0.0), (1.0, 1.0))
"""Trust in habit, and whether the line alone is asked, that are tried beside a mind's own temper: Eq. (1) with all of
its prior, habits of pace, over all explanations and over the line, the best one can do with little experience."""
CLOSER = 1.05
"""They are kept where they feel closer by more than this factor."""
REHEARSAL_S, MOVEMENTS = 10.0, 2
REHEARSERS = MOVEMENTS * len(EAGERNESS)
PACE = 0.5
"""Top speed of the made-up movement, as a share of the speed that babbling went up to."""


def made_up_movement(body: Body, mind: Mind, rng: np.random.Generator, seconds: float = REHEARSAL_S) -> Movement:
    """Minimum-jerk moves between random postures: babbling without its jitter, at a quieter pace."""
    span = mind.pilot.motors
    quiet = replace(span, speed=span.speed * PACE, jitter=0 * span.jitter)
    stream = smooth(quiet, 1, body.tick_s, rng)
    commands = np.concatenate([next(stream) for _ in range(round(seconds / body.tick_s))])
    senses = np.full((len(commands), len(body.sense_low)), np.nan)
    senses[:, mind.pilot.schema.posture] = mind.pilot.schema.efference(commands)
    return Movement("made up", body.tick_s, senses)


def felt_errors(body: Body, mind: Mind, inverse: MovingInverse, seed: int, seconds: float = REHEARSAL_S) -> FloatArray:
    """(E, F) root mean square of believed posture minus goal at each of EAGERNESS, the worst movement's.

    The body has `REHEARSERS` copies: all movements at all candidates at once.
    """
    movements = [made_up_movement(body, mind, np.random.default_rng([seed, 4, n]), seconds) for n in range(MOVEMENTS)]
    everything = together([movement for movement in movements for _ in EAGERNESS])
    eagerness, rng = np.tile(EAGERNESS, MOVEMENTS)[:, None], np.random.default_rng([seed, 5])
    attempt = imitate(body, everything, mind, inverse=inverse, eagerness=eagerness, rng=rng)[0]
    missed = attempt.believed[..., 0] - everything.postures(mind.pilot.schema)
    errors = np.sqrt(np.mean(missed**2, axis=0)).reshape(MOVEMENTS, len(EAGERNESS), -1)
    return np.asarray(errors.max(0))


def calmest(errors: FloatArray) -> NDArray[np.intp]:
    """(F,) first of (B, F) candidates, calmest first, that is within `CALM` of the best."""
    first: NDArray[np.intp] = (errors <= CALM * errors.min(0)).argmax(0)
    return first


def rehearse(
    body: Body,
    mind: Mind,
    seed: int,
    known: Sequence[FloatArray] = (),
    after: Callable[[FloatArray], object] = lambda errors: None,
    candidates: int = CANDIDATES,
    seconds: float = REHEARSAL_S,
) -> Mind:
    """The same mind with a temper of its own.

    Args:
        body: the one that babbled, in `REHEARSERS` copies.
        mind: what babbling learned.
        seed: randomness of the made-up movement.
        known: (E, F) `felt_errors` that are known from before, one for each temper that is tried.
        after: is told each that is found anew.
        candidates: actions that Eq. (1) weighs for every joint.
        seconds: of each made-up movement.
    """
    temper, felt = mind.temper, np.full(len(mind.temper.trust), np.inf)
    tempers: list[tuple[FloatArray | float, FloatArray | float]] = [(temper.trust, temper.simple), *OTHERWISE]
    for number, (trust, simple) in enumerate(tempers):
        other = Temper(temper.eagerness, *np.broadcast_arrays(trust, simple, felt)[:2])
        if number < len(known):
            errors = known[number]
        else:
            errors = felt_errors(
                body, mind, AveragedInverse.of(replace(mind, temper=other), candidates=candidates), seed, seconds
            )
            after(errors)
        chosen = calmest(errors)
        best = errors[chosen, np.arange(len(chosen))]
        better = best * CLOSER < felt
        tried = np.array([np.array(EAGERNESS)[chosen], other.trust, other.simple])
        temper = Temper(*np.where(better, tried, [temper.eagerness, temper.trust, temper.simple]))
        felt = np.where(better, best, felt)
    return replace(mind, temper=temper)


def best_eagerness(
    body: Body, mind: Mind, inverse: MovingInverse, seed: int, seconds: float = REHEARSAL_S
) -> FloatArray:
    """(F,) the eagerness at which another inverse model feels closest, found in the same rehearsal (for peers)."""
    return np.asarray(np.array(EAGERNESS)[calmest(felt_errors(body, mind, inverse, seed, seconds))])
