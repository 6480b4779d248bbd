"""Any P(action | context) as a prior of Eq. (1): shapes, brute force, what is forbidden, what is wrong."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from babbling.axes import Axis
from babbling.mind import learn
from imitation.acting.loop import imitate
from imitation.acting.movement import Movement
from imitation.errors import ImitationError
from imitation.inference.inverse import BayesianInverse, Term
from imitation.inference.moving import CONTEXTS, AveragedInverse, Decided
from imitation.inference.priors import PriorTable
from models.loading import load_body
from tests.babbling.joints import learned, slack
from tests.imitation.test_inverse import categories, measured
from tests.imitation.test_moving import places

RNG = np.random.default_rng(0)
REACH = 0.8
ACTION = Axis("action", "rad", np.full(2, -REACH), np.full(2, REACH), 161)
POSTURE = Axis("posture", "rad", np.full(2, -1.0), np.full(2, 1.0), 5)
RATE = Axis("rate", "rad/s", np.full(2, -1.0), np.full(2, 1.0), 3)


def test_all_that_says_the_same_is_the_same() -> None:
    numbers = RNG.random(161)
    same = [
        numbers,
        np.tile(numbers, (2, 1)),
        np.tile(numbers, (2, 5, 1)),
        list(7 * numbers),
        lambda posture, action: np.interp(action, ACTION.points[0], numbers),
    ]
    tables = [PriorTable.of(one, ACTION, POSTURE).probability for one in same]
    for table in tables:
        assert table.shape == (2, 5, 161)
        np.testing.assert_allclose(table, tables[0], rtol=1e-9)
    np.testing.assert_allclose(tables[0].sum(-1), 1)
    kept = RNG.dirichlet(np.ones(161), (2, 5))
    kept /= kept.sum(-1, keepdims=True)
    np.testing.assert_array_equal(PriorTable.of(kept, ACTION, POSTURE).probability, kept)
    model, (here, wanted) = learned(slack, 1500, seed=10), places(slack)
    chosen = [
        AveragedInverse(model, prior=PriorTable.of(one, ACTION, POSTURE)).choose(here, wanted, (), RNG) for one in same
    ]
    for choice in chosen:
        np.testing.assert_allclose(choice.posterior.probability, chosen[0].posterior.probability, atol=1e-9)


def test_a_function_of_several_contexts_knows_which_is_which() -> None:
    table = PriorTable.of(lambda q, v, a: 1 + q**2 + 3 * v**4 + a, ACTION, POSTURE, RATE)
    for i, j, k in ((0, 2, 5), (4, 1, 160), (2, 0, 80)):
        q, v, a = (axis.points[0, n] for axis, n in ((POSTURE, i), (RATE, j), (ACTION, k)))
        whole = sum(1 + q**2 + 3 * v**4 + b for b in ACTION.points[0])
        assert table.probability[1, i, j, k] == pytest.approx((1 + q**2 + 3 * v**4 + a) / whole)


@pytest.mark.parametrize("build", [categories, measured])
def test_on_a_grid_it_is_eq_1_by_brute_force(build: Any) -> None:
    model = build(3, 4, 5, 6)
    for given in (RNG.random(5), RNG.random((2, 5)), RNG.random((2, 3, 4, 5)), lambda a, b, c: 1 + a**2 + b**2 + c**2):
        inverse = BayesianInverse(model, "map", prior=given)
        for i in range(3):
            for j in range(4):
                here = tuple(axis.points[:, n][None] for axis, n in zip(model.contexts, (i, j), strict=True))
                choice = inverse.choose([Term(model, here, model.outcome.points[:, 3][None])], RNG)
                for f in range(2):
                    joint = np.empty(5)
                    for a in range(5):
                        if callable(given):
                            prior = given(*(axis.points[f, n] for axis, n in zip(model.axes, (i, j, a), strict=False)))
                        else:
                            prior = np.broadcast_to(given if given.ndim == 4 else np.atleast_2d(given)[:, None, None],
                                                    (2, 3, 4, 5))[f, i, j, a]  # fmt: skip
                        joint[a] = model.predictive[f, i, j, a, 3] * prior
                    if joint.sum():
                        mine = choice.posterior.probability[0, f]
                        np.testing.assert_allclose(mine, joint / joint.sum(), atol=1e-12)


def test_a_prior_given_one_of_several_contexts_is_spread_over_the_others() -> None:
    model = measured(3, 4, 5, 6)
    one, other = model.contexts
    numbers = RNG.random((2, 4, 5))
    for name, given, expected in (
        ("the second", PriorTable.of(numbers, model.action, other), np.broadcast_to(numbers[:, None], (2, 3, 4, 5))),
        ("none", PriorTable.of(numbers[:, 0], model.action), np.broadcast_to(numbers[:, :1, None], (2, 3, 4, 5))),
    ):
        expected = expected / expected.sum(-1, keepdims=True)
        np.testing.assert_allclose(BayesianInverse(model, prior=given).habits, expected, err_msg=name)
    whole = RNG.random((2, 4, 3, 5))
    swapped = BayesianInverse(model, prior=PriorTable.of(whole, model.action, other, one)).habits
    whole = whole / whole.sum(-1, keepdims=True)
    np.testing.assert_allclose(swapped, whole.swapaxes(1, 2))
    for wrong in (PriorTable.of(np.ones(161), ACTION), PriorTable.of(np.ones(5), model.action, POSTURE)):
        with pytest.raises(ImitationError, match="its actions must be on the forward model's own axis"):
            BayesianInverse(model, prior=wrong)


def test_a_uniform_array_is_no_prior_at_all() -> None:
    grid = measured(3, 9, 11)
    term = Term(grid, (grid.contexts[0].points[:, 1][None],), grid.outcome.points[:, 7][None])
    uniform, none = (
        BayesianInverse(grid, **how).choose([term], RNG) for how in ({"prior": np.ones(9)}, {"trust": 0.0})
    )
    np.testing.assert_allclose(uniform.posterior.probability, none.posterior.probability, atol=1e-12)
    model, (here, wanted) = learned(slack, 1500, seed=10), places(slack)
    for rule in ("map", "mean"):
        mine = AveragedInverse(model, rule, trust=0.0, prior=PriorTable.of(np.ones((2, 161)), ACTION))
        choice = mine.choose(here, wanted, (), RNG)
        np.testing.assert_allclose(choice.action, AveragedInverse(model, rule, trust=0.0).choose(here, wanted, (), RNG).action)  # noqa: E501  # fmt: skip


def test_a_table_over_real_actions_is_eq_1_on_a_dense_grid() -> None:
    """As where one is says: the prior is read between its grid points."""
    model, (here, wanted) = learned(slack, 1500, seed=10), places(slack)
    table = PriorTable.of(lambda q, v, a: np.exp(-0.5 * ((a - 0.1 * q + 0.05 * v) / 0.05) ** 2), ACTION, POSTURE, RATE)
    choice = AveragedInverse(model, "mean", prior=table).choose(here, wanted, (), RNG)
    outlook = model.at(here.posture, here.rate, here.echo)
    actions = np.linspace(-0.8, 0.8, 20001)[:, None, None] + np.zeros_like(here.posture)
    prior = np.zeros(actions.shape)
    for b, f in np.ndindex(here.posture.shape):
        q, v = np.clip(here.posture[b, f], -1, 1), np.clip(here.rate[b, f], -1, 1)
        i, j = min(int((q + 1) / 0.5), 3), min(int(v + 1), 1)
        s, t = (q + 1) / 0.5 - i, v + 1 - j
        row = sum(
            (1 - s, s)[m] * (1 - t, t)[n] * table.probability[f, i + m, j + n] for m in range(2) for n in range(2)
        )
        prior[:, b, f] = np.interp(actions[:, b, f], ACTION.points[f], row)
    density = np.exp(-0.5 * ((wanted - outlook.expected(here.posture + actions)) / model.spread) ** 2) * prior
    density /= density.sum(0)
    mean = (density * actions).sum(0)
    spread = np.sqrt((density * (actions - mean) ** 2).sum(0))
    assert np.abs((choice.action - mean) / spread).max() < 0.05


@pytest.mark.parametrize("allowed", [slice(0, 40), slice(120, 121), slice(100, 161, 20), slice(0, 1)])
@pytest.mark.parametrize("rule", ["map", "matching"])
def test_what_is_forbidden_is_never_done(rule: str, allowed: slice) -> None:
    model, (here, wanted) = learned(slack, 1500, seed=10), places(slack)
    numbers = np.zeros(161)
    numbers[allowed] = RNG.random(161)[allowed] + 0.1
    table = PriorTable.of(numbers, ACTION)
    choice = AveragedInverse(model, rule, prior=table).choose(here, wanted, (), RNG)
    forbidden = np.isneginf(table.log((), np.moveaxis(choice.candidates, -1, 0)))
    assert (np.moveaxis(choice.posterior.probability, -1, 0)[forbidden] == 0).all()
    near = np.abs(choice.action[..., None] - ACTION.points[0][numbers > 0]).min(-1)
    assert near.max() < ACTION.step[0] * (1 + 1e-9)  # between two points it is interpolated
    np.testing.assert_allclose(choice.posterior.probability.sum(-1), 1)
    narrow = Axis("action", "rad", np.full(2, -0.01), np.full(2, 0.01), 3)
    bound = AveragedInverse(model, rule, prior=PriorTable.of(np.ones(3), narrow)).choose(here, wanted, (), RNG)
    assert np.abs(bound.action).max() <= 0.01 + 1e-12  # nothing is allowed beyond its ends
    grid = measured(3, 9, 11)
    term = Term(grid, (np.zeros((50, 2)),), np.tile(grid.outcome.points[:, 7], (50, 1)))
    chosen = BayesianInverse(grid, "map", prior=np.eye(9)[2]).choose([term], RNG).action
    np.testing.assert_allclose(chosen, np.tile(grid.action.points[:, 2], (50, 1)))


AXIS = measured(3, 9, 11)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (np.ones(8), r"prior of shape \(8,\): \(9,\) or \(2, 9\) or \(2, 3, 9\) is possible here"),
        (np.ones((9, 2)), r"prior of shape \(9, 2\): "),
        (np.ones((3, 9)), r"prior of shape \(3, 9\): "),
        (lambda q, a: a[0, 0], r"prior of shape \(9,\) holds -"),
        (-np.ones(9), "holds -1: numbers must be finite and at least 0"),
        (np.full((2, 9), np.nan), "holds nan: "),
        (np.full((2, 3, 9), np.inf), "holds inf: "),
    ],
)
def test_a_wrong_prior_is_one_line(given: Any, told: str) -> None:
    with pytest.raises(ImitationError, match=told) as caught:
        BayesianInverse(AXIS, prior=given)
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 400


def test_a_wrong_prior_over_real_actions_is_one_line() -> None:
    model, (here, wanted) = learned(slack, 1500, seed=10), places(slack)
    one = Axis("action", "rad", np.zeros(1), np.ones(1), 9)
    sound = Axis("sound", "1", np.full(2, -1.0), np.full(2, 1.0), 5)
    hole = np.ones((2, 5, 161))
    hole[1, 2] = 0
    for wrong, told in (
        (np.ones(161), r"PriorTable.of\(numbers, action axis, contexts\)"),
        (PriorTable.of(np.ones(9), one), "prior of 1 factors, given nothing: there are 2 factors, and it may be given"),
        (PriorTable.of(np.ones(161), ACTION, sound), f"given sound: .*{', '.join(CONTEXTS)}"),
        (PriorTable.of(hole, ACTION, POSTURE), "a row is all zero"),
    ):
        with pytest.raises(ImitationError, match=told):
            AveragedInverse(model, prior=wrong)  # type: ignore[arg-type]
    with pytest.raises(ImitationError, match="axes of different factors"):
        PriorTable.of(np.ones(161), ACTION, one)
    for bad in (lambda o, a: np.nan * a, lambda o, a: np.full(a.shape, -np.inf), lambda o, a: a[0]):
        with pytest.raises(ImitationError, match=r"log P\(a \| s\) of shape"):
            AveragedInverse(model, prior=bad).choose(here, wanted, (), RNG)


ARM = """<mujoco><compiler angle="radian"/><worldbody><body><joint name="arm" axis="0 1 0" range="-1.5 1.5"
  armature="0.01"/><geom type="capsule" size=".02 .1" mass=".2"/></body></worldbody>
  <actuator><position joint="arm" kp="20" kv="1" inheritrange="1"/></actuator></mujoco>"""


def test_a_prior_is_heard_when_a_movement_is_imitated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An arm that is shown how to lift itself, and that may not be told to go further up than it is to be by now."""
    (tmp_path / "arm.xml").write_text(ARM)
    mind = learn(load_body(tmp_path / "arm.xml", copies=4), minutes=0.3, seed=0)
    body, axis = load_body(tmp_path / "arm.xml"), Axis("action", "rad", -np.ones(1), np.ones(1), 2001)
    movement = Movement("up", body.tick_s, body.sensations(np.linspace(0, 0.4, 40)[:, None]))
    choose, actions = AveragedInverse.choose, list[float]()

    def listening(self: AveragedInverse, *how: Any) -> Decided:
        decided = choose(self, *how)
        actions.append(float(decided.action.max()))
        return decided

    monkeypatch.setattr(AveragedInverse, "choose", listening)
    missed, most = [], []
    for numbers in (np.ones(2001), (axis.points[0] <= 0).astype(float)):
        actions.clear()
        inverse = AveragedInverse(mind.forward_model, trust=0.0, prior=PriorTable.of(numbers, axis))
        [done] = imitate(body, movement, mind, rng=RNG, inverse=inverse, witness=lambda: body.joint_angles)
        missed.append(0.4 - done.truth[-1, 0, 0])
        most.append(max(actions))
    assert most[0] > 0.005 and most[1] < axis.step[0] and abs(missed[0]) < 1e-3 < 0.02 < missed[1]
