"""Options of `imitate benchmark`."""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any

from experiments.errors import ExperimentError
from experiments.shared.options import (
    BABBLING_MINUTES,
    DEMONSTRATION,
    BodyOptions,
    Demonstration,
    Flag,
    Minutes,
    N,
    WatchingOptions,
    choices,
    known,
    options,
    some,
    within,
    written,
)
from models.robots import find as find_robot

BODIES: Mapping[str, Mapping[str, Any]] = MappingProxyType({
    "ideal": {},
    "noisy": {"sensor_noise_deg": 0.2},
    "scrambled": {"scramble": 3},
    **{name: {"robot": f"hoap2-{name}"} for name in ("worn", "payload", "spring", "backlash", "hysteresis")},
})  # fmt: skip
"""What each is, besides HOAP-2."""
MODELS = (
    "average", "table", "replay", "inverse_line", "forward_line", "gaussian", "feature_line", "feature_line_forward",
    "mlp", "trees", "lqr", "average_without_table", "average_mean", "average_matching",
)  # fmt: skip
"""The imitator; its peers; and what of it is left without the table or with other rules of selection."""
PEERS, LEARNERS = MODELS[1:11], MODELS[8:10]
"""Peers; those that need scikit-learn (extra `peers`), and are left out without it."""
CURVE = ("average", "table", "inverse_line", "forward_line", "feature_line", "feature_line_forward")
"""Whom the learning curve shows."""


def _body(name: str) -> object:
    return BODIES[name] if name in BODIES else find_robot(name)


def _model(option: str, name: str) -> None:
    if name not in MODELS:
        raise ExperimentError(f"{option} {name}: unknown; possible: {', '.join(MODELS)}")


@options
class Config(WatchingOptions):
    """Options of `imitate benchmark`."""

    clips: Annotated[tuple[Demonstration, ...], some, written(f"{DEMONSTRATION} ...")] = (
        "icub-wave",
        "romeo-bow",
        "human-raise",
        "g1-squat",
    )
    """What to imitate: demonstrations that `imitate list` names, or files."""
    bodies: Annotated[tuple[Annotated[str, known(_body)], ...], some, written(f"{choices(BODIES)}|ROBOT ...")] = (
        "ideal",
        "worn",
    )
    """Bodies, HOAP-2's (noisy: by 0.2 degrees) or other robots."""
    seeds: Annotated[int, within(1, 1_000), N] = 2
    """How many minds of each body learn and imitate: seeds --seed, --seed + 1 ..."""
    models: Annotated[tuple[Annotated[str, _model], ...], some, written(f"{choices(MODELS)} ...")] = MODELS[:12]
    """Who imitates; average_mean and average_matching (other rules of selection) only when asked for."""
    babbling_minutes: Minutes = BABBLING_MINUTES
    """Body-minutes of babbling in all: over all copies, the pilot counted."""
    attempts: Annotated[int, within(1, 1_000), N] = 1
    """Attempts of the averaged model; from 5 on, the error of the fifth is told."""
    curve: Flag = False
    """Also errors after 0.3 to 100 body-minutes, on ideal and worn bodies: much longer."""
    keep: Annotated[Path | None, written("DIR", "they are not kept")] = None
    """Folder in which every life stays that was lived: other benchmarks with the same lives take them from there."""
    workers: Annotated[int, within(1, 64), N] = 2
    """Processes; the result does not depend on it."""
    peers: Flag = False
    """Also the maze's peers (pgmpy, pymdp) where they are installed."""


def body_options(name: str, seed: int) -> BodyOptions:
    """A body of one seed; one thread each."""
    return BodyOptions(seed=seed, threads=1, **BODIES.get(name, {"robot": name}))
