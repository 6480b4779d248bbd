"""What a battery leaves, for its figures and its page."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from experiments.battery.beside import Row, rows
from experiments.battery.effects import differences
from experiments.battery.infants import Rate
from experiments.battery.options import Config
from experiments.battery.table import IMITATOR, WHOLE, varied


@dataclass(frozen=True, eq=False)
class Battery:
    """All that agents did."""

    config: Config
    frame: pd.DataFrame
    """See `experiments.battery.table`."""
    failed: tuple[str, ...]
    """Shards that failed, in words."""
    shards: int
    took_s: float
    busy_s: float | None
    """Processor time of all workers, that of starting them too; None where they were elsewhere."""

    @property
    def factors(self) -> list[str]:
        """What was varied."""
        return varied(self.frame)

    @cached_property
    def whole(self) -> pd.DataFrame:
        """The first cell of the design, without the columns of factors: agents of other cells are the same children."""
        first = self.frame
        for name in self.factors:
            first = first[first[name] == self.frame[name].iloc[0]]
        return first.drop(columns=self.factors)

    @cached_property
    def effects(self) -> pd.DataFrame:
        """Differences between whole agents and those without a stage, peers, and values of what was varied."""
        own = self.whole[self.whole["who"] == IMITATOR]
        parts = [(own, "without"), (self.whole[self.whole["without"] == WHOLE], "who")]
        parts += [(only(self.frame, name), name) for name in self.factors]
        rng = np.random.default_rng([self.config.seed, 0xEFF])
        found = [differences(enough(part, name), name, rng=rng) for part, name in parts if len(enough(part, name))]
        return pd.concat(found, ignore_index=True) if found else pd.DataFrame()

    @cached_property
    def rows(self) -> list[Row]:
        """Beside infants."""
        return rows(self.whole, np.random.default_rng([self.config.seed, 0xBE51]))

    @cached_property
    def metrics(self) -> dict[str, Any]:
        """For metrics.json."""
        return {
            "agents": int(self.frame["agent"].nunique()),
            "trials": len(self.frame),
            "rows": [told(row) for row in self.rows],
            "effects": self.effects.astype(object).where(self.effects.notna(), None).to_dict("records"),
            "failed": list(self.failed),
            "took_s": self.took_s,
            "workers": self.config.workers,
            "shards": self.shards,
            **self._spent,
        }

    @property
    def _spent(self) -> dict[str, float | None]:
        """How much of the workers' time was work, and what of it each shard cost beside: being sent, waiting for the
        last ones. It says little where most was done before."""
        there = self.config.workers * self.took_s
        share = None if self.busy_s is None else self.busy_s / there
        over = None if self.busy_s is None else 1000 * max(there - self.busy_s, 0) / self.shards
        return {"efficiency_factor": share, "shard_overhead_ms": over}


def only(frame: pd.DataFrame, factor: str) -> pd.DataFrame:
    """Whole imitators, all other factors at their first values."""
    own = frame[(frame["who"] == IMITATOR) & (frame["without"] == WHOLE)]
    for name in (name for name in varied(frame) if name != factor):
        own = own[own[name] == frame[name].iloc[0]].drop(columns=name)
    return own


def enough(frame: pd.DataFrame, between: str | None = None) -> pd.DataFrame:
    """Cells of two agents or more: of one alone nothing is said."""
    keys = [name for name in ("task", "condition", "who", "without", between) if name and name in frame]
    return frame[frame.groupby(keys, dropna=False)["agent"].transform("nunique") > 1]


def told(row: Row) -> dict[str, Any]:
    """A row beside infants."""
    one, found = row.published, row.simulated
    cell = str(one.cell) if isinstance(one, Rate) else f"{one.more} {one.relation} {one.less}"
    published = (one.share, one.hits, one.n) if isinstance(one, Rate) else one.relation
    return {
        "study": one.study,
        "task": cell,
        "simulated": None if found is None else found.value,
        "interval": None if found is None else [found.low, found.high],
        "agents": row.agents,
        "published": published,
        "published_interval": row.verdict.published and [row.verdict.published.low, row.verdict.published.high],
        "status": one.status,
        "remark": one.remark,
        "verdict": row.verdict.word,
    }
