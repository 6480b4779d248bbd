"""Bouts of one babble are had apart, in shards; what they teach is learned in their order.

A bout begins from rest and depends on (body, pilot, seed, its number) alone, so anybody can have it. Learning foretells
each bout before it counts it (`babbling.explanations`), with all that earlier ones taught: counts would add in any
order, what they foretold would not. So experience travels, and the same bytes come of any number of shards.
"""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

from babbling.axes import FloatArray
from babbling.loop import experience
from babbling.pilot import Pilot
from experiments.babble.options import Config
from experiments.shared.minds import Experiences, body_of
from experiments.shared.options import BodyOptions
from experiments.shared.parallel import in_order


class Shard(NamedTuple):
    """Bouts that follow each other."""

    options: BodyOptions
    copies: int
    found: Pilot
    ticks: Sequence[int]
    """Of each."""
    first: int
    """Number of the first."""

    @property
    def label(self) -> str:
        """For people."""
        return f"{self.options.robot}, bouts {self.first + 1} to {self.first + len(self.ticks)}"


def have(shard: Shard) -> list[tuple[FloatArray, FloatArray]]:
    """The `experience` of every bout of a shard."""
    body, felt = body_of(shard.options, shard.copies), []
    for bout, ticks in enumerate(shard.ticks, shard.first):
        body.reseed(1 + bout)
        felt.append(experience(body, shard.found, shard.options.seed, bout, ticks))
    return felt


def in_shards(config: Config, copies: int, found: Pilot, plan: tuple[int, ...], first: int) -> Experiences:
    """See `experiments.shared.minds.Elsewhere`."""
    edges = [max(first, number * len(plan) // config.shards) for number in range(config.shards + 1)]
    alone = replace(config, threads=1)
    shards = [Shard(alone, copies, found, plan[start:end], start) for start, end in pairwise(edges) if end > start]
    with closing(in_order(have, shards, config.workers, config.scheduler)) as everything:
        for felt in everything:
            yield from felt
