"""Shards of the battery: an adult, a ward of newborns' faces, a life; none depends on which of them came first."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from experiments.battery.acting import acting
from experiments.battery.films import Camera
from experiments.battery.gazes import gazes
from experiments.battery.life import Adult, Life, grown
from experiments.battery.movements import movements
from experiments.battery.table import Trial


@dataclass(frozen=True, eq=False)
class Shard:
    """Agents of one childhood, who differ in nothing but what comes after it, and whom they watch."""

    lives: tuple[Life, ...]
    adult: Adult | None
    """For stages with objects."""
    stages: tuple[str, ...]
    filmed: bool = False

    @property
    def label(self) -> str:
        """In words."""
        return f"agent {self.lives[0].agent} (seed {self.lives[0].seed})"


def lived(shard: Shard, camera: Camera) -> Iterator[Trial]:
    """All that these agents did."""
    lives = shard.lives
    if "gaze" in shard.stages:
        yield from gazes(lives, camera)
    if {"movements", "objects"} & set(shard.stages):
        who = grown(lives[0], camera)
        if "movements" in shard.stages:
            for row in movements(who, camera):  # nothing in them comes after childhood
                yield from (replace(row, agent=life.agent) for life in lives)
        if "objects" in shard.stages and shard.adult is not None:
            yield from acting(who, lives, shard.adult, camera)
