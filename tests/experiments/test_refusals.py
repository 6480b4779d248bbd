"""Everything on the command line is checked before the first second of work: every option of every experiment."""

import os
from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest

from babbling.errors import BabblingError
from babbling.files import save
from babbling.mind import Mind
from experiments.__main__ import main
from experiments.benchmark import strangers
from experiments.registry import EXPERIMENTS, entry
from experiments.shared.options import LARGEST_SEED, MOST_NAMES, file
from models.body import SimulatedBody
from models.errors import BodyError
from models.maze import MazeBody
from models.seeing_body import SeeingBody

HOSTILE = {
    float: (float("nan"), float("inf"), -float("inf"), 1e308, -1e308),
    int: (10**30, -(10**30), 10**400, -1_000_000),
}
FREE = {"objects", "out", "keep", "runs"}
"""Texts that are judged where their world is known, before anything moves; and places, which are tried."""


def inner(kind: Any) -> Iterator[Any]:
    """A type and all types in it."""
    yield kind
    for one in () if get_origin(kind) is Literal else get_args(kind):
        yield from inner(one)


def options_of(*kinds: type) -> list[tuple[str, str]]:
    """(experiment, option) whose value is, or holds, one of these."""
    found = []
    for name in EXPERIMENTS:
        hints = get_type_hints(entry(name).options(), include_extras=True)
        found += [(name, option) for option, kind in hints.items() if any(one in kinds for one in inner(kind))]
    return found


def checked(name: str, option: str, value: Any) -> str:
    """The one line by which this value is refused, by the options alone."""
    config = entry(name).options()()
    listed = any(get_origin(one) is tuple for one in inner(get_type_hints(type(config), include_extras=True)[option]))
    with pytest.raises((BabblingError, BodyError)) as caught:
        replace(config, **{option: (value,) if listed else value}).check()
    said = " ".join(str(caught.value).split())
    assert len(said.replace(str(value)[:1000], "")) < 400
    return said


@pytest.mark.parametrize(("name", "option"), options_of(float))
def test_numbers_that_are_none_or_beyond_all_bounds_are_refused(name: str, option: str) -> None:
    for value in HOSTILE[float]:
        assert f"--{option.replace('_', '-')} {value:g}: " in checked(name, option, value)


@pytest.mark.parametrize(("name", "option"), options_of(int))
def test_whole_numbers_beyond_all_bounds_are_refused(name: str, option: str) -> None:
    for value in HOSTILE[int]:
        assert f"--{option.replace('_', '-')} {str(value)[:24]}" in checked(name, option, value)


def files_of() -> list[tuple[str, str]]:
    found = []
    for name in EXPERIMENTS:
        hints = get_type_hints(entry(name).options(), include_extras=True)
        found += [(n, o) for n, o in options_of(Path) if n == name and file in metadata(hints[o])]
    return found


def metadata(kind: Any) -> list[Any]:
    return [rule for one in inner(kind) for rule in getattr(one, "__metadata__", ())]


@pytest.mark.parametrize(("name", "option"), files_of())
def test_files_that_are_none_are_refused(name: str, option: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "empty").touch()
    for place in ("nowhere", ".", "pipe", "empty", "x" * 300, "nul\0"):
        checked(name, option, tmp_path / place)
    for place in ("/dev/zero", "/proc/self/mem"):
        checked(name, option, Path(place))


@pytest.mark.parametrize(("name", "option"), options_of(str))
def test_names_that_are_none_are_refused(name: str, option: str, tmp_path: Path) -> None:
    if option in FREE or (name, option) in LATER:
        pytest.skip("judged where its world is known: below")
    for value in ("no such thing", str(tmp_path / "nowhere.xml"), "\n", "-"):
        checked(name, option, value)


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_lists_have_an_end(name: str) -> None:
    config = entry(name).options()()
    studied = {"study": True} if name in ("objects", "intentions") else {}
    for one in fields(config):
        value = getattr(config, one.name)
        if isinstance(value, tuple):
            with pytest.raises(BabblingError, match=f"--{one.name}: {MOST_NAMES + 1} are named"):
                replace(config, **studied, **{one.name: ("x",) * (MOST_NAMES + 1)}).check()


def test_honest_numbers_are_taken() -> None:
    for name in EXPERIMENTS:
        config = entry(name).options()()
        replace(config, seed=20261231).check()
        replace(config, seed=LARGEST_SEED).check()


def test_strangers_obey_the_same_rules() -> None:
    for wrong in ({"robots": ("nobody",)}, {"minutes": (float("nan"),)}, {"seeds": 0}, {"workers": 10**9}):
        with pytest.raises(BabblingError):
            strangers.main(replace(strangers.Config(), **wrong))


# --- what only a run can judge: it does before anything moves --------------------------------------------------------

LATER: dict[tuple[str, str], str] = {
    ("intentions", "object"): "toaster",
    ("intentions", "wants"): "peace=nan",
    ("maze", "goal_prior"): "nan,nan,nan",
    ("play", "things"): "toaster",
}
WORDS = [
    ["gaze", "--objects", "nan,0;0.5,0.2"],
    ["gaze", "--objects", "1e308,0;0.5,0.2"],
    ["gaze", "--objects", ""],
    ["gaze", "--objects", "0.5,0.2;0.5,-0.2", "--target", "3"],
    ["maze", "--goal", "4"],
    ["maze", "--goal-prior", "nan,0.5,0.5"],
    ["maze", "--goal-prior", "1,1e309,0"],
    ["maze", "--goal-prior", ","],
    ["intentions", "--wants", "apart=nan"],
    ["intentions", "--wants", "apart=-1"],
    ["intentions", "--child", "20"],
    ["intentions", "--study"],
    ["face", "--study", "--memory", "{text}"],
    ["face", "--adult", "{xml}"],
    ["face", "--face", "{xml}"],
    ["gesture", "--stand", "--study", "--clips", "icub-wave", "{text}.amc"],
    ["gesture", "--stand", "--robot", "biclops"],
    ["gesture", "--push", "nan,1,1,1"],
    ["gesture", "--motion", "{text}"],
    ["notice", "--demonstrations", "icub-wave", "{text}.amc"],
    ["benchmark", "--bodies", "ideal", "biclops"],
    ["benchmark", "--bodies", "ideal", "{xml}"],
    ["benchmark", "--clips", "icub-wave", "{text}.csv"],
    ["correspondence", "--demonstrations", "icub-wave", "{text}.bvh"],
    ["correspondence", "--shown", "nobody"],
    ["saccades", "--renderer", "crayons"],
    ["compare", "{here}", "{here}"],
    ["compare", "nowhere", "nowhere-else"],
    ["robot", "hoap2", "--template", "{text}"],
    ["fit"],
    ["fit", "nowhere"],
    ["fit", "{text}"],
    ["fit", "{text}.parquet"],
]
BESIDE = {"balance": ["--stand"], "clips": ["--stand", "--study"], "plays": ["--study"], "motion": ["--demonstration",
          "{text}.urdf"], "memory": []}  # fmt: skip


@pytest.fixture
def refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Runs `imitate` in an empty folder where no physics may be stepped but a teacher's kinematics."""
    here = tmp_path / "here"
    here.mkdir()
    for suffix in ("", ".amc", ".csv", ".bvh", ".urdf", ".parquet"):
        (tmp_path / f"text{suffix}").write_text("no such thing\n")
    (tmp_path / "robot.xml").write_text("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    monkeypatch.chdir(here)
    names = {"text": tmp_path / "text", "xml": tmp_path / "robot.xml", "here": here}

    def never(*_: object, **__: object) -> None:
        raise AssertionError("something moved before the options were checked")

    for body in (SimulatedBody, SeeingBody, MazeBody):
        monkeypatch.setattr(body, "act", never)

    def run(*words: object) -> str:
        assert main([str(word).format(**names) for word in words]) == 2
        out, err = capfd.readouterr()
        assert err.startswith("imitate: ") and err.count("\n") == 1 and err.endswith("\n") and len(err) < 400, err
        assert out == "" and list(here.iterdir()) == []
        return err

    return run


@pytest.mark.parametrize("words", WORDS, ids=" ".join)
def test_what_cannot_be_meant_is_refused_before_anything_moves(refused: Callable[..., str], words: list[str]) -> None:
    refused(*words)


@pytest.mark.parametrize(("name", "option"), LATER)
def test_names_in_a_world(refused: Callable[..., str], name: str, option: str) -> None:
    refused(name, f"--{option.replace('_', '-')}", LATER[name, option])


@pytest.mark.parametrize(("name", "option"), files_of())
def test_files_of_another_kind_or_body_are_refused_before_anything_moves(
    refused: Callable[..., str], name: str, option: str, arm_mind: Mind, tmp_path: Path
) -> None:
    save(arm_mind, tmp_path / "arm.nc")
    more = BESIDE.get(option, [])
    if (name, option) == ("face", "memory"):
        more = ["--mind", tmp_path / "arm.nc"]
    for place in (tmp_path / "text", tmp_path / "arm.nc"):
        places = [place, place] if option == "merge" else [place]
        refused(name, f"--{option.replace('_', '-')}", *places, *more)
