"""What `imitate fit` found."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
from scipy.special import softmax

from babbling.axes import FloatArray, IntArray
from experiments.battery.fit import MODELS, Evidence, Fit, Population, summary
from experiments.battery.recovery import Recovery
from experiments.compare.reading import plain
from experiments.shared.tables import table

MOST_ROWS = 20


@dataclass(frozen=True, eq=False)
class Found:
    """Posteriors, models, checks."""

    fit: Fit
    population: Population | None
    """None of a single individual."""
    evidence: dict[str, Evidence]
    check: pd.DataFrame
    recovery: Recovery | None = None

    @property
    def names(self) -> list[str]:
        """Of parameters."""
        return [one.name for one in self.fit.prior]

    @property
    def individuals(self) -> list[str]:
        """Whose choices they are."""
        return [plain(str(one)) for one in self.fit.choices.individuals]

    @cached_property
    def individual(self) -> FloatArray:
        """(I, 3, 3) median and ends of the 95 % interval of each alone."""
        return summary(self.fit.individual, self.fit.prior)

    @cached_property
    def pooled(self) -> FloatArray:
        """(3, 3) of all, as if they were one."""
        return np.asarray(summary(self.fit.pooled, self.fit.prior)[0])

    @property
    def typical(self) -> FloatArray | None:
        """(3, 3) middle of the population, and ends between which 95 % of its individuals lie."""
        if self.population is None:
            return None
        turns = self.population.mean[:, None] + np.array([0, -1.96, 1.96]) * self.population.sd[:, None]
        ends = [(one.edges[0], one.edges[-1]) for one in self.fit.prior]
        return np.array([one.back(np.clip(t, *e)) for one, t, e in zip(self.fit.prior, turns, ends, strict=True)])

    @property
    def probability(self) -> FloatArray:
        """(models,) of each, alike before, if all individuals share theta."""
        return np.asarray(softmax([self.evidence[model].pooled for model in MODELS]))

    @property
    def best(self) -> IntArray:
        """(models,) individuals for whom it is the likeliest."""
        alone = np.stack([self.evidence[model].individual for model in MODELS])
        return np.bincount(alone.argmax(0), minlength=len(MODELS))

    @property
    def outside(self) -> pd.DataFrame:
        """Responses whose observed share the fitted individuals would hardly ever give."""
        return self.check[(self.check["observed"] < self.check["low"]) | (self.check["observed"] > self.check["high"])]

    def metrics(self) -> dict[str, Any]:
        """For metrics.json."""
        told: dict[str, Any] = {
            "individuals": len(self.individuals),
            "choices": int(self.fit.choices.counts.sum()),
            "rows_left_out": self.fit.choices.left_out,
            "pooled": _named(self.names, self.pooled),
            "individual": {
                who: _named(self.names, one) for who, one in zip(self.individuals, self.individual, strict=True)
            },
            "log_evidence": {model: self.evidence[model].pooled for model in MODELS},
            "model_probability": dict(zip(MODELS, self.probability.tolist(), strict=True)),
            "best_model_of": dict(zip(MODELS, self.best.tolist(), strict=True)),
            "check": {", ".join(map(plain, row[:3])): list(row[3:]) for row in self.check.itertuples(index=False)},
            "outside": len(self.outside),
        }
        if self.typical is not None:
            told["population"] = _named(self.names, self.typical)
        if self.recovery is not None:
            told["recovery"] = self.recovery.coverage()
        return told

    def summary(self) -> str:
        """Markdown."""
        fitted = self.fit.choices
        parts = [f"**{len(self.individuals)} individuals, {int(fitted.counts.sum())} choices**"]
        if fitted.left_out:
            parts.append(f"{fitted.left_out} rows have no options, of their own or in a reference: left out.")
        medians = self.individual[:, :, 0]
        rows = []
        for place, name in enumerate(self.names):
            typical = "-" if self.typical is None else _ends(self.typical[place])
            spread = f"{medians[:, place].min():.3g} to {medians[:, place].max():.3g}"
            rows.append((name, _ends(self.pooled[place]), typical, spread))
        parts.append(table(rows, ("", "all as one (95 %)", "population (95 % of it)", "medians of individuals")))
        models = [
            (model, f"{self.evidence[model].pooled:.1f}", f"{share:.3f}", int(count))
            for model, share, count in zip(MODELS, self.probability, self.best, strict=True)
        ]
        parts.append(table(models, ("model", "log evidence", "probability", "best for individuals")))
        out = [
            (*map(plain, row[:3]), f"{row[3]:.3f}", f"{row[5]:.3f} to {row[6]:.3f}")
            for row in self.outside.itertuples(index=False)
        ]
        told = f"Posterior predictive check: {len(out)} of {len(self.check)} responses outside their 95 % interval."
        parts.append(told)
        if out:
            parts.append(table(out[:MOST_ROWS], ("task", "condition", "response", "observed", "expected (95 %)")))
        if self.recovery is not None:
            shown = [
                (kind, name, f"{one['coverage']:.3f}", "{:.3f} to {:.3f}".format(*one["interval"]),
                 f"{one['correlation']:.2f}")
                for kind, each in self.recovery.coverage().items() for name, one in each.items()
            ]  # fmt: skip
            parts.append(table(shown, ("recovery", "parameter", "coverage of 95 %", "(95 %)", "correlation")))
        return "\n\n".join(parts)


def _named(names: list[str], values: FloatArray) -> dict[str, list[float]]:
    return dict(zip(names, values.tolist(), strict=True))


def _ends(values: FloatArray) -> str:
    middle, low, high = values
    return f"{middle:.3g} ({low:.3g} to {high:.3g})"
