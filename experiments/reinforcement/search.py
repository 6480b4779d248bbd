"""A search for gains, by reward: what a servo's own engineer would tune, tuned by trial and error."""

from collections.abc import Iterator

import numpy as np

from babbling.axes import FloatArray
from experiments.reinforcement.trials import Policy, Trials, tried

GAINS = np.array([1.0, 1.0, 0.5, 0.05])
"""Of a search, what counts as one: ticks of lead, of bend; share of what is short, of what was short in all."""
OFFSET, SPREAD = 0.01, 0.3
"""rad that count as one offset; standard deviation of the first gains tried."""


def guided(gains: FloatArray) -> Policy:
    """The next sub-goal, and (B or 1, J, 5) gains of its pace, its bend, what is short now, in all; and an offset."""

    def policy(trials: Trials) -> FloatArray:
        here, (after, later) = trials.goals[trials.tick], trials.ahead[:2]
        shape = trials.angles.shape
        parts = [np.broadcast_to(one, shape) for one in (after - here, later - 2 * after + here)]
        given = np.stack([*parts, trials.short, trials.summed], -1) * GAINS
        return np.asarray(after + (given * gains[..., :4]).sum(-1) + OFFSET * gains[..., 4])

    return policy


def search(trials: Trials, seed: int) -> Iterator[Policy]:
    """CMA-ES (Hansen 2016, arXiv 1604.00772; pycma) for five gains of every joint, from direct replay; a copy tries one
    set of all joints, and every joint's search is told the reward of its own sense, so that all search at once."""
    from cma import CMAEvolutionStrategy

    rng, joints = np.random.default_rng([seed, 0x5EA]), trials.goals.shape[1]
    how = {"popsize": trials.body.copies, "seed": np.nan, "verbose": -9, "randn": lambda *n: rng.standard_normal(n)}
    each = [CMAEvolutionStrategy(np.zeros(len(GAINS) + 1), SPREAD, how) for _ in range(joints)]
    yield guided(np.zeros((1, joints, len(GAINS) + 1)))
    while True:
        asked = [one.ask() for one in each]
        missed, _ = tried(trials, guided(np.array(asked).swapaxes(0, 1)))
        for one, gains, costs in zip(each, asked, (missed**2).mean(0).T, strict=True):
            one.tell(gains, costs.tolist())
        yield guided(np.array([one.mean for one in each])[None])
