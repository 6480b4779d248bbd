"""A watched head movement as a file: what lasts until another day (deferred imitation; Meltzoff 1988)."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from babbling.axes import FloatArray
from babbling.storage import read_dataset, write_dataset
from imitation.errors import ImitationError

FORMAT, VERSION = "imitation-laboratory head movement", 1
LONGEST = 100_000
"""Ticks of a movement that are believed."""


@dataclass(frozen=True, eq=False)
class HeadMemory:
    """States s_1 .. s_N of somebody's head, in terms of one's own."""

    body: str
    """Fingerprint of the body in whose terms they are."""
    tick_s: float
    name: str
    pose: FloatArray
    """(T, 2) pan and tilt, rad."""
    deviation: FloatArray
    """(T, 2) how surely they were seen, rad."""

    def check(self, fingerprint: str) -> None:
        """Refuse to act on somebody else's memory.

        Raises:
            ImitationError: it belongs to another body.
        """
        if self.body != fingerprint:
            raise ImitationError(
                f"this memory belongs to another body (fingerprint {self.body}, this body has {fingerprint}); "
                "give the robot that watched"
            )


def save_head_memory(memory: HeadMemory, path: Path) -> None:
    """Write a memory: beside, then renamed."""
    variables = {
        "pose": (("tick", "axis"), memory.pose, {"units": "rad"}),
        "deviation": (("tick", "axis"), memory.deviation, {"units": "rad"}),
    }
    attributes = {"format": FORMAT, "version": VERSION, "fingerprint": memory.body, "tick_s": memory.tick_s,
                  "name": memory.name}  # fmt: skip
    write_dataset(xr.Dataset(variables, coords={"axis": ["pan", "tilt"]}, attrs=attributes), path)


def load_head_memory(path: Path) -> HeadMemory:
    """Read a memory back; nothing in it is believed before it is checked.

    Raises:
        BabblingError: no such file, or another kind of file.
        ImitationError: numbers that cannot be.
    """
    data = read_dataset(path, FORMAT, VERSION)
    try:
        pose, deviation = data["pose"].to_numpy().copy(), data["deviation"].to_numpy().copy()
        tick, name, body = float(data.attrs["tick_s"]), str(data.attrs["name"]), str(data.attrs["fingerprint"])
    except (KeyError, ValueError, TypeError) as error:
        raise ImitationError(f"{path}: not a memory of a head movement ({error}); watch anew") from error
    fits = pose.ndim == 2 and pose.shape[1:] == (2,) and deviation.shape == pose.shape and 3 <= len(pose) <= LONGEST
    if not fits or pose.dtype.kind != "f" or not (np.isfinite(pose).all() and np.isfinite(deviation).all()):
        raise ImitationError(f"{path}: its arrays are not a movement of 3 to {LONGEST} postures; watch anew")
    if np.abs(pose).max() > np.pi or not 1e-3 <= tick <= 1.0:
        raise ImitationError(f"{path}: angles beyond half a turn or a tick of {tick:g} s; it was changed")
    return HeadMemory(body, tick, name[:80], pose, deviation)
