"""Choices out of a tidy table: what each individual chose, and among what, ready for any parameters.

A choice among the options of a set has P(i) = lapse / K + (1 - lapse) * (L_i P_i^trust)^temperature / sum over options.
Where an individual's own set is not known, its chance is the mean over the sets that simulated agents had in the same
task and condition: each of these is as likely to have been its own.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
from scipy.sparse import csr_array

from babbling.axes import FloatArray, IntArray
from experiments.battery.table import BETWEEN, parted
from experiments.errors import ExperimentError
from models.errors import unknown

PLACE = ("task", "condition")
MOST_OPTIONS, AT_ONCE, DENSE = 1000, 1 << 23, 0.05
"""Options of a set; numbers that are held at once; share of counts that are not 0 from which zeros are multiplied
too."""
Set = tuple[tuple[str, ...], tuple[float, ...], tuple[float, ...]]
"""Options, their likelihoods and priors."""


@dataclass(frozen=True, eq=False)
class Sets:
    """S sets of at most K options; what is beyond a set's own options is never chosen."""

    likelihood: FloatArray
    """(S, K)."""
    prior: FloatArray
    """(S, K)."""
    there: FloatArray
    """(S, K) 1 for its options, 0 beyond."""

    def chances(self, exponents: FloatArray) -> FloatArray:
        """(S K, E) chance of every option with (E, 2) exponents of likelihood and prior; where no option is possible,
        each is as likely as any, as in a lapse."""
        with np.errstate(divide="ignore", invalid="ignore"):
            weight = np.log(self.there)[..., None]
            for values, exponent in ((self.likelihood, exponents[:, 0]), (self.prior, exponents[:, 1])):
                term = np.log(values)[..., None] * exponent
                weight = weight + np.where(exponent == 0, 0.0, term)  # 0^0 is 1
            best = weight.max(1, keepdims=True)
            weight = np.where(np.isfinite(best), np.exp(weight - best), self.there[..., None])
        return np.asarray((weight / weight.sum(1, keepdims=True)).reshape(-1, len(exponents)))

    @property
    def lapse(self) -> FloatArray:
        """(S K,) 1 / K."""
        return np.asarray((self.there / self.there.sum(1, keepdims=True)).ravel())


@dataclass(frozen=True, eq=False)
class Choices:
    """Who chose what, where."""

    individuals: tuple[str | int, ...]
    """I of them."""
    sets: Sets
    cells: csr_array
    """(C, S K) what each response in each situation averages over; a situation's own responses sum to 1 each."""
    situation: IntArray
    """(C,) of each cell."""
    names: tuple[tuple[str, str, str], ...]
    """(C,) task, condition and response of each cell."""
    counts: csr_array
    """(I, C) how often."""
    left_out: int = 0
    """Rows without a set, their own or anybody's."""

    @cached_property
    def weight(self) -> FloatArray:
        """(C,) chance of every cell in a lapse."""
        return np.asarray(self.cells @ self.sets.lapse)

    def chances(self, exponents: FloatArray, which: IntArray | slice = slice(None)) -> FloatArray:
        """(C, E) of every response, or of `which`, without lapse, for (E, 2) exponents."""
        width, own = self.sets.there.shape[1], self.cells[which]
        needed = np.unique(own.indices // width)
        sets = Sets(self.sets.likelihood[needed], self.sets.prior[needed], self.sets.there[needed])
        own = own[:, (needed[:, None] * width + np.arange(width)).ravel()]
        step = max(1, AT_ONCE // own.shape[1])
        return np.concatenate(
            [own @ sets.chances(exponents[at : at + step]) for at in range(0, len(exponents), step)], 1
        )

    def log_likelihood(self, exponents: FloatArray, lapses: FloatArray) -> FloatArray:
        """(I, E, N) log P(choices of each | theta): (E, 2) exponents of likelihood and prior, (N,) lapses."""
        found = np.zeros((len(self.individuals), len(exponents) * len(lapses)))
        seen, step = np.flatnonzero(self.counts.sum(0)), max(1, AT_ONCE // found.shape[1])
        for at in range(0, len(seen), step):
            cells = seen[at : at + step]
            chance, lapse = self.chances(exponents, cells)[..., None], self.weight[cells, None, None]
            with np.errstate(divide="ignore"):
                logs = np.log(lapses * lapse + (1 - lapses) * chance).reshape(len(cells), -1)
            counts = self.counts[:, cells]
            dense = counts.nnz > DENSE * np.prod(counts.shape)
            found += (counts.toarray() if dense else counts) @ logs
        return found.reshape(-1, len(exponents), len(lapses))


def choices(frame: pd.DataFrame, reference: pd.DataFrame | None = None, who: str | None = None) -> Choices:
    """All choices of a table.

    Args:
        frame: rows with `options` and `likelihood` of their own (`prior`: alike where it is empty), or without.
        reference: a table whose sets stand for those that are missing; its rows of the same task and condition.
        who: of the reference, whose sets: `imitator`; None is everybody's.

    Raises:
        ExperimentError: cells that are no probabilities, a response that is no option, or nothing to fit.
    """
    own = [_set(row, "the table") for row in _rows(frame)]
    others: dict[tuple[str, str], list[Set]] = {}
    if reference is not None:
        rows = reference[reference["who"] == who] if who is not None and "who" in reference else reference
        for row in _rows(rows):
            if (one := _set(row, "the reference")) is not None:
                others.setdefault((str(row["task"]), str(row["condition"])), []).append(one)
    found = _Collected()
    for row, one in zip(_rows(frame), own, strict=True):
        place = (str(row["task"]), str(row["condition"]))
        found.add(row["agent"], place, str(row["response"]), [one] if one is not None else others.get(place, []))
    if not found.rows:
        there = "; ".join(sorted({", ".join(place) for place in others})) or "there is no reference"
        raise ExperimentError(
            f"no row has options and likelihoods, of its own or of the same task and condition in a reference ({there})"
        )
    return found.choices()


class _Collected:
    """Rows, one by one."""

    def __init__(self) -> None:
        self.rows: list[tuple[int, int, int]] = []
        self.who: dict[str | int, int] = {}
        self.sets: dict[Set, int] = {}
        self.situations: dict[tuple[tuple[str, str], tuple[int, ...]], tuple[int, list[str], list[Set]]] = {}
        self.left_out = 0

    def add(self, agent: Any, place: tuple[str, str], response: str, sets: Sequence[Set]) -> None:
        """A choice among one of these sets."""
        if not sets:
            self.left_out += 1
            return
        numbers = tuple(self.sets.setdefault(one, len(self.sets)) for one in sets)
        if (place, numbers) not in self.situations:
            names = sorted({name for options, _, _ in sets for name in options})
            self.situations[place, numbers] = len(self.situations), names, list(sets)
        number, names, _ = self.situations[place, numbers]
        if response not in names:
            raise ExperimentError(f"{', '.join(place)}: {unknown('response', response, names)}")
        self.rows.append((self.who.setdefault(agent, len(self.who)), number, names.index(response)))

    def choices(self) -> Choices:
        """All of them."""
        width = max(len(one[0]) for one in self.sets)
        arrays = np.zeros((3, len(self.sets), width))
        for one, (options, likelihood, prior) in enumerate(self.sets):
            arrays[:, one, : len(options)] = likelihood, prior, np.ones(len(options))
        first, cells, told, situation = [], list[tuple[int, int, float]](), list[tuple[str, str, str]](), list[int]()
        for (place, numbers), (number, names, sets) in self.situations.items():
            first.append(len(told))
            for name in names:
                cells += [
                    (len(told), one * width + own[0].index(name), 1 / len(sets))
                    for one, own in zip(numbers, sets, strict=True) if name in own[0]
                ]  # fmt: skip
                told.append((*place, name))
                situation.append(number)
        row, column, share = (np.array(one) for one in zip(*cells, strict=True))
        who, where, what = np.array(self.rows).T
        return Choices(
            tuple(self.who),
            Sets(*arrays),
            csr_array((share, (row, column)), (len(told), len(self.sets) * width)),
            np.array(situation),
            tuple(told),
            csr_array((np.ones(len(who)), (who, np.array(first)[where] + what)), (len(self.who), len(told))),
            self.left_out,
        )


def _rows(frame: pd.DataFrame) -> list[dict[str, Any]]:
    names = [name for name in ("agent", *PLACE, "response", "options", "likelihood", "prior") if name in frame]
    columns: list[list[Any]] = [frame[name].tolist() for name in names]
    return [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]


def _set(row: Mapping[str, Any], where: str) -> Set | None:
    """Options of a row, if it has any with likelihoods.

    Raises:
        ExperimentError: see `choices`.
    """
    said, likelihood, prior = (str(row.get(name, "")) for name in ("options", "likelihood", "prior"))
    if not said or not likelihood:
        return None
    names = tuple(said.split(BETWEEN))
    place = f"{where}, agent {row['agent']}, {row['task']}, {row['condition']}"
    if not 2 <= len(names) <= MOST_OPTIONS or len({*names}) < len(names):
        raise ExperimentError(f"{place}: {len(names)} options; 2 to {MOST_OPTIONS} of different names can be fitted")
    numbers = []
    for name, cell in (("likelihood", likelihood), ("prior", prior or BETWEEN.join("1" * len(names)))):
        try:
            values = parted(cell)
        except ValueError:
            values = np.zeros(0)
        if len(values) != len(names) or not (values >= 0).all() or not np.isfinite(values).all():
            raise ExperimentError(
                f"{place}, {name} {cell[:40]!r}: it must be {len(names)} numbers of 0 or more, joined by {BETWEEN}"
            )
        numbers.append(tuple(values.tolist()))
    return names, numbers[0], numbers[1]
