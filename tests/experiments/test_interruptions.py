"""Told to stop at any moment, or with nobody to talk to: a line at most, no traceback, nothing left, no orphans."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUSY = """
import os, sys, time, weakref
from multiprocessing import active_children
from pathlib import Path
from babbling.whole import whole
from experiments import command_line
from experiments.stopping import work
how, out = sys.argv[1], Path(sys.argv[2])

class Lost:
    "It is told to stop where no exception comes out."
    def __del__(self):
        ready()
        time.sleep(60)

def ready():
    print("ready", *(child.pid for child in active_children()), flush=True)

def obey(words):
    if how == "loads":
        ready()
        time.sleep(60)
    work()
    with whole(out / "deep" / "result") as new:
        new.write_text("half")
        if how == "lost":
            Lost()
        if how in ("workers", "cluster"):
            from threading import Thread
            from experiments.shared.parallel import in_parallel
            def begun():
                while len(active_children()) < 2:
                    time.sleep(0.01)
                time.sleep(0.15)  # they are loading
                ready()
            Thread(target=begun, daemon=True).start()
            in_parallel(time.sleep, [60, 60, 60, 60], 2, "sleeping", "local" if how == "cluster" else None)
        ready()
        time.sleep(60)
    return 0

command_line.obey = obey
from experiments.__main__ import main
if __name__ == "__main__":
    sys.exit(main())
"""


def begun(how: str, out: Path) -> tuple["subprocess.Popen[str]", list[int]]:
    """A process of a group of its own that is busy so, and its workers."""
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    pipe = subprocess.PIPE
    process = subprocess.Popen(
        [sys.executable, "-c", BUSY, how, str(out)], env=env, stdout=pipe, stderr=pipe, text=True,
        start_new_session=True,
    )  # fmt: skip
    assert process.stdout is not None
    return process, [int(word) for word in process.stdout.readline().split()[1:]]


def gone(pids: Sequence[int]) -> bool:
    """Whether these processes end, within reason."""
    limit = time.monotonic() + 60
    while time.monotonic() < limit:
        if not any(Path(f"/proc/{pid}").exists() for pid in pids):
            return True
        time.sleep(0.05)
    return False


@pytest.mark.parametrize(
    ("how", "number", "group"),
    [
        ("works", signal.SIGTERM, False),
        ("works", signal.SIGHUP, False),
        ("works", signal.SIGINT, False),
        ("loads", signal.SIGINT, False),
        ("lost", signal.SIGINT, False),
        ("workers", signal.SIGINT, True),  # as a terminal does
        ("workers", signal.SIGTERM, False),
        ("cluster", signal.SIGINT, True),
        ("cluster", signal.SIGTERM, False),
    ],
)
def test_told_to_stop_it_does_so_in_a_line_and_leaves_nothing(
    tmp_path: Path, how: str, number: signal.Signals, group: bool
) -> None:
    if how == "cluster":
        pytest.importorskip("distributed", reason="distributed is not installed: extra `cluster`")
    process, workers = begun(how, tmp_path)
    assert len(workers) == (2 if how in ("workers", "cluster") else 0)
    (os.killpg if group else os.kill)(process.pid, number)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == 128 + number
    assert said.startswith("imitate: interrupted; ") and said.count("\n") == 1
    assert os.listdir(tmp_path) == [] and gone(workers)


@pytest.mark.parametrize("how", ["workers", "cluster"])
def test_who_is_killed_leaves_no_orphans(tmp_path: Path, how: str) -> None:
    if how == "cluster":
        pytest.importorskip("distributed", reason="distributed is not installed: extra `cluster`")
    process, workers = begun(how, tmp_path)
    process.kill()
    assert len(workers) == 2 and gone(workers)
    process.communicate(timeout=60)


def test_many_signals_are_one(tmp_path: Path) -> None:
    process, _ = begun("works", tmp_path)
    for _ in range(20):
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            time.sleep(0.005)
    said = process.communicate(timeout=60)[1]
    assert process.returncode == 130 and said.count("\n") == 1 and os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("words", "shell", "status", "line"),
    [
        ("list", "> /dev/full", 2, "imitate: standard output, or a file: cannot be written (No space left on device)"),
        (
            "gesture --help",
            "> /dev/full",
            2,
            "imitate: standard output, or a file: cannot be written (No space left on device)",
        ),
        ("gesture --help", "| true", 141, ""),
        ("list", ">&-", 0, ""),
        ("nonsense", "2>&-", 2, ""),
        ("nonsense", "2> /dev/full", 2, ""),
        ("--completion zsh", "> /dev/null", 0, ""),
    ],
)
def test_with_nobody_to_talk_to(words: str, shell: str, status: int, line: str) -> None:
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    told = f"sleep_until=1; {sys.executable} -m experiments {words} {shell}; echo ${{PIPESTATUS[0]}} >&3"
    read, write = os.pipe()
    with os.fdopen(read) as statuses:
        done = subprocess.run(
            ["bash", "-c", f"exec 3>&{write}; {told}"], env=env, cwd=ROOT, stderr=subprocess.PIPE, text=True,
            stdout=subprocess.DEVNULL, pass_fds=[write], timeout=120,
        )  # fmt: skip
        os.close(write)
        assert int(statuses.read()) == status
    assert done.stderr.startswith(line) and done.stderr.count("\n") == bool(line)


def test_letters_that_standard_output_does_not_have_are_question_marks() -> None:
    env = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "ascii"}
    code = """
from experiments import command_line
from experiments.shared.tables import show
command_line.obey = lambda words: show("| 90° | µ |\\n| --- | --- |\\n| é | 2² |") or 0
import sys
from experiments.__main__ import main
sys.exit(main())
"""
    done = subprocess.run([sys.executable, "-c", code], env=env, cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "") and "90?" in done.stdout


def test_graphics_are_only_looked_for_where_something_is_rendered(tmp_path: Path) -> None:
    """A library that is not there; each word of it would be a traceback."""
    env = {**os.environ, "PYTHONPATH": str(ROOT), "MUJOCO_GL": "glfw-of-nowhere"}
    code = """
import sys
from experiments import command_line
from experiments.registry import entry
from experiments.saccades.options import Config
from experiments.stopping import say
try:
    command_line.load(entry("saccades"), Config(renderer=sys.argv[1]))
except Exception as error:
    say(str(error))
"""
    for renderer, begins in (("rays", ""), ("mujoco", "imitate: --renderer mujoco: MUJOCO_GL=glfw-of-nowhere cannot")):
        command = [sys.executable, "-c", code, renderer]
        done = subprocess.run(command, env=env, cwd=ROOT, capture_output=True, text=True)
        assert done.returncode == 0 and done.stderr.startswith(begins) and done.stderr.count("\n") == bool(begins)
