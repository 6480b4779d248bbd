"""A study that was killed goes on where it stopped, with the same results."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field, is_dataclass
from pathlib import Path
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np
import pytest

from babbling.kinds import KINDS
from babbling.mind import Mind
from experiments.benchmark import strangers
from experiments.benchmark.lives import Point, Task
from experiments.benchmark.lives import live as lived
from experiments.correspondence import acts
from experiments.correspondence.run import learning_curve
from experiments.errors import ExperimentError
from experiments.face.infants import raised
from experiments.face.mirroring import compared
from experiments.face.study import answer
from experiments.face.watching import watched
from experiments.gaze import crowds
from experiments.gaze import run as gaze
from experiments.gesture.standing_study import tried as stood
from experiments.head import run as head
from experiments.head.distractor import Strays
from experiments.intentions.study import part
from experiments.intentions.study import tried as intended
from experiments.maze.changes import _worlds
from experiments.maze.options import Config as Maze
from experiments.maze.study import _curve
from experiments.notice.options import Config as Notice
from experiments.objects.study import measured
from experiments.shared.caregiver import lesson
from experiments.shared.kept import _tell, keeping, once, studying
from experiments.shared.minds import learn_mind
from experiments.shared.mirrors import look_into_mirror
from experiments.shared.one_leg import learn_to_stand
from experiments.shared.options import BodyOptions
from experiments.shared.parallel import in_parallel
from experiments.shared.rounds import look_at_hands, played
from tests.experiments.slow_study import TASKS, slowly

ROOT = Path(__file__).resolve().parents[2]
CLIPS = {"one": np.linspace(0, 1, 12).reshape(4, 3)}
DONE: list[Any] = []
"""What was really done."""


class Pair(NamedTuple):
    one: Any
    other: Any


@dataclass(frozen=True)
class Thing:
    pair: Pair
    several: dict[Any, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Stranger:
    x: int = 0


VALUES = (
    None, True, 1, -0.0, 0.1, float("inf"), "wörds\n", "", [], (), (1, [2.5, None]), {"a": {1: (2,), (3, 4): "b"}},
    np.float32(0.1), np.int8(-3), np.bool_(True), np.array(2.5), np.zeros((0, 3)), np.array(["a", "bc"]),
    np.arange(6, dtype=np.int16).reshape(2, 3).T, np.array([np.nan, -np.inf, -0.0]), np.array([True, False]),
    Thing(Pair(np.arange(3.0), (1, "x")), {"y": Pair(None, [Thing(Pair(1, 2))])}),
)  # fmt: skip


def give(value: Any, told: Any = None) -> Any:
    DONE.append(value)
    return value


def live(task: Task) -> list[Point]:
    DONE.append(task)
    return [Point(2.0 + task.seed, {"average": [0.1, 0.2]}, {"average": np.array([0.5, 0.25])}, [[0.1, 0.05]], {})]


@pytest.fixture(autouse=True)
def nothing_done() -> None:
    DONE.clear()


def same(one: Any, other: Any) -> bool:
    """To the last bit, types included."""
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray | np.generic):
        return bool(one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes())
    if isinstance(one, dict):
        return list(one) == list(other) and all(map(same, one.values(), other.values()))
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(same, one, other))
    return same(vars(one), vars(other)) if isinstance(one, Thing) else repr(one) == repr(other)


@pytest.mark.parametrize("value", VALUES, ids=lambda value: f"{type(value).__name__} {str(value)[:20]!r}")
def test_what_was_found_is_not_found_again_and_is_the_same(value: Any, tmp_path: Path) -> None:
    with keeping(tmp_path / "parts", stays=True):
        first, again = once(give, value), once(give, value)
    assert len(DONE) == 1 and same(first, value) and same(again, value), again
    once(give, value)
    assert len(DONE) == 2, "without a block nothing is kept"


def test_minds_come_back_as_files_of_theirs(arm_mind: Mind, tmp_path: Path) -> None:
    def told(mind: Mind) -> list[Any]:
        model = mind.forward_model
        return [mind.seed, mind.pilot.low, mind.temper.trust, model.moments, model.evidence, model.weights]

    with keeping(tmp_path, stays=True):
        again = [once(give, arm_mind, n) for n in (0, 0)]
        for mind in (arm_mind, again[1]):  # what is done with them is the same task
            once(give, 1, [mind, mind.pilot, mind.forward_model])
    assert len(DONE) == 2 and again[1] is not arm_mind and same(told(again[1]), told(arm_mind))


def test_what_cannot_be_told_or_kept_is_a_mistake_of_ours(tmp_path: Path) -> None:
    x = 1
    with keeping(tmp_path / "parts", stays=True):
        for wrong in (object(), {1, 2}, Stranger, print):
            with pytest.raises(TypeError):
                once(give, wrong)
        with pytest.raises(TypeError, match="cannot be told"):
            once(give, lambda: x)
    assert list(tmp_path.iterdir()) == []


def task(**other: object) -> Task:
    return Task("ideal", 0, CLIPS, ("average",), (1.0,))._replace(**other)


@pytest.mark.parametrize(
    "other",
    [
        {"seed": 1},
        {"seed": 0.0},
        {"body": "worn"},
        {"models": ("table",)},
        {"stops": (2.0,)},
        {"attempts": 2},
        {"costs": True},
        {"clips": {"one": CLIPS["one"] + 1e-12}},
        {"clips": {"one": CLIPS["one"].astype(np.float32)}},
        {"clips": {"one": CLIPS["one"].reshape(3, 4)}},
        {"clips": {"two": CLIPS["one"]}},
        {"models": ("aver", "age")},
    ],
    ids=str,
)
def test_another_task_is_another_part(tmp_path: Path, other: dict[str, object]) -> None:
    with keeping(tmp_path, stays=True):
        for one in (task(), task(**other), task(), task(**other)):
            once(live, one)
    assert len(DONE) == 2


def test_files_are_told_by_what_is_in_them_and_options_by_what_matters(tmp_path: Path) -> None:
    robot = tmp_path / "robot.xml"
    with keeping(tmp_path / "parts", stays=True):
        for content, options, count in (
            ("one", BodyOptions(robot=str(robot)), 1),
            ("one", BodyOptions(robot=str(robot), threads=7, quiet=True, out=Path("x")), 1),
            ("two", BodyOptions(robot=str(robot)), 2),
            ("two", BodyOptions(robot=str(robot), seed=1), 3),
            ("one", BodyOptions(robot=str(robot)), 3),
        ):
            robot.write_text(content)
            once(give, 1, options)
            assert len(DONE) == count


class Trap:
    def __reduce__(self) -> tuple[object, tuple[str]]:
        return os.mkdir, ("sprung",)


def spoilt(path: Path) -> dict[str, Callable[[], object]]:
    whole, named = path.read_bytes(), {"arr_0": np.frombuffer(b'["array", 7]', np.uint8)}
    return {
        "empty": lambda: path.write_bytes(b""),
        "cut": lambda: path.write_bytes(whole[:-30]),
        "one bit": lambda: path.write_bytes(whole.replace(b"average", b"averagf", 1)),
        "text": lambda: path.write_text("[1]"),
        "no such array": lambda: np.savez(path, **named),
        "deep": lambda: np.savez(path, arr_0=np.frombuffer(b"[" * 100_000, np.uint8)),
        "stranger": lambda: np.savez(path, arr_0=np.frombuffer(b'["class", "os.system", "true"]', np.uint8)),
        "pickle": lambda: np.savez(path, arr_0=np.array([Trap()], object)),
        "other names": lambda: np.savez(path, x=np.zeros(3)),
        "a folder": lambda: (path.unlink(), path.mkdir(), (path / "x").write_text("")),
    }


@pytest.mark.parametrize("case", list(spoilt(Path(__file__))))
def test_a_spoilt_part_is_done_again_and_said(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with keeping(tmp_path, stays=True):
        once(live, task())
        [path] = tmp_path.iterdir()
        spoilt(path)[case]()
        if case == "a folder":
            with pytest.raises(ExperimentError, match="cannot be kept there"):
                once(live, task())
        else:
            assert once(live, task())[0].minutes == 2.0 and len(DONE) == 2
            once(live, task())
            assert len(DONE) == 2, "it was mended"
    said = capsys.readouterr().err
    assert str(path) in said and "is done again" in said and said.count("\n") == 1
    assert not Path("sprung").exists() and [p.name for p in tmp_path.iterdir()] == [path.name]


def test_a_folder_that_cannot_be_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with keeping(tmp_path / "file"), pytest.raises(ExperimentError, match=r"file: .* cannot be kept there") as caught:
        once(give, 1)
    assert "\n" not in str(caught.value) and (tmp_path / "file").read_text() == ""


def test_parts_go_when_the_block_ends_well_and_nothing_of_others(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with pytest.raises(KeyboardInterrupt), studying(Notice(), out):
        once(give, 1)
        raise KeyboardInterrupt
    assert len(list((tmp_path / "out.partial").iterdir())) == 1
    with studying(Notice(), out):
        once(give, 1)
    assert len(DONE) == 1 and list(tmp_path.iterdir()) == []
    (tmp_path / "out.partial").mkdir()
    (tmp_path / "out.partial" / "thesis.txt").write_text("years of work")
    with studying(Notice(), out):
        once(give, 2)
    assert [p.name for p in (tmp_path / "out.partial").iterdir()] == ["thesis.txt"]


def test_only_studies_keep(tmp_path: Path) -> None:
    for config, count in ((Maze(), 0), (Maze(study=True), 1)):
        with studying(config, tmp_path / "out"):
            once(give, 1)
            assert len(list(tmp_path.glob("out.partial/*"))) == count


WORKS = (
    raised, watched, answer, compared, measured, intended, part, stood, lived, strangers.live, played, learn_mind,
    look_into_mirror, look_at_hands, learn_to_stand, lesson, learning_curve, head._watch, head._perform, head._babbled,
    gaze._eyes, gaze._met, crowds._meets, acts._answers, _curve, _worlds,
)  # fmt: skip
"""Everything that studies do once."""


@pytest.mark.parametrize("work", WORKS, ids=lambda work: f"{work.__module__}.{work.__name__}")
def test_what_studies_find_can_be_kept(work: Callable[..., Any]) -> None:
    """By its annotations, all the way down."""
    todo, met = [get_type_hints(work, include_extras=True)["return"]], set[str]()
    while todo:
        hint = todo.pop()
        if str(hint) in met:
            continue
        met.add(str(hint))
        if any(kind.holds is hint for kind in KINDS.values()) or hint in (Any, ..., None, type(None)):
            continue
        if get_origin(hint) is np.ndarray or (isinstance(hint, type) and issubclass(hint, bool | int | float | str)):
            continue
        if is_dataclass(hint) or hasattr(hint, "_fields"):
            todo += get_type_hints(hint, include_extras=True).values()
        elif get_origin(hint) is Annotated:
            todo.append(hint.__origin__)
        else:
            assert hint is not Strays and get_args(hint), hint
            todo += [one for one in get_args(hint) if one is not Strays]  # of whom nothing is kept


# --- processes that are killed ---------------------------------------------------------------------------------------


def test_killed_and_repeated_it_ends_with_the_same_and_does_little_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = [sys.executable, "-m", "tests.experiments.slow_study"]
    how: Any = {"cwd": tmp_path, "env": {**os.environ, "PYTHONPATH": str(ROOT)}, "start_new_session": True}
    running, until = subprocess.Popen(asked, **how), time.monotonic() + 100
    while len(list(tmp_path.glob("parts/*.npz"))) < 2 and running.poll() is None and time.monotonic() < until:
        time.sleep(0.01)
    os.killpg(running.pid, signal.SIGKILL)
    running.wait()
    kept_then, begun = len(list(tmp_path.glob("parts/*.npz"))), (tmp_path / "done.txt").read_text().split()
    assert 2 <= kept_then <= TASKS and not (tmp_path / "found.txt").exists()
    subprocess.run(asked, check=True, timeout=120, **how)
    again = (tmp_path / "done.txt").read_text().split()[len(begun) :]
    assert len(again) == TASKS - kept_then and not (tmp_path / "parts").exists()
    monkeypatch.chdir(tmp_path)
    assert (tmp_path / "found.txt").read_text() == repr([slowly(number) for number in range(TASKS)])


def test_a_part_says_what_its_work_says(tmp_path: Path) -> None:
    with keeping(tmp_path, stays=True):
        assert in_parallel(give, [1, 2, 3], 1, "x") == [1, 2, 3]
        assert in_parallel(give, [3, 2, 4], 1, "x") == [3, 2, 4]
    assert DONE == [1, 2, 3, 4]


def test_a_part_is_another_when_what_its_robot_names_is_another(tmp_path: Path) -> None:
    """Included files and meshes count; a file that is called like a word does not."""

    def told(*task: object) -> bytes:
        said = bytearray()
        _tell(said.extend, task)
        return bytes(said)

    (tmp_path / "inner.xml").write_text("<mujocoinclude/>")
    (robot := tmp_path / "r.xml").write_text('<mujoco><include file="inner.xml"/></mujoco>')
    before = told(str(robot), "map")
    (tmp_path / "inner.xml").write_text("<mujocoinclude> </mujocoinclude>")
    assert told(str(robot), "map") != before
    with contextlib.chdir(tmp_path):
        as_word = told("map")
        Path("map").touch()
        assert told("map") == as_word


def test_what_comes_back_at_once_is_what_comes_back_later(tmp_path: Path) -> None:
    """To the order of an array's numbers in memory, on which the last bits of a mean depend."""
    with keeping(tmp_path / "parts", stays=True):
        first, again = once(swapped), once(swapped)
    assert first.strides == again.strides and first.mean((0, 1)).tobytes() == again.mean((0, 1)).tobytes()


def swapped() -> np.ndarray:
    return np.random.default_rng(0).random((40, 30, 20)).swapaxes(0, 2)
