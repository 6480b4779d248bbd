"""What infants did, to stand beside what agents do. Nothing of it is ever tuned on.

Statuses: `seen`, the figure stands in a source that was read; `chapter`, in Rao, Shon and Meltzoff alone; `recalled`,
no source with the figure was at hand; `computed`, from a published data set. Contested rows stand beside what contests
them. Where several acts of each infant were counted and their spread was not published, a rate has no n.
"""

from dataclasses import dataclass
from typing import Literal

Status = Literal["seen", "chapter", "recalled", "computed"]


@dataclass(frozen=True)
class Cell:
    """Trials of the table that are meant."""

    task: str
    condition: str
    target: str = ""
    """What the target begins with, where only some trials of the condition are meant."""

    def __str__(self) -> str:
        thing = f", {self.target}" if self.target else ""
        return f"{self.task}: {self.condition}{thing}"


@dataclass(frozen=True)
class Rate:
    """How many of n infants did it; or what share, where n is not known over infants."""

    study: str
    cell: Cell
    share: float
    hits: int | None
    n: int | None
    status: Status
    remark: str = ""


@dataclass(frozen=True)
class Sign:
    """One condition above another, or no difference found between them."""

    study: str
    more: Cell
    less: Cell
    relation: Literal[">", "="]
    status: Status
    remark: str = ""


def _touch(condition: str) -> Cell:
    return Cell("head touch", condition)


def _meant(condition: str, target: str = "") -> Cell:
    return Cell("intention", condition, target)


def _rate(study: str, cell: Cell, hits: int, n: int, status: Status, remark: str = "") -> Rate:
    return Rate(study, cell, hits / n, hits, n, status, remark)


_1995, _1988 = "Meltzoff 1995, 18 months", "Meltzoff 1988, 14 months"
_2017, _2002 = "Heimann et al. 2017, 13 to 17 months", "Gergely et al. 2002, 14 months"
_GAZE = "Brooks and Meltzoff 2002"
RATES: tuple[Rate, ...] = (
    _rate(_1988, _touch("a week before"), 8, 12, "chapter", "n recalled"),
    _rate(_2017, _touch("a week before"), 29, 63, "seen", "replication"),
    _rate(_1988, _touch("nothing"), 0, 24, "chapter", "n recalled"),
    _rate(_2017, _touch("nothing"), 2, 41, "seen", "replication"),
    _rate(_2002, _meant("head free"), 9, 13, "recalled", "direction seen; contested, see the signs below"),
    _rate(_2002, _meant("head bound"), 3, 14, "recalled", "direction seen; contested, see the signs below"),
    Rate(_1995, _meant("target"), 0.76, None, None, "recalled", "acts of five; spread over infants not known"),
    Rate(_1995, _meant("failed"), 0.80, None, None, "recalled", "acts of five; spread over infants not known"),
    Rate(_1995, _meant("baseline"), 0.20, None, None, "recalled", "acts of five; spread over infants not known"),
    Rate(_1995, _meant("manipulation"), 0.20, None, None, "recalled", "acts of five; spread over infants not known"),
    _rate(_1995, _meant("failed", "dumbbell"), 18, 30, "recalled", "person; sign seen"),
    _rate(_1995, _meant("device failed", "dumbbell"), 3, 30, "recalled", "device; sign seen"),
)
SIGNS: tuple[Sign, ...] = (
    Sign(_1988, _touch("a week before"), _touch("nothing"), ">", "chapter"),
    Sign("Meltzoff 1988a, 14 months", _touch("television"), _touch("nothing"), ">", "chapter", "24 h later"),
    Sign("all studies of the video deficit", _touch("live"), _touch("television"), ">", "computed", "g = 0.52 ± 0.12"),
    Sign("Klein and Meltzoff 1999, 12 months", _touch("live"), _touch("another room"), "=", "seen"),
    Sign("Barnat et al. 1996, 14 months", _touch("live"), _touch("another room"), ">", "seen", "object changed too"),
    Sign(_2002, _meant("head free"), _meant("head bound"), ">", "seen"),
    Sign("Heimann et al. 2017; Beisert et al. 2012", _meant("head free"), _meant("head bound"), "=", "seen",
         "hands covered; salience reversed it"),
    Sign(_1995, _meant("target"), _meant("baseline"), ">", "seen"),
    Sign(_1995, _meant("failed"), _meant("baseline"), ">", "seen"),
    Sign(_1995, _meant("failed"), _meant("manipulation"), ">", "seen"),
    Sign(_1995, _meant("failed", "dumbbell"), _meant("device failed", "dumbbell"), ">", "seen"),
    Sign(_1995, _meant("device failed", "dumbbell"), _meant("baseline", "dumbbell"), "=", "chapter"),
    Sign(_1995, _meant("device success", "dumbbell"), _meant("baseline", "dumbbell"), ">", "chapter"),
    Sign("Carpenter et al. 1998, 14 to 18 months", _meant("intended"), _meant("accidental"), ">", "seen", "2 to 1"),
    Sign("Meltzoff 2002", _meant("outsized"), _meant("outsized baseline"), ">", "chapter", "by other means"),
    Sign("Meltzoff and Moore 1977 to 1994", Cell("face", "tongue out, strong", "tongue out"),
         Cell("face", "nothing shown", "tongue out"), ">", "seen", "g = 1.87 ± 0.50; other laboratories 0.38 ± 0.10"),
    Sign("Oostenbroek et al. 2016", Cell("face", "tongue out, strong", "tongue out"),
         Cell("face", "nothing shown", "tongue out"), "=", "seen", "g = 0.09 ± 0.02; contested in turn"),
    Sign("Nagy et al. 2013", Cell("face", "tongue out, strong"), Cell("face", "tongue out, weak"), ">", "seen"),
    Sign(_GAZE, Cell("gaze, headband", "12 months"), Cell("gaze, blindfold", "12 months"), "=", "seen"),
    Sign(_GAZE, Cell("gaze, headband", "18 months"), Cell("gaze, blindfold", "18 months"), ">", "seen"),
    Sign("Meltzoff and Brooks 2008", Cell("gaze, blindfold", "12 months"),
         Cell("gaze, blindfold", "12 months, after an opaque blindfold"), ">", "seen"),
    Sign("Meltzoff and Brooks 2008", Cell("gaze, blindfold", "18 months, after a see-through one"),
         Cell("gaze, blindfold", "18 months"), ">", "seen"),
)  # fmt: skip
