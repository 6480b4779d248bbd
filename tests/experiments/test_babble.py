"""`imitate babble`: interrupted and resumed is uninterrupted, and what is in the way is refused."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import experiments.babble.bouts as babble_bouts
from babbling.files import load
from babbling.files import save as write
from babbling.mind import Mind
from experiments.__main__ import main
from experiments.shared import minds
from experiments.shared.minds import learn_mind
from experiments.shared.options import BodyOptions

MINUTES = "1.0"  # three bouts of 8 copies


def command(arm: Path, out: Path, *more: str) -> list[str]:
    return ["babble", "--robot", str(arm), "--babbling-minutes", MINUTES, "--out", str(out), *more]


@pytest.fixture(scope="module")
def whole(arm: Path, hasty: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("babble") / "arm.nc"
    assert main(command(arm, out, "--threads", "1", "--sensor-noise-deg", "0.1")) == 0
    return out


def assert_same_file(one: Path, other: Path) -> None:
    assert one.read_bytes() == other.read_bytes()


def assert_same_beside(one: Path, other: Path) -> None:
    """Curve and numbers, wall times apart."""
    assert_same_file(one.with_suffix(".png"), other.with_suffix(".png"))
    numbers = [json.loads(out.with_suffix(".json").read_text()) for out in (one, other)]
    for told in numbers:
        assert sum(told.pop(name) > 0 for name in [name for name in told if name.endswith(("_s", "_factor"))]) == 4
    assert numbers[0] == numbers[1]


def interrupting(after: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Press Ctrl-C when so many checkpoints have been written."""
    written = 0

    def save(*args: object, **notes: object) -> None:
        nonlocal written
        write(*args, **notes)
        written += 1
        if written == after:
            raise KeyboardInterrupt

    monkeypatch.setattr(minds, "save", save)


@pytest.mark.parametrize("after", [1, 2, 4])
def test_interrupted_and_repeated_is_uninterrupted_to_the_last_bit(
    arm: Path,
    whole: Path,
    hasty: None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    after: int,
) -> None:
    out = tmp_path / "arm.nc"
    with monkeypatch.context() as patch:
        interrupting(after, patch)
        assert main(command(arm, out, "--sensor-noise-deg", "0.1")) == 130
    assert capsys.readouterr().err.count("\n") == 1
    assert [p.name for p in tmp_path.iterdir()] == ["arm.nc.partial"]
    ran: list[int] = []

    def counting(*args: object, **how: object) -> object:
        ran.append(int(how["first"]))  # type: ignore[call-overload]
        return babble(*args, **how)

    babble = minds.babble
    monkeypatch.setattr(minds, "babble", counting)
    assert main(command(arm, out, "--sensor-noise-deg", "0.1")) == 0
    assert ran == [after - 1]  # after its pilot, after a bout, after all: it went on, it did not begin again
    assert_same_file(out, whole)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["arm.json", "arm.nc", "arm.png"]
    assert_same_beside(out, whole)


KILLED = """
import os, signal, sys
from conftest import hurry
hurry(setattr)
when, real, count = sys.argv.pop(1), os.replace, 0
def replace(one, other):
    global count
    count += 1
    if f"before {count}" == when:
        os.kill(os.getpid(), signal.SIGKILL)
    real(one, other)
    if f"after {count}" == when:
        os.kill(os.getpid(), signal.SIGKILL)
os.replace = replace
import experiments.babble.bouts as babble_bouts
from experiments.__main__ import main
sys.exit(main())
"""
"""Dies before, or after, something that it wrote appears for the n-th time."""
ROOT = Path(__file__).resolve().parents[2]


def test_killed_without_warning_again_and_again_and_repeated(
    arm: Path, whole: Path, hasty: None, tmp_path: Path
) -> None:
    """After its first bout, twice in a row, in rehearsal, and between FILE and what is beside it."""
    out = tmp_path / "arm.nc"
    words = command(arm, out, "--sensor-noise-deg", "0.1")
    env = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'tests'}"}
    for when in ("after 2", "before 1", "after 3", "after 2", "never"):
        killed = subprocess.run(
            [sys.executable, "-c", KILLED, when, *words], cwd=ROOT, env=env, stdout=subprocess.DEVNULL, timeout=300
        )
        assert killed.returncode == (0 if when == "never" else -signal.SIGKILL)
    assert_same_file(out, whole)
    assert_same_beside(out, whole)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["arm.json", "arm.nc", "arm.png"]


def test_a_finished_babble_is_left_as_it_is_and_one_of_other_options_replaced(
    arm: Path, whole: Path, hasty: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    out = tmp_path / "arm.nc"
    for path in whole.parent.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with monkeypatch.context() as patch:
        patch.setattr(minds, "begin", None)
        assert main(command(arm, out, "--sensor-noise-deg", "0.1")) == 0
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1 and "this very babble is finished" in said.err
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert main(command(arm, out, "--sensor-noise-deg", "0.2")) == 0
    assert {path.name for path in tmp_path.iterdir()} == set(before)
    assert out.read_bytes() != before["arm.nc"]
    assert main(command(arm, out, "--sensor-noise-deg", "0.1")) == 0
    assert out.read_bytes() == before["arm.nc"]


def test_the_file_works_where_it_was_made_for(whole: Path, arm: Path, wave: Path, hasty: None, tmp_path: Path) -> None:
    mind = load(whole, Mind)
    with xr.open_dataset(whole, engine="h5netcdf") as data:
        assert data.attrs["robot"] == str(arm) and data.attrs["minutes"] == 1
        assert data["motor_name"].values.tolist() == ["shoulder", "elbow", "wrist"]
    words = ["gesture", "--robot", str(arm), "--demonstration", str(wave), "--forward-model", str(whole)]
    assert main([*words, "--out", str(tmp_path / "g")]) == 0
    told = json.loads((tmp_path / "g" / "metrics.json").read_text())
    assert told["babbling_transitions"] == mind.forward_model.transitions
    assert told["babbling_body_minutes"] + told["pilot_body_minutes"] == pytest.approx(1, rel=0.01)
    assert told["babbling_efficiency_factor"] is None  # nobody babbled


@pytest.mark.parametrize(
    "other", [["--seed", "1"], ["--babbling-minutes", "1.1"], ["--sensor-noise-deg", "0.2"], ["--scramble", "1"]]
)
def test_leftovers_of_another_babble_are_refused(
    arm: Path,
    hasty: None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    other: list[str],
) -> None:
    out = tmp_path / "arm.nc"
    with monkeypatch.context() as patch:
        interrupting(1, patch)
        assert main(command(arm, out)) == 130
    before = (tmp_path / "arm.nc.partial").read_bytes()
    capsys.readouterr()
    assert main(command(arm, out, *other)) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "arm.nc.partial: an interrupted babble of another" in said
    assert (tmp_path / "arm.nc.partial").read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["arm.nc.partial"]


def test_leftovers_that_are_none(
    arm: Path, whole: Path, hasty: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, leftover = tmp_path / "arm.nc", tmp_path / "arm.nc.partial"
    for content, message in (
        (b"not one", "not a readable NetCDF-4 file"),
        (whole.read_bytes(), "not a file of kind 'imitation-laboratory interrupted babble'; move or delete"),
    ):
        leftover.write_bytes(content)
        assert main(command(arm, out)) == 2
        said = capsys.readouterr().err
        assert said.count("\n") == 1 and message in said
        assert leftover.read_bytes() == content and not out.exists()


def test_the_learning_curve_is_no_worse_than_the_line(hasty: None, arm: Path) -> None:
    curve = learn_mind(BodyOptions(robot=str(arm)), 2.0, lambda done: None).curve
    assert curve is not None
    assert (np.diff(curve.minutes) > 0).all()
    assert curve.piloted is not None and curve.minutes[0] < curve.piloted < curve.minutes[-1]
    after = curve.minutes > curve.piloted  # before, its axes are not yet laid
    assert (curve.table[after] < 1.05 * curve.line[after]).all()
    assert curve.table[-1] < 1.02 * curve.table[0]


@pytest.mark.parametrize("how", [("3", "--workers", "1"), ("2", "--workers", "2"), ("3", "--scheduler", "local")])
def test_shards_make_no_difference(arm: Path, whole: Path, hasty: None, tmp_path: Path, how: tuple[str, ...]) -> None:
    """To file, curve and numbers: in this process, in two, on a cluster."""
    if "local" in how:
        pytest.importorskip("distributed", reason="distributed is not installed: extra `cluster`")
    out = tmp_path / "arm.nc"
    assert main(command(arm, out, "--sensor-noise-deg", "0.1", "--shards", *how)) == 0
    assert_same_file(out, whole)
    assert_same_beside(out, whole)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["arm.json", "arm.nc", "arm.png"]


@pytest.mark.parametrize("after", [1, 3])
def test_interrupted_it_goes_on_in_other_shards(
    arm: Path, whole: Path, hasty: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, after: int
) -> None:
    out, words = tmp_path / "arm.nc", ("--sensor-noise-deg", "0.1", "--workers", "1", "--shards")
    with monkeypatch.context() as patch:
        interrupting(after, patch)
        assert main(command(arm, out, *words, "2")) == 130
    had: list[int] = []
    real = babble_bouts.have
    monkeypatch.setattr(babble_bouts, "have", lambda shard: had.append(shard.first) or real(shard))
    assert main(command(arm, out, *words, "3")) == 0
    assert_same_file(out, whole)
    assert had[0] == after - 1  # what was learned is not had again


def test_eyes_babble_here(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["babble", "--robot", "biclops", "--shards", "2", "--out", str(tmp_path / "b")]) == 2
    assert "--shards and --scheduler are for bodies of many joints; biclops" in capsys.readouterr().err
