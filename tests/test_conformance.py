"""What every registered thing has to keep: a newcomer is tested by being entered into its dict."""

import ast
import inspect
import os
import re
import runpy
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from babbling.axes import Axis
from babbling.body import Body
from babbling.errors import BabblingError
from experiments.__main__ import main
from experiments.registry import EXPERIMENTS, entry
from experiments.shared.caregiver import opposite
from experiments.shared.eyes import EyeOptions, nursery
from imitation.errors import ImitationError
from imitation.inference.selection import SELECTION, selection_rule
from models.body import SimulatedBody
from models.errors import BodyError
from models.loading import load_body
from models.maze import MazeBody, parse_maze
from models.motion import FORMATS, MotionError, read_motion
from models.part import PartOfBody
from models.robots import ROBOTS
from models.seeing_body import SeeingBody, watching_body
from models.teachers import robots as teaching
from models.teachers.demonstrations import DEMONSTRATIONS
from models.teachers.performing import perform
from tests.babbling.creature import Creature

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = sorted({path.parent for path in (ROOT / "models").rglob("*.xml")})
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
    assert main([name, "--help"]) == 0
    shown = capsys.readouterr().out
    assert [option for option in options if option not in shown] == []
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
    assert [line.split()[0] for line in shown[:-1]] == list(EXPERIMENTS)


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
    "before a face": partial(opposite, EYES, 2, 0, distance=0.5, tick_s=0.2),
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
    if isinstance(body, SimulatedBody | PartOfBody):  # servos that are not asked to jump
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
    noise = np.sqrt(2) * NOISE / body.tick_s if isinstance(body, SimulatedBody) else 0.0  # of a speed, the largest
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
    with pytest.raises(MotionError) as caught:
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
