"""Options of `imitate reinforcement`."""

from importlib.util import find_spec
from typing import Annotated

from experiments.errors import ExperimentError
from experiments.shared.options import (
    BABBLING_MINUTES,
    BodyOptions,
    Demonstration,
    Minutes,
    N,
    WatchingOptions,
    choices,
    one_of,
    options,
    some,
    within,
    written,
)

PEERS = {"search": ("cma", "cma"), "residual": ("stable_baselines3", "stable-baselines3"),
         "nothing": ("stable_baselines3", "stable-baselines3")}  # fmt: skip
"""Who learns by reward, with the module and the package that each needs."""


@options
class Config(BodyOptions, WatchingOptions):
    """Options of `imitate reinforcement`."""

    demonstration: Demonstration = "icub-wave"
    """A built-in demonstration's name, or a file; see `imitate gesture`."""
    peers: Annotated[tuple[Annotated[str, one_of("peer", PEERS)], ...], some, written(f"{choices(PEERS)} ...")] = tuple(
        PEERS
    )
    """Who learns by reward: search (CMA-ES for gains, from direct replay), residual (PPO beside direct replay), nothing
    (PPO from nothing)."""
    seeds: Annotated[int, within(1, 1_000), N] = 3
    """How many of each learn: seeds --seed, --seed + 1 ..."""
    minutes: Minutes = 60.0
    """Body-minutes that each learner by reward has, over all its copies."""
    babbling_minutes: Minutes = BABBLING_MINUTES
    """Body-minutes of the imitator's babbling in all; its rehearsal is counted besides."""
    workers: Annotated[int, within(1, 64), N] = 2
    """Processes; the result does not depend on it."""


def must_be_there(config: Config) -> None:
    """Refuse peers whose package is not installed.

    Raises:
        ExperimentError: the first such one, and those that are possible.
    """
    able = [name for name, (module, _) in PEERS.items() if find_spec(module) is not None]
    for name in config.peers:
        if name not in able:
            other = f", or --peers {' '.join(able)}" if able else ""
            raise ExperimentError(
                f"--peers {name}: the package {PEERS[name][1]} is not installed; "
                f"pip install 'imitation-laboratory[reinforcement]'{other}"
            )
