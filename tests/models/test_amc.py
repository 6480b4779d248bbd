"""Human motion capture: real files are read whole and right way round, broken ones say what is wrong and where."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from dm_control.suite.utils import parse_amc

from models.errors import BodyError
from models.teachers.amc import BONES, read_amc, write_amc
from models.teachers.performance import PARTS
from models.teachers.performing import perform

CLIPS = ("02_01", "02_05", "02_06", "02_10")


def standing(frames: int = 6, number: int = 1) -> list[str]:
    """Lines of a file in which somebody stands with everything at a degree."""
    lines = ["# made by hand", ":FULLY-SPECIFIED", ":DEGREES"]
    for frame in range(number, number + frames):
        lines.append(str(frame))
        lines += [f"{bone} " + " ".join(["1.0"] * count) for bone, count in BONES.items()]
    return lines


def write(tmp_path: Path, lines: list[str], end: str = "\n") -> Path:
    path = tmp_path / "a.amc"
    path.write_bytes((end.join(lines) + end).encode())
    return path


def test_skeleton_has_the_numbers_of_dm_controls() -> None:
    """One number per joint of the humanoid, three lengths and three angles for the root, bones in the same order."""
    names = [name.rstrip("0123456789") for name in parse_amc._CMU_MOCAP_JOINT_ORDER]
    bones = [name[:-2] if name.endswith(("rx", "ry", "rz")) else name for name in names]
    assert [bone for bone, count in BONES.items() for _ in range(count)] == bones


@pytest.mark.parametrize("clip", CLIPS)
def test_real_clips_are_read_as_dm_control_reads_them(cmu: Path, clip: str) -> None:
    np.testing.assert_array_equal(read_amc(cmu / f"{clip}.amc"), np.array(parse_amc.parse(str(cmu / f"{clip}.amc"))))


@pytest.mark.parametrize("clip", CLIPS)
def test_real_clips_are_movements(cmu: Path, clip: str) -> None:
    seen = perform(cmu / f"{clip}.amc")
    assert seen.name == clip and set(seen.directions) == set(PARTS)
    np.testing.assert_allclose(np.diff(seen.time), 1 / 120, atol=1e-12)
    for part, way in seen.directions.items():
        np.testing.assert_allclose(np.linalg.norm(way, axis=1), 1, atol=1e-12)
        assert np.rad2deg(np.linalg.norm(np.diff(way, axis=0), axis=1).max()) < 10, part
    assert np.linalg.norm(np.diff(seen.points, axis=0), axis=2).max() < 0.1


def test_a_walker_walks_forwards(cmu: Path) -> None:
    """Who walks moves the way nose and feet point, bends knees backwards, and swings each arm against its leg."""
    seen = perform(cmu / "02_01.amc")
    names = {name: number for number, name in enumerate(("waist", "neck", "crown", "nose"))}
    way = seen.points[-1, names["waist"]] - seen.points[0, names["waist"]]
    nose = (seen.points[:, names["nose"]] - seen.points[:, names["crown"]]).mean(axis=0)
    assert way[:2] @ nose[:2] / np.linalg.norm(way[:2]) / np.linalg.norm(nose[:2]) > 0.9
    assert abs(way[2]) < 0.1 and seen.points[:, names["crown"], 2].min() > 1.2
    for side, other in (("left", "right"), ("right", "left")):
        thigh, shank, foot, arm = (
            seen.directions[f"{side}_{part}"] for part in ("thigh", "shank", "foot", "upper_arm")
        )
        across = seen.directions[f"{other}_thigh"]
        assert (shank[:, 0] < thigh[:, 0] + 0.05).all()
        assert foot[:, 0].mean() > 0.8
        assert arm[:, 2].max() < -0.8
        assert np.corrcoef(arm[:, 0], across[:, 0])[0, 1] > 0.5 > np.corrcoef(arm[:, 0], thigh[:, 0])[0, 1]


def test_harmless_differences_do_no_harm(tmp_path: Path) -> None:
    """Any first frame number, Windows line ends, blank lines, bones in another order, no flags: the same frames."""
    plain = read_amc(write(tmp_path, standing()))
    np.testing.assert_array_equal(plain, np.ones((6, 62)))
    np.testing.assert_array_equal(read_amc(write(tmp_path, standing(number=118), end="\r\n")), plain)
    np.testing.assert_array_equal(read_amc(write(tmp_path, standing(number=0), end="\n\n")), plain)
    lines = standing()[2:]
    shuffled = [line for start in range(1, len(lines), 30) for line in [lines[start], *lines[start + 29 : start : -1]]]
    np.testing.assert_array_equal(read_amc(write(tmp_path, shuffled)), plain)


def test_writing_and_reading_again_is_exact(tmp_path: Path) -> None:
    frames = np.random.default_rng(0).normal(size=(5, 62)) * 100
    write_amc(frames, tmp_path / "a.amc")
    np.testing.assert_array_equal(read_amc(tmp_path / "a.amc"), frames)


def test_angles_that_wrap_are_no_jumps(cmu: Path, tmp_path: Path) -> None:
    """A whole turn more on some angles from some frame on is the same movement, also between frames."""
    frames = read_amc(cmu / "02_01.amc")[:60]
    write_amc(frames, tmp_path / "plain.amc")
    turned = frames.copy()
    turned[30:, 3:] += 360
    write_amc(turned, tmp_path / "turned.amc")
    plain, wrapped = perform(tmp_path / "plain.amc"), perform(tmp_path / "turned.amc")
    for part in PARTS:
        np.testing.assert_allclose(wrapped.directions[part], plain.directions[part], atol=1e-9)


def change(number: int, text: str) -> Callable[[list[str]], list[str]]:
    """Replace the line of that number, counted from 1."""
    return lambda lines: [*lines[: number - 1], text, *lines[number:]]


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda lines: lines[:-5], "the file ends in the middle of frame 6: 5 of 29 bones are missing, first 'rtoes'"),
        (lambda lines: [*lines[:-1], "ltoes"], r"line 183 \(frame 6\): bone 'ltoes' has 0 numbers where 1 are needed"),
        (lambda lines: lines[:40] + lines[41:], "the next frame begins in the middle of frame 2"),
        (change(8, "thorax 1 nan 1"), r"line 8 \(frame 1\): bone 'thorax': 'nan' is not a finite number"),
        (change(8, "thorax 1 left 1"), r"line 8 \(frame 1\): bone 'thorax': 'left' is not a finite number"),
        (change(8, "thorax 1 1"), r"line 8 \(frame 1\): bone 'thorax' has 2 numbers where 3 are needed"),
        (change(8, "torax 1 1 1"), r"line 8 \(frame 1\): bone 'torax' does not exist; did you mean 'thorax'"),
        (change(8, "qqq 1 1 1"), "bone 'qqq' does not exist; only the skeleton of the CMU database is known"),
        (change(8, "upperback 1 1 1"), r"line 8 \(frame 1\): bone 'upperback' comes twice"),
        (change(34, "7"), "line 34: frame 7 follows frame 1; frames must count up by one"),
        (change(3, ":RADIANS"), "line 3: angles in radians are not read"),
        (lambda lines: ["ROOT Hips", *lines], "line 1: 'ROOT Hips' stands before the first frame number"),
        (lambda lines: lines[:3], "holds no frame"),
        (lambda lines: lines[: 3 + 3 * 30], "has 3 frames; a movement needs at least 4"),
    ],
)
def test_broken_files(spoil: Callable[[list[str]], list[str]], message: str, tmp_path: Path) -> None:
    path = write(tmp_path, spoil(standing()))
    with pytest.raises(BodyError, match=message) as fault:
        perform(path)
    assert str(fault.value).startswith(str(path)) and "\n" not in str(fault.value)


def test_files_that_are_none(tmp_path: Path) -> None:
    path = tmp_path / "a.amc"
    with pytest.raises(BodyError, match=r"a\.amc: there is no such file"):
        perform(path)
    path.write_bytes(b"")
    with pytest.raises(BodyError, match=r"a\.amc: is empty"):
        perform(path)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BodyError, match=r"a\.amc: is not text"):
        perform(path)
    with path.open("wb") as stream:
        stream.truncate(10 * 2**30)
    with pytest.raises(BodyError, match="has 10,240 MB where at most 64 MB are read"):
        perform(path)
    with pytest.raises(BodyError, match="this is a directory"):
        perform(tmp_path)
