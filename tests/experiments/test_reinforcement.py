"""Learning by reward: what it is told and gets, who learns and when it is done, and ratios that are only bounds."""

import importlib.util
import json
from collections.abc import Iterator
from itertools import islice, pairwise
from pathlib import Path

import numpy as np
import pytest

import experiments.reinforcement.options
import experiments.reinforcement.run as running
from babbling.axes import FloatArray
from babbling.pilot import pilot_minutes
from experiments.errors import ExperimentError
from experiments.reinforcement import deep
from experiments.reinforcement.found import Point, ratio, reached
from experiments.reinforcement.options import Config, must_be_there
from experiments.reinforcement.run import Task, compare, practise, run
from experiments.reinforcement.search import GAINS, OFFSET, guided, search
from experiments.reinforcement.trials import AHEAD, Policy, Trials, off, replaying, reward, tried
from experiments.shared.baselines import direct_replay
from experiments.shared.experiment import publish
from experiments.shared.judging import rmse_deg
from experiments.shared.minds import copies_for
from experiments.shared.options import BodyOptions
from experiments.shared.watching import watch
from models.loading import load_body
from models.risk import Risks, WatchedBody

pytestmark = pytest.mark.usefixtures("hasty")
with_sb3 = pytest.mark.skipif(
    importlib.util.find_spec("stable_baselines3") is None, reason="stable-baselines3 (extra `reinforcement`) is missing"
)


@pytest.fixture
def angles(arm: Path, wave: Path) -> FloatArray:
    return watch(str(wave), load_body(arm)).angles


def trials_of(arm: Path, angles: FloatArray, copies: int = 4, noise: float = 0.0) -> Trials:
    return Trials(WatchedBody(load_body(arm, copies=copies, noise=noise, scramble=3, seed=1)), angles)


def test_the_same_commands_feel_the_same_and_reward_is_minus_the_squared_error_felt(
    arm: Path, angles: FloatArray
) -> None:
    trials, body = trials_of(arm, angles, noise=0.01), load_body(arm, copies=4, noise=0.01, scramble=3, seed=1)
    body.reseed(1), trials.body.body.reseed(1)
    trials.reset()
    np.testing.assert_array_equal(trials.felt, body.reset())
    rng = np.random.default_rng(0)
    for tick in range(1, 30):
        told = rng.uniform(*body.joint_range.T, (4, 3))
        missed = trials.step(told)
        felt = body.act(body.command_angles(told))
        np.testing.assert_array_equal(trials.felt, felt)
        away = np.rad2deg(body.senses.read(felt, "angle") - trials.goals[tick])
        np.testing.assert_allclose(missed, away, atol=1e-12)
        np.testing.assert_allclose(reward(missed), -np.mean(away**2, axis=1), atol=1e-12)


def test_a_trial_goes_into_the_movement_and_ends_with_it(arm: Path, angles: FloatArray) -> None:
    trials = trials_of(arm, angles)
    np.testing.assert_array_equal(trials.goals[trials.begins : trials.begins + len(angles)], angles)
    seen = []
    missed, true = tried(trials, lambda here: (seen.append(here.observation()), replaying(here))[1])
    assert trials.over and len(missed) == trials.steps == trials.begins + len(angles) - 1
    assert true.shape == (len(angles), 4, 3)
    observed = np.array(seen)
    assert np.isfinite(observed).all() and observed.shape[2] == 6 + 3 * 3 + 3 * (AHEAD - 1) + 1
    np.testing.assert_allclose(observed[[0, -1], :, -1], [[-1] * 4, [1 - 2 / trials.steps] * 4])
    last = trials.goals[-AHEAD - 2 :]
    np.testing.assert_allclose(np.diff(last, axis=0), [last[1] - last[0]] * (AHEAD + 1), err_msg="on at its last pace")


def test_direct_replay_and_the_search_before_any_trial_are_one(arm: Path, angles: FloatArray) -> None:
    trials = trials_of(arm, angles, copies=1)
    replayed = rmse_deg(direct_replay(load_body(arm, scramble=3, seed=1), angles), angles)
    assert off(trials, replaying) == pytest.approx(replayed, rel=1e-9)
    assert off(trials, next(search(trials_of(arm, angles), 0))) == pytest.approx(replayed, rel=1e-9)


def test_gains_mean_what_they_say(arm: Path, angles: FloatArray) -> None:
    trials, rng = trials_of(arm, angles), np.random.default_rng(0)
    short, summed = [], np.zeros((4, 3))
    for tick in range(6):
        felt = trials.body.body.senses.read(trials.felt, "angle")
        short.append(trials.goals[tick] - felt)
        summed += short[-1]
        gains = rng.normal(size=(4, 3, 5))
        here, after, later = trials.goals[tick : tick + 3]
        parts = [after - here, later - 2 * after + here, short[-1], summed]
        wanted = after + sum(GAINS[n] * gains[..., n] * part for n, part in enumerate(parts)) + OFFSET * gains[..., 4]
        np.testing.assert_allclose(guided(gains)(trials), wanted, atol=1e-12)
        trials.step(replaying(trials) + 0.05 * rng.normal(size=(4, 3)))


def test_a_search_finds_better_gains_and_the_same_ones_again(arm: Path, angles: FloatArray) -> None:
    def errors(seed: int) -> list[float]:
        trials, judge = trials_of(arm, angles, copies=8), trials_of(arm, angles, copies=1)
        return [off(judge, policy) for policy in islice(search(trials, seed), 9)]

    first = errors(0)
    assert first[-1] < 0.6 * first[0]
    assert errors(0) == first and errors(1)[1:] != first[1:]


def steadily(trials: Trials, seed: int) -> Iterator[Policy]:
    """Half as far off after every trial, by being told the way back to what replay misses."""
    share = 1.0
    while True:
        yield lambda here, share=share: replaying(here) + share * 0.1
        tried(trials, replaying)
        share /= 2


def test_a_learner_is_done_when_good_enough_or_when_time_is_up(
    arm: Path, angles: FloatArray, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(running.LEARNERS, "search", steadily)  # type: ignore[arg-type]
    task = Task("search", BodyOptions(robot=str(arm), threads=1), angles, 3.0, 0.0)
    whole = practise(task)
    spent = [point.risks.minutes for point in whole]
    assert spent[0] == 0 and spent[-2] < 3.0 <= spent[-1] and spent == sorted(spent)
    assert all(b / a > running.SPACED for a, b in pairwise(spent[1:-1]))
    done = practise(task._replace(target=whole[2].error))
    assert done == whole[:3]


def test_reached_is_the_first_point_good_enough_or_all_that_was_had() -> None:
    curve = [Point(Risks(m, int(m), 2 * m, 3 * m), error) for m, error in ((0, 5.0), (1, 2.0), (2, 3.0), (4, 1.0))]
    assert reached(curve, 2.0) == (curve[1].risks, True)
    assert reached(curve, 1.5) == (curve[3].risks, True)
    assert reached(curve, 0.5) == (curve[3].risks, False)


def test_ratios_of_those_for_whom_time_was_not_enough_have_no_upper_bound() -> None:
    whole = ratio([30, 40, 20], [10, 12, 11], [True] * 3)
    assert whole.value == pytest.approx(90 / 33) and not whole.at_least
    assert 20 / 12 <= whole.low < whole.value < whole.high <= 40 / 10  # type: ignore[operator]
    cut = ratio([30, 40, 20], [10, 12, 11], [True, False, True])
    assert (cut.value, cut.low) == (whole.value, whole.low) and cut.high is None and cut.at_least
    assert str(cut).startswith("≥ 2.7") and str(whole).startswith("2.73 (")
    assert ratio([3, 4], [0, 0], [True, True])[:3] == (None, None, None)
    assert ratio([0, 0], [3, 4], [True, True])[:3] == (0, 0, 0)
    alone = ratio([6], [2], [True])
    assert alone.low == alone.value == alone.high == 3


def test_every_question_is_asked_of_every_peer_and_ours_is_the_soonest_that_is_as_good() -> None:
    def life(*points: tuple[float, float]) -> list[Point]:
        return [Point(Risks(m, 2, 4.0, 8.0), error) for m, error in points]

    lives = [
        running.Life(life((2, 0.3), (12, 0.2), (22, 0.1)), 0.5),
        running.Life(life((2, 0.6), (12, 0.2), (22, 0.1)), 0.5),
    ]
    slow = [life((0, 0.4), (30, 0.2), (60, 0.15))] * 2
    levels = {"direct replay": 0.4, "attempt after the pilot": 0.25, "first attempt": 0.1}
    rows = {(row.as_good_as, row.what): row for row in compare(lives, {"slow": slow}, levels)}
    assert len(rows) == 3 * len(Risks._fields)
    begun = rows["attempt after the pilot", "minutes"]
    assert (begun.theirs, begun.ours, begun.enough) == ([30, 30], [2, 2], [True, True]) and begun.ratio.value == 15
    first, replay = rows["first attempt", "minutes"], rows["direct replay", "minutes"]
    assert (first.theirs, first.ours, first.enough) == ([60, 60], [22, 22], [False, False]) and first.ratio.at_least
    assert (replay.theirs, replay.ours, replay.enough) == ([0, 0], [2, 12], [True, True])
    assert rows["first attempt", "touching_s"].ours == [8, 8]
    assert str(compare(lives, {"slow": slow}, {"direct replay": 0.05})[0].ratio) == "none", "nor are we as good"


def test_a_peer_whose_package_is_missing_is_refused_in_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    there = {"cma": True, "stable_baselines3": False}
    monkeypatch.setattr(experiments.reinforcement.options, "find_spec", lambda name: there[name] or None)
    with pytest.raises(ExperimentError, match=r"--peers residual: the package stable-baselines3 is not installed; pip "
                       r"install 'imitation-laboratory\[reinforcement\]', or --peers search"):  # fmt: skip
        run(Config())
    must_be_there(Config(peers=("search",)))
    there["cma"] = False
    with pytest.raises(ExperimentError, match=r"--peers search: the package cma .*\]'$"):
        must_be_there(Config(peers=("search",)))


def test_a_run_of_it_all_small(arm: Path, wave: Path, tmp_path: Path) -> None:
    config = Config(robot=str(arm), demonstration=str(wave), peers=("search",), seeds=2, minutes=1.0,
                    babbling_minutes=1.0, workers=1, out=tmp_path / "out")  # fmt: skip
    result = run(config)
    out = publish("reinforcement", config, result)
    metrics = json.loads((out / "metrics.json").read_text())
    assert metrics["levels_deg"]["first attempt"] < metrics["levels_deg"]["direct replay"]
    assert [len(life) for life in metrics["ours"]] == [3, 3]
    for life in metrics["ours"]:
        spent = [point["minutes"] for point in life]
        assert (
            spent[1] - spent[0] == pytest.approx(1 - pilot_minutes(copies_for(1.0)), abs=0.01) and spent[2] > spent[1]
        )
    assert metrics["peers"]["search"][0][0]["minutes"] == 0
    assert {row["peer"] for row in metrics["rows"]} == {"search"}
    assert "until as good as first attempt" in result.summary and (out / "body_time.png").exists()


@with_sb3
def test_episodes_are_trials_as_stable_baselines_has_them(arm: Path, angles: FloatArray) -> None:
    trials, alone = trials_of(arm, angles), trials_of(arm, angles)
    env, rng = deep.vectorised(trials, residual=True), np.random.default_rng(0)
    np.testing.assert_allclose(env.reset(), alone.observation(), rtol=1e-6, atol=1e-6)
    for tick in range(1, trials.steps + 1):
        actions = rng.uniform(-1, 1, (4, 3)).astype(np.float32)
        seen, gained, done, infos = env.step(actions)
        missed = alone.step(replaying(alone) + deep.RESIDUAL * actions.astype(float))
        np.testing.assert_allclose(gained, reward(missed), rtol=1e-5)
        assert done.tolist() == [tick == trials.steps] * 4
    np.testing.assert_allclose(
        [one["terminal_observation"] for one in infos], alone.observation(), rtol=1e-4, atol=1e-4
    )
    alone.reset()
    np.testing.assert_allclose(seen, alone.observation(), rtol=1e-6, atol=1e-6)


@with_sb3
def test_who_begins_with_replay_and_who_with_nothing(arm: Path, angles: FloatArray) -> None:
    trials, judge = trials_of(arm, angles), trials_of(arm, angles, copies=1)
    replayed = off(judge, replaying)
    first, second = (
        islice(deep.proximal(trials, 0, residual=True), 2),
        islice(deep.proximal(trials, 0, residual=False), 1),
    )
    errors = [off(judge, policy) for policy in first]
    assert errors[0] == pytest.approx(replayed, rel=1e-6) and errors[1] != errors[0]
    assert off(judge, next(second)) > 5 * replayed
    again = [off(judge, policy) for policy in islice(deep.proximal(trials_of(arm, angles), 0, residual=True), 2)]
    assert again == errors


def test_actions_are_beside_the_next_sub_goal_or_anywhere_that_commands_reach(arm: Path, angles: FloatArray) -> None:
    trials, rng = trials_of(arm, angles), np.random.default_rng(0)
    actions = rng.uniform(-1, 1, (4, 3))
    np.testing.assert_array_equal(deep.told(trials, 0 * actions, True), replaying(trials))
    beside = deep.told(trials, actions, True) - trials.goals[1]
    np.testing.assert_allclose(beside, deep.RESIDUAL * actions)
    body = trials.body.body
    sent = body.command_angles(deep.told(trials, actions, False))
    np.testing.assert_allclose(body.commands(sent), body.commands(actions), atol=1e-12, err_msg="lines, as they are")
