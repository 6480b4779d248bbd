"""Shared fixtures: where outside data stands, when it does."""

import experiments  # isort: skip  # before NumPy loads: one thread for linear algebra
import io
import os
import signal
import tempfile
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import numpy as np
import pytest
import rerun as rr
from matplotlib.figure import Figure

import babbling.loop
import experiments.shared.minds
import imitation.acting.movement
import models.apart
from babbling.mind import Mind, learn
from experiments.stopping import STOPS
from imitation.acting import rehearsal
from models.errors import BodyError, Told
from models.loading import load_body
from tests.figures import faults
from tests.recordings import empty_views

os.environ.setdefault("MUJOCO_GL", "disabled")

CMU = Path(__file__).resolve().parents[2] / "shared" / "data" / "cmu"


LONGEST_FIRST = (
    *("babble", "battery", "conformance", "play_and_objects", "gesture", "standing", "intentions", "correspondence"),
    *("notebook", "interruptions", "pages", "shards", "told", "environment"),
)
"""Files of tests that take long: begun first, so that no process waits for them at the end."""


def pytest_configure(config: pytest.Config) -> None:
    """The filter is here, not in pyproject.toml: there it would load NumPy before it is told to take one thread."""
    config.addinivalue_line("filterwarnings", "error::numpy.exceptions.VisibleDeprecationWarning")
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # begun in the background; tests press Ctrl-C
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: item.path.stem.removeprefix("test_") not in LONGEST_FIRST)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Of the fuzz suite."""
    parser.addoption(
        "--fuzz", type=float, metavar="SECONDS", help="tests/fuzz: go on so long, instead of a short while"
    )
    parser.addoption("--fuzz-seed", default="0", metavar="N", help="tests/fuzz: other cases")


@pytest.fixture
def cmu() -> Path:
    """Folder of real CMU motion capture files beside the project; tests that need it skip without it."""
    if not CMU.is_dir():
        pytest.skip("CMU motion capture files are not beside the project")
    return CMU


apart = models.apart.apart
"""The real one: a process for each file."""


@pytest.fixture(autouse=True, scope="session")
def tried_here() -> Iterator[None]:
    """What strangers' files are tried with is done in the process of the tests: quicker, and as strict."""

    @cache
    def here(work: str, path: str, seconds: int, version: tuple[int, ...]) -> None:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv(models.apart.INSIDE, "1")
            try:
                resolve_name(work)(Path(path))
            except Told as error:
                raise BodyError(str(error)) from None

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(models.apart, "apart", here)
        yield


ARM = """
<mujoco model="arm">
  <compiler angle="radian" autolimits="true"/>
  <option timestep="0.005" integrator="implicitfast"/>
  <default>
    <joint damping="0.05" armature="0.01" frictionloss="0.002"/>
    <position kp="20" kv="1" inheritrange="1"/>
  </default>
  <worldbody>
    <body name="upper" pos="0 0 1">
      <joint name="shoulder" axis="0 1 0" range="-1.5 1.0"/>
      <geom name="upper" type="capsule" fromto="0 0 0 0 0 -0.3" size="0.03" mass="0.4"/>
      <body name="fore" pos="0 0 -0.3">
        <joint name="elbow" axis="0 1 0" range="-0.4 2.0"/>
        <geom name="fore" type="capsule" fromto="0 0 0 0 0 -0.25" size="0.025" mass="0.2"/>
        <body name="hand" pos="0 0 -0.25">
          <joint name="wrist" axis="1 0 0" range="-1 1"/>
          <geom name="hand" type="box" pos="0 0 -0.05" size="0.02 0.03 0.05" mass="0.05"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="shoulder" joint="shoulder"/>
    <position name="elbow" joint="elbow"/>
    <position name="wrist" joint="wrist"/>
  </actuator>
</mujoco>
"""


@pytest.fixture(autouse=True)
def as_it_was() -> Iterator[None]:
    """Who runs the command line in this process leaves it deaf, and with it what it begins; others go elsewhere."""
    before, here = {number: signal.getsignal(number) for number in (*STOPS, signal.SIGALRM)}, Path.cwd()
    yield
    os.chdir(here)
    for number, heard in before.items():
        signal.signal(number, heard)


@pytest.fixture(scope="session", autouse=True)
def every_view_shows_something() -> Iterator[None]:
    """Whatever is recorded in any test: no panel of its blueprint is empty."""
    drain = rr.MemoryRecording.drain_as_bytes

    def drained(held: rr.MemoryRecording) -> bytes:
        content = drain(held)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "it.rrd").write_bytes(content)
            assert not (empty := empty_views(Path(folder) / "it.rrd")), f"nothing is seen in {empty}"
        return content

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rr.MemoryRecording, "drain_as_bytes", drained)
        yield


@pytest.fixture(scope="session", autouse=True)
def every_figure_says_what_it_shows() -> Iterator[None]:
    """Whatever figure is drawn for a result in any test: a caption, axes with names, nothing over the data."""
    save = Figure.savefig

    def saved(figure: Figure, place: Any, **how: Any) -> None:
        save(figure, place, **how)
        assert not isinstance(place, io.BytesIO) or not (found := faults(figure)), found

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "savefig", saved)
        yield


@pytest.fixture(scope="session")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A robot of three joints, as a user brings it."""
    path = tmp_path_factory.mktemp("robot") / "arm.xml"
    path.write_text(ARM)
    return path


@pytest.fixture(scope="session")
def wave(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two seconds of movement for `arm`, as a user brings it."""
    t = np.arange(0, 2, 0.02)
    angles = np.stack([-0.3 + 0.5 * np.sin(2 * t), 0.8 + 0.6 * np.sin(3 * t + 1), 0.4 * np.sin(4 * t)], 1)
    path = tmp_path_factory.mktemp("movement") / "wave.csv"
    rows = [",".join(map(repr, (moment, *row))) for moment, row in zip(t.tolist(), angles.tolist(), strict=True)]
    path.write_text("\n".join(["time,shoulder,elbow,wrist", *rows]) + "\n")
    return path


@pytest.fixture(scope="session")
def arm_mind(arm: Path) -> Mind:
    """What one minute of babbling teaches of `arm`."""
    return learn(load_body(arm, copies=16), minutes=1, seed=0)


@pytest.fixture(scope="module")
def hasty(arm_mind: Mind) -> Iterator[None]:
    """Babble with few copies in short bouts, rehearse for a moment, draw coarsely; `arm_mind` is as ever."""
    with pytest.MonkeyPatch.context() as patch:
        hurry(patch.setattr)
        yield


def hurry(replace: Callable[[Any, str, Any], None]) -> None:
    """What takes long only to be good for a robot of 25 joints, made short."""
    replace(experiments.shared.minds, "COPIES", 8)
    replace(experiments.shared.minds, "BARE_TICKS", 10)
    replace(experiments.shared.minds, "EVERY_S", 0.0)
    replace(experiments.shared.minds, "SPARING", 0.0)
    replace(babbling.loop.bouts, "__defaults__", (150,))
    replace(imitation.acting.movement, "APPROACH_S", 0.5)
    for one in (rehearsal.made_up_movement, rehearsal.felt_errors, rehearsal.best_eagerness):
        replace(one, "__defaults__", (0.5,))
    replace(rehearsal.rehearse, "__defaults__", (*rehearsal.rehearse.__defaults__[:-1], 0.5))
    usual = experiments.shared.minds.learn_mind.__kwdefaults__
    replace(experiments.shared.minds.learn_mind, "__kwdefaults__", {**usual, "rehearsal_s": 0.5})
    save = Figure.savefig
    replace(Figure, "savefig", lambda figure, path, **_: save(figure, path, dpi=20))
