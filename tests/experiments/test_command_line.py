"""Bad input: exit 2, one line that names the file, the place and the remedy, nothing written, nothing spent."""

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from babbling.files import VERSION, save
from babbling.mind import Mind
from experiments.__main__ import main
from experiments.command_line import in_one_line
from experiments.shared import minds
from experiments.shared.experiment import as_json

Refused = Callable[..., str]


@pytest.fixture
def refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Runs `imitate` in an empty folder; checks the refusal and returns its line."""
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)

    def run(*words: object, before: bool = True) -> str:
        def never(*_: object, **__: object) -> None:
            raise AssertionError("babbling began before the options were checked")

        with monkeypatch.context() as patch:
            if before:
                patch.setattr(minds, "begin", never)
                patch.setattr(minds, "babble", never)
            status = main([str(word) for word in words])
        out, err = capfd.readouterr()
        assert status == 2, err
        assert err.startswith("imitate: ") and err.count("\n") == 1 and err.endswith("\n"), err
        assert out == ""
        assert list(here.iterdir()) == []
        return err

    return run


# --- words and numbers --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["gestur"], r"unknown experiment 'gestur'; there are .*gesture.*; did you mean 'gesture'?"),
        (["gesture", "--atempts", "2"], "unknown option --atempts, 2; did you mean --attempts?"),
        (["gesture", "--selecton", "map"], "did you mean --selection?"),
        (["gesture", "--completely-unknown"], "unknown option --completely-unknown; `imitate gesture --help` lists"),
        (["gesture", "stray"], "unknown option stray"),
        (["gesture", "--attempts"], "--attempts: a value is missing"),
        (["gesture", "--attempts", "many"], "--attempts 'many': this is not a whole number"),
        (["gesture", "--attempts", "1.5"], "--attempts '1.5': this is not a whole number"),
        (["gesture", "--attempts", "0"], "--attempts 0: it must lie between 1 and 1000"),
        (["gesture", "--attempts", "-3"], "--attempts -3: it must lie between 1 and 1000"),
        (["gesture", "--babbling-minutes", "long"], "--babbling-minutes 'long': this is not a number"),
        (["gesture", "--babbling-minutes", "-1"], "--babbling-minutes -1: it must be more than 0"),
        (["gesture", "--babbling-minutes", "0"], "--babbling-minutes 0: it must be more than 0"),
        (["gesture", "--babbling-minutes", "nan"], "--babbling-minutes nan: it must be more than 0"),
        (["gesture", "--babbling-minutes", "inf"], "--babbling-minutes inf: it must be more than 0 and at most"),
        (["gesture", "--babbling-minutes", "1e30"], "--babbling-minutes 1e+30: it must be more than 0 and at most"),
        (["babble", "--babbling-minutes", "nan"], "--babbling-minutes nan: it must be more than 0"),
        (["babble", "--babbling-minutes", "-2"], "--babbling-minutes -2: it must be more than 0"),
        (["gesture", "--selection", "men"], "unknown selection 'men'; there are map, matching, mean; did you mean"),
        (["gesture", "--sensor-noise-deg", "-1"], "--sensor-noise-deg -1: it must lie between 0 and 30 degrees"),
        (["gesture", "--sensor-noise-deg", "nan"], "--sensor-noise-deg nan: it must lie between"),
        (["gesture", "--seed", "-1"], "--seed -1: it must lie between 0 and 4000000000"),
        (["gesture", "--scramble", "-1"], "--scramble -1: it must lie between 0 and 4000000000"),
        (["gesture", "--threads", "0"], "--threads 0: it must lie between 1 and 256"),
        (["gesture", "--robot", "hoap3"], "unknown robot 'hoap3'; there are .*hoap2-worn; did you mean 'hoap2'?"),
        (["babble", "--robot", "hoap3"], "unknown robot 'hoap3'"),
        (["gesture", "--demonstration", "icub-wav"], "unknown demonstration 'icub-wav'; there are .*'icub-wave'?"),
    ],
)  # fmt: skip
def test_words_and_numbers(refused: Refused, words: list[str], message: str) -> None:
    said = refused(*words)
    for part in message.split(".*"):
        assert part in said


def test_boxes_become_lines() -> None:
    box = (
        "╭─ Unrecognized options ───╮\n│ Unrecognized options:    │\n│ --selecton               │\n"
        "│ ──────────────────────── │\n│ Perhaps you meant:       │\n│     --selection STR      │\n"
        "│         not --this-one?  │\n╰──────────────────────────╯\n"
    )
    assert in_one_line(box, "gesture").startswith("unknown option --selecton; did you mean --selection")
    assert "\n" not in in_one_line("", "gesture")


def test_help_is_no_error(capsys: pytest.CaptureFixture[str]) -> None:
    for words in ([], ["--help"], ["list"], ["gesture", "--help"], ["babble", "--help"]):
        assert main(words) == 0
        out, err = capsys.readouterr()
        assert out and not err


# --- places to write ----------------------------------------------------------------------------------------------


@pytest.fixture
def taken(tmp_path: Path) -> Path:
    folder = tmp_path / "taken"
    folder.mkdir()
    (folder / "thesis.txt").write_text("years of work")
    return folder


def test_places_that_cannot_be_written(refused: Refused, taken: Path, tmp_path: Path) -> None:
    thesis = taken / "thesis.txt"
    for place, message in (
        (thesis, "this is a file; name a folder"),
        (taken, "holds other things than a result ('thesis.txt'); name another"),
        (thesis / "below", "cannot be written (Not a directory)"),
        ("/proc/nowhere", "cannot be written"),
        ("/dev/null/x", "cannot be written (Not a directory)"),
        ("x" * 300, "cannot be written (File name too long)"),
    ):
        said = refused("gesture", "--out", place)
        assert f"--out {place}: " in said and message in said
    for place, message in (
        (taken, "this is a directory; name a file such as"),
        (thesis, "a forward model's file ends in .nc; name it thesis.nc"),
        (thesis / "below.nc", "cannot be written (Not a directory)"),
        ("/proc/nowhere.nc", "cannot be written"),
    ):
        said = refused("babble", "--out", place)
        assert f"--out {place}: " in said and message in said
    assert thesis.read_text() == "years of work" and len(list(taken.iterdir())) == 1


def test_files_of_others_are_not_lost(refused: Refused, taken: Path) -> None:
    (taken / "robot.json").write_text("{}")
    assert "robot.json is there already and would be lost" in refused("babble", "--out", taken / "robot.nc")
    (taken / "data.nc").write_text("measurements")
    assert "data.nc: this is no forward model and would be lost" in refused("babble", "--out", taken / "data.nc")
    assert (taken / "data.nc").read_text() == "measurements"


@pytest.mark.skipif(os.geteuid() == 0, reason="permissions do not bind the superuser")
def test_a_folder_without_permission(refused: Refused, taken: Path) -> None:
    taken.chmod(0o500)
    assert "cannot be written (Permission denied)" in refused("gesture", "--out", taken / "result")


def test_a_folder_with_another_programs_metrics_is_not_ours(refused: Refused, taken: Path) -> None:
    (taken / "metrics.json").write_text("{}")
    (taken / "config.json").write_text('{"files": "all"}')
    assert "holds other things than a result" in refused("gesture", "--out", taken)


# --- demonstrations -----------------------------------------------------------------------------------------------


def spoiled(wave: Path, old: str, new: str) -> str:
    text = wave.read_text()
    assert old in text
    return text.replace(old, new, 1)


def csv_cases(wave: Path) -> dict[str, tuple[str, list[str]]]:
    """Name -> (content, what must be said)."""
    lines = wave.read_text().splitlines()
    cells = [line.split(",") for line in lines]
    without = "\n".join(row[0] for row in cells)
    swapped = "\n".join([*lines[:10], lines[12], lines[11], *lines[13:]])
    degrees = "\n".join(
        [lines[0], *(",".join([r[0], *(repr(float(np.rad2deg(float(c)))) for c in r[1:])]) for r in cells[1:])]
    )
    return {
        "no joint": (without, ["names no joint"]),
        "no time": (spoiled(wave, "time,", "clock,"), ["line 1: column 'time' is missing"]),
        "a text cell": (spoiled(wave, cells[5][2], "much"), ["line 6, column 'elbow': 'much' is not a finite number"]),
        "not a number": (spoiled(wave, cells[5][2], "nan"), ["line 6, column 'elbow': 'nan' is not a finite number"]),
        "backwards": (swapped, ["time does not increase from frame"]),
        "two frames": ("\n".join(lines[:3]), ["2 frames", "at least 3"]),
        "degrees": (degrees, ["joint 'elbow' is at ", "deg beyond its range", "declare that unit"]),
        "another joint": (spoiled(wave, "wrist", "wirst"), ["wirst"]),
        "a cell too few": (spoiled(wave, "," + cells[7][3], ""), ["line 8 has 3 cells where most have 4"]),
        "empty": ("", ["is empty"]),
    }


CSV_CASES = (
    "no joint", "no time", "a text cell", "not a number", "backwards", "two frames", "degrees",
    "another joint", "a cell too few", "empty",
)  # fmt: skip


@pytest.mark.parametrize("case", CSV_CASES)
def test_spoiled_tables(refused: Refused, arm: Path, wave: Path, tmp_path: Path, case: str) -> None:
    content, parts = csv_cases(wave)[case]
    path = tmp_path / "demo.csv"
    path.write_text(content)
    said = refused("gesture", "--robot", arm, "--demonstration", path)
    assert str(path) in said
    for part in parts:
        assert part in said


def test_every_case_is_tried(wave: Path) -> None:
    assert set(csv_cases(wave)) == set(CSV_CASES)


class Trap:
    def __reduce__(self) -> tuple[object, tuple[str]]:
        return os.mkdir, ("sprung",)


def test_pickled_objects_are_refused_and_never_loaded(refused: Refused, arm: Path, tmp_path: Path) -> None:
    path = tmp_path / "trap.npz"
    np.savez(path, time=np.arange(3.0), angles=np.zeros((3, 1)), joints=np.array([Trap()], dtype=object))
    assert "Python objects, which are never loaded" in refused("gesture", "--robot", arm, "--demonstration", path)
    path.write_bytes(pickle.dumps(Trap()))
    assert "not a complete NumPy archive" in refused("gesture", "--robot", arm, "--demonstration", path)
    assert not Path("sprung").exists()


def test_files_that_are_none(refused: Refused, arm: Path, tmp_path: Path) -> None:
    for name in ("none.csv", "none.npz", "none.amc"):
        said = refused("gesture", "--robot", "hoap2", "--demonstration", tmp_path / name)
        assert f"{tmp_path / name}: there is no such file" in said
    for name in ("folder.csv", "folder.npz", "folder.amc"):
        (tmp_path / name).mkdir()
        assert "is a directory" in refused("gesture", "--demonstration", tmp_path / name)
    for name in ("huge.csv", "huge.npz", "huge.amc"):
        with open(tmp_path / name, "wb") as file:
            os.truncate(file.fileno(), 10 << 30)
        assert "10,240 MB where at most" in refused("gesture", "--demonstration", tmp_path / name)


def frames(count: int) -> list[str]:
    from models.teachers.amc import BONES

    lines = [":FULLY-SPECIFIED", ":DEGREES"]
    for number in range(1, count + 1):
        lines += [str(number), *(" ".join([bone, *["0.5"] * size]) for bone, size in BONES.items())]
    return lines


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda lines: lines[:-7], "the file ends in the middle of frame 6"),
        (lambda lines: [line.replace("head 0.5", "head nan") for line in lines], "'nan' is not a finite number"),
        (lambda lines: [*lines[:5], "lhumerous 1 2 3", *lines[5:]], "bone 'lhumerous' does not exist; did you mean"),
        (lambda lines: [], "is empty"),
        (lambda lines: lines[:2], "holds no frame"),
    ],
)
def test_spoiled_motion_capture(
    refused: Refused, tmp_path: Path, spoil: Callable[[list[str]], list[str]], message: str
) -> None:
    path = tmp_path / "clip.amc"
    path.write_text("\n".join(spoil(frames(6))))
    said = refused("gesture", "--demonstration", path)
    assert str(path) in said and message in said


def test_another_robot_is_shown_angles_only(refused: Refused, arm: Path) -> None:
    said = refused("gesture", "--robot", arm, "--demonstration", "icub-wave")
    assert "limb directions can be shown to hoap2, hoap2-worn, " in said and "shoulder, elbow, wrist" in said


# --- robots -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("experiment", ["gesture", "babble"])
def test_spoiled_robots(refused: Refused, arm: Path, tmp_path: Path, experiment: str) -> None:
    path = tmp_path / "robot.xml"
    for content, message in (
        (arm.read_text().replace("</worldbody>", ""), "MuJoCo cannot compile it"),
        ('<mujoco><worldbody><geom size="1"/></worldbody></mujoco>', "has no position actuators; add <position"),
        (arm.read_text().replace("<position name", "<motor name"), "is not a position servo"),
        ("", "is empty"),
    ):
        path.write_text(content)
        said = refused(experiment, "--robot", path)
        assert str(path) in said and message in said
    assert "no such file" in refused(experiment, "--robot", tmp_path / "none.xml")
    assert "this is a directory" in refused(experiment, "--robot", tmp_path)
    with open(path, "wb") as file:
        os.truncate(file.fileno(), 10 << 30)
    assert "has 10,240 MB where at most 64 MB are read" in refused(experiment, "--robot", path)


@pytest.mark.parametrize("experiment", ["gesture", "babble"])
def test_a_robot_that_becomes_unstable(
    refused: Refused, arm: Path, wave: Path, hasty: None, tmp_path: Path, experiment: str
) -> None:
    path = tmp_path / "wild.xml"
    path.write_text(arm.read_text().replace('<position name="elbow"', '<position kp="4e5" kv="0" name="elbow"'))
    more = ["--demonstration", wave] if experiment == "gesture" else []
    said = refused(experiment, "--robot", path, *more, before=False)
    assert (
        f"{path}: the physics became unstable at joint 'elbow' after 0." in said and "lower its actuator's gain" in said
    )


# --- forward models -----------------------------------------------------------------------------------------------


def test_forward_models_that_do_not_fit(
    refused: Refused, arm: Path, wave: Path, arm_mind: Mind, tmp_path: Path
) -> None:
    path = tmp_path / "mind.nc"
    save(arm_mind, path)
    whole = path.read_bytes()
    common = ["gesture", "--robot", arm, "--demonstration", wave, "--forward-model", path]

    assert "learned by another body" in refused("gesture", "--forward-model", path)
    assert "learned by another body" in refused(*common, "--scramble", "1")
    with h5py.File(path, "r+") as file:
        file.attrs["version"] = VERSION + 1
    assert f"written in version {VERSION + 1}, this program reads up to {VERSION}; update it" in refused(*common)
    path.write_bytes(whole[: len(whole) // 2])
    assert f"{path}: not a readable NetCDF-4 file (truncated, or something else); make it anew" in refused(*common)
    path.write_text("not one at all")
    assert f"{path}: not a readable NetCDF-4 file" in refused(*common)
    with h5py.File(path, "w") as file:
        file["temperature"] = np.arange(3)
    assert f"{path}: this is not a file of kind" in refused(*common)
    with open(path, "wb") as file:
        os.truncate(file.fileno(), 10 << 30)
    assert f"{path}: has 10,240 MB where at most" in refused(*common)
    assert "this is a directory" in refused(*common[:-1], tmp_path)
    assert "there is no such file" in refused(*common[:-1], tmp_path / "none.nc")


# --- all of it in a process of its own ----------------------------------------------------------------------------


def test_a_process_says_one_line_and_no_traceback(tmp_path: Path) -> None:
    """With nothing captured or patched: libraries that talk to the terminal behind Python's back would show here."""
    root = Path(__file__).resolve().parents[2]
    (tmp_path / "text.nc").write_text("no")
    ran = subprocess.run(
        [sys.executable, "-m", "experiments.gesture", "--forward-model", "text.nc"],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(root)}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert ran.returncode == 2 and ran.stdout == ""
    assert ran.stderr == "imitate: text.nc: not a readable NetCDF-4 file (truncated, or something else); make it anew\n"
    assert [p.name for p in tmp_path.iterdir()] == ["text.nc"]


def test_numbers_that_are_none_never_reach_a_file() -> None:
    with pytest.raises(ValueError, match="JSON"):
        as_json({"rmse": float("nan")})
    assert as_json({"a": np.float64(1.5), "b": np.arange(2), "c": (Path("x"), None)}) == (
        '{\n  "a": 1.5,\n  "b": [\n    0,\n    1\n  ],\n  "c": [\n    "x",\n    null\n  ]\n}\n'
    )


@pytest.mark.parametrize("locale", ["C", "C.UTF-8"])
def test_a_wrong_option_is_a_line_in_every_locale(locale: str) -> None:
    """Where letters are ASCII alone, boxes have no sides; a terminal of one column is one of forty."""
    where = {"LC_ALL": locale, "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "COLUMNS": "1"}
    done = subprocess.run(
        [sys.executable, "-m", "experiments", "gesture", "--sed", "3"],
        env=os.environ | where, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 2 and done.stdout == ""
    meant = "unknown option --sed, 3; did you mean --seed or --speed?"
    assert done.stderr == f"imitate: {meant}; `imitate gesture --help` lists what there is\n"


@pytest.mark.parametrize("words", [["list", "x"], ["--version", "now"], ["--help", "gesture"]], ids=" ".join)
def test_what_takes_no_more_words_is_given_none(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert not out and err == f"imitate: {' '.join(words)}: nothing goes with {words[0]}; leave the rest out\n"
