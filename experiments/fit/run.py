"""A table of choices, fitted: temperature, trust and lapse of each individual, rival models, and how good that is."""

import numpy as np
import pandas as pd

from experiments.battery.choices import choices
from experiments.battery.fit import evidence, fit, population, prior
from experiments.battery.reading import read
from experiments.battery.recovery import check, recover
from experiments.battery.table import IMITATOR, WHOLE
from experiments.errors import ExperimentError
from experiments.fit.figures import figures
from experiments.fit.found import Found
from experiments.fit.options import Config
from experiments.shared.experiment import Result
from experiments.shared.progress import progress

OWN = {"who": IMITATOR, "without": WHOLE}
"""Of a battery's table with peers and ablations, only these rows."""


def _own(frame: pd.DataFrame) -> pd.DataFrame:
    for name, value in OWN.items():
        if name in frame and (frame[name] == value).any():
            frame = frame[frame[name] == value]
    return frame


def run(config: Config) -> Result:
    """Read, fit, compare, check.

    Raises:
        ExperimentError, BodyError: no table, or one that cannot be used.
    """
    config.check()
    if config.table is None:
        raise ExperimentError(
            "imitate fit TABLE: no table is named; one of a row a choice, .csv or .parquet, is fitted"
        )
    before = prior(config.spread, config.lapse)
    told = choices(_own(read(config.table)), None if config.reference is None else _own(read(config.reference)))
    checked, drawn = np.random.default_rng(config.seed).spawn(2)
    with progress("fitting") as report:
        found = fit(told, before)
        report(0.2)
        rivals = evidence(told, before)
        report(0.4)
        many = population(found) if len(told.individuals) > 1 else None
        report(0.5)
        rows = check(found, None if many is None else many.posterior, rng=checked)
        report(0.6)
        again = recover(told, before, config.recoveries, rng=drawn) if config.recover else None
        report(1.0)
    done = Found(found, many, rivals, rows, again)
    return Result(done.metrics(), done.summary(), figures(done))
