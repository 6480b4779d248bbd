"""`imitate notice`: what counts as noticed, as named and as a false alarm; and a run of it all, small."""

import json

import numpy as np
import pytest

import experiments.notice.run
import experiments.notice.trials
from babbling.features import BEFORE, COLUMNS
from experiments.notice.counting import FORGETTING, RecursiveLine
from experiments.notice.run import Config, run
from experiments.notice.trials import Changed, alarms, judge
from experiments.shared.experiment import publish


def test_false_alarms_that_last_are_one_and_others_are_counted_each() -> None:
    whole = np.zeros((200, 3))
    whole[10:60, 0] = whole[150, 0] = whole[20, 1] = 9
    assert alarms(whole, 8.0, 0.02) == 3
    assert alarms(whole, 10.0, 0.02) == 0


def test_what_is_noticed_is_noticed_in_time_and_after_the_change() -> None:
    surprise, at = np.zeros((100, 4, 3)), np.array([20, 30, 40, 50])
    surprise[21, 0, 1] = surprise[54, 1, 2] = 9  # at once; .48 s later, but another joint
    surprise[66, 2, 0] = surprise[50, 3, 0] = 9  # too late; before it can be felt
    changed = Changed({"x": surprise}, {"x": surprise.max(2)}, at, [{1}, {1}, {0}, {0}], 1, None)
    found = judge(changed, "x", 8.0, 0.02)
    assert found["noticed"] == 0.5 and found["already_alarmed"] == 1
    assert found["delay_median"] == pytest.approx((0.02 + 0.48) / 2)
    assert found["noticed_95"] == pytest.approx((0.0676, 0.9324), abs=1e-4)  # Clopper and Pearson's table


def test_the_recursive_line_is_weighted_least_squares(arm_mind) -> None:
    rng = np.random.default_rng(0)
    columns = np.zeros((400, 3, len(COLUMNS)))
    columns[..., 0] = 1
    columns[..., [1, len(BEFORE)]] = rng.normal(0, 1, (400, 3, 2))
    outcome = columns[..., [0, 1, len(BEFORE)]] @ [0.1, -0.2, 0.5] + rng.normal(0, 0.01, (400, 3))
    whole, parts = RecursiveLine(arm_mind), RecursiveLine(arm_mind)
    for line in (whole, parts):
        line.precision = 1e-9 * line.precision
    whole.count(columns, outcome)
    for part in (slice(0, 150), slice(150, None)):
        parts.count(columns[part], outcome[part])
    np.testing.assert_allclose(parts.weights, whole.weights, rtol=1e-6)
    root = np.sqrt(FORGETTING ** np.arange(400)[::-1])
    for f in range(3):
        x = columns[:, f][:, [0, 1, len(BEFORE)]] * root[:, None]
        np.testing.assert_allclose(whole.weights[f], np.linalg.lstsq(x, outcome[:, f] * root)[0], rtol=1e-4)


def test_a_small_run_leaves_everything(hasty, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(experiments.notice.run, "COPIES", 4)
    monkeypatch.setattr(experiments.notice.trials, "CASE_S", 1.2)
    config = Config(
        cases=2, healthy_minutes=0.1, rehearsal_minutes=0.3, babbling_minutes=0.3, demonstrations=("icub-wave",),
        robot="hoap2-backlash", out=tmp_path / "out",
    )  # fmt: skip
    result = run(config)
    publish("notice", config, result)
    metrics = json.loads((tmp_path / "out" / "metrics.json").read_text())
    for kind in ("jam", "carry", "swap"):
        for way in ("average", "line", "error"):
            low, high = metrics[kind][way]["noticed_95"]
            assert low <= metrics[kind][way]["noticed"] <= high
    assert metrics["swap"]["average"]["noticed"] == 1
    assert "counting_on_deg" not in metrics  # only HOAP-2 itself has a twin that babbled with the weight
    assert {"recording.rrd", "noticing.png"} <= {file.name for file in (tmp_path / "out").iterdir()}
