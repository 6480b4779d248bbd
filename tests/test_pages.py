"""What README.md, RESULTS.md and CONTRIBUTING.md show is run as it stands there, in haste."""

import json
import re
import runpy
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import experiments
from babbling.loop import babble  # noqa: F401
from babbling.mind import learn
from babbling.states import Wanderer  # noqa: F401
from experiments.__main__ import main
from experiments.command_line import parse
from experiments.registry import EXPERIMENTS, Entry
from imitation.acting.follow import Follower, follow  # noqa: F401  (what the pages name)
from imitation.acting.loop import Imitator  # noqa: F401
from imitation.acting.movement import Movement
from imitation.inference.moving import AveragedInverse  # noqa: F401
from models.loading import load_body
from models.robots import Robot
from models.shapes import parts
from tests.conftest import hurry
from tests.imitation.test_follow import ACTS, SUCCESSOR, Bench, Things

ROOT = Path(__file__).resolve().parents[1]
LINK = "v 0 0 0.2\nv .02 .02 0\nv -.02 .02 0\nv 0 -.02 0\nf 2 3 1\nf 3 4 1\nf 4 2 1\nf 4 3 2\n"


def blocks(page: str, language: str) -> list[str]:
    """Every block of this language."""
    return re.findall(rf"```{language}\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)


def entry_of(page: str, thing: str) -> Any:
    """What a page says to enter in a registry."""
    told = re.search(rf'`("\w+": {thing}\(.*?\))`', (ROOT / page).read_text())
    assert told, f"{page} shows no entry of {thing}"
    return eval(f"{{{told[1]}}}", {"Robot": Robot, "Entry": Entry, "Path": Path, "__file__": "models/robots.py"})


@pytest.fixture(scope="module")
def toy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The robot of CONTRIBUTING.md."""
    path = tmp_path_factory.mktemp("toy") / "toy.xml"
    (path.parent / "assets").mkdir()
    (path.parent / "assets" / "link.obj").write_text(LINK)
    path.write_text(blocks("CONTRIBUTING.md", "xml")[0])
    return path


@pytest.fixture
def sway(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The experiment of CONTRIBUTING.md, entered."""
    code = blocks("CONTRIBUTING.md", "python")[0]
    for name, text in re.findall(r"^# (experiments/\S+)\n(.*?)(?=^# experiments/|\Z)", code, re.DOTALL | re.MULTILINE):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    (path.parent / "__init__.py").write_text('"""Swaying."""\n')
    (path.parent / "__main__.py").write_text((ROOT / "experiments" / "gesture" / "__main__.py").read_text())
    monkeypatch.setattr(experiments, "__path__", [*experiments.__path__, str(tmp_path / "experiments")])
    for name, entry in entry_of("CONTRIBUTING.md", "Entry").items():
        monkeypatch.setitem(EXPERIMENTS, name, entry)
        yield name
        for module in [one for one in sys.modules if one.startswith(f"experiments.{name}")]:
            del sys.modules[module]


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_every_command_can_be_pasted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Commands of README.md and RESULTS.md, each read by a shell and by the options, in order: what one reads was left
    by one before, or is somebody's capture."""
    pages = "".join((ROOT / name).read_text() for name in ("README.md", "RESULTS.md"))
    text = re.sub(r"```.*?```", "", pages.replace("\\\n", " "), flags=re.DOTALL)
    lines = re.findall(r"^ {4}(imitate .*)$|`((?:imitate|for \w+ in [^`]*?imitate)\s[^`]*)`", text, re.MULTILINE)
    assert len(lines) > 30
    monkeypatch.chdir(tmp_path)
    for line in (" ".join((one or other).split()) for one, other in lines):
        say = 'imitate() { printf "%s\\n" "$@" "--END--"; }; ' + line
        told = subprocess.run(["bash", "-euo", "pipefail", "-c", say], capture_output=True, text=True, check=False)
        assert told.returncode == 0 and not told.stderr, f"{line}: {told.stderr}"
        commands = [command.splitlines() for command in told.stdout.split("--END--\n") if command]
        assert commands, line
        for name, *words in commands:
            if name in ("list", "--version"):
                continue
            for file in (Path(word) for word in words):
                if file.suffix in (".amc", ".bvh"):
                    file.write_text("a capture")
            config = parse(EXPERIMENTS[name].options(), name, words)
            assert config is not None, line
            config.check()
            if config.out is not None:
                Path(config.out).parent.mkdir(parents=True, exist_ok=True)
                Path(config.out).write_text("left")


def test_the_five_lines_run_and_take_any_prior(monkeypatch: pytest.MonkeyPatch) -> None:
    hurry(monkeypatch.setattr)
    five, prior = blocks("README.md", "python")
    hasty, changed = re.subn(r"babbling_minutes=\d+", "babbling_minutes=0.6", five)
    assert changed == 1
    here: dict[str, Any] = {}
    exec(compile(hasty, "README.md", "exec"), here)
    seen, felt = here["seen"].movement.senses, here["felt"]
    assert felt.shape == (len(seen), 1, seen.shape[1])
    there = np.isfinite(seen)
    assert np.sqrt(np.mean((felt[:, 0] - seen)[there] ** 2)) < np.deg2rad(1)
    exec(compile(prior, "README.md", "exec"), here)
    wanted, done = here["seen"].angles, here["attempt"].senses[:, 0, here["mind"].pilot.schema.posture]
    assert done.shape == wanted.shape and (np.abs(here["attempt"].candidates) <= 0.2 + 1e-9).any()


def test_the_robot_has_meshes_and_an_entry(toy: Path) -> None:
    assert entry_of("CONTRIBUTING.md", "Robot")["toy"].path == Path("models/toy/toy.xml")
    body = load_body(toy)
    np.testing.assert_allclose(body.joint_range, [[-1.5, 1.5]])
    [part] = parts(body.model, np.zeros((1, 1)))
    [shape] = part.shapes
    corners = np.array([[0, 0, 0.2], [0.02, 0.02, 0], [-0.02, 0.02, 0], [0, -0.02, 0]])
    assert shape.kind == "mesh" and shape.mesh is not None and shape.mesh.triangles.shape == (4, 3)
    away = np.linalg.norm(shape.mesh.corners[:, None] - corners, axis=-1)
    assert away.min(1).max() < 1e-6 and away.min(0).max() < 1e-6  # as written, whatever MuJoCo makes of its frame


def test_the_smallest_experiment_runs(
    sway: str, toy: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([sway, "--help"]) == 0
    assert "--babbling-minutes" in capsys.readouterr().out
    monkeypatch.setattr(sys, "argv", [sway, "--help"])
    with pytest.raises(SystemExit) as stop:
        runpy.run_module(f"experiments.{sway}", run_name="__main__")
    assert stop.value.code == 0 and "--babbling-minutes" in capsys.readouterr().out
    assert main([sway, "--babbling-minutes", "-1"]) == 2
    assert "--babbling-minutes -1: it must be more than 0" in capsys.readouterr().err
    out = tmp_path / "out"
    assert main([sway, "--robot", str(toy), "--babbling-minutes", "0.5", "--out", str(out)]) == 0
    assert {"config.json", "metrics.json", "errors.png", "recording.rrd", "report.html"} == {
        path.name for path in out.iterdir()
    }
    assert 0 < json.loads((out / "metrics.json").read_text())["imitated_rmse_deg"] < 1


def test_a_step_by_hand_and_a_world_of_states_run(toy: Path) -> None:
    body = load_body(toy)
    angles = 0.2 * np.sin(np.arange(0, 1, body.tick_s))[:, None]
    here = globals() | {
        "mind": learn(load_body(toy, copies=8), minutes=0.5, seed=0),
        "body": body,
        "movement": Movement("a little", body.tick_s, body.sensations(angles)),
        "rng": np.random.default_rng(0),
        "world": Bench(),
        "states": Things(),
        "acts": ACTS,
        "successor": SUCCESSOR,
    }
    exec(compile(blocks("CONTRIBUTING.md", "python")[1], "CONTRIBUTING.md", "exec"), here)
    assert np.abs(body.joint_angles[0] - angles[-1]).max() < np.deg2rad(2)
    assert here["journey"].reached.all()
