"""Tables as other programs write them: the same movement, whatever parts its cells; what cannot be meant is named."""

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from models.errors import BodyError
from models.files import text
from models.motion import JointTrajectory, read_motion
from models.motion.checks import beyond, gaps
from models.tables import table

JOINTS = ("l_knee", "grösse", "t")
TIME = np.arange(12) * 0.02 + 0.5
ANGLES = np.random.default_rng(0).normal(0, 0.3, (12, 3)).round(6)
RANGES = dict.fromkeys(JOINTS, (-3.0, 3.0))
FRAME = pd.DataFrame(np.column_stack([TIME, ANGLES]), columns=["time", *JOINTS])


def write(tmp_path: Path, text: str | bytes, name: str = "a.csv") -> Path:
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def same(movement: JointTrajectory, joints: tuple[str, ...] = JOINTS) -> None:
    assert movement.joints == joints
    np.testing.assert_allclose(movement.time, TIME - TIME[0], atol=1e-12)
    np.testing.assert_allclose(movement.angles, ANGLES[:, [JOINTS.index(joint) for joint in joints]], atol=1e-12)


@pytest.mark.parametrize("sep", [",", ";", "\t", " "])
@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("index", [False, True])
@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252", "latin-1"], ids=lambda encoding: encoding
)
def test_whatever_pandas_writes(tmp_path: Path, sep: str, decimal: str, index: bool, encoding: str) -> None:
    path = tmp_path / "a.csv"
    FRAME.to_csv(path, sep=sep, decimal=decimal, index=index, encoding=encoding, lineterminator="\r\n")
    same(read_motion(path, RANGES))


def columns(
    sep: str = ",", head: Callable[[str], str] = str, number: Callable[[float], str] = repr, first: str | None = None
) -> str:
    """The movement as text; first: header of a column that counts the rows from 1, "" for one without a header."""
    names = [head(name) for name in FRAME.columns]
    rows = [[number(cell) for cell in row] for row in FRAME.to_numpy().tolist()]
    if first is not None:
        names = [first, *names] if first else names
        rows = [[f'"{i}"', *row] for i, row in enumerate(rows, 1)]
    return "\n".join(sep.join(row) for row in [names, *rows]) + "\n"


def quoted(name: str) -> str:
    return f'"{name}"'


def comma(cell: float) -> str:
    return repr(cell).replace(".", ",")


EXCEL = columns(";", number=comma).replace("\n", ";;\r\n") + ";;;;;\r\n;;;;;\r\n"
DIALECTS = {
    "R write.csv": columns(head=quoted, first='""'),
    "R write.csv2": columns(";", head=quoted, number=comma, first='""'),
    "R write.table": columns(" ", head=quoted, first=""),
    "R write.table, tabs": columns("\t", head=quoted, first=""),
    "Excel, a German one": EXCEL,
    "Excel, with its own line": "sep=;\r\n" + EXCEL,
    "Excel, comments and unit lines through a spreadsheet": '"# made by hand",,,\n"# unit: rad",,,\n\n' + columns(),
    "LibreOffice, all quoted": columns(head=quoted, number=lambda cell: quoted(comma(cell))),
    "read and written again by pandas": columns(first="Unnamed: 0"),
    "a frame's number": columns(first="Frame"),
    "spaces to look nice": columns("   ", number=lambda cell: f"{cell:12.6f}"),
    "commas and spaces": columns(" , "),
    "scientific": columns(number=lambda cell: f"{cell:.6E}"),
    "a trailing comma in every line": columns().replace("\n", ",\n"),
    "a trailing comma under a header without": columns().replace("\n", ",\n").replace(",\n", "\n", 1),
    "old Macintosh lines": columns().replace("\n", "\r"),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_whatever_others_write(tmp_path: Path, dialect: str) -> None:
    same(read_motion(write(tmp_path, DIALECTS[dialect]), RANGES))


@pytest.mark.parametrize(
    ("header", "factor"),
    [
        *[
            (one, 1)
            for one in ("time", "Time", "t", "TIMESTAMP", "time (s)", "Time_s", "time [sec]", "t [s]", "time_s_")
        ],
        *[(one, 1e3) for one in ("time_ms", "time [ms]", "t(ms)", "Time ms", "timestamp_ms", "time_milliseconds")],
        *[("time [us]", 1e6), ("t [min]", 1 / 60), ("Time (µs)", 1e6), ("timestamp_ns", 1e9)],
    ],
)
def test_time_says_its_unit(tmp_path: Path, header: str, factor: float) -> None:
    frame = FRAME.drop(columns="t").rename(columns={"time": header}).assign(**{header: TIME * factor})
    frame.to_csv(tmp_path / "a.csv", index=False)
    same(read_motion(tmp_path / "a.csv", RANGES), JOINTS[:2])


@pytest.mark.parametrize(
    ("header", "factor"),
    [
        *[
            (one, np.pi / 180)
            for one in ("l_knee [deg]", "l_knee (deg)", "l_knee_deg", "l_knee[°]", "l_knee (degrees)")
        ],
        *[(one, 1) for one in ("l_knee [rad]", "l_knee(radians)", "l_knee_rad_", "l_knee [m]")],
        *[("l_knee [mm]", 1e-3), ("l_knee_mm", 1e-3), ("l_knee (cm)", 1e-2)],
    ],
)
@pytest.mark.parametrize("unit", [None, "deg"])
def test_a_column_says_its_unit(tmp_path: Path, header: str, factor: float, unit: str | None) -> None:
    """The file's or the command line's unit is for what says none, and for angles that say another."""
    usual = 1.0 if unit is None else np.pi / 180
    factor = factor if unit is None or header[-2:] in ("m]", "m)", "mm") else usual
    text = f"time,{header},grösse,slide\n" + "".join(f"{i},{i},{i},{i}\n" for i in range(4))
    ranges = RANGES | {"slide": (-9.0, 9.0)}
    movement = read_motion(write(tmp_path, text), ranges, unit, slides=["slide"])  # type: ignore[arg-type]
    assert movement.joints == ("l_knee", "grösse", "slide")
    np.testing.assert_allclose(movement.angles[-1], [3 * factor, 3 * usual, 3])


def test_a_suffix_is_a_unit_only_where_there_is_such_a_joint(tmp_path: Path) -> None:
    path = write(tmp_path, "time,l_knee_deg\n0,0\n1,1\n2,2\n")
    assert read_motion(path).joints == ("l_knee_deg",)
    both = read_motion(path, {"l_knee_deg": (-9, 9), "l_knee": (-9, 9)})
    assert both.joints == ("l_knee_deg",) and both.angles[2, 0] == 2
    assert read_motion(path, RANGES).angles[2, 0] == pytest.approx(np.deg2rad(2))


def test_joints_called_as_time_or_counts_are_joints(tmp_path: Path) -> None:
    rows = "".join(f"{i},{i},{i / 50}\n" for i in range(5))
    movement = read_motion(write(tmp_path, "index,t,time\n" + rows), {"index": (-9, 9), "t": (-9, 9)})
    assert movement.joints == ("index", "t")
    assert read_motion(write(tmp_path, "index,t [s],hip\n" + rows), {"hip": (-9, 9)}).joints == ("hip",)


def test_the_real_robots_file_comes_through_a_spreadsheet(tmp_path: Path) -> None:
    line = "20," + ",".join(map(str, range(26)))
    plain = read_motion(write(tmp_path, f"{line}\n" * 4))
    again = read_motion(write(tmp_path, (line.replace(",", ";") + "\r\n") * 4))
    np.testing.assert_array_equal(again.angles, plain.angles)
    np.testing.assert_allclose(again.time, [0, 0.02, 0.04, 0.06])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time;hip\n0;0,5\n1;0.5\n2;1\n", "line 2, column 'hip': '0,5' is not a finite number"),
        ("time;hip\n0;1.234,5\n1;1\n2;1\n", "line 2, column 'hip': '1.234,5' is not a finite number"),
        ("time,hip\n0,1\n1,1_0\n2,1\n", "line 3, column 'hip': '1_0' is not a finite number"),
        ("time,hip\n0,1\n1,NaN\n2,1\n", "line 3, column 'hip': 'NaN' is not a finite number"),
        ("time,hip\n0,1\n1,\n2,1\n", "line 3, column 'hip': '' is not a finite number"),
        ("time,hip [deg]\n0,1\n1,x\n2,1\n", r"line 3, column 'hip \[deg\]': 'x' is not"),
        ("time,hip\n0,1\n1,1,1\n2,1\n", "line 3 has 3 cells where most have 2"),
        ("time;hip;\n0;1;5\n1;1;6\n2;2;7\n", "line 1: a column has no name"),
        (",time,hip\n0,0,1\n2,1,1\n3,2,1\n", "line 1: a column has no name"),
        ("time,hip [turns]\n0,1\n1,1\n2,1\n", r"'hip' in unit 'turns'; angles are in 'rad' or 'deg', what slides in"),
        ('time,"hip\njoint"\n0,1\n1,1\n2,1\n', "line 1: a quoted cell does not end there"),
        ("time [days],hip\n0,1\n1,1\n2,1\n", "column 'time' is missing"),
        ("time,toe\n0,1\n1,1\n2,1\n", "unknown joint 'toe'; there are hip, knee"),
        ("frame,hip\n0,1\n1,1\n2,1\n3,1\n", "column 'time' is missing"),
        ('time,hip" x, knee"\n0,1,1\n1,1,1\n2,1,1\n', "line 1: a quote stands inside a cell"),
    ],
)  # fmt: skip
def test_what_cannot_be_read(tmp_path: Path, text: str, message: str) -> None:
    path = write(tmp_path, text)
    with pytest.raises(BodyError, match=message) as fault:
        read_motion(path, {"hip": (-9, 9), "knee": (-9, 9)})
    assert str(fault.value).startswith(str(path))
    assert "\n" not in str(fault.value) and len(str(fault.value)) - len(str(path)) < 300


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "time," + ",".join(f"j{i}" for i in range(300_000)) + "\n",
            "line 1 has 2288894 characters where at most 65536",
        ),
        ("\n".join(["time," * 2500] * 3), "line 1 has 2501 cells where at most 2000 are read"),
        ("time,hip\n0," + "1" * 10_000_000 + "\n", "line 2 has 10000002 characters where at most 65536 are read"),
        ('time,"' + "x" * 60_000 + '"\n0,1\n', "line 1: the name of column 2 has 60000 characters; name the joint"),
        ("time,hip\n0,1\0\n1,2\n", "is not text"),
        ("\n".join(["time"] + ['"'] * 100_000), "line 2: a quoted cell does not end there"),
        (";" * 60_000 + "\n", "line 1 has 60001 cells where at most 2000"),
    ],
    ids=["names", "columns", "a number", "a name", "a null", "quotes", "nothing"],
)
def test_giants_are_refused_at_once(tmp_path: Path, text: str, said: str) -> None:
    table("time,hip\n0,1\n", Path("warm"))  # pandas is there
    began = time.perf_counter()
    with pytest.raises(BodyError, match=said) as fault:
        read_motion(write(tmp_path, text), RANGES)
    assert time.perf_counter() - began < 1
    assert "\n" not in str(fault.value) and len(str(fault.value)) - len(str(tmp_path)) < 300


def test_a_long_table_is_read_quickly(tmp_path: Path) -> None:
    rows = np.column_stack([np.arange(20_000) / 50, np.zeros((20_000, 25))])
    frame = pd.DataFrame(rows, columns=["time", *(f"j{i}" for i in range(25))])
    frame.to_csv(tmp_path / "a.csv", index=False)
    began = time.perf_counter()
    assert read_motion(tmp_path / "a.csv").angles.shape == (20_000, 25)
    assert time.perf_counter() - began < 5


# --- what cannot be meant -----------------------------------------------------------------------------------------


def movement(time: np.ndarray, hip: np.ndarray) -> str:
    return "time,hip\n" + "".join(f"{a!r},{b!r}\n" for a, b in zip(time.tolist(), hip.tolist(), strict=True))


@pytest.mark.parametrize(
    ("step", "frames", "header", "message"),
    [
        (20, 50, "time", "50 frames are 20 s apart, 980 s in all; if these are milliseconds call the column time_ms"),
        (1, 4001, "time", "4001 frames are 1 s apart, 4000 s in all"),
        (20, 50, "time [ms]", None),
        (20, 50, "time [s]", None),
        (1, 5, "time", None),
        (0.04, 400, "time", None),
    ],
)
def test_milliseconds_are_not_taken_for_seconds(
    tmp_path: Path, step: float, frames: int, header: str, message: str | None
) -> None:
    path = write(tmp_path, movement(step * np.arange(frames), np.zeros(frames)).replace("time", header, 1))
    if message is None:
        assert read_motion(path).duration == pytest.approx(step * (frames - 1) * (1e-3 if "ms" in header else 1))
        return
    with pytest.raises(BodyError, match=message):
        read_motion(path)


def test_jumps_are_refused_and_what_an_arm_can_do_is_not(tmp_path: Path) -> None:
    time = np.arange(6) / 50
    for way, said in (
        (217.8, r"'hip' jumps by 217.8 deg from frame 3 to 4, 10890 deg/s, .* than 9000; take bad frames out"),
        (355, "unwrap it where it turns past 180 deg"),
    ):
        path = write(tmp_path, movement(time, np.deg2rad(np.where(time < 0.05, 0, way))))
        with pytest.raises(BodyError, match=said):
            read_motion(path)
        assert read_motion(path, slides=["hip"]).duration == pytest.approx(0.1)
    read_motion(write(tmp_path, movement(time, np.deg2rad(170 * (time > 0.05)))))


def test_gaps_and_curves_beyond_a_range_are_told() -> None:
    time = np.r_[np.arange(50), 150 + np.arange(50)] / 50
    gap = JointTrajectory("x", time, ("hip",), np.zeros((100, 1)))
    assert gaps(gap) == ("x: no frame for 2.02 s after 0.98 s (elsewhere every 0.02 s); a smooth curve stands there",)
    assert gaps(JointTrajectory("x", np.arange(5) * 2.0, ("hip",), np.zeros((5, 1)))) == ()
    corner = JointTrajectory("x", np.arange(20) / 10, ("hip",), np.where(np.arange(20) < 10, 0, 1.0)[:, None])
    curve = corner.resampled(0.02)
    over = np.rad2deg(curve.angles.max() - 1)
    [line] = beyond(curve, np.array([[-1.0, 1.0]]))
    assert f"'hip' would swing {over:.1f} deg beyond its range at {curve.time[curve.angles.argmax()]:.2f} s" in line
    assert over > 3 and beyond(curve, np.array([[-1.0, 1.0 + np.deg2rad(over)]])) == ()


def test_archives_know_milliseconds(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", time_ms=TIME * 1000, angles=ANGLES, joints=JOINTS)
    same(read_motion(tmp_path / "a.npz"))
    np.savez(tmp_path / "a.npz", time=np.arange(200) * 20, angles=np.zeros((200, 1)), joints=["hip"])
    with pytest.raises(BodyError, match="call the column time_ms"):
        read_motion(tmp_path / "a.npz")


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_first_line_that_is_short_is_as_r_writes_it_whatever_ends_lines(end: str, tmp_path: Path) -> None:
    (path := tmp_path / "r.csv").write_bytes(end.join(["a,b", "0,1,2", "1,3,4", ""]).encode())
    found = table(text(path), path)
    assert found.cells.tolist() == [["", "a", "b"], ["0", "1", "2"], ["1", "3", "4"]]
