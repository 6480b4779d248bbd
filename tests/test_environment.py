"""Where it runs makes no difference: no home, plain C locale, no terminal, asserts off, no place for caches."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from experiments.maze.options import Config
from experiments.maze.run import run
from experiments.shared.experiment import as_json

ROOT = Path(__file__).resolve().parents[1]
WORLDS: dict[str, dict[str, str | None]] = {
    "no home": {"HOME": None, "XDG_CACHE_HOME": None, "XDG_CONFIG_HOME": None},
    "a home that is not there": {"HOME": "/proc/nowhere", "MPLCONFIGDIR": None},
    "plain C": {"LC_ALL": "C", "LANG": "C"},
    "a dumb terminal": {"TERM": "dumb", "NO_COLOR": "1", "TZ": "Pacific/Chatham"},
    "no docstrings, no asserts": {"PYTHONOPTIMIZE": "2", "MUJOCO_GL": None},
}


def ran(code: str, world: dict[str, str | None], cwd: Path) -> subprocess.CompletedProcess[bytes]:
    env = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1", **world}
    told = {name: value for name, value in env.items() if value is not None}
    whole = f"import sys; from experiments.__main__ import main; sys.exit({code})"
    command = [sys.executable, "-c", whole]
    return subprocess.run(command, cwd=cwd, env=told, capture_output=True, timeout=120, start_new_session=True)


@pytest.mark.parametrize("world", WORLDS)
def test_list_help_and_refusals_are_the_same_everywhere(world: str, tmp_path: Path) -> None:
    done = ran("main(['list']) or main(['maze', '--help']) or main(['maze', '--goal', '10'])", WORLDS[world], tmp_path)
    assert done.returncode == 2 and done.stderr == b"imitate: --goal 10: it must lie between 1 and 9\n"
    assert done.stdout.startswith(b"Stage 1") and b"--wander" in done.stdout


def test_results_are_the_same_in_the_worst_of_worlds(tmp_path: Path) -> None:
    """All at once; and out of a folder, into one, whose names are no ASCII and have spaces."""
    worst = {name: value for world in WORLDS.values() for name, value in world.items()}
    here = tmp_path / "größe und maß"
    here.mkdir()
    done = ran("main(['maze', '--wander-steps', '300', '--out', 'ö ü'])", worst, here)
    assert done.returncode == 0, done.stderr
    assert [path.name for path in here.iterdir()] == ["ö ü"]
    assert (here / "ö ü" / "metrics.json").read_text() == as_json(run(Config(wander_steps=300)).metrics)
