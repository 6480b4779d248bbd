"""What a battery leaves, for its figures and its page."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from experiments.battery.beside import Row, rows
from experiments.battery.infants import Rate
from experiments.battery.options import Config


@dataclass(frozen=True, eq=False)
class Battery:
    """All that agents did."""

    config: Config
    frame: pd.DataFrame
    """See `experiments.battery.table`."""
    factors: tuple[str, ...]
    """What was varied."""
    failed: tuple[str, ...]
    """Shards that failed, in words."""
    shards: int
    took_s: float

    @cached_property
    def whole(self) -> pd.DataFrame:
        """Without the columns of factors: all cells together."""
        return self.frame.drop(columns=list(self.factors))

    @cached_property
    def rows(self) -> list[Row]:
        """Beside infants."""
        return rows(self.frame, np.random.default_rng([self.config.seed, 0xBE51]))

    @cached_property
    def metrics(self) -> dict[str, Any]:
        """For metrics.json."""
        return {
            "agents": int(self.frame["agent"].nunique()),
            "trials": len(self.frame),
            "rows": [told(row) for row in self.rows],
            "workers": self.config.workers,
            "shards": self.shards,
            "failed": list(self.failed),
            "took_s": self.took_s,
        }


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
