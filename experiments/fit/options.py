"""Options of `imitate fit`."""

from pathlib import Path
from typing import Annotated

import tyro

from experiments.shared.options import Options, options, within


@options
class Config(Options):
    """Options of `imitate fit`."""

    table: Annotated[Path | None, tyro.conf.Positional, tyro.conf.arg(metavar="TABLE")] = None
    """.csv or .parquet, a row a choice: agent, task, condition, trial, response; where they are known also options,
    likelihood and prior, each joined by |. A battery's own, or one's own infants'."""
    reference: Annotated[Path | None, tyro.conf.arg(metavar="TABLE")] = None
    """A battery's table, whose options, likelihoods and priors of the same task and condition stand for those that are
    missing."""
    spread: Annotated[float, within(0.1, 3)] = 0.75
    """Standard deviation of the logarithms of temperature and of trust, before anything is seen; both are about 1."""
    lapse: Annotated[float, within(0.01, 0.5)] = 0.1
    """Mean share of choices that mean nothing, before anything is seen."""
    recover: bool = False
    """Also simulate infants of known parameters on the same options, and see how well they are found again."""
    recoveries: Annotated[int, within(2, 2000)] = 200
    """How often: each time 20 infants of 40 trials, and a group of 20 that are alike."""
