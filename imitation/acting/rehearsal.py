"""Rehearsal: a mind tries itself on movements of its own before it imitates somebody else's.

How eagerly an error may be undone, and how far habit is to be trusted, depends on the body: a worn joint that is pushed
too hard starts to hunt, a fresh one that is held back lags. The mind performs a made-up movement with every candidate
and keeps, joint by joint, what felt closest; how far habit is trusted is settled for the whole body. It judges by its
own senses alone.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray
from babbling.body import Body
from babbling.exploration import smooth
from babbling.mind import Mind, Temper
from imitation.acting.loop import imitate
from imitation.acting.movement import Movement
from imitation.inference.inverse import BayesianInverse, InverseModel

EAGERNESS = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8)
"""Candidates, one per copy of the body, the calmest first."""
TRUST = (1.0, 0.1)
"""Candidates: as one is used to, and nearly without habit."""
CALM = 1.15
"""The calmest candidate within this factor of the best is kept: what is eager enough today may hunt tomorrow."""
REHEARSAL_S, MOVEMENTS = 10.0, 2
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


def felt_errors(body: Body, mind: Mind, inverse: InverseModel, seed: int) -> FloatArray:
    """(B, F) root mean square of believed posture minus goal, the worst movement's; copy b has EAGERNESS[b]."""
    worst = np.zeros((body.copies, len(mind.forward_model.factors)))
    for number in range(MOVEMENTS):
        movement = made_up_movement(body, mind, np.random.default_rng([seed, 4, number]))
        goals = movement.postures(mind.pilot.schema)
        eagerness = np.array(EAGERNESS)[:, None]
        rng = np.random.default_rng([seed, 5, number])
        attempt = imitate(body, movement, mind, inverse=inverse, eagerness=eagerness, rng=rng)[0]
        error = np.sqrt(np.mean((attempt.believed[..., 0] - goals[:, None]) ** 2, axis=0))
        worst = np.maximum(worst, error)
    return worst


def calmest(errors: FloatArray) -> NDArray[np.intp]:
    """(F,) first of (B, F) candidates, calmest first, that is within `CALM` of the best."""
    first: NDArray[np.intp] = (errors <= CALM * errors.min(0)).argmax(0)
    return first


def rehearse(body: Body, mind: Mind, seed: int) -> Mind:
    """The same mind with a temper of its own.

    Args:
        body: the one that babbled, a copy for each of `EAGERNESS`.
        mind: what babbling learned.
        seed: randomness of the made-up movement.
    """
    errors = [felt_errors(body, mind, BayesianInverse(mind.forward_model, trust=trust), seed) for trust in TRUST]
    choice = np.stack([calmest(e) for e in errors])  # (trust, F)
    reached = np.stack([np.take_along_axis(e, c[None], 0)[0] for e, c in zip(errors, choice, strict=True)])
    # one trust for the whole body: a single worn joint that leaves its habit may hunt where rehearsal did not go
    gain = float(np.median(reached[1] / reached[0]))
    trust = np.full(reached.shape[1], int(gain * CALM < 1), np.intp)
    chosen = np.take_along_axis(choice, trust[None], 0)[0]
    return replace(mind, temper=Temper(np.array(EAGERNESS)[chosen], np.array(TRUST)[trust]))


def best_eagerness(body: Body, mind: Mind, inverse: InverseModel, seed: int) -> FloatArray:
    """(F,) the eagerness at which another inverse model feels closest, found in the same rehearsal (for peers)."""
    return np.asarray(np.array(EAGERNESS)[calmest(felt_errors(body, mind, inverse, seed))])
