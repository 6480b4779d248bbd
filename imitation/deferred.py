"""Memory as a file: what was felt and what was seen, kept for imitation at another time in another process.

Infants imitate after a day or a week what they have only watched (Meltzoff 1988; chapter, section 2.2). What has to
last is small: the counts of one's own babbling and the demonstrations. The file is NetCDF: labelled arrays, no code.
"""

import os
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from babbling.axes import IntArray
from babbling.forward_model import ForwardModel
from imitation.episodes import Episode, check_range
from imitation.errors import ImitationError

LARGEST = 1 << 26
"""Bytes of a memory file, and numbers in it, that are believed."""

FORMAT = "imitation-memory-1"


@dataclass(frozen=True, eq=False)
class Memory:
    """What lasts."""

    body: str
    """Fingerprint of the body that babbled and of the world in which it watched."""
    counts: IntArray
    """(F, A, O) outcomes counted while babbling (in units of one visit)."""
    episodes: tuple[Episode, ...]
    """What was watched."""

    def recall_onto(self, forward_model: ForwardModel) -> ForwardModel:
        """Put the counts back onto a forward model that has learned nothing yet.

        Raises:
            BabblingError: another body, or counts of another shape.
        """
        if forward_model.provenance.get("body") != self.body:
            raise ImitationError(
                f"this memory belongs to body {self.body}, not to {forward_model.provenance.get('body')}; "
                "recall it in the maze it was made in"
            )
        forward_model.add(self.counts)
        return forward_model


def remember(forward_model: ForwardModel, episodes: Sequence[Episode]) -> Memory:
    """What lasts of a babbling and a watching."""
    return Memory(
        str(forward_model.provenance.get("body", "")), forward_model.counts // forward_model.unit, tuple(episodes)
    )


def save_memory(memory: Memory, path: Path) -> None:
    """Write a memory: beside, then renamed."""
    lengths = np.array([e.steps for e in memory.episodes], np.int64)
    data = xr.Dataset(
        {
            "counts": (("factor", "action", "outcome"), memory.counts),
            "goal": (("demonstration",), np.array([e.goal for e in memory.episodes], np.int64)),
            "steps": (("demonstration",), lengths),
            "state": (("visit",), _joined([e.states for e in memory.episodes])),
            "did": (("step",), _joined([e.actions for e in memory.episodes])),
        },
        attrs={"format": FORMAT, "body": memory.body},
    )
    beside = Path(tempfile.mkdtemp(prefix=f".{path.name}-", dir=path.parent)) / path.name
    try:
        data.to_netcdf(beside, engine="h5netcdf")
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)
        beside.parent.rmdir()


def load_memory(path: Path, *, goals: int, states: int) -> Memory:
    """Read a memory back; nothing in it is believed before it is checked.

    Args:
        path: the file.
        goals: how many goals exist.
        states: how many states exist.

    Raises:
        ImitationError: no such file, not a memory, too large, or numbers that cannot be.
    """
    try:
        size = path.stat().st_size
    except OSError as error:
        raise ImitationError(f"{path}: cannot be read ({error.strerror}); give a memory that a run has left") from None
    if size > LARGEST:
        raise ImitationError(f"{path}: {size} bytes; a memory has at most {LARGEST}")
    try:
        with xr.open_dataset(path, engine="h5netcdf") as data:
            if data.attrs.get("format") != FORMAT:
                raise ImitationError(f"{path}: not a memory of this kind (format {data.attrs.get('format')!r})")
            if sum(int(v.size) for v in data.variables.values()) > LARGEST:
                raise ImitationError(f"{path}: more than {LARGEST} numbers; a memory has fewer")
            body = str(data.attrs.get("body"))
            read = {name: _integers(data[name].values) for name in ("counts", "goal", "steps", "state", "did")}
    except (OSError, KeyError, ValueError, RuntimeError) as error:
        if isinstance(error, ImitationError):
            raise
        raise ImitationError(f"{path}: not a memory ({type(error).__name__}: {str(error).splitlines()[0]})") from None
    counts, steps, state, did = read["counts"], read["steps"], read["state"], read["did"]
    fits = counts.ndim == 3 and steps.ndim == state.ndim == did.ndim == 1 and read["goal"].shape == steps.shape
    if not fits or steps.sum() != len(did) or (steps + 1).sum() != len(state) or counts.sum() > LARGEST:
        raise ImitationError(f"{path}: its arrays do not fit each other; it was not written by a run, or was changed")
    episodes = []
    for i, n in enumerate(steps):
        visit, step = int((steps[:i] + 1).sum()), int(steps[:i].sum())
        episodes.append(Episode(int(read["goal"][i]), state[visit : visit + n + 1], did[step : step + n]))
    check_range(episodes, goals, states, counts.shape[1])
    return Memory(body, counts, tuple(episodes))


def _joined(arrays: list[IntArray]) -> IntArray:
    return np.concatenate([np.zeros(0, np.int64), *arrays])


def _integers(values: NDArray[np.generic]) -> IntArray:
    if values.dtype.kind not in "iu" or (values.size and int(values.min()) < 0):
        raise ImitationError("a memory holds whole numbers from 0; this file does not")
    return values.astype(np.int64)
