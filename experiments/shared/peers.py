"""Peers of the averaged model in the very same loop: other ways to choose an action, learned from the same experience.

They share its belief filter, its coasting and its rehearsal. Each answers for every joint on its own, but for the net.
"""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from babbling.axes import FloatArray
from babbling.dynamics import LinearDynamics
from babbling.explanations import PRIOR_STRENGTH, Explanations
from babbling.features import Echo
from babbling.forward_model import ForwardModel
from babbling.pilot import Pilot, symmetric
from babbling.regression import LinearFit, Regression
from imitation.inference.inverse import BayesianInverse, Term
from imitation.inference.moving import Decided, Here

GRID = (15, 91, 91)
"""Rate, action and outcome of the one table."""
SLOW, SMALL = (0.02, 0.2), (1e-4, 1e-3)
"""rad/s and rad at which features of the sign of rates and of displacements bend."""
HELD_OUT = 0.25
"""Last share of the experience, which decides whether gravity features are of use."""
AHEAD = 8
"""Ticks that the preview looks ahead."""
LEAVES, DEPTH, ROWS = 31, 8, 40_000
_CHUNK = 2048

Answer = Callable[[Here, FloatArray], FloatArray]
"""(B, F) actions for wanted outcomes, or outcomes for commands."""


class Steps(NamedTuple):
    """Transitions, or where one is; arrays (N, F)."""

    posture: FloatArray
    rate: FloatArray
    before: FloatArray
    """Last command minus posture."""
    pace: FloatArray
    """Rate that came next, or is wanted next."""
    action: FloatArray
    outcome: FloatArray

    @classmethod
    def lived(cls, found: Pilot, motors: FloatArray, senses: FloatArray) -> "Steps":
        """Of a run from rest: (T, B, M) commands, (T + 1, B, S) sensations."""
        believed, told = found.believed(motors, senses)
        q, v = believed[..., 0], believed[..., 1]
        past, outcome = np.concatenate([q[:1], told[:-1]]), q[1:] - q[:-1] - v[:-1] * found.dynamics.coasting
        parts = q[:-1], v[:-1], past - q[:-1], v[1:], told - q[:-1], outcome
        return cls(*(part.reshape(-1, part.shape[-1]) for part in parts))

    @classmethod
    def asked(cls, here: Here, wanted: FloatArray) -> "Steps":
        """Where one is, for (B, F) wanted outcomes."""
        return cls(here.posture, here.rate, here.echo.command - here.posture, here.pace, 0 * wanted, wanted)

    def part(self, rows: Any) -> "Steps":
        """Some of them."""
        return Steps(*(part[rows] for part in self))


Features = Callable[[Steps], FloatArray]
"""(N, F, X) of N steps."""


def plain(at: Steps) -> FloatArray:
    """Of a forward line."""
    return np.stack([np.ones_like(at.rate), at.rate], -1)


def signs(at: Steps) -> FloatArray:
    """Of the forward feature line: posture and the sign of rate, as gears and gravity have it, and the last command."""
    q, v = at.posture, at.rate
    return np.stack([np.ones_like(v), v, at.before, np.sin(q), np.cos(q), *(np.tanh(v / slow) for slow in SLOW)], -1)


def wanted_signs(at: Steps) -> FloatArray:
    """Of the inverse feature line: also the signs of what is wanted, but not the last command."""
    bent = [*(np.tanh(at.outcome / small) for small in SMALL), *(np.tanh(at.pace / slow) for slow in SLOW)]
    return np.concatenate([np.delete(signs(at), 2, -1), np.stack([at.outcome, *bent], -1)], -1)


def gravity(features: Features) -> Features:
    """The same, and sine and cosine of all postures beside the features of each joint."""

    def more(at: Steps) -> FloatArray:
        x, everywhere = features(at), np.concatenate([np.sin(at.posture), np.cos(at.posture)], -1)
        return np.concatenate([x, np.broadcast_to(everywhere[:, None], (*x.shape[:2], everywhere.shape[1]))], -1)

    return more


def _inputs(seen: Steps, features: Features, target: str) -> FloatArray:
    x = features(seen)
    return np.concatenate([x, seen.action[..., None]], -1) if target == "outcome" else x


def fit(seen: Steps, features: Features, target: str) -> LinearFit:
    """Least squares of actions or outcomes on features; of outcomes, the action is the last feature."""
    sums = None
    for start in range(0, len(seen.rate), _CHUNK):
        some = seen.part(slice(start, start + _CHUNK))
        x = _inputs(some, features, target)
        sums = sums or Regression(x.shape[1], x.shape[2], 1)
        sums.observe(x, getattr(some, target)[..., None])
    assert sums is not None  # one has lived
    return sums.fit()


def with_gravity(seen: Steps, features: Features, target: str) -> Features:
    """Features with or without gravity's: those that foretell the last of what was seen better, by log likelihood."""
    cut, best = int(len(seen.rate) * (1 - HELD_OUT)), []
    early, late = seen.part(slice(cut)), seen.part(slice(cut, None, 1 + len(seen.rate) // ROWS))
    for tried in (features, gravity(features)):
        foretold = fit(early, tried, target).mean(_inputs(late, tried, target))[..., 0]
        best.append((np.log(((foretold - getattr(late, target)) ** 2).mean(0) + 1e-30).sum(), tried))
    return min(best, key=lambda one: one[0])[1]


@dataclass(frozen=True)
class Peer:
    """A `MovingInverse` of two functions; it knows nothing of other terms."""

    answer: Answer
    foretell: Answer

    def choose(self, here: Here, wanted: FloatArray, terms: Sequence[Term], rng: np.random.Generator) -> Decided:
        """See `MovingInverse`."""
        return Decided.bare(self.answer(here, wanted))

    def expect(self, here: Here, command: FloatArray) -> FloatArray:
        """See `MovingInverse`."""
        return self.foretell(here, command)


def gaussian(forward: LinearFit, habit: LinearFit, features: Features, trust: float) -> Peer:
    """Eq. (1) in closed form: w = x . b + k a + N(0, s^2) for features x, and the habit a = x . g + N(0, r^2), to the
    power of `trust`; 0 is the forward line solved for a."""
    line, pull, usual = forward.coefficients[:, 0, :-1], forward.coefficients[:, 0, -1], habit.coefficients[:, 0]
    unsure = np.maximum(np.stack([forward.covariance, habit.covariance])[..., 0, 0], 1e-24)
    held = trust * unsure[0] / unsure[1]

    def answer(here: Here, wanted: FloatArray) -> FloatArray:
        x = features(Steps.asked(here, wanted))
        return np.asarray((pull * (wanted - (x * line).sum(-1)) + held * (x * usual).sum(-1)) / (pull**2 + held))

    def foretell(here: Here, command: FloatArray) -> FloatArray:
        return np.asarray((features(Steps.asked(here, command)) * line).sum(-1) + pull * (command - here.posture))

    return Peer(answer, foretell)


def forward_line(model: Explanations, trust: float = 0.0) -> Peer:
    """w = b_0 + b_1 v + k a, solved for a; with trust in a habit of v, Gaussian Eq. (1)."""
    forward, habit = model.sums.fit(["outcome"], ["rate", "action"]), model.sums.fit(["action"], ["rate"])
    return gaussian(forward, habit, plain, trust)


def feature_line_forward(seen: Steps, trust: float) -> Peer:
    """The same with features of posture, signs and the last command."""
    features = with_gravity(seen, signs, "outcome")
    return gaussian(fit(seen, features, "outcome"), fit(seen, features, "action"), features, trust)


def inverse_line(model: Explanations) -> Peer:
    """a = b_0 + b_1 v + b_2 w; it expects what the forward line does."""
    fitted = model.sums.fit(["action"], ["rate", "outcome"])
    return Peer(lambda here, wanted: fitted.predict(here.rate, wanted)[..., 0], forward_line(model).foretell)


def feature_line(seen: Steps, forward: Peer) -> Peer:
    """a = x . b with features of what is wanted; it expects what the forward feature line does."""
    features = with_gravity(seen, wanted_signs, "action")
    fitted = fit(seen, features, "action")
    return Peer(lambda here, wanted: fitted.mean(features(Steps.asked(here, wanted)))[..., 0], forward.foretell)


def one_table(begun: Steps, seen: Steps) -> ForwardModel:
    """P(w | v, a) counted on axes that reach as far as the pilot's experience."""
    names, units = ("rate", "action", "outcome"), ("rad/s", "rad", "rad")
    values = begun.rate, begun.action, begun.outcome
    rate, action, outcome = (symmetric(*one) for one in zip(names, units, values, GRID, strict=True))
    factors = [f"motor {f}" for f in range(seen.rate.shape[1])]
    model = ForwardModel((rate,), action, outcome, factors=factors, prior_strength=PRIOR_STRENGTH)
    model.observe((seen.rate,), seen.action, seen.outcome)
    return model


def table(model: ForwardModel, trust: float) -> Peer:
    """Eq. (1) on one Dirichlet table with its own habit to the power of `trust`."""
    inverse, sure = BayesianInverse(model, trust=trust), np.random.default_rng(0)  # the mean draws nothing
    return Peer(
        lambda here, wanted: inverse.choose([Term(model, (here.rate,), wanted)], sure).action,
        lambda here, command: inverse.expect((here.rate,), command - here.posture),
    )


def lqr(found: LinearDynamics, weight: float, forward: Peer) -> Peer:
    """Preview control: the commands c_1 .. c_n that bring linear dynamics closest to the next n postures, their second
    differences costing `weight` (in units of what a command moves); the first is given."""
    gains = []
    for step, push, drift in zip(found.transition, found.control, found.offset, strict=True):
        free, still = [np.eye(3)], [np.zeros(3)]
        for _ in range(AHEAD):
            still.append(step @ still[-1] + drift)
            free.append(step @ free[-1])
        pushed = [(power @ push)[0] for power in free]
        effect = np.array([[pushed[k - j] if j <= k else 0.0 for j in range(AHEAD)] for k in range(AHEAD)])
        bends = np.diff(np.eye(AHEAD), 2, axis=0)
        first = np.linalg.solve(effect.T @ effect + weight * pushed[0] ** 2 * bends.T @ bends, effect.T)[0]
        gains.append((first, first @ np.array(free[1:])[:, 0], first @ np.array(still[1:])[:, 0]))
    onto, state, drift = (np.array(gain) for gain in zip(*gains, strict=True))

    def answer(here: Here, wanted: FloatArray) -> FloatArray:
        bias = here.ahead[0] - here.posture - found.coasting * here.rate - wanted
        believed, short = np.stack([here.posture, here.rate, bias], -1), max(AHEAD - len(here.ahead), 0)
        pace = here.ahead[-1] - here.ahead[-2] if len(here.ahead) > 1 else 0 * wanted
        beyond = here.ahead[-1] + pace * np.arange(1, short + 1)[:, None, None]
        path = np.concatenate([here.ahead[:AHEAD], beyond])
        return np.asarray(np.einsum("fn,nbf->bf", onto, path) - (believed * state).sum(-1) - drift - here.posture)

    return Peer(answer, forward.foretell)


def mlp(seen: Steps, line: Peer, forward: Peer, seed: int) -> Peer:
    """One net for all joints at once, scikit-learn's: what it adds to the forward line's answer."""
    from sklearn.neural_network import MLPRegressor

    def features(at: Steps) -> FloatArray:
        bent = np.tanh(at.pace / SLOW[0])
        return np.concatenate([at.rate, at.outcome, np.sin(at.posture), np.cos(at.posture), at.pace, bent], -1)

    some = seen.part(np.random.default_rng(seed).permutation(len(seen.rate))[:ROWS])
    x, y = features(some), _left(some, line)
    middle, wide, size = x.mean(0), x.std(0) + 1e-9, y.std(0) + 1e-12
    how = {"learning_rate_init": 2e-3, "max_iter": 25, "early_stopping": True, "random_state": seed}
    net = MLPRegressor(hidden_layer_sizes=(96,), **how)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it is told when to stop
        net.fit((x - middle) / wide, y / size)
    return _beyond(line, lambda at: net.predict((features(at) - middle) / wide).reshape(at.rate.shape) * size, forward)


def trees(seen: Steps, line: Peer, forward: Peer) -> Peer:
    """Gradient-boosted trees of every joint, scikit-learn's: what they add to the forward line's answer."""
    from sklearn.ensemble import HistGradientBoostingRegressor

    some = seen.part(slice(None, None, 1 + len(seen.rate) // ROWS))
    x, y = _joint(some), _left(some, line)
    tree = partial(HistGradientBoostingRegressor, max_iter=80, learning_rate=0.15, early_stopping=False)
    grown = [tree(max_leaf_nodes=LEAVES, max_depth=DEPTH).fit(x[:, f], y[:, f]) for f in range(y.shape[1])]
    return _beyond(line, Forest(grown), forward)


def _joint(at: Steps) -> FloatArray:
    return np.stack([at.rate, at.outcome, at.posture, at.pace], -1)


class Forest:
    """Boosted trees of all joints, asked at once: one by one they take longer than a tick."""

    def __init__(self, grown: Sequence[Any]) -> None:
        most = 2 * LEAVES
        self.base = np.array([one._baseline_prediction.item() for one in grown])
        self.nodes = {
            name: np.array([[np.resize(tree.nodes[name], most) for (tree,) in one._predictors] for one in grown])
            for name in ("feature_idx", "num_threshold", "left", "right", "value", "is_leaf")
        }

    def __call__(self, at: Steps) -> FloatArray:
        """(N, F)."""
        x, (joints, trees, _) = _joint(at), self.nodes["value"].shape
        f, tree, row = np.arange(joints)[:, None], np.arange(trees), np.arange(len(x))[:, None, None]
        place = np.zeros((len(x), joints, trees), int)
        for _ in range(DEPTH):
            node = {name: values[f, tree, place] for name, values in self.nodes.items() if name != "value"}
            goes = np.where(x[row, f, node["feature_idx"]] <= node["num_threshold"], node["left"], node["right"])
            place = np.where(node["is_leaf"], place, goes)
        return np.asarray(self.base + self.nodes["value"][f, tree, place].sum(-1))


def _left(seen: Steps, line: Peer) -> FloatArray:
    here = Here(seen.posture, seen.rate, Echo(seen.posture, seen.posture), seen.pace, seen.posture[None])
    return seen.action - line.answer(here, seen.outcome)


def _beyond(line: Peer, more: Callable[[Steps], FloatArray], forward: Peer) -> Peer:
    return Peer(lambda here, wanted: line.answer(here, wanted) + more(Steps.asked(here, wanted)), forward.foretell)
