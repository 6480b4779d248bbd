"""What is varied between agents: `--vary NAME=a,b,c`, crossed in full, the same seeds in every cell."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from itertools import product
from math import isfinite, prod
from typing import Any, Generic, Literal, NamedTuple, TypeVar, get_args, get_origin, get_type_hints

from experiments.errors import ExperimentError
from experiments.shared.options import obey
from models.errors import unknown

Parameters = TypeVar("Parameters")
BOOLS = {"true": True, "false": False, "yes": True, "no": False, "1": True, "0": False}
MOST_CELLS = 1000
"""Combinations of values."""


class Design(NamedTuple, Generic[Parameters]):
    """One agent's."""

    agent: int
    """From 0: block by block, so that more agents leave the numbers of those there are."""
    block: int
    """Agents of all cells with the same block have the same seed (common random numbers)."""
    factors: dict[str, float | str]
    """What was varied, by name: numbers, or words (`true` and `false` too)."""
    parameters: Parameters


def parse(said: Sequence[str], kind: type) -> dict[str, tuple[Any, ...]]:
    """Names of fields of a dataclass of parameters, and the values that each takes.

    Args:
        said: `NAME=a,b,c` each; - stands for _ too.
        kind: whose fields are numbers, bools or closed sets (`Literal`), held to the rules in their types.

    Raises:
        ExperimentError: a name that there is not (and what was probably meant), twice, or a value that cannot be.
    """
    hints, found = get_type_hints(kind, include_extras=True), dict[str, tuple[Any, ...]]()
    for one in said:
        name, equals, values = one.partition("=")
        name = name.strip().replace("-", "_")
        if not equals:
            raise ExperimentError(
                f"--vary {one[:60]!r}: it must be NAME=a,b,c; NAME is one of {', '.join(_names(kind))}"
            )
        if name not in hints:
            raise ExperimentError(f"--vary {unknown('parameter', name, _names(kind))}")
        if name in found:
            raise ExperimentError(f"--vary {name}: named twice; give all of its values at once, {name}=a,b,c")
        found[name] = tuple(_value(name, hints[name], word.strip()) for word in values.split(","))
        if len(set(found[name])) < len(found[name]):
            raise ExperimentError(f"--vary {one[:60]}: a value stands there twice; each makes a cell of its own")
    if prod(map(len, found.values())) > MOST_CELLS:
        raise ExperimentError(f"--vary: more than {MOST_CELLS} combinations; vary fewer parameters or values")
    return found


def designs(
    varied: Mapping[str, Sequence[Any]], parameters: Parameters, agents: int, *, one_by_one: bool = False
) -> list[Design[Parameters]]:
    """Every combination of values (full factorial) for `agents` agents each, in order of their numbers.

    Args:
        varied: as `parse` leaves it; nothing varied is one cell.
        parameters: what holds where nothing is varied; a dataclass.
        agents: of each cell.
        one_by_one: no combinations: a cell in which nothing is varied, and one for each other value of each.
    """
    if one_by_one:
        rest = ((name, value) for name, values in varied.items() for value in values)
        cells = [{}, *({name: value} for name, value in rest if value != getattr(parameters, name))]
    else:
        cells = [dict(zip(varied, values, strict=True)) for values in product(*varied.values())]
    held: list[Any] = [replace(parameters, **cell) for cell in cells]  # type: ignore[type-var]
    told = [{name: _told(getattr(one, name)) for name in varied} for one in held]
    return [
        Design(block * len(cells) + cell, block, dict(told[cell]), held[cell])
        for block in range(agents)
        for cell in range(len(cells))
    ]


def around(parameters: Any, nothing: Mapping[str, Any]) -> dict[str, tuple[Any, ...]]:
    """Of every parameter, what it is, and half and twice of that as far as its rule allows; bools are turned round.

    Args:
        parameters: a dataclass as `parse` takes them.
        nothing: what those may be that are 0, of which there is no half.
    """
    found = dict[str, tuple[Any, ...]]()
    for name, kind in get_type_hints(type(parameters), include_extras=True).items():
        value = getattr(parameters, name)
        if isinstance(value, bool):
            others: tuple[Any, ...] = (not value,)
        else:
            others = (value / 2, 2 * value) if value else (nothing[name],)
        found[name] = (
            value,
            *(other for other in map(type(value), others) if other != value and _may(name, kind, other)),
        )
    return found


def _may(name: str, kind: Any, value: Any) -> bool:
    try:
        obey(name, kind, value)
    except ExperimentError:
        return False
    return True


def _names(kind: type) -> list[str]:
    return [field.name for field in fields(kind)]


def _told(value: object) -> float | str:
    if isinstance(value, bool):
        return str(value).lower()
    return float(value) if isinstance(value, int | float) else str(value)


def _value(name: str, kind: Any, word: str) -> Any:
    """A word as a value of a field."""
    bare = get_args(kind)[0] if hasattr(kind, "__metadata__") else kind
    option, shown = f"--vary {name}={word[:30]}", word[:30]
    possible: Sequence[Any] = get_args(bare) if get_origin(bare) is Literal else ()
    value: Any = None
    if possible:
        value = next((one for one in possible if str(one) == word), None)
        wrong = f"possible: {', '.join(map(str, possible))}"
    elif bare is bool:
        value, wrong = BOOLS.get(word.lower()), "possible: true, false"
    elif bare in (int, float):
        wrong = "it must be a whole number" if bare is int else "it must be a finite number"
        try:
            value = bare(word)
        except ValueError:
            value = None
        if value is not None and not isfinite(value):
            value = None
    else:
        raise ExperimentError(f"--vary {name}: this is neither a number nor one of a closed set; vary another")
    if value is None:
        raise ExperimentError(f"{option}: {wrong}; {shown!r} was given")
    obey(f"--vary {name}", kind, value)
    return value
