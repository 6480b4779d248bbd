"""What is published appears whole or not at all: killed at any moment, on a full disk, in another's way."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from babbling.whole import folder_beside, sweep, whole
from experiments.errors import ExperimentError
from experiments.shared.experiment import Result, check_out, publish
from experiments.shared.options import Options

ROOT = Path(__file__).resolve().parents[2]
DIES = """
import os, shutil, signal, sys
from pathlib import Path
from babbling import whole
out, exchanges, where = Path(sys.argv[1]), sys.argv[2] == "exchanges", sys.argv[3]
real, count = {"rename": os.rename, "rmtree": shutil.rmtree}, {"rename": 0, "rmtree": 0}
def dying(name):
    def call(*args, **how):
        count[name] += 1
        if where == f"{name} {count[name]}":
            os.kill(os.getpid(), signal.SIGKILL)
        return real[name](*args, **how)
    return call
os.rename, shutil.rmtree = dying("rename"), dying("rmtree")
if not exchanges:
    whole._exchanged = lambda one, other: False
with whole.whole(out) as new:
    new.mkdir()
    for name in "ab":
        (new / name).write_text("new")
print("alive")
"""


def child(code: str, *words: str) -> subprocess.CompletedProcess[str]:
    env = {**os.environ, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'tests'}"}
    return subprocess.run([sys.executable, "-c", code, *words], cwd=ROOT, env=env, capture_output=True, text=True)


def held(out: Path) -> set[str]:
    return {path.read_text() for path in out.iterdir()}


@pytest.mark.parametrize(
    ("exchanges", "where", "hidden", "then"),
    [
        (True, "rename 1", False, "old"),
        (True, "rmtree 1", False, "new"),
        (False, "rename 2", False, "old"),
        (False, "rename 3", True, "old"),
        (False, "rmtree 1", False, "new"),
    ],
)
def test_a_name_holds_a_whole_result_wherever_its_writer_is_killed(
    tmp_path: Path, exchanges: bool, where: str, hidden: bool, then: str
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    for name in "ab":
        (out / name).write_text("old")
    if exchanges and not sys.platform.startswith("linux"):
        pytest.skip("names cannot be exchanged here")
    done = child(DIES, str(out), "exchanges" if exchanges else "renames", where)
    assert done.returncode == -signal.SIGKILL and "alive" not in done.stdout
    assert out.exists() != hidden
    assert sweep(out) == hidden
    assert sorted(path.name for path in out.iterdir()) == ["a", "b"] and held(out) == {then}
    assert os.listdir(tmp_path) == ["out"]


def test_the_next_run_says_that_an_older_result_is_back(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    publish("maze", Options(out=out), Result({"told": 1}, ""))
    before = (out / "metrics.json").read_bytes()
    assert child(DIES, str(out), "renames", "rename 3").returncode == -signal.SIGKILL
    assert not out.exists()
    check_out(out)
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "the older result is back" in said
    assert (out / "metrics.json").read_bytes() == before and os.listdir(tmp_path) == ["out"]


def test_what_the_living_hold_and_what_strangers_left_is_not_swept(tmp_path: Path) -> None:
    out = tmp_path / "out"
    strange = tmp_path / ".out.imitate-pictures"
    strange.mkdir()
    (strange / "mine.png").write_text("mine")
    with whole(out) as new:
        assert not sweep(out)
        new.write_text("whole")
    assert out.read_text() == "whole"
    assert sorted(os.listdir(tmp_path)) == [".out.imitate-pictures", "out"] and (strange / "mine.png").exists()


def test_one_that_fails_leaves_nothing_not_even_the_folders_above(tmp_path: Path) -> None:
    with pytest.raises(KeyError), whole(tmp_path / "deep" / "down" / "file") as new:
        new.write_text("half")
        raise KeyError
    assert os.listdir(tmp_path) == []
    (tmp_path / "mine").write_text("mine")
    with pytest.raises(FileExistsError), whole(tmp_path / "mine", over=False) as new:
        new.write_text("other")
    assert (tmp_path / "mine").read_text() == "mine" and os.listdir(tmp_path) == ["mine"]
    with folder_beside(tmp_path / "x") as folder:
        assert os.listdir(folder) == []
    assert os.listdir(tmp_path) == ["mine"]


FILLS = """
import json, os, resource, sys
from pathlib import Path
import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from matplotlib.figure import Figure
from babbling.errors import BabblingError
from experiments.shared.experiment import Result, publish
from experiments.shared.options import Options
from experiments.shared.recording import recording
from experiments.shared.trajectories import labelled, left
noise = np.random.default_rng(0).random
def record(path, count=20_000):
    with recording(path, "full", "disk", rrb.Vertical(), "") as stream:
        for entity in "abc":
            index = [rr.TimeColumn("step", sequence=np.arange(count))]
            stream.send_columns(entity, index, rr.Scalars.columns(scalars=noise(count)))
figure = Figure()
figure.subplots().imshow(noise((200, 200)))
tracks = {"angle": (("attempt", "time", "joint"), noise((1, 20_000, 1)), "degree", "noise")}
table = left(labelled(("hip",), ("degree",), 0.02, tracks), csv=True)
results = {
    "recording": Result({}, "", record=record),
    "figure": Result({}, "", {"noise": figure}),
    "arrays": Result({}, "", files={"t.nc": table["trajectories.nc"]}),
    "table": Result({}, "", files={"t.csv": table["trajectories.csv"]}),
    "numbers": Result({"many": [0.123456] * 20_000}, ""),
}
out, most, said = Path(sys.argv[1]), [int(word) for word in sys.argv[2:]], {}
for what, result in results.items():
    for bytes in most:
        resource.setrlimit(resource.RLIMIT_FSIZE, (bytes, resource.RLIM_INFINITY))
        try:
            publish("maze", Options(out=out), result)
            said[f"{what} {bytes}"] = "published"
        except BabblingError as error:
            said[f"{what} {bytes}"] = str(error)
print(json.dumps(said))
"""


def test_a_full_disk_is_a_line_and_the_older_result_stays_whole(tmp_path: Path) -> None:
    """Whoever writes: Rerun, Matplotlib, HDF5, pandas, Python; early, and at the very end of a recording."""
    out = tmp_path / "out"
    publish("maze", Options(out=out), Result({"told": 1}, ""))
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    size = {path.name: path.stat().st_size for path in out.iterdir()}
    assert max(size.values()) < 4096
    done = child(FILLS, str(out), "8192", "65536")
    assert done.returncode == 0 and done.stderr == ""
    said = json.loads(done.stdout)
    assert len(said) == 10
    for line in said.values():
        assert line.startswith(f"--out {out}: cannot be written (") and "\n" not in line and len(line) < 400
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before and os.listdir(tmp_path) == ["out"]


def test_a_name_that_is_no_text_is_refused_before_any_work(tmp_path: Path) -> None:
    with pytest.raises(ExperimentError, match="this name is not text in this locale"):
        check_out(tmp_path / "caf\udce9")
    check_out(tmp_path / "café and more")
    assert os.listdir(tmp_path) == []
