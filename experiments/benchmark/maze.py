"""How fast the maze's questions are answered, beside bare NumPy and, where they are installed, pgmpy and pymdp.

`rows(peers=...)` gives one row per question for `imitate benchmark`. Peers get the very same counts or tables.
"""

import time
import warnings
from collections.abc import Callable
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np

from babbling.axes import FloatArray, IntArray
from experiments.maze.mind import wanderer
from imitation.inference.bayes import action_posterior
from models.maze import ACTIONS, TRUE_DYNAMICS, MazeBody, default_maze

TRANSITIONS, POSTERIORS = 1_000_000, 10_000


class Row(NamedTuple):
    """One question and one who answered it."""

    question: str
    who: str
    time_s: float
    """Best of several runs, wall seconds for the whole batch."""
    each_us: float
    """Microseconds per transition or per posterior."""
    times_ours_factor: float
    """time_s over this project's time_s."""
    largest_difference: float
    """Largest absolute difference of a probability from this project's."""


def rows(*, peers: bool = False, seed: int = 0) -> list[Row]:
    """Every question answered by us, by bare NumPy and, when asked and installed, by the peers."""
    rng = np.random.default_rng(seed)
    return [*_learning(rng, peers=peers), *_inference(rng, peers=peers)]


def metrics(found: list[Row]) -> dict[str, float]:
    """The figures a run keeps: keys ending in _us and _factor are timings."""
    by = {(row.question, row.who): row for row in found}
    bare, ours = by["learn", "np.bincount"], by["learn", "imitate"]
    return {
        "learn_over_bincount_factor": ours.time_s / bare.time_s,
        "learn_floats_over_bincount_factor": by["learn", "imitate, from senses"].time_s / bare.time_s,
        "action_posterior_each_us_factor": by["action posterior", "imitate"].each_us,
    }


def best_of(*works: Callable[[], object], repeats: int = 25) -> list[float]:
    """Least wall time of several runs of each, s; taken in turns, so that a busy machine is unkind to all alike."""
    best = [np.inf] * len(works)
    for _ in range(repeats):
        for i, work in enumerate(works):
            began = time.perf_counter()
            work()
            best[i] = min(best[i], time.perf_counter() - began)
    return best


def _learning(rng: np.random.Generator, *, peers: bool) -> list[Row]:
    """P(outcome | action) from a million transitions, categories as whole numbers."""
    action = rng.integers(0, len(ACTIONS), (TRANSITIONS, 1))
    outcome = (rng.random((TRANSITIONS, 1)) >= np.cumsum(TRUE_DYNAMICS, 1)[action[:, 0], :-1]).sum(1)[:, None]
    model = wanderer(MazeBody(default_maze())).forward_model()
    model.observe((), action, outcome)
    table = model.predictive[0].copy()
    size = len(ACTIONS)

    def bare() -> IntArray:
        return np.bincount(action[:, 0] * size + outcome[:, 0], minlength=size * size)

    counts, floats = bare().reshape(size, size), (action.astype(float), outcome.astype(float))
    ours, count, slow = best_of(
        lambda: wanderer(MazeBody(default_maze())).forward_model().observe((), action, outcome),
        bare,
        lambda: wanderer(MazeBody(default_maze())).forward_model().observe((), *floats),
    )
    difference = np.abs(counts / counts.sum(1, keepdims=True) - table).max()
    found = [
        _row("learn", "imitate", ours, ours, TRANSITIONS, 0.0),
        _row("learn", "np.bincount", count, ours, TRANSITIONS, difference),
        _row("learn", "imitate, from senses", slow, ours, TRANSITIONS, 0.0),
    ]
    if peers and find_spec("pgmpy"):
        found.append(_pgmpy_learning(action[:, 0], outcome[:, 0], table, ours))
    return found


def _inference(rng: np.random.Generator, *, peers: bool) -> list[Row]:
    """Ten thousand action posteriors, Eq. (1), each with its own sub-goal and prior."""
    model = wanderer(MazeBody(default_maze())).forward_model()
    model.add(np.rint(TRUE_DYNAMICS * 1000).astype(np.int64)[None])
    wanted, prior = rng.integers(0, 5, (POSTERIORS, 1)), rng.dirichlet(np.ones(5), (POSTERIORS, 1))

    def ask() -> FloatArray:
        return action_posterior(model.likelihood((), wanted), prior).probability

    def bare() -> FloatArray:
        joint = model.predictive[0].T[wanted[:, 0]] * prior[:, 0]
        return np.asarray(joint / joint.sum(-1, keepdims=True))

    answer = ask()[:, 0]
    ours, lines = best_of(ask, bare)
    found = [
        _row("action posterior", "imitate", ours, ours, POSTERIORS, 0.0),
        _row("action posterior", "bare NumPy", lines, ours, POSTERIORS, np.abs(bare() - answer).max()),
    ]
    if peers and find_spec("pgmpy"):
        found.append(_pgmpy_inference(model.predictive[0], wanted[:, 0], prior[:, 0], answer, ours))
    if peers and find_spec("pymdp"):
        found.append(_pymdp_inference(model.predictive[0], wanted[:, 0], prior[:, 0], answer, ours))
    return found


def _row(question: str, who: str, seconds: float, ours: float, batch: int, difference: float) -> Row:
    return Row(question, who, seconds, 1e6 * seconds / batch, seconds / ours, float(difference))


def _pgmpy_learning(action: IntArray, outcome: IntArray, table: FloatArray, ours: float) -> Row:
    import pandas
    from pgmpy.estimators import MaximumLikelihoodEstimator  # 1.1 announces another name for 1.3
    from pgmpy.models import DiscreteBayesianNetwork

    data = pandas.DataFrame({"a": action, "o": outcome})
    network = DiscreteBayesianNetwork([("a", "o")])

    def learn() -> FloatArray:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", FutureWarning)
            learned = MaximumLikelihoodEstimator(network, data).estimate_cpd("o")
        return np.asarray(learned.get_values()).T

    difference = np.abs(learn() - table).max()
    return _row("learn", "pgmpy", best_of(learn, repeats=3)[0], ours, TRANSITIONS, difference)


def _pgmpy_inference(
    table: FloatArray, wanted: IntArray, prior: FloatArray, answer: FloatArray, ours: float, asked: int = 100
) -> Row:
    """Variable elimination, one network per prior; fewer questions, since each takes milliseconds."""
    from pgmpy.factors.discrete import TabularCPD
    from pgmpy.inference import VariableElimination
    from pgmpy.models import DiscreteBayesianNetwork

    def ask(i: int) -> FloatArray:
        network = DiscreteBayesianNetwork([("a", "o")])
        network.add_cpds(TabularCPD("a", 5, prior[i][:, None]), TabularCPD("o", 5, table.T, ["a"], [5]))
        query = VariableElimination(network).query(["a"], evidence={"o": int(wanted[i])}, show_progress=False)
        return np.asarray(query.values)

    difference = max(np.abs(ask(i) - answer[i]).max() for i in range(10))
    seconds = best_of(lambda: [ask(i) for i in range(asked)], repeats=2)[0] * len(wanted) / asked
    return _row("action posterior", "pgmpy, variable elimination", seconds, ours, len(wanted), difference)


def _pymdp_inference(table: FloatArray, wanted: IntArray, prior: FloatArray, answer: FloatArray, ours: float) -> Row:
    """pymdp's fixed-point inference with one factor, which is exact: the action is the hidden state, the sub-goal what
    is observed. Compiled and batched by JAX; compilation is not counted.
    """
    import jax
    import jax.numpy as jnp
    from pymdp.algos import run_vanilla_fpi

    likelihood, seen = jnp.asarray(table.T), jnp.asarray(np.eye(5)[wanted])
    ask = jax.jit(jax.vmap(lambda o, p: run_vanilla_fpi([likelihood], [o], [p], 1)[0]))
    beliefs = jnp.asarray(prior)
    difference = np.abs(np.asarray(ask(seen, beliefs)) - answer).max()
    seconds = best_of(lambda: ask(seen, beliefs).block_until_ready())[0]
    return _row("action posterior", "pymdp, compiled by JAX", seconds, ours, len(wanted), difference)
