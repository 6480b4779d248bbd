"""A benchmark that was interrupted goes on where it stopped."""

from pathlib import Path

import numpy as np
import pytest

from experiments.benchmark import kept
from experiments.benchmark.kept import lived
from experiments.benchmark.lives import Config, Point, Task
from experiments.errors import ExperimentError

CLIPS = {"one": np.linspace(0, 1, 12).reshape(4, 3)}


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> list[Task]:
    """Tasks that were really lived."""
    done: list[Task] = []

    def live(task: Task) -> list[Point]:
        done.append(task)
        return [Point(2.0 + task.seed, {"average": [0.1, 0.2]}, {"average": np.array([0.5, 0.25])}, [[0.1, 0.05]], {})]

    monkeypatch.setattr(kept, "live", live)
    return done


def task(**other: object) -> Task:
    return Task(Config(), "ideal", 0, CLIPS, ("average",), (1.0,))._replace(**other)


def test_what_was_lived_is_not_lived_again_and_is_the_same(counted: list[Task], tmp_path: Path) -> None:
    first, again = lived(task(), tmp_path / "lives"), lived(task(), tmp_path / "lives")
    assert len(counted) == 1 and len(list((tmp_path / "lives").iterdir())) == 1
    np.testing.assert_array_equal(first[0].ringing["average"], again[0].ringing["average"])
    for name in ("minutes", "errors", "last", "costs"):
        assert getattr(first[0], name) == getattr(again[0], name)
    lived(task())
    assert len(counted) == 2, "without a folder nothing is kept"


@pytest.mark.parametrize(
    "other",
    [
        {"seed": 1},
        {"body": "worn"},
        {"models": ("table",)},
        {"stops": (2.0,)},
        {"attempts": 2},
        {"costs": True},
        {"clips": {"one": CLIPS["one"] + 1e-12}},
        {"clips": {"two": CLIPS["one"]}},
    ],
)
def test_another_task_is_another_life(counted: list[Task], tmp_path: Path, other: dict[str, object]) -> None:
    lived(task(), tmp_path)
    lived(task(**other), tmp_path)
    assert len(counted) == 2


@pytest.mark.parametrize("content", ["", "[]", "{}", "[1]", '[{"minutes": 1}]', "[" * 10_000, "null", "\0"])
def test_a_file_that_is_no_life_is_refused_in_one_line(counted: list[Task], tmp_path: Path, content: str) -> None:
    lived(task(), tmp_path)
    [path] = tmp_path.iterdir()
    path.write_text(content)
    with pytest.raises(ExperimentError, match="this is no life of a benchmark; remove it") as refused:
        lived(task(), tmp_path)
    assert "\n" not in str(refused.value)


def test_a_folder_that_cannot_be_is_refused(counted: list[Task], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ExperimentError, match=r"--keep .* cannot be written"):
        lived(task(), tmp_path / "file")
