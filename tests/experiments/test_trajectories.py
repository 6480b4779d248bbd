"""What a gesture leaves of its movements: labelled arrays that agree with its metrics; and the same run from Python."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from babbling.files import opened
from babbling.mind import Mind
from experiments.__main__ import main
from experiments.gesture.options import Config
from experiments.gesture.run import judged, perform
from experiments.shared.trajectories import peoples, trajectories
from imitation.acting.loop import imitate
from imitation.acting.movement import Movement
from imitation.inference.bayes import entropy
from models.loading import load_body

JOINTS = ["shoulder", "elbow", "wrist"]


def asked(arm: Path, wave: Path, **more: Any) -> Config:
    common = {"robot": str(arm), "demonstration": str(wave), "babbling_minutes": 1.0, "attempts": 2, "threads": 1}
    return Config(**common, seed=3, **more)


@pytest.fixture(scope="module")
def done(arm: Path, wave: Path, hasty: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("gesture") / "result"
    words = ["--robot", arm, "--demonstration", wave, "--babbling-minutes", 1, "--attempts", 2, "--threads", 1]
    assert main(["gesture", *map(str, words), "--seed", "3", "--csv", "--film", "gif", "--out", str(out)]) == 0
    return out


@pytest.fixture
def arrays(done: Path) -> xr.Dataset:
    with xr.open_dataset(done / "trajectories.nc") as found:
        return found.load()


def metrics(out: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((out / "metrics.json").read_text())
    return found


def test_joints_are_named_with_units_and_times(arrays: xr.Dataset, done: Path) -> None:
    assert arrays.joint.values.tolist() == JOINTS and arrays.unit.values.tolist() == ["degree"] * 3
    np.testing.assert_allclose(np.diff(arrays.time), 0.02)
    assert arrays.attempt.values.tolist() == [1, 2] and len(arrays.time) == metrics(done)["frames"]
    for name, one in arrays.data_vars.items():
        assert one.attrs["units"] and one.attrs["long_name"] and "time" in one.dims, name
    assert arrays.believed_rate.attrs["units"] == "degree/s" and arrays.time.attrs["units"] == "s"
    with opened(done / "trajectories.nc") as file:
        assert file["joint"].dtype == "S1"  # letters: every reader of NetCDF knows them


def test_errors_are_those_of_the_metrics(arrays: xr.Dataset, done: Path) -> None:
    told = metrics(done)

    def rmse(values: xr.DataArray) -> Any:
        return np.sqrt(((values - arrays.demonstrated) ** 2).mean(("time", "joint"))).values

    np.testing.assert_allclose(rmse(arrays.imitated), told["attempts_rmse_deg"], atol=1e-5)
    np.testing.assert_allclose(rmse(arrays.replayed), told["direct_replay_rmse_deg"], atol=1e-5)
    np.testing.assert_allclose(rmse(arrays.linear), told["linear_peer_rmse_deg"], atol=1e-5)
    last = arrays.sel(attempt=2)
    assert last.entropy.mean().item() == pytest.approx(told["mean_entropy_bits"], rel=1e-5)
    assert (last.never_tried == 1).mean().item() == pytest.approx(told["never_tried_share"])
    assert (last.uninformed == 1).sum().item() == told["uninformed_selections"]
    assert np.abs(last.believed - last.imitated).max() < 0.3 and np.abs(last.believed_bias).max() > 0


def test_the_posterior_lies_over_the_commands_that_were_weighed(arrays: xr.Dataset) -> None:
    last = arrays.sel(attempt=2)
    np.testing.assert_allclose(arrays.posterior.sum("candidate"), 1, atol=5e-4)
    np.testing.assert_allclose(entropy(arrays.posterior.values.astype(float)), last.entropy, atol=0.01)
    best = arrays.action.values[*np.indices(last.origin.shape), arrays.posterior.values.argmax(-1)]
    step = arrays.action.diff("candidate").max("candidate")
    assert (np.abs(last.commanded - last.origin - best) <= step + 1e-4).all()
    assert (arrays.action.diff("candidate") > 0).all() and np.abs(best).max() > 1


def test_a_command_is_where_actions_are_counted_from_and_the_action(arm: Path, arm_mind: Mind) -> None:
    body = load_body(arm)
    movement = Movement(
        "a little", body.tick_s, body.sensations(0.3 * np.sin(np.arange(0, 1, 0.02))[:, None] + np.zeros(3))
    )
    [one] = imitate(body, movement, arm_mind, selection="mean", rng=np.random.default_rng(0))
    mean = (one.posterior * one.candidates).sum(-1)
    np.testing.assert_allclose(one.origin[:, 0] + mean, one.commands[:, 0], atol=1e-6)


def test_the_table_says_the_same(arrays: xr.Dataset, done: Path) -> None:
    table = pd.read_csv(done / "trajectories.csv")
    assert len(table) == 2 * len(arrays.time) * 3
    assert list(table.columns[:4]) == ["attempt", "time", "joint", "demonstrated"] and "posterior" not in table
    row = table[(table.attempt == 2) & (table.joint == "elbow") & np.isclose(table.time, 0.4)].squeeze()
    here = arrays.sel(attempt=2, joint="elbow").sel(time=0.4, method="nearest")
    for name in ("demonstrated", "imitated", "commanded", "believed_rate", "evidence"):
        assert row[name] == pytest.approx(here[name].item(), rel=1e-4), name
    assert row.unit == "degree"


def test_python_gives_the_figures_of_the_command_line(done: Path, arm: Path, wave: Path, hasty: None) -> None:
    again = perform(asked(arm, wave))
    told, timed = metrics(done), ("_s", "_ms", "_factor")
    found = json.loads(json.dumps(judged(again).metrics, default=lambda x: x.tolist()))
    assert {k: v for k, v in found.items() if not k.endswith(timed)} == {
        k: v for k, v in told.items() if not k.endswith(timed)
    }
    with xr.open_dataset(done / "trajectories.nc") as kept:
        xr.testing.assert_equal(kept.load(), again.trajectories)


def attempt(count: int, factors: int) -> dict[str, np.ndarray]:
    """Fields of `Info` through some ticks, each number its factor's."""
    number = np.broadcast_to(np.arange(factors, dtype=float), (count, 1, factors))
    found = {name: number for name in ("commands", "origin", "entropy", "evidence")}
    found |= {"believed": np.repeat(number[..., None], 3, -1), "uninformed": number > 0, "familiarity": number[:, 0]}
    return found | {name: np.repeat(number[:, 0, :, None], 5, -1) for name in ("candidates", "posterior")}


def test_what_slides_is_in_millimetres_what_ended_or_was_not_found_is_no_number(arm: Path) -> None:
    body = load_body(arm)
    assert peoples(body) == (("degree",) * 3, pytest.approx(np.full(3, 180 / np.pi)))
    body.units = ("rad", "rad", "m")
    angles = np.ones((6, 3))
    found = trajectories(body, np.array([1, -1, 2]), {"demonstrated": (angles, "told")}, [(angles, attempt(4, 3))])
    assert found.unit.values.tolist() == ["degree", "degree", "mm"]
    np.testing.assert_allclose(found.demonstrated[0], [180 / np.pi, 180 / np.pi, 1e3], rtol=1e-6)
    np.testing.assert_allclose(found.commanded[0, :4, [0, 2]], [[180 / np.pi, 2e3]] * 4, rtol=1e-6)
    np.testing.assert_allclose(found.action[:4, 2, 3], 2e3)
    assert found.commanded[0, 4:].isnull().all() and found.commanded[0, :, 1].isnull().all()
    assert found.uninformed[0].values.tolist() == [[1, -1, 1]] * 4 + [[-1] * 3] * 2
    assert found.never_tried[0, 0].values.tolist() == [0, -1, 0]
