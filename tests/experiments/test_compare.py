"""`imitate compare`: what is shared is compared, what is not is said; strangers' folders are data."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from PIL import Image
from rerun.chunk import RrdReader

from experiments.__main__ import main
from experiments.compare.options import Config
from experiments.compare.run import labels, run
from experiments.shared.trajectories import TRIES, labelled, write

TICK, COUNT = 0.02, 60
JOINTS = ("knee", "elbow", "toe")


def tracks(off: float, joints: tuple[str, ...], units: tuple[str, ...]) -> Any:
    """Joints that move more and more, each missed by `off` times its number from 1 on, better at the second try."""
    time = np.arange(COUNT)[:, None] * TICK
    shown = np.sin(time) * np.arange(1, len(joints) + 1)
    missed = np.stack([shown + (2 - k) * off * np.arange(1, len(joints) + 1) for k in range(2)])
    given = {
        "demonstrated": (TRIES[1:], shown.astype("f4"), "degree", "sub-goals"),
        "imitated": (TRIES, missed.astype("f4"), "degree", "true posture"),
    }
    return labelled(joints, units, TICK, given)


def left(
    folder: Path,
    off: float = 0.1,
    joints: tuple[str, ...] = JOINTS,
    units: tuple[str, ...] = ("degree",) * 3,
    experiment: str = "gesture",
    **options: Any,
) -> Path:
    """What a run leaves."""
    folder.mkdir()
    notes = {"experiment": experiment, "options": {"robot": "toy", "seed": 1, "out": str(folder), **options}}
    metrics = {"joint_rmse_deg": off, "seed": 1, "parts": {"knee": off}, "select_s": off, "list": [1], "text": "a"}
    (folder / "config.json").write_text(json.dumps(notes))
    (folder / "metrics.json").write_text(json.dumps(metrics))
    if joints:
        write(tracks(off, joints, units), folder / "trajectories.nc")
    return folder


@pytest.fixture
def one(tmp_path: Path) -> Path:
    return left(tmp_path / "one")


@pytest.fixture
def two(tmp_path: Path) -> Path:
    return left(tmp_path / "two", 0.2, selection="mean")


def test_errors_options_and_metrics_are_set_side_by_side(one: Path, two: Path) -> None:
    found = run(Config(runs=(one, two)))
    told = found.metrics
    size = float(np.sqrt(np.mean(np.arange(1, 4) ** 2)))
    assert told["error"] == {"one": pytest.approx(0.1 * size, rel=1e-4), "two": pytest.approx(0.2 * size, rel=1e-4)}
    assert told["options"] == {"selection": ["-", '"mean"']}
    assert told["metrics"] == {"joint_rmse_deg": [0.1, 0.2], "seed": [1, 1], "parts.knee": [0.1, 0.2]}
    assert told["joints"] == ["toe", "elbow", "knee"] and told["remarks"] == []
    assert "| joint_rmse_deg | 0.1 | 0.2 |" in found.summary and "The same in all: seed." in found.summary


def test_other_robots_and_experiments_are_compared_in_what_they_share(one: Path, tmp_path: Path) -> None:
    units = ("degree", "mm", "degree")
    other = left(tmp_path / "other", joints=("elbow", "knee", "hand"), units=units, experiment="head")
    bare = left(tmp_path / "bare", joints=())
    told = run(Config(runs=(one, other, bare))).metrics
    assert told["joints"] == ["elbow"]  # one knee slides
    assert told["options"]["experiment"] == ["gesture", "head", "gesture"]
    assert told["error"].keys() == {"one", "other"}
    remarks = " ".join(told["remarks"])
    assert "no movements: bare" in remarks and "left out: 4" in remarks and "not the same" in remarks
    alone = run(Config(runs=(bare, left(tmp_path / "bare2", 0.3, joints=()))))
    assert alone.record is None and alone.metrics["error"] == {} and "comparison" in alone.figures


def test_the_command_leaves_a_table_a_figure_and_a_recording(one: Path, two: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["compare", str(one), str(two), "--out", str(out)]) == 0
    with Image.open(out / "comparison.png") as picture:
        assert min(picture.size) > 400
    reader = RrdReader(out / "recording.rrd")
    paths = {str(path) for path in reader.store(store=reader.recordings()[0]).schema().entity_paths()}
    wanted = {f"/joints/{j}/imitated/{n}" for j in range(3) for n in range(2)} | {"/error/0", "/error/1", "/summary"}
    assert wanted <= paths and "/joints/0/demonstrated/0" in paths
    assert "/joints/0/demonstrated/1" not in paths  # the same as the first


def test_runs_of_one_name_are_told_apart_by_where_they_are(tmp_path: Path) -> None:
    assert labels([Path("a/x"), Path("b/x"), Path("b/y")]) == ["a/x", "b/x", "b/y"]
    assert labels([tmp_path / "p" / "x", tmp_path / "y"]) == ["x", "y"]


def refusal(capsys: pytest.CaptureFixture[str], *runs: Path) -> str:
    capsys.readouterr()
    assert main(["compare", *map(str, runs), "--out", str(runs[0].parent / "out") if runs else "none"]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert line.startswith("imitate: ") and len(line) < 400 and line.isprintable()
    return line


def test_too_few_and_no_runs_are_one_line(one: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "0 given; 2 to 12" in refusal(capsys)
    assert "1 given; 2 to 12" in refusal(capsys, one)
    assert "named twice" in refusal(capsys, one, tmp_path / "." / "one")
    assert "no folder that a run left" in refusal(capsys, one, tmp_path / "missing")
    assert "no folder that a run left" in refusal(capsys, one, one / "metrics.json")


HOSTILE: dict[str, tuple[str, bytes, str]] = {
    "cut": ("metrics.json", b'{"a": 1', "no JSON"),
    "a list": ("metrics.json", b"[1]", "no names and values"),
    "bytes": ("metrics.json", b"\xff\xfe\x00", "not text"),
    "nested": ("metrics.json", b'{"a":' * 100_000, "no JSON"),
    "long number": ("metrics.json", b'{"a": ' + b"9" * 10_000 + b"}", "no JSON"),
    "no options": ("config.json", b'{"experiment": "gesture"}', "does not say which experiment"),
    "no netcdf": ("trajectories.nc", b"text", "NetCDF-4"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_broken_files_are_refused_in_a_line(
    name: str, one: Path, two: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, content, said = HOSTILE[name]
    (two / file).write_bytes(content)
    line = refusal(capsys, one, two)
    assert said in line and file in line


CHANGES: dict[str, Callable[[h5py.File], object]] = {
    "gone": lambda file: file.pop("imitated"),
    "not a number": lambda file: file["imitated"].__setitem__((0, 0, 0), np.nan),
    "backwards": lambda file: file["time"].__setitem__(slice(None), np.arange(COUNT)[::-1]),
    "misshapen": lambda file: (
        file.pop("demonstrated"), file.create_dataset("demonstrated", data=np.zeros((3, 3), "f4"))
    ),
    "endless": lambda file: (
        file.pop("time"), file.create_dataset("time", (1 << 28,), "f8", chunks=(1 << 20,), fillvalue=0.0)
    ),
    "linked": lambda file: (file.pop("imitated"), file.__setitem__("imitated", h5py.ExternalLink("x.nc", "/a"))),
    "one name": lambda file: file["joint"].__setitem__(slice(None), file["joint"][:1]),
}  # fmt: skip


@pytest.mark.parametrize("name", CHANGES)
def test_arrays_that_cannot_be_are_refused_in_a_line(
    name: str, one: Path, two: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with h5py.File(two / "trajectories.nc", "r+") as file:
        CHANGES[name](file)
    line = refusal(capsys, one, two)
    assert "trajectories.nc" in line and ("are read of a file" in line or name != "endless")


def test_garbled_arrays_are_found_out_by_their_seal(one: Path, two: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = two / "trajectories.nc"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)
    assert "damaged" in refusal(capsys, one, two)


def test_odd_names_and_numbers_harm_nothing(one: Path, two: Path) -> None:
    for folder in (one, two):
        odd = {
            "a|b": 1,
            "[red]x": 2,
            "new\nline": 3,
            "big": 10**400,
            "inf": 1e999,
            "x" * 500: 4,
            "ok": len(folder.name),
        }
        (folder / "metrics.json").write_text(json.dumps(odd))
        (folder / "config.json").write_text(json.dumps({"experiment": "g|\nx", "options": {"a": f"|{folder}\x1b[31m"}}))
    found = run(Config(runs=(one, two)))
    assert found.metrics["metrics"] == {"ok": [3.0, 3.0]}
    assert "\x1b" not in found.summary and "g|" not in found.summary
