"""Options of `imitate fit`."""

from pathlib import Path
from typing import Annotated

import tyro

from experiments.shared.options import Flag, N, Options, options, within, written


@options
class Config(Options):
    """Options of `imitate fit`."""

    table: Annotated[Path | None, tyro.conf.Positional, written("TABLE.csv|TABLE.parquet", "must be given")] = None
    """A row a choice: agent, task, condition, trial, response; where they are known also options,
    likelihood and prior, each joined by |. A battery's own, or one's own infants'."""
    reference: Annotated[Path | None, written("TABLE", "rows say it themselves")] = None
    """A battery's table, whose options, likelihoods and priors of the same task and condition stand for those that are
    missing."""
    spread: Annotated[float, within(0.1, 3), written("SD")] = 0.75
    """Standard deviation of the logarithms of temperature and of trust, before anything is seen; both are about 1."""
    lapse: Annotated[float, within(0.01, 0.5), written("SHARE")] = 0.1
    """Mean share of choices that mean nothing, before anything is seen."""
    recover: Flag = False
    """Also simulate infants of known parameters on the same options, and see how well they are found again."""
    recoveries: Annotated[int, within(2, 2000), N] = 200
    """How often: each time 20 infants of 40 trials, and a group of 20 that are alike."""
