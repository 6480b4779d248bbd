"""`imitate benchmark`: peers obey their laws, and it does not matter who lives a life."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from sklearn.ensemble import HistGradientBoostingRegressor

from babbling.dynamics import LinearDynamics
from babbling.features import COLUMNS, Echo
from babbling.loop import experience
from babbling.mind import Mind
from babbling.pilot import begin, pilot_minutes
from babbling.regression import LinearGaussian
from experiments.__main__ import main
from experiments.benchmark import lives
from experiments.benchmark.options import CURVE
from experiments.benchmark.run import curves, growths, ratio
from experiments.shared import peers
from experiments.shared.minds import COPIES, learn_mind
from experiments.shared.options import BodyOptions
from experiments.shared.peers import Peer, Steps
from imitation.inference.moving import Here
from models.loading import load_body

FACTORS = 3
RNG = np.random.default_rng(0)


def here(at: Steps, ahead: np.ndarray | None = None) -> Here:
    return Here(at.posture, at.rate, Echo(at.posture + at.before, at.posture[..., None]), at.pace, ahead)


def steps(number: int = 400, **law: object) -> Steps:
    """Random steps; `outcome` or `action` as a function of the rest."""
    rng = np.random.default_rng(number)
    scales = np.array([0.5, 0.1, 0.01, 0.1, 0.02, 0.01])[:, None, None]
    seen = Steps(*(scales * rng.standard_normal((6, number, FACTORS))))
    return seen._replace(**{name: value(seen) for name, value in law.items()})  # type: ignore[operator]


def model_of(seen: Steps) -> SimpleNamespace:
    """As much of a forward model as lines are fitted to."""
    far = np.full((FACTORS, 3), 1.0)
    sums = LinearGaussian(("rate", "action", "outcome"), -far, far)
    values = np.stack([seen.rate, seen.action, seen.outcome], -1)
    sums.observe(values, np.ones(values.shape[:2], bool))
    return SimpleNamespace(sums=sums)


def line(seen: Steps, noise: float = 0.0) -> np.ndarray:
    return 0.002 + 0.1 * seen.rate + 0.4 * seen.action + noise * RNG.standard_normal(seen.rate.shape)


def answered(peer: Peer, at: Steps) -> np.ndarray:
    return peer.choose(here(at), at.outcome, (), RNG).action


@pytest.mark.parametrize("peer", [peers.forward_line, peers.inverse_line])
def test_in_a_world_that_is_a_line_lines_find_the_action_and_expect_what_comes(peer) -> None:
    seen, new = steps(4000, outcome=line), steps(50, outcome=line)
    fitted = peer(model_of(seen))
    np.testing.assert_allclose(answered(fitted, new), new.action, atol=2e-5)
    np.testing.assert_allclose(fitted.expect(here(new), new.posture + new.action), new.outcome, atol=2e-5)


def test_gaussian_eq_1_is_its_definition_summed_over_a_grid_and_without_habit_the_forward_line() -> None:
    seen = steps(2000, outcome=lambda at: line(at, 0.004))
    model, new = model_of(seen), steps(4)
    np.testing.assert_array_equal(
        answered(peers.forward_line(model, 0.0), new), answered(peers.forward_line(model), new)
    )
    forward, habit = model.sums.fit(["outcome"], ["rate", "action"]), model.sums.fit(["action"], ["rate"])
    a = np.linspace(-0.5, 0.5, 20001)[:, None, None]
    foretold = forward.predict(np.broadcast_to(new.rate, (len(a), *new.rate.shape)), a + 0 * new.rate)[..., 0]
    usual = habit.predict(new.rate)[..., 0]
    logs = -0.5 * (new.outcome - foretold) ** 2 / forward.covariance[:, 0, 0]
    logs = logs - 0.5 * 0.1 * (a - usual) ** 2 / habit.covariance[:, 0, 0]
    posterior = np.exp(logs - logs.max(0))
    np.testing.assert_allclose(
        answered(peers.forward_line(model, 0.1), new), (posterior * a).sum(0) / posterior.sum(0), atol=1e-7
    )


def test_feature_lines_recover_a_law_of_signs_and_postures() -> None:
    weights = RNG.standard_normal((FACTORS, 7)) * 0.003

    def forwards(at: Steps) -> np.ndarray:
        return (peers.signs(at) * weights).sum(-1) + 0.4 * at.action

    def backwards(at: Steps) -> np.ndarray:
        return (peers.wanted_signs(at) * backward).sum(-1)

    backward = RNG.standard_normal((FACTORS, 11)) * 0.003
    new = steps(50, outcome=forwards)
    forward = peers.feature_line_forward(steps(outcome=forwards), trust=0.0)
    np.testing.assert_allclose(answered(forward, new), new.action, atol=1e-7)
    np.testing.assert_allclose(forward.expect(here(new), new.posture + new.action), new.outcome, atol=1e-7)
    inverse, other = peers.feature_line(steps(action=backwards), forward), steps(50, action=backwards)
    np.testing.assert_allclose(answered(inverse, other), other.action, atol=1e-7)
    assert inverse.foretell is forward.foretell


def test_gravity_features_are_taken_where_another_joint_matters_and_left_where_none_does() -> None:
    def pulled(at: Steps) -> np.ndarray:
        return line(at, 0.001) + 0.003 * np.sin(at.posture[:, [1, 2, 0]])

    for law, taken in ((pulled, True), (lambda at: line(at, 0.001), False)):
        assert (peers.with_gravity(steps(outcome=law), peers.signs, "outcome") is not peers.signs) == taken


def test_trees_asked_at_once_say_what_each_says_alone() -> None:
    seen, new = steps(3000), steps(40)
    x, y = (np.stack([s.rate, s.outcome, s.posture, s.pace], -1) for s in (seen, new))
    target = np.sin(20 * x[..., 0]) * x[..., 2]
    how = {"max_iter": 10, "max_leaf_nodes": peers.LEAVES, "max_depth": peers.DEPTH, "early_stopping": False}
    grown = [HistGradientBoostingRegressor(**how).fit(x[:, f], target[:, f]) for f in range(FACTORS)]
    alone = np.stack([one.predict(y[:, f]) for f, one in enumerate(grown)], -1)
    np.testing.assert_allclose(peers.Forest(grown)(new), alone, atol=1e-12)


def test_learners_add_to_the_forward_line_what_bends() -> None:
    def bent(at: Steps) -> np.ndarray:
        return line(at) + 0.02 * np.tanh(at.rate / 0.02)

    seen, new = steps(3000, outcome=bent), steps(200, outcome=bent)
    base = peers.forward_line(model_of(seen))
    plainly = np.abs(answered(base, new) - new.action).mean()
    for learner in (peers.trees(seen, base, base), peers.mlp(seen, base, base, 0)):
        assert np.abs(answered(learner, new) - new.action).mean() < 0.7 * plainly
        assert learner.foretell is base.foretell


def test_free_preview_control_brings_a_linear_world_onto_every_posture_of_the_path() -> None:
    transition = np.array([[[0.7, 0.01, 1.0], [-3.0, 0.4, 20.0], [0.0, 0.0, 0.98]]] * FACTORS)
    control, offset = np.array([[0.3, 3.0, 0.0]] * FACTORS), np.array([[1e-3, 2e-2, 0.0]] * FACTORS)
    found = LinearDynamics(transition, control, offset, 0 * transition, control[:, 0], np.full(FACTORS, 0.01))
    peer = peers.lqr(found, 0.0, peers.forward_line(model_of(steps(outcome=line))))
    path, state = 0.1 * np.sin(np.arange(12) / 5)[:, None, None] + np.zeros((12, 1, FACTORS)), np.zeros((1, FACTORS, 3))
    state[..., 2] = 1e-3
    for tick in range(8):
        at = Steps(state[..., 0], state[..., 1], *([state[..., 0]] * 4))
        wanted = path[tick] - at.posture - 0.01 * at.rate - state[..., 2]
        command = at.posture + peer.choose(here(at, path[tick:]), wanted, (), RNG).action
        state = np.einsum("fij,bfj->bfi", transition, state) + control * command[..., None] + offset
        np.testing.assert_allclose(state[..., 0], path[tick], atol=1e-9)


def test_peers_are_taught_what_the_forward_model_learns(arm: Path) -> None:
    body = load_body(arm, copies=4)
    runs: list[tuple[np.ndarray, np.ndarray]] = []
    found, model = begin(body, 2, lambda *run: runs.append(run))
    [run] = runs
    begun = Steps.lived(found, *run)
    columns, outcome = found.experienced(*run)
    assert (model.sums.samples == len(outcome)).all()
    for name in ("posture", "rate", "before", "action"):
        np.testing.assert_allclose(getattr(begun, name), columns[..., COLUMNS.index(name)], atol=1e-12)
    np.testing.assert_array_equal(begun.outcome, outcome)
    motors, senses = experience(body, found, 2, 0, 20)
    lived = Steps.lived(found, motors, senses)
    np.testing.assert_array_equal(lived.pace[: -4 * 1], lived.rate[4:])


def test_ratio_is_to_the_best_mean_and_its_interval_holds_it() -> None:
    best, middle, low, high = ratio([1.0, 3.0], {"one": [1.0, 7.0], "other": [3.0, 2.0]})
    assert (best, middle) == ("other", 0.8)
    assert low == pytest.approx(1.0 / 1.0) or low <= middle <= high
    assert ratio([1.0], {"one": [2.0]}) == ("one", 0.5, 0.5, 0.5)


def command(arm: Path, clip: Path, out: Path, *more: str) -> list[str]:
    words = ["benchmark", "--clips", str(clip), "--bodies", str(arm), "--seeds", "2", "--babbling-minutes", "0.5"]
    return [
        *words,
        "--models",
        "average",
        "table",
        "replay",
        "feature_line",
        "average_without_table",
        *more,
        "--out",
        str(out),
    ]


@pytest.fixture(scope="module")
def tiny(arm: Path, wave: Path, hasty: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A benchmark of the arm with a clip cut short."""
    folder = tmp_path_factory.mktemp("benchmark")
    clip = folder / "short.csv"
    clip.write_text("\n".join(wave.read_text().splitlines()[:40]) + "\n")
    assert main(command(arm, clip, folder / "one", "--workers", "1", "--attempts", "5")) == 0
    return folder / "one"


def test_every_body_clip_and_model_has_an_error_for_every_seed(tiny: Path, arm: Path) -> None:
    metrics = json.loads((tiny / "metrics.json").read_text())
    errors = metrics["errors_deg"][str(arm)]["short.csv"]
    assert list(errors) == ["replay", "average", "table", "feature_line", "average_without_table"]
    assert all(len(one) == 2 and 0 < min(one) for one in errors.values())
    assert np.mean(errors["average"]) < 0.5 * np.mean(errors["replay"])
    assert len(metrics["fifth_deg"][str(arm)]["short.csv"]) == 2
    assert metrics["best_peer"][str(arm)]["short.csv"] in ("table", "feature_line")
    assert {p.name for p in tiny.iterdir()} == {"config.json", "metrics.json", "errors.png", "report.html"}


def test_a_life_without_peers_is_the_mind_of_every_other_experiment(
    arm: Path, hasty: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    minds: list[Mind] = []
    monkeypatch.setattr(lives, "perform", lambda task, options, mind, lived, point: minds.append(mind))
    babbling = 1.6  # enough for a pilot of as many bodies
    lives.live(lives.Task(str(arm), 1, {}, (), (babbling,)))
    total = babbling + pilot_minutes(COPIES)
    usual = learn_mind(BodyOptions(robot=str(arm), seed=1, threads=1), total, lambda done: None).mind
    np.testing.assert_array_equal(minds[0].forward_model.moments, usual.forward_model.moments)


def test_the_curve_has_every_seed_at_every_number_of_minutes() -> None:
    """Those of short lives of few bodies before those of the long one."""
    tasks = [lives.Task("ideal", seed, {}, (), (0.0,), copies=copies) for seed in (0, 1) for copies in (1, 8)]
    grown = [
        [lives.Point(m, {name: [e * m, 3 * e * m] for name in CURVE}) for m in minutes]
        for e in (0.1, 0.2)
        for minutes in ((0.5,), (1.0, 2.0))
    ]
    found = curves(tasks, grown)["curve"]["table"]
    assert found[0] == [0.5, 1.0, 2.0]
    np.testing.assert_allclose(found[1], [[0.1, 0.2], [0.2, 0.4], [0.4, 0.8]])


def test_the_curve_begins_as_early_as_a_pilot_allows() -> None:
    total = [pilot_minutes(copies) + stop for copies, stops in growths() for stop in stops]
    assert total == sorted(total) and total[0] < pilot_minutes(1) + 0.01
    assert all(stop >= 0 for _, stops in growths() for stop in stops)


def test_a_life_with_stops_ends_as_one_without(arm: Path, hasty: None, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[tuple[float, int]] = []

    def note(task: object, options: object, mind: Mind, lived: list[Steps], point: lives.Point) -> lives.Point:
        seen.append((point.minutes - mind.pilot.minutes, sum(len(one.rate) for one in lived)))
        assert seen[-1][1] == mind.forward_model.sums.samples[0]
        return point

    monkeypatch.setattr(lives, "perform", note)
    lives.live(lives.Task(str(arm), 1, {}, (), (0.0, 0.1, 0.5)))
    assert [minutes for minutes, _ in seen] == pytest.approx([0, 0.1, 0.5])
    assert [rows - seen[0][1] for _, rows in seen] == [0, 304, 1504]  # whole ticks of 8 copies, 50 a second


def test_an_unknown_model_or_body_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    for words in (["--models", "nobody"], ["--bodies", "nobody"]):
        assert main(["benchmark", *words]) == 2
        assert capsys.readouterr().err.count("\n") == 1
