"""`--vary`: what can be varied, all of it crossed, the same seeds in every cell."""

from dataclasses import dataclass, fields, replace
from typing import Annotated, Literal

import pytest

from experiments.battery.options import Config
from experiments.battery.parameters import Parameters
from experiments.battery.vary import MOST_CELLS, around, designs, parse
from experiments.errors import ExperimentError
from experiments.shared.options import within


@dataclass(frozen=True)
class Some:
    noise: Annotated[float, within(0, 1)] = 0.1
    lessons: int = 3
    mirror: bool = True
    rule: Literal["map", "matching"] = "map"
    names: tuple[str, ...] = ()


def test_everything_is_crossed_and_an_agent_of_one_cell_has_its_like_in_every_other() -> None:
    varied = parse(["noise=0,0.5", "mirror=true,false", "rule=matching,map"], Some)
    assert varied == {"noise": (0.0, 0.5), "mirror": (True, False), "rule": ("matching", "map")}
    found = designs(varied, Some(lessons=7), 3)
    assert [one.agent for one in found] == list(range(24))
    assert {one.parameters.lessons for one in found} == {7}
    blocks = [[one for one in found if one.block == block] for block in range(3)]
    for block in blocks:
        assert [(one.factors, one.parameters) for one in block] == [(a.factors, a.parameters) for a in blocks[0]]
        assert len({(one.parameters.noise, one.parameters.mirror, one.parameters.rule) for one in block}) == 8
    for one in found:
        assert one.factors["noise"] == one.parameters.noise and one.factors["rule"] == one.parameters.rule
        assert one.factors["mirror"] == str(one.parameters.mirror).lower()
    assert designs(varied, Some(lessons=7), 5)[:24] == found  # more agents change nothing of those there are


def test_nothing_varied_is_one_cell() -> None:
    [one, two] = designs({}, Some(), 2)
    assert (one.agent, one.block, one.factors, one.parameters) == (0, 0, {}, Some()) and two.agent == 1


def test_one_by_one_nothing_else_is_ever_varied() -> None:
    usual = Some(noise=0.2)
    varied = parse(["noise=0,0.2,0.5", "mirror=true,false"], Some)
    found = designs(varied, usual, 2, one_by_one=True)
    assert [one.parameters for one in found[:4]] == [
        usual, replace(usual, noise=0.0), replace(usual, noise=0.5), replace(usual, mirror=False)
    ]  # fmt: skip
    assert [one.factors for one in found[:4]] == [
        {"noise": 0.2, "mirror": "true"}, {"noise": 0.0, "mirror": "true"}, {"noise": 0.5, "mirror": "true"},
        {"noise": 0.2, "mirror": "false"},
    ]  # fmt: skip
    assert [one.block for one in found] == [0] * 4 + [1] * 4 and [one.agent for one in found] == list(range(8))


@pytest.mark.parametrize("quick", [True, False])
def test_every_parameter_of_an_agent_is_varied_about_what_it_is_within_its_bounds(quick: bool) -> None:
    config = Config(quick=quick, one_by_one=True)
    usual, found = config.parameters, config.varied
    assert list(found) == [one.name for one in fields(Parameters)]
    for name, (first, *others) in found.items():
        assert first == getattr(usual, name) and others and first not in others
        assert all(type(one) is type(first) for one in others)
        assert parse([f"{name}={','.join(map(str, others))}"], Parameters)[name] == tuple(others)  # they are allowed
    assert found["exponent"] == (1.0, 0.5, 2.0) and found["repeats"] == (0.8, 0.4)
    assert Config(one_by_one=True, vary=("acts=1,3",)).varied == {"acts": (1, 3)}
    with pytest.raises(KeyError):
        around(Some(noise=0.0), {})


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("nois=1", "unknown parameter 'nois'; there are .*did you mean 'noise'"),
        ("noise", "must be NAME=a,b,c; NAME is one of noise, lessons"),
        ("noise=", "a finite number; '' was given"),
        ("noise=nan", "a finite number"),
        ("noise=1e999", "a finite number"),
        ("noise=0.1,2", "--vary noise 2: it must lie between 0 and 1"),
        ("noise=0.1,0.10", "stands there twice"),
        ("lessons=1.5", "a whole number; '1.5'"),
        ("mirror=maybe", "possible: true, false; 'maybe'"),
        ("rule=mean", "possible: map, matching; 'mean'"),
        ("names=a", "neither a number nor one of a closed set"),
    ],
)
def test_what_cannot_be_meant_is_a_line(said: str, told: str) -> None:
    with pytest.raises(ExperimentError, match=told) as caught:
        parse([said], Some)
    assert str(caught.value).startswith("--vary") and "\n" not in str(caught.value)


def test_too_much_and_twice_the_same_are_refused() -> None:
    with pytest.raises(ExperimentError, match="named twice"):
        parse(["lessons=1,2", "lessons=3"], Some)
    many = ",".join(map(str, range(32)))
    with pytest.raises(ExperimentError, match=f"more than {MOST_CELLS} combinations"):
        parse([f"lessons={many}", "noise=" + ",".join(str(n / 100) for n in range(32))], Some)
