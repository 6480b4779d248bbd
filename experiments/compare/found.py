"""Runs side by side: what they share, and what they do not."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from babbling.axes import FloatArray
from experiments.compare.reading import Run, Tracks

Name = TypeVar("Name")
HEADLINES = 6
UNSAID = ("out", "runs", "threads", "workers", "csv", "film")
"""Options that change no number."""


def common(lists: Sequence[Sequence[Name]]) -> list[Name]:
    """What is in all of them, in the order of the first."""
    return [one for one in lists[0] if all(one in other for other in lists[1:])] if lists else []


@dataclass(frozen=True)
class Compared:
    """Two runs or more."""

    runs: tuple[Run, ...]

    @cached_property
    def options(self) -> dict[str, list[str]]:
        """Options (and the experiment) that are not the same in all runs: name -> what each was told; of different
        experiments those that all have."""
        told = {"experiment": [run.experiment for run in self.runs]}
        names = list(dict.fromkeys(name for run in self.runs for name in run.options))
        if len(set(told["experiment"])) > 1:
            names = common([list(run.options) for run in self.runs])
        told |= {name: [run.options.get(name, "-") for run in self.runs] for name in names if name not in UNSAID}
        return {name: values for name, values in told.items() if len(set(values)) > 1}

    @cached_property
    def metrics(self) -> dict[str, list[float]]:
        """Metrics of all runs: name -> of each."""
        names = common([list(run.metrics) for run in self.runs])
        return {name: [run.metrics[name] for run in self.runs] for name in names}

    @cached_property
    def different(self) -> dict[str, list[float]]:
        """Those of them that are not the same in all; errors in degrees first, parts of a whole last."""
        found = {name: values for name, values in self.metrics.items() if len(set(values)) > 1}
        return dict(sorted(found.items(), key=lambda one: ("." in one[0], not one[0].endswith("_deg"))))

    @property
    def headlines(self) -> dict[str, list[float]]:
        """The first few."""
        return dict(list(self.different.items())[:HEADLINES])

    @cached_property
    def tracked(self) -> list[tuple[int, Run, Tracks]]:
        """Number, run and movements of those that left any."""
        return [(n, run, run.tracks) for n, run in enumerate(self.runs) if run.tracks is not None]

    @cached_property
    def joints(self) -> list[str]:
        """Joints that all who left movements have in the same unit, by how much they move, most first."""
        named = [list(zip(tracks.joints, tracks.units, strict=True)) for _, _, tracks in self.tracked]
        shared = {joint for joint, _ in common(named)}
        return [joint for joint in self.tracked[0][2].busiest if joint in shared] if shared else []

    @cached_property
    def errors(self) -> list[tuple[int, Run, FloatArray, FloatArray]]:
        """Number, run, (T,) s and (T,) root mean square error over the joints that all have."""
        if not self.joints:
            return []
        return [(n, run, tracks.time, tracks.of(self.joints).error) for n, run, tracks in self.tracked]

    @property
    def unit(self) -> str:
        """Of the errors."""
        return " and ".join(dict.fromkeys(self.tracked[0][2].of(self.joints).units))

    @property
    def alike(self) -> bool:
        """Whether all were shown the same, as far as they share joints."""
        return len({tracks.of(self.joints).demonstrated.tobytes() for _, _, tracks in self.tracked}) == 1

    @property
    def overall(self) -> dict[str, float]:
        """Run -> its error, root mean square over time too."""
        return {run.label: float(np.sqrt(np.mean(error**2))) for _, run, _, error in self.errors}

    @property
    def remarks(self) -> list[str]:
        """What is not shared, a line each."""
        found = []
        if without := [run.label for run in self.runs if run.tracks is None]:
            found.append(f"No trajectories.nc, so no movements: {', '.join(without)}.")
        if own := sum(len(tracks.joints) - len(self.joints) for _, _, tracks in self.tracked):
            found.append(f"Joints that are not in all runs in the same unit are left out: {own}.")
        if own := len({name for run in self.runs for name in run.metrics} - self.metrics.keys()):
            found.append(f"Metrics that are not in all runs are left out: {own}.")
        if len(self.tracked) > 1 and not self.alike:
            found.append("The movements are not the same.")
        return found
