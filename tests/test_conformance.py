"""What every registered thing has to keep: a newcomer is tested by being entered into its dict."""

import ast
import inspect
import os
import re
import runpy
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
from numpy.typing import NDArray

from babbling.axes import Axis
from babbling.body import Body
from babbling.errors import BabblingError
from babbling.files import VERSION, load, save
from babbling.kinds import KINDS
from experiments.__main__ import main
from experiments.registry import EXPERIMENTS, entry
from experiments.shared.caregiver import FIND_FACE
from experiments.shared.eyes import EyeOptions, nursery, open_eyes
from imitation.errors import ImitationError
from imitation.inference.selection import SELECTION, selection_rule
from models.body import SimulatedBody
from models.errors import BodyError
from models.loading import load_body
from models.maze import MazeBody, parse_maze
from models.motion import FORMATS, read_motion
from models.robots import ROBOTS
from models.seeing_body import SeeingBody, watching_body
from models.teachers import robots as teaching
from models.teachers.demonstrations import DEMONSTRATIONS
from models.teachers.performing import perform
from tests.babbling.creature import Creature
from tests.kinds import FILES, write_kinds

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = sorted({path.parent for path in (ROOT / "models").rglob("*.xml") if path.name != "object.xml"})
REGISTRIES: dict[str, tuple[Mapping[str, object], Callable[[str], object], type[Exception]]] = {
    "robot": (ROBOTS, load_body, BodyError),
    "demonstration": (DEMONSTRATIONS, perform, BodyError),
    "selection": (SELECTION, selection_rule, ImitationError),
    "experiment": (EXPERIMENTS, entry, BabblingError),
}


@pytest.mark.parametrize("kind", REGISTRIES)
def test_names_are_typeable_and_a_wrong_one_is_answered_with_the_nearest(kind: str) -> None:
    registered, ask, error = REGISTRIES[kind]
    assert registered
    for name in registered:
        assert re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", name), name
        with pytest.raises(error, match=rf"unknown {kind} '{name}x'; there are .*did you mean") as caught:
            ask(name + "x")
        assert "\n" not in str(caught.value)


def line_of(one: object) -> str:
    """What people are told of a registered thing."""
    told = getattr(one, "line", None) or getattr(one, "about", None) or inspect.getdoc(one) or ""
    return str(told).splitlines()[0] if told else ""


@pytest.mark.parametrize("kind", REGISTRIES)
def test_everything_is_described_in_a_line_of_its_own(kind: str) -> None:
    lines = {name: line_of(one) for name, one in REGISTRIES[kind][0].items()}
    assert all(15 <= len(line) <= 120 for line in lines.values()), lines
    assert len(set(lines.values())) == len(lines)


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_an_experiment_is_options_and_a_run(name: str) -> None:
    module, options = entry(name).load(), entry(name).options()
    assert (module.__doc__ or "").strip()
    assert is_dataclass(options)
    config = options()
    with pytest.raises(AttributeError):
        config.seed = 1  # frozen
    assert {"out", "seed"} <= {field.name for field in fields(options)}
    assert config.out is None and config.seed == 0
    assert callable(getattr(module, "run", None) or getattr(module, "command", None))


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_every_option_of_an_experiment_is_explained(name: str) -> None:
    for block in entry(name).options().__mro__[:-1]:
        source = ast.parse(inspect.getsource(block)).body[0]
        assert isinstance(source, ast.ClassDef)
        for statement, following in zip(source.body, [*source.body[1:], None], strict=True):
            if isinstance(statement, ast.AnnAssign):
                explained = isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant)
                assert explained, f"{name}: {ast.unparse(statement.target)} has no line under it"


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_help_names_every_option_both_ways(
    name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    one = entry(name)
    options = [f"--{field.name.replace('_', '-')}" for field in fields(one.options())]
    assert main([name, "--help"]) == 0 and (shown := capsys.readouterr().out)
    at_a_place = {"robot": {"--robot"}, "compare": {"--runs"}, "fit": {"--table"}}.get(name, set())
    assert {*re.findall(r"^. (--[a-z-]+)", shown, re.MULTILINE)} == {*options} - at_a_place
    assert one.line.split()[0] in shown
    monkeypatch.setattr(sys, "argv", [name, "--help"])  # python -m experiments.NAME
    with pytest.raises(SystemExit) as stop:
        runpy.run_module(f"experiments.{name}", run_name="__main__")
    assert stop.value.code in (0, None)
    assert "--seed" in capsys.readouterr().out


def test_the_list_shows_everything_and_waits_for_no_physics() -> None:
    code = (
        "import sys; from experiments.__main__ import main; status = main(['list']);"
        "print(sorted({'mujoco', 'pinocchio', 'dm_control', 'rerun'} & set(sys.modules)), status)"
    )
    shown = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, env=os.environ, capture_output=True, text=True, check=True, timeout=60
    ).stdout.splitlines()
    assert shown[-1] == "[] 0"
    assert [line.split()[0] for line in shown if re.match("  [a-z]", line)] == [*EXPERIMENTS]
    assert all(any(name in re.split(r"[ ,;]+", line) for line in shown) for name in (*ROBOTS, *DEMONSTRATIONS))


def test_options_are_known_and_checked_without_physics_and_figures() -> None:
    code = (
        "import sys; from experiments.registry import EXPERIMENTS\n"
        "for one in EXPERIMENTS.values(): one.options()().check()\n"
        "heavy = {'mujoco', 'pinocchio', 'dm_control', 'scipy', 'h5py', 'rerun', 'matplotlib'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    shown = subprocess.check_output([sys.executable, "-c", code], cwd=ROOT, text=True, timeout=60)
    assert shown == "[]\n"


def test_a_wrong_name_is_exit_2_and_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gestrue"]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert len(shown.err.splitlines()) == 1 and "did you mean 'gesture'?" in shown.err


EYES, NOISE = EyeOptions(width=80, height=60), 0.001
HALL = """\
+--+--+--+
|    2| 1|
+  +--+  +
| *      |
+--+--+--+
"""
BODIES: dict[str, Callable[[], Body]] = {
    **{name: partial(load_body, name, copies=2, threads=1, noise=NOISE) for name in ROBOTS},
    "scrambled": partial(load_body, "hoap2", copies=2, threads=1, noise=NOISE, scramble=1),
    **{f"head of {name}": partial(watching_body, name, copies=2) for name, one in ROBOTS.items() if one.head},
    "among toys": partial(nursery, EYES, 0, copies=2),
    "wires crossed": partial(nursery, replace(EYES, scramble=1), 0, copies=2),
    "squinting": partial(nursery, replace(EYES, squint=1), 0, copies=2),
    "before a face": partial(open_eyes, EYES, FIND_FACE, copies=2, tick_s=0.2, seed=0, teacher=True, distance=0.5),
    "maze": partial(MazeBody, parse_maze(HALL), copies=2),
    "creature": partial(Creature, copies=2),
}


@pytest.mark.parametrize("name", BODIES)
def test_a_body_is_numbers_and_ranges(name: str) -> None:
    """The `Body` protocol: shapes, ranges, dtypes, rest, and nothing that changes behind one's back."""
    body, twin = BODIES[name](), BODIES[name]()
    low, high = body.sense_low, body.sense_high
    motors, senses = len(body.motor_low), len(low)
    assert body.copies == 2 and body.tick_s > 0 and body.fingerprint == twin.fingerprint
    for vector, size in ((body.motor_low, motors), (body.motor_high, motors), (low, senses), (high, senses)):
        assert vector.shape == (size,) and vector.dtype == np.float64 and np.isfinite(vector).all()
    assert (body.motor_low < body.motor_high).all() and (low < high).all()
    moves = np.random.default_rng(5).uniform(body.motor_low, body.motor_high, (40, 2, motors))
    if isinstance(body, SimulatedBody):  # servos that are not asked to jump
        moves = body.command_angles(body.joint_angles) + np.cumsum(0.005 * moves, 0)
    elif isinstance(body, SeeingBody):
        moves *= 0.2
    felt = [body.reset(), *(body.act(np.rint(move) if name == "maze" else move) for move in moves)]
    kept = [one.copy() for one in felt]
    again = body.reset()
    for before, after in zip(felt, kept, strict=True):
        assert before.shape == (2, senses) and before.dtype == np.float64
        np.testing.assert_array_equal(before, after)
        assert not np.shares_memory(before, again)
    noise = float(np.max(body.senses["speed"].noise)) if isinstance(body, SimulatedBody) else 0.0  # the largest
    np.testing.assert_allclose(again, felt[0], rtol=0, atol=12 * noise)
    values, slack = np.array(felt).reshape(-1, senses), 0.01 * (high - low) + 6 * noise
    there = np.isfinite(values)
    assert (values >= low - slack)[there].all() and (values <= high + slack)[there].all()
    assert there.all() or isinstance(body, SeeingBody)
    assert (np.nanmax(values, 0) > np.nanmin(values, 0)).all(), "a sense that never changes"


@pytest.mark.parametrize("name", [name for name in BODIES if name != "creature"])
def test_the_channels_of_a_body_cover_its_sense_vector_exactly_once(name: str) -> None:
    body: Any = BODIES[name]()
    layout = body.senses
    lines = np.concatenate([layout.lines(channel).ravel() for channel in layout.channels])
    assert sorted(lines) == list(range(len(body.sense_low)))
    assert len(set(layout.labels)) == len(lines) and all(channel.unit for channel in layout.channels.values())
    felt = body.reset()
    readings = {channel: layout.read(felt, channel) for channel in layout.channels}
    np.testing.assert_array_equal(layout.vector(readings), felt)


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_feels_the_same_again(name: str) -> None:
    def felt(seed: int) -> NDArray[np.float64]:
        body = load_body(name, copies=2, threads=1, noise=0.01, seed=seed)
        moves = np.random.default_rng(5).uniform(body.motor_low, body.motor_high, (3, 2, len(body.motor_low)))
        return np.array([body.reset(), *(body.act(0.3 * move) for move in moves)])

    senses = felt(0)
    np.testing.assert_array_equal(senses, felt(0))
    assert (senses != felt(1)).any()
    assert np.abs(senses[3] - senses[0]).max() > 0.02  # it moves


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_a_robots_folder_has_its_papers(folder: Path) -> None:
    papers = (folder / "README.md").read_text()
    assert (folder / f"{folder.name}.xml").exists() and (folder / "scene.xml").exists()
    for file in folder.glob("*.xml"):
        assert f"`{file.name}`" in papers, f"{folder.name}/README.md does not say what {file.name} is"


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize("content", [b"", bytes(range(256)) * 8], ids=["empty", "noise"])
def test_a_format_refuses_what_is_none_of_it(suffix: str, content: bytes, tmp_path: Path) -> None:
    path = tmp_path / f"movement{suffix}"
    path.write_bytes(content)
    with pytest.raises(BodyError) as caught:
        read_motion(path)
    assert path.name in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("name", DEMONSTRATIONS)
def test_a_demonstration_is_postures_in_order(name: str) -> None:
    one = DEMONSTRATIONS[name]
    times = [time for time, _ in one.postures]
    assert one.robot in teaching.ROBOTS
    assert times[0] == 0 and len(times) > 1 and (np.diff(times) > 0).all()
    assert any(a != b for (_, a), (_, b) in zip(one.postures, one.postures[1:], strict=False))


AXES = {
    "measured": Axis("action", "rad", np.array([-1.0, 2.0]), np.array([1.0, 2.5]), 9),
    "categorical": Axis.categorical("action", ("north", "east", "south"), factors=2),
}


@pytest.mark.parametrize("axis", AXES.values(), ids=AXES)
@pytest.mark.parametrize("name", SELECTION)
def test_a_selection_is_an_action_of_the_axis(name: str, axis: Axis) -> None:
    rule, rng = selection_rule(name), np.random.default_rng(3)
    posteriors = rng.dirichlet(np.full(axis.size, 0.3), (200, 2))
    certain = np.eye(axis.size)[[[1, 2]]]
    if name == "mean" and axis.is_categorical:
        with pytest.raises(ImitationError, match="have no mean"):
            rule(posteriors, axis, rng)
        return
    actions = rule(posteriors, axis, rng)
    assert actions.shape == (200, 2)
    assert (actions >= axis.low - 1e-12).all() and (actions <= axis.high + 1e-12).all()
    if axis.is_categorical:
        assert set(np.unique(actions)) <= set(range(axis.size))
    chosen = np.array([rule(certain, axis, rng)[0] for _ in range(50)])
    assert (np.abs(chosen - [axis.points[0, 1], axis.points[1, 2]]) <= axis.step + 1e-12).all()
    again = [rule(posteriors, axis, np.random.default_rng(4)) for _ in range(2)]
    np.testing.assert_array_equal(*again)


FOR_PEOPLE = ("_name", "_probability")  # so end variables that nobody reads back


@pytest.fixture(scope="module")
def kept(arm: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Path]]:
    """A file of every kind."""
    with pytest.MonkeyPatch.context() as patch:
        yield write_kinds(arm, tmp_path_factory.mktemp("kinds"), patch)


def read_variables(path: Path) -> dict[str, tuple[NDArray[np.generic], bool]]:
    """What is in a file, bare dimensions apart, and whether it is read back."""
    with h5py.File(path) as file:
        bare = {name for name in file if b"not a netCDF variable" in file[name].attrs.get("NAME", b"")}
        return {name: (file[name][()], not name.endswith(FOR_PEOPLE)) for name in file if name not in bare}


def refused(path: Path, name: str) -> str:
    """The one line that this file is refused with."""
    with pytest.raises(KINDS[name].error) as caught:
        load(path, KINDS[name].holds)
    assert type(caught.value) is KINDS[name].error
    said = str(caught.value)
    assert str(path) in said and len(said.splitlines()) == 1 and said.isprintable()
    return said


def test_every_kind_of_file_is_tried() -> None:
    assert set(FILES) == set(KINDS)


@pytest.mark.parametrize("name", FILES)
def test_a_file_comes_back_to_the_last_bit(name: str, kept: dict[str, Path], tmp_path: Path) -> None:
    save(load(kept[name], KINDS[name].holds), tmp_path / "again.nc")
    before, after = read_variables(kept[name]), read_variables(tmp_path / "again.nc")
    assert before.keys() == after.keys()
    for variable, (values, _) in before.items():
        assert values.dtype == after[variable][0].dtype and values.tobytes() == after[variable][0].tobytes(), variable
    assert (tmp_path / "again.nc").read_bytes() == kept[name].read_bytes()
    with xr.open_dataset(kept[name], engine="h5netcdf") as data:
        assert set(map(str, data.variables)) == set(before)


@pytest.mark.parametrize("name", FILES)
def test_what_is_missing_misshapen_or_no_number_is_named(name: str, kept: dict[str, Path], tmp_path: Path) -> None:
    path, before = tmp_path / "spoiled.nc", read_variables(kept[name])
    for turn, (variable, (values, wanted)) in enumerate(before.items()):
        kind = values.dtype.kind
        other = np.zeros(values.shape, "S2" if kind == "S" else np.float32)
        spoiled = [None, np.stack([values, values]), other]
        if kind != "S" and values.size:
            spoiled.append(np.full_like(values, {"f": (np.nan, -np.inf, 1e30)[turn // 2 % 3], "i": -(2**63)}[kind]))
        for bad in spoiled[turn % 2 :: 2]:
            path.write_bytes(kept[name].read_bytes())
            with h5py.File(path, "r+") as file:
                del file[variable]
                if bad is not None:
                    file[variable] = bad
            if wanted:
                assert variable.removesuffix("_points") in refused(path, name), (variable, bad)
            else:
                load(path, KINDS[name].holds)


@pytest.mark.parametrize("name", FILES)
def test_other_kinds_versions_and_no_files_are_refused(name: str, kept: dict[str, Path], tmp_path: Path) -> None:
    for other in set(FILES) - {name}:
        assert f"not a file of kind 'imitation-laboratory {name}'" in refused(kept[other], name)
    path = tmp_path / "version.nc"
    for version in (-5, 0, VERSION + 1, 1.5, "2", np.nan):
        path.write_bytes(kept[name].read_bytes())
        with h5py.File(path, "r+") as file:
            file.attrs["version"] = version
        assert f"written in version {version}," in refused(path, name)
    os.mkfifo(tmp_path / "pipe")
    for place in (tmp_path / "pipe", Path("/dev/zero")):
        assert "no regular file" in refused(place, name)
    assert "a directory" in refused(tmp_path, name)
    assert "no such file" in refused(tmp_path / "none.nc", name)


@pytest.mark.parametrize("name", FILES)
def test_cut_and_garbled_files_are_one_line(name: str, kept: dict[str, Path], tmp_path: Path) -> None:
    whole, rng, path = kept[name].read_bytes(), np.random.default_rng(0), tmp_path / "garbled.nc"
    for share in (0.0, 0.1, 0.5, 0.9, 0.99):
        path.write_bytes(whole[: int(share * len(whole))])
        assert ("not a readable NetCDF-4 file" if share else "is empty") in refused(path, name)
    for flips in (1, 3, 20, 200) * 10:
        garbled = np.frombuffer(whole, np.uint8).copy()
        garbled[rng.integers(0, len(whole), flips)] ^= rng.integers(1, 256, flips, dtype=np.uint8)
        path.write_bytes(garbled.tobytes())
        assert "damaged" in refused(path, name)


@pytest.mark.parametrize("name", FILES)
def test_numbers_that_were_changed_are_possible_or_one_line(name: str, kept: dict[str, Path], tmp_path: Path) -> None:
    """Written by another program, a file has no seal: whatever its numbers are, they are judged."""
    rng, path = np.random.default_rng(0), tmp_path / "changed.nc"
    for variable, (values, _) in read_variables(kept[name]).items():
        bits = np.frombuffer(values.tobytes() or b"none", np.uint8).copy()
        bits[rng.integers(0, len(bits), 3)] ^= rng.integers(1, 256, 3, dtype=np.uint8)
        path.write_bytes(kept[name].read_bytes())
        with h5py.File(path, "r+") as file:
            file[variable][...] = np.frombuffer(bits.tobytes()[: values.nbytes], values.dtype).reshape(values.shape)
        try:
            load(path, KINDS[name].holds)
        except KINDS[name].error as error:
            assert str(error).isprintable()
