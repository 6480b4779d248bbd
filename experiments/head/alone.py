"""Head imitation without a teacher: nobody was found, or a memory is all there is."""

from typing import Any

import numpy as np

from babbling.files import load
from babbling.mind import Mind
from experiments.errors import ExperimentError
from experiments.head.figures import recalled
from experiments.head.options import Config
from experiments.head.recall import reproduce
from experiments.head.recording import record_recall, record_search
from experiments.shared.caregiver import Search
from experiments.shared.experiment import Result
from experiments.shared.judging import rmse_deg
from imitation.deferred import HeadMemory
from models.seeing_body import head_fingerprint, watching_body


def nobody(config: Config, looked: Search) -> Result:
    """A search that ended without a face: said clearly, nothing imitated."""
    where = ", ".join(f"{np.rad2deg(pan):.0f}" for pan in looked.pans)
    summary = (
        f"# {config.robot}: no face\n\nNo face was seen in {len(looked.pans)} looks ({where} degrees of pan) and "
        f"{looked.seconds:.1f} s; the search was given up (--search-s {config.search_s:g}). Nothing was imitated.\n"
    )
    metrics: dict[str, Any] = {
        "robot": config.robot,
        "face_found": False,
        "search_s_simulated": looked.seconds,
        "search_looks": len(looked.pans),
        **dict.fromkeys(("head_estimate_rmse_deg", "head_raw_estimate_rmse_deg", "head_reproduced_rmse_deg")),
    }
    return Result(metrics, summary, record=lambda path: record_search(path, looked, summary))


def from_memory(config: Config) -> Result:
    """Imitate from a memory file.

    Raises:
        BabblingError: a file that is none, or one of another body.
    """
    assert config.memory is not None
    memory = load(config.memory, HeadMemory)
    memory.check(head_fingerprint(config.robot, config.scramble))
    beside = config.memory.with_name("mind.nc")
    if not beside.exists():
        raise ExperimentError(f"--memory {config.memory}: its mind.nc must lie beside it; keep the run's folder whole")
    mind = load(beside, Mind)
    mind.check(watching_body(config.robot, scramble=config.scramble))
    imitated = reproduce(memory, mind, config.robot, config.selection, config.seed, config.scramble)
    away = rmse_deg(imitated, memory.pose)
    metrics: dict[str, Any] = {
        "robot": config.robot,
        "movement": memory.name,
        "deferred": True,
        "sequences": 1,
        "head_reproduced_against_memory_rmse_deg": away,
    }
    summary = (
        f"# {config.robot} imitates from memory\n\n{memory.name}, {len(memory.pose) * memory.tick_s:.1f} s, remembered "
        f"from {config.memory.name}: reproduced within {away:.3f} deg RMS of what was remembered.\n"
    )
    return Result(
        metrics,
        summary,
        {"recalled": recalled(memory, imitated)},
        lambda path: record_recall(path, config, memory, imitated, summary),
    )
