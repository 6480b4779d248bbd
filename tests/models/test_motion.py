"""Joint trajectories and the files they come in: round trips are exact, and every broken file says what is wrong."""

import os
import pickle
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.errors import BodyError
from models.files import LIMIT_BYTES
from models.hoap2.facts import HOME_DEG, JOINTS, RANGES_DEG
from models.motion import FORMATS, JointTrajectory, read_motion

RANGES = {"hip": (-1.0, 1.5), "knee": (0.0, 2.0)}


def swing(frames: int = 7) -> JointTrajectory:
    time = np.arange(frames) * 0.02
    return JointTrajectory("swing", time, ("hip", "knee"), np.column_stack([np.sin(time), 1 - np.cos(3 * time)]))


def write_table(movement: JointTrajectory, path: Path) -> None:
    rows, sep = np.column_stack([movement.time, movement.angles]), SEPARATORS[path.suffix]
    np.savetxt(path, rows, fmt="%.17g", delimiter=sep, header=sep.join(["time", *movement.joints]), comments="")


def write_archive(movement: JointTrajectory, path: Path) -> None:
    np.savez(path, time=movement.time, angles=movement.angles, joints=movement.joints)


SEPARATORS = {".csv": ",", ".tsv": "\t", ".txt": "  "}
WRITERS = {**dict.fromkeys(SEPARATORS, write_table), ".npz": write_archive}


def table(tmp_path: Path, text: str, name: str = "a.csv") -> Path:
    path = tmp_path / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


# --- trajectories -----------------------------------------------------------------------------------------------


def test_arrays_are_copied_and_read_only() -> None:
    angles = np.zeros((3, 1))
    trajectory = JointTrajectory("a", np.arange(3.0), ("hip",), angles)
    angles[:] = 1
    assert (trajectory.angles == 0).all()
    for array in (trajectory.time, trajectory.angles):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_time_starts_at_zero() -> None:
    trajectory = JointTrajectory("a", np.array([5.0, 5.5, 6.0]), ("hip",), np.zeros((3, 1)))
    np.testing.assert_array_equal(trajectory.time, [0, 0.5, 1])
    assert trajectory.duration == 1


@given(st.lists(st.floats(-1, 1), min_size=4, max_size=4), st.integers(0, 2**31))
@settings(max_examples=25, deadline=None)
def test_resampling_reproduces_cubics(coefficients: list[float], seed: int) -> None:
    """The not-a-knot spline through any samples of a cubic is that cubic."""
    time = np.concatenate([[0], np.cumsum(np.random.default_rng(seed).uniform(0.05, 0.2, 9))])
    trajectory = JointTrajectory("a", time, ("hip",), np.polyval(coefficients, time)[:, None])
    finer = trajectory.resampled(0.01)
    np.testing.assert_allclose(np.diff(finer.time), 0.01, atol=1e-12)
    assert time[-1] - 0.01 < finer.duration <= time[-1] + 1e-9
    np.testing.assert_allclose(finer.angles[:, 0], np.polyval(coefficients, finer.time), atol=1e-10)


def test_resampling_on_its_own_grid_changes_nothing() -> None:
    np.testing.assert_allclose(swing().resampled(0.02).angles, swing().angles, atol=1e-14)


@pytest.mark.parametrize(
    ("dt", "message"),
    [(0.0, "more than 0"), (-0.1, "more than 0"), (1.0, "less than 3 frames"), (1e-9, "more than 1000000 frames")],
)
def test_impossible_time_steps(dt: float, message: str) -> None:
    with pytest.raises(BodyError, match=message):
        swing().resampled(dt)


def test_reordering() -> None:
    other = swing().reordered(["knee", "hip"])
    assert other.joints == ("knee", "hip")
    np.testing.assert_array_equal(other.angles, swing().angles[:, ::-1])
    with pytest.raises(BodyError, match="joint 'ankle' is missing; add a column"):
        swing().reordered(["knee", "hip", "ankle"])
    resting = swing().reordered(["knee", "ankle", "hip"], np.array([0.1, 0.2, 0.3]))
    np.testing.assert_array_equal(resting.angles, np.insert(other.angles, 1, 0.2, axis=1))
    with pytest.raises(BodyError, match="unknown joint 'hip'; there are hips, knee; did you mean 'hips'"):
        swing().reordered(["knee", "hips"])


@pytest.mark.parametrize(
    ("time", "joints", "angles", "message"),
    [
        ([0, 1], ("a",), [[0], [0]], "has 2 frames; a movement needs at least 3"),
        ([0, 2, 1], ("a",), [[0], [0], [0]], r"from frame 2 \(2 s\) to frame 3 \(1 s\); put the frames in order"),
        ([0, 1, 1], ("a",), [[0], [0], [0]], "time does not increase"),
        ([0, 1, np.inf], ("a",), [[0], [0], [0]], "time of frame 3 is not a finite number"),
        ([0, 1, 2], ("a",), [[0], [np.nan], [0]], "frame 2, joint 'a' is not a finite number"),
        ([0, 1, 2], ("a", "a"), [[0, 0]] * 3, "joint 'a' appears twice"),
        ([0, 1, 2], ("a", "b"), [[0], [0], [0]], r"angles \(3, 1\) and there are 2 joint names"),
        ([0, 1, 2], (), np.zeros((3, 0)), "names no joint"),
    ],
)
def test_impossible_trajectories(time: list[float], joints: tuple[str, ...], angles: object, message: str) -> None:
    with pytest.raises(BodyError, match=message):
        JointTrajectory("x", np.array(time, dtype=float), joints, np.array(angles, dtype=float))


# --- files ------------------------------------------------------------------------------------------------------


def test_every_format_has_a_conformance_test() -> None:
    assert set(FORMATS) == set(WRITERS)


@pytest.mark.parametrize("suffix", sorted(FORMATS))
def test_round_trip_is_exact(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{suffix}"
    WRITERS[suffix](swing(), path)
    again = read_motion(path, RANGES)
    assert again.joints == swing().joints
    np.testing.assert_array_equal(again.angles, swing().angles)
    np.testing.assert_array_equal(again.time, swing().time)


def test_degrees(tmp_path: Path) -> None:
    rows = "time,hip\n0,0\n1,45\n2,90\n"
    declared = read_motion(table(tmp_path, "\ufeff# unit: deg\r\n" + rows))
    np.testing.assert_allclose(declared.angles[:, 0], [0, np.pi / 4, np.pi / 2])
    np.testing.assert_allclose(read_motion(table(tmp_path, rows), unit="deg").angles, declared.angles)
    np.testing.assert_array_equal(read_motion(table(tmp_path, "# unit: deg\n" + rows), unit="rad").angles[2], 90)
    np.savez(tmp_path / "a.npz", time=np.arange(3), angles=[[0], [45], [90]], joints=["hip"], unit="deg")
    np.testing.assert_allclose(read_motion(tmp_path / "a.npz").angles, declared.angles)


def test_time_may_be_any_column(tmp_path: Path) -> None:
    trajectory = read_motion(table(tmp_path, "hip, time ,knee\n\n1,0,2\n3,1,4\n5,2,6\n"))
    assert trajectory.joints == ("hip", "knee")
    np.testing.assert_array_equal(trajectory.angles, [[1, 2], [3, 4], [5, 6]])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("\n\n", "has no header"),
        ("hip,knee\n0,0\n", "line 1: column 'time' is missing"),
        ("0,1\n1,2\n2,3\n", "line 1: column 'time' is missing"),
        ("time,hip,\n0,0,0\n", "line 1: a column has no name"),
        ("time,hip,hip\n0,0,0\n1,0,0\n2,0,0\n", "joint 'hip' appears twice"),
        ("time,hip,knee\n0,0,0\n1,0\n2,0,0\n", "line 3 has 2 cells where most have 3"),
        ("time,hip\n0,0\n1,left\n2,0\n", "line 3, column 'hip': 'left' is not a finite number"),
        ("time,hip\n0,0\n1,nan\n2,0\n", "line 3, column 'hip': 'nan' is not a finite number"),
        ("time,hip\n0,0\n1,\n2,0\n", "line 3, column 'hip': '' is not a finite number"),
        ("time,hip\n0,0\n2,0\n1,0\n", r"time does not increase from frame 2 \(2 s\) to frame 3"),
        ("time,hip\n0,0\n1,0\n", "has 2 frames; a movement needs at least 3"),
        ("time\n0\n1\n2\n", "names no joint"),
        ("# unit: turns\ntime,hip\n0,0\n", "joint 'hip' in unit 'turns'; angles are in 'rad' or 'deg'"),
        ("time,hip\n0,0\n1,45\n2,0\n", r"'hip' is at 2578.3 deg in frame 2, 2492.4 deg beyond .* declare that unit"),
        ("time,hip\n0,0\n1,-1.5\n2,0\n", r"'hip' is at -85.9 deg in frame 2, 28.6 deg beyond its range -57 .. 86 deg"),
        ("time,hop\n0,0\n1,0\n2,0\n", "unknown joint 'hop'; there are hip, knee; did you mean 'hip'"),
        (b"time,hip\n0,\xff\n", "line 2, column 'hip': 'ÿ' is not a finite number"),
        (b"time,hip\n0,\x81\n", "is not text"),
        (b"t\0i\0m\0e\0", "is not text"),
        (b"\xff\xfet\0i", "is not text"),
    ],
)
def test_broken_tables(text: str, message: str, tmp_path: Path) -> None:
    path = table(tmp_path, text)
    with pytest.raises(BodyError, match=message) as fault:
        read_motion(path, RANGES)
    assert str(fault.value).startswith(str(path))
    assert "\n" not in str(fault.value)


class Bomb:
    """Something that would make a file if it were ever unpickled."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return os.mkdir, (str(self.mark),)


def test_pickled_objects_are_refused_and_never_loaded(tmp_path: Path) -> None:
    mark = tmp_path / "exploded"
    np.savez(tmp_path / "a.npz", time=np.arange(3), angles=np.zeros((3, 1)), joints=np.array([Bomb(mark)]))
    with pytest.raises(BodyError, match="array 'joints' holds Python objects, which are never loaded"):
        read_motion(tmp_path / "a.npz")
    (tmp_path / "b.npz").write_bytes(pickle.dumps(Bomb(mark)))
    with pytest.raises(BodyError, match="not a complete NumPy archive"):
        read_motion(tmp_path / "b.npz")
    assert not mark.exists()


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"angles": np.zeros((3, 1)), "joints": ["hip"]}, "array 'time' is missing; there are angles, joints"),
        ({"time": np.arange(3), "angles": np.zeros((3, 1)), "joints": [1]}, "'joints' holds int64"),
        ({"time": np.arange(3), "angles": [["a"]] * 3, "joints": ["hip"]}, "array 'angles' holds <U1"),
        ({"time": np.arange(3), "angles": np.zeros(3), "joints": ["hip"]}, r"angles \(3,\)"),
        ({"time": np.arange(3), "angles": np.zeros((3, 1)), "joints": ["hip"], "unit": "grad"}, "unit 'grad'"),
    ],
)
def test_broken_archives(arrays: dict[str, object], message: str, tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", **arrays)  # type: ignore[arg-type]
    with pytest.raises(BodyError, match=message):
        read_motion(tmp_path / "a.npz")


def test_damaged_archives(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    write_archive(swing(), path)
    whole = path.read_bytes()
    path.write_bytes(whole[:-40])
    with pytest.raises(BodyError, match="not a complete NumPy archive"):
        read_motion(path)
    with zipfile.ZipFile(path, "w") as bundle:
        for key in ("time.npy", "angles.npy", "joints.npy"):
            bundle.writestr(key, b"\x93NUMPY\x01\x00nonsense")
    with pytest.raises(BodyError, match=r"array 'time' is damaged|not a complete NumPy archive"):
        read_motion(path)


def test_small_archives_that_unpack_to_much_are_refused(tmp_path: Path) -> None:
    frames = LIMIT_BYTES // 8 + 1
    np.savez_compressed(tmp_path / "a.npz", time=np.arange(3), angles=np.zeros(frames), joints=["hip"])
    with pytest.raises(BodyError, match="unpacks to 64 MB where at most 64 MB are read"):
        read_motion(tmp_path / "a.npz")


@pytest.mark.parametrize("suffix", [*sorted(FORMATS), ".amc"])
def test_files_that_are_none(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{suffix}"
    with pytest.raises(BodyError, match="no such file"):
        read_motion(path)
    path.mkdir()
    with pytest.raises(BodyError, match="is a directory; name one file in it"):
        read_motion(path)


@pytest.mark.parametrize("suffix", sorted(FORMATS))
def test_huge_files_are_refused_by_size(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"a{suffix}"
    with path.open("wb") as stream:
        stream.truncate(10 * 2**30)
    with pytest.raises(BodyError, match="has 10,240 MB where at most 64 MB are read"):
        read_motion(path)


def test_unknown_suffix(tmp_path: Path) -> None:
    with pytest.raises(
        BodyError, match=r"unknown motion file suffix '.cvs'; there are .csv, .npz, .tsv, .txt; did you mean"
    ):
        read_motion(table(tmp_path, "x", "a.cvs"))


# --- the real HOAP-2's motion files -------------------------------------------------------------------------------

WALK_READY = "1,0,0,0,4180,8360,-4598,0,18810,-2090,-2090,5225,0,0,-4180,-8360,4598,0,-18810,2090,2090,-5225,0,60,0,0,0"
"""The walk-ready crouch in encoder pulses: angles of the published posture x 209 x the published signs, by hand."""


def test_hoap2_file_gives_the_published_posture(tmp_path: Path) -> None:
    trajectory = read_motion(table(tmp_path, "\n".join([WALK_READY] * 4)), limits())
    assert trajectory.joints == JOINTS
    np.testing.assert_allclose(trajectory.time, [0, 0.001, 0.002, 0.003])
    home = [HOME_DEG.get(joint, 0.0) for joint in JOINTS]
    np.testing.assert_allclose(np.rad2deg(trajectory.angles), np.tile(home, (4, 1)), atol=1e-9)


def test_hoap2_sampling_field_is_milliseconds(tmp_path: Path) -> None:
    lines = [WALK_READY.replace("1,", f"{ms},", 1) for ms in (20, 5, 10)]
    np.testing.assert_allclose(read_motion(table(tmp_path, "\n".join(lines))).time, [0, 0.02, 0.025])


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (WALK_READY.rsplit(",", 1)[0], "line 3 has 26 cells where most have 27"),
        (WALK_READY.replace("8360", "x", 1), "line 3, field 6: 'x' is not a finite number"),
        (WALK_READY.replace("8360", "nan", 1), "line 3, field 6: 'nan' is not a finite number"),
        (WALK_READY.replace("1,", "0,", 1), "line 3: sampling interval 0 ms; it must be above 0"),
        (WALK_READY.replace("8360", "836000", 1), "joint 'right_leg_joint_4' is at 4000.0 deg in frame 3"),
    ],
)
def test_broken_hoap2_files(line: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(BodyError, match=message):
        read_motion(table(tmp_path, "\n".join([WALK_READY, WALK_READY, line])), limits())


def limits() -> dict[str, tuple[float, float]]:
    return {joint: (float(np.deg2rad(low)), float(np.deg2rad(high))) for joint, (low, high) in RANGES_DEG.items()}
