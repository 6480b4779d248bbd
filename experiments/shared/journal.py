"""What one lived through on one's feet is kept: who was interrupted goes on from there, and need not fall again."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from babbling.axes import FloatArray
from babbling.files import is_kind, load, save
from babbling.kinds import Numbers, kind
from experiments.errors import ExperimentError
from experiments.shared.minds import EVERY_S


@dataclass(frozen=True)
class Episode:
    """One time on one's feet."""

    felt: Annotated[FloatArray, Numbers(".moment line")]
    """(T * B, L) what was felt, one tick of all copies after the other."""


@kind("interrupted learning to stand", "move or delete the file", ExperimentError)
@dataclass(frozen=True)
class Lived:
    """All times so far."""

    episodes: Annotated[tuple[Episode, ...], Numbers("episode")]


@dataclass
class Journal:
    """Episodes in the order in which they are lived through; without a path they are only in one's head."""

    path: Path | None = None
    told: Mapping[str, str | float] = field(default_factory=dict)
    """Options; notes of the file."""

    def __post_init__(self) -> None:
        """Go on where the file ends.

        Raises:
            ExperimentError: it is of other options, or no such file.
        """
        self.episodes, self.kept = list[Episode](), time.perf_counter()
        if self.path is not None and self.path.exists():
            self.episodes += load(self.path, Lived).episodes
            if not is_kind(self.path, Lived, **self.told):
                raise ExperimentError(
                    f"{self.path}: another interrupted learning to stand is here; repeat that command to finish it, or "
                    "delete the file"
                )

    def read(self, number: int, ticks: int, copies: int) -> FloatArray | None:
        """(T, B, L) of an earlier episode; None where it is still to come.

        Raises:
            ExperimentError: it went on for another time.
        """
        if number >= len(self.episodes):
            return None
        felt = self.episodes[number].felt
        if len(felt) != ticks * copies:
            raise ExperimentError(f"{self.path}: {len(felt)} moments where there were {ticks * copies}; delete it")
        return felt.reshape(ticks, copies, -1)

    def add(self, felt: FloatArray) -> None:
        """Keep (T, B, L) for good, with what else is new, if the last time is long ago."""
        self.episodes.append(Episode(felt.reshape(-1, felt.shape[-1])))
        if self.path is not None and time.perf_counter() - self.kept >= EVERY_S:
            save(Lived(tuple(self.episodes)), self.path, None, **self.told)
            self.kept = time.perf_counter()
