"""The door: whatever stands under a name that a user gives, opening it ends soon, in bytes or in one line."""

import ast
import os
import socket
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from babbling.errors import BabblingError
from babbling.files import load
from babbling.mind import Mind
from models.errors import LONGEST, BodyError
from models.files import LIMIT_BYTES, MOST_LINES, checked, finite, lines, opened, raw, text
from models.loading import load_body
from models.maze import read_maze
from models.motion import read_motion
from models.teachers.performing import perform
from models.teachers.urdf import read_urdf

ROOT = Path(__file__).resolve().parents[2]


def a_pipe(path: Path) -> None:
    os.mkfifo(path)


def a_socket(path: Path) -> None:
    with socket.socket(socket.AF_UNIX) as one:
        os.chdir(path.parent)  # names of sockets are short
        one.bind(path.name)


def a_large_one(path: Path) -> None:
    with path.open("wb") as file:
        os.truncate(file.fileno(), 20 << 30)


SPECIAL: dict[str, tuple[Callable[[Path], object], str]] = {
    "pipe": (a_pipe, "no regular file"),
    "socket": (a_socket, "no regular file"),
    "endless": (lambda path: path.symlink_to("/dev/zero"), "no regular file"),
    "directory": (Path.mkdir, "a directory"),
    "nothing": (lambda path: None, "no such file"),
    "dangling": (lambda path: path.symlink_to("nowhere"), "no such file"),
    "round": (lambda path: path.symlink_to(path.name), "cannot be read"),
    "empty": (Path.touch, "is empty"),
    "large": (a_large_one, "MB are read"),
}
READERS: dict[str, Callable[[Path], object]] = {
    ".xml": load_body,
    ".urdf": read_urdf,
    ".amc": perform,
    ".bvh": perform,
    ".csv": read_motion,
    ".npz": read_motion,
    ".txt": read_maze,
    ".nc": lambda path: load(path, Mind),
}


@pytest.mark.parametrize("kind", SPECIAL)
@pytest.mark.parametrize("suffix", READERS)
def test_what_is_no_file_is_one_line_at_once(
    kind: str, suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    make, said = SPECIAL[kind]
    path, started = tmp_path / f"a{suffix}", time.monotonic()
    make(path)
    with pytest.raises((BodyError, BabblingError), match=said) as caught:
        READERS[suffix](path)
    assert str(caught.value).isprintable() and path.name in str(caught.value)
    assert time.monotonic() - started < 20


@pytest.mark.parametrize("name", ["a\nb", "n" * 4096, "a\0b", os.fsdecode(b"\xff\xfe"), "\x1b[2J", "d/" * 2000])
def test_a_strange_name_is_told_in_one_line(name: str, tmp_path: Path) -> None:
    for suffix, read in READERS.items():
        with pytest.raises((BodyError, BabblingError)) as caught:
            read(tmp_path / f"{name}{suffix}")
        said = str(caught.value)
        assert said.isprintable() and len(said) <= LONGEST and "imitate: " + said < "imitate: " + "\U0010ffff"


def test_a_pipe_that_takes_a_files_place_is_not_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time,a\n")
    status = path.stat()
    path.unlink()
    os.mkfifo(path)
    monkeypatch.setattr(Path, "stat", lambda *_, **__: status)
    with pytest.raises(BodyError, match="no regular file"):
        raw(path)


def test_what_grows_is_read_to_the_bound_and_what_shrinks_to_its_end(tmp_path: Path) -> None:
    path = tmp_path / "a"
    path.write_bytes(b"x" * 100)
    with opened(path, 100) as file:
        os.truncate(path, 10)
        assert file.read() == b"x" * 10
    real, path_stat = raw(path, 10), path.stat()
    assert real == b"x" * 10
    path.write_bytes(b"y" * 1000)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Path, "stat", lambda *_, **__: path_stat)
        patch.setattr(os, "fstat", lambda _: path_stat)
        assert raw(path, 10) == b"y" * 10


def test_a_file_that_may_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> int:
        raise PermissionError(13, "Permission denied")

    (tmp_path / "a").write_bytes(b"x")
    monkeypatch.setattr(os, "open", refuse)
    for read in (opened, raw, text):
        with pytest.raises(BodyError, match=r"a: cannot be read \(Permission denied\)"):
            read(tmp_path / "a")
    assert checked(tmp_path / "a") == tmp_path / "a"


@pytest.mark.parametrize("parted", ["\n", "\r\n", "\r"])
def test_lines_are_numbered_as_editors_do(parted: str) -> None:
    assert [(n, line.strip()) for n, line in lines("x", parted.join(["a", "", " b", ""]))] == [(1, "a"), (3, "b")]
    with pytest.raises(BodyError, match=f"at most {MOST_LINES} are read"):
        next(lines("x", parted * (MOST_LINES + 1)))


@pytest.mark.parametrize("cell", ["1", "-1.5", "+.5", "3.", "1e3", "-2E-3"])
def test_plain_numbers(cell: str) -> None:
    assert finite(cell, "x") == float(cell)


@pytest.mark.parametrize("cell", ["", "nan", "inf", "1_0", "١", "1e999", "1e10", "0x1", "1 ", "e5", ".", "9" * 5000])
def test_what_is_no_plain_number(cell: str) -> None:
    with pytest.raises(BodyError, match="is not a finite number"):
        finite(cell, "x")


OPENS = {"open", "fdopen", "FileIO", "read_bytes", "read_text", "ZipFile", "from_file", "from_xml_path", "load_dataset",
         "open_dataset", "imread", "genfromtxt", "loadtxt", "read_csv", "from_string"}  # fmt: skip
"""And h5py.File, np.load and Pinocchio's builders."""
OURS = {
    "models/files.py: open", "models/files.py: FileIO",  # the door
    "models/trial.py: from_file", "models/hush.py: open", "models/apart.py: open", "models/apart.py: read_text",
    "models/teachers/urdf.py: buildModelFromXML", "models/motion/archives.py: ZipFile", "models/tables.py: read_csv",
    "babbling/files.py: File", "experiments/shared/kept.py: load",  # what came through the door
    "babbling/whole.py: open", "experiments/shared/kept.py: open",  # written; a lock on a folder
    "experiments/shared/kept.py: read_bytes",  # the program itself, and what it just wrote
    "experiments/shared/report.py: read_bytes", "experiments/shared/report.py: read_text",  # what this run just wrote
    "experiments/shared/report.py: imread",  # of its own figures
    "experiments/shared/report.py: from_string", "experiments/stopping.py: open", "experiments/command_line.py: open",
    "models/objects/scene.py: from_file", "models/loading.py: from_file", "models/heads.py: from_file",  # registered
    "models/biclops/room.py: from_file", "models/teachers/robots.py: buildModelFromMJCF",
    "models/teachers/robots.py: buildModelFromUrdf", "models/maze/drawing.py: read_text",
    "models/hoap2/kinematics.py: buildModelFromMJCF", "models/hoap2/kinematics.py: buildReducedModel",
    "models/hoap2/derive_gains.py: from_xml_path", "models/hoap2/derive_gains.py: read_text",
    "models/hoap2/derive_seat.py: read_text", "models/maze/walk_file.py: open",  # written
    "experiments/robot/run.py: open", "experiments/shared/film.py: open", "experiments/__main__.py: open",  # written
    "experiments/shared/notebook.py: read_bytes", "experiments/face/later.py: read_bytes",  # of this very run
    "experiments/benchmark/strangers.py: ZipFile", "experiments/benchmark/strangers.py: open",  # a wheel, unpacked
}  # fmt: skip
"""Where else something is opened or a native reader called: nothing that a user names, or what came by the door."""


def test_nothing_else_opens_files() -> None:
    found = set()
    for package in ("models", "babbling", "imitation", "experiments"):
        for path in (ROOT / package).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                if not isinstance(node, ast.Call):
                    continue
                name = getattr(node.func, "attr", getattr(node.func, "id", ""))
                whole = ast.unparse(node.func)
                if name in OPENS or whole in ("h5py.File", "np.load", "json.load") or name.startswith("buildModel"):
                    found.add(f"{path.relative_to(ROOT)}: {name}")
                elif name == "buildReducedModel":
                    found.add(f"{path.relative_to(ROOT)}: {name}")
    assert found == OURS


def test_the_largest_file_is_an_hour_of_movement() -> None:
    row = ",".join(["-0.123456"] * 25)
    assert 3600 * 50 * (len(row) + 10) < LIMIT_BYTES
    assert np.isfinite(finite("1e9", "x"))
