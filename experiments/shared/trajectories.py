"""What a run leaves of its movements: labelled arrays in NetCDF-4 for xarray, MATLAB and R, and a table for the rest.

Dimensions are `time` (ticks of the movement), `joint`, `attempt` (1, 2, ...) and `candidate` (actions that Eq. (1)
weighed). Joints are shown in the units of people, each joint's own in the coordinate `unit`.
"""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from babbling.axes import FloatArray, IntArray
from babbling.files import FORMAT, seal
from models.body import SimulatedBody

PEOPLES = {"rad": ("degree", 180 / np.pi), "m": ("mm", 1e3)}
"""Unit of a joint -> the one that people are shown, and how many of it that is."""
KIND = f"{FORMAT} trajectories"
NEVER = -1
"""Of yes (1) and no (0): there was no choice any more."""
TRIES = ("attempt", "time", "joint")
CHOICES = ("time", "joint", "candidate")

Track = tuple[tuple[str, ...], NDArray[Any], str, str]
"""Dimensions, values, unit, and what they are in words."""


def peoples(body: SimulatedBody) -> tuple[tuple[str, ...], FloatArray]:
    """(J,) the unit in which people are shown each joint, and (J,) how many of it are one of the body's own."""
    own = np.broadcast_to(body.senses["angle"].unit, len(body.joints))
    names, factors = zip(*(PEOPLES.get(str(unit), (str(unit), 1.0)) for unit in own), strict=True)
    return names, np.array(factors)


def labelled(
    joints: Sequence[str], units: Sequence[str], tick_s: float, tracks: Mapping[str, Track], **notes: Any
) -> xr.Dataset:
    """Tracks by name, their joints and times as coordinates; `notes` become the attributes of the whole."""
    arrays = {
        name: (dims, values, {"long_name": about} | ({"units": unit} if unit else {}))
        for name, (dims, values, unit, about) in tracks.items()
    }
    found = xr.Dataset(arrays, attrs={"format": KIND, "Conventions": "CF-1.11", **notes})
    coordinates = {
        "time": ("time", np.arange(found.sizes["time"]) * tick_s, {"units": "s", "long_name": "since the movement began"}),
        "joint": ("joint", np.array(joints, str), {"long_name": "name of the joint"}),
        "unit": ("joint", np.array(units, str), {"long_name": "in which this joint's numbers are"}),
    }
    if "attempt" in found.sizes:
        coordinates["attempt"] = ("attempt", np.arange(1, found.sizes["attempt"] + 1), {"long_name": "first, second ..."})
    return found.assign_coords(coordinates)


def trajectories(
    body: SimulatedBody,
    postures: Sequence[int],
    shown: Mapping[str, tuple[FloatArray, str]],
    attempts: Sequence[tuple[FloatArray, Mapping[str, NDArray[Any]]]],
    **notes: Any,
) -> xr.Dataset:
    """A movement, and how it was imitated.

    Args:
        body: who imitates.
        postures: (F,) sense line of each factor's posture.
        shown: (T, J) joint angles by name, and what they are in words; the first are the sub-goals.
        attempts: of each (T, J) true joint angles and the fields of `Info` through the time that there were any, 1 tick
            to T; the rest of it is not a number.
        notes: see `labelled`.
    """
    units, factor = peoples(body)
    count, labels = len(next(iter(shown.values()))[0]), [body.sense_labels[line] for line in postures]
    order = np.array([labels.index(joint) if joint in labels else -1 for joint in body.joints])
    whole, rate = (" and ".join(dict.fromkeys(f"{unit}{per}" for unit in units)) for per in ("", "/s"))

    def by_joint(values: NDArray[Any], scale: FloatArray | float = 1.0) -> NDArray[Any]:
        """(T, J, ...) of (t, F, ...): nothing where no choice was made, or babbling did not find the joint."""
        yes_or_no = values.dtype == bool
        found = np.full((count, len(order), *values.shape[2:]), NEVER if yes_or_no else np.nan, "i1" if yes_or_no else "f4")
        found[: len(values)] = np.where(
            (order < 0).reshape(-1, *(1 for _ in values.shape[2:])), found[: len(values)], values[:, order] * scale
        )
        return found

    def tries(values: Callable[[Mapping[str, NDArray[Any]]], NDArray[Any]], unit: str, about: str) -> Track:
        own = factor if unit in (whole, rate) else 1
        return TRIES, np.stack([by_joint(values(info), own) for _, info in attempts]), unit, about

    last = attempts[-1][1]
    tracks: dict[str, Track] = {
        name: (TRIES[1:], np.asarray(angles * factor, "f4"), whole, about) for name, (angles, about) in shown.items()
    }
    done = np.stack([angles * factor for angles, _ in attempts]).astype("f4")
    tracks |= {
        "imitated": (TRIES, done, whole, "true posture of the imitator"),
        "commanded": tries(lambda info: info["commands"][:, 0], whole, "commanded posture (efference copy)"),
        "believed": tries(lambda info: info["believed"][:, 0, :, 0], whole, "believed posture"),
        "believed_rate": tries(lambda info: info["believed"][:, 0, :, 1], rate, "believed rate"),
        "believed_bias": tries(lambda info: info["believed"][:, 0, :, 2], whole, "believed bias"),
        "origin": tries(lambda info: info["origin"][:, 0], whole, "posture from which actions are counted"),
        "entropy": tries(lambda info: info["entropy"][:, 0], "bit", "entropy of Eq. (1)'s posterior"),
        "evidence": tries(lambda info: info["evidence"][:, 0], "1", "evidence of Eq. (1), its normaliser"),
        "never_tried": tries(lambda info: info["familiarity"] < 1, "1", f"never tried here while babbling; {NEVER}: no choice"),
        "uninformed": tries(lambda info: info["uninformed"][:, 0], "1", f"asked beyond the table's axes; {NEVER}: no choice"),
        "action": (
            CHOICES,
            by_joint(last["candidates"], factor[:, None]).round(6),
            whole,
            "actions weighed in the last attempt: commanded posture less `origin`",
        ),
        "posterior": (
            CHOICES, by_joint(last["posterior"]).round(6), "1", "P(action) of Eq. (1) in the last attempt, to 6 decimals"
        ),
    }  # fmt: skip
    return labelled(body.joints, units, body.tick_s, tracks, **notes)


def left(found: xr.Dataset, *, csv: bool) -> dict[str, Callable[[Path], None]]:
    """Files of a result: name -> writer."""
    files: dict[str, Callable[[Path], None]] = {"trajectories.nc": lambda path: write(found, path)}
    return files | ({"trajectories.csv": lambda path: tidy(found, path)} if csv else {})


def write(found: xr.Dataset, path: Path) -> None:
    """NetCDF-4, packed; text as letters, which every reader knows."""
    packed = {name: {"zlib": True, "complevel": 4, "shuffle": True} for name in found.data_vars}
    text: dict[Any, Any] = {name: {"dtype": "S1"} for name in ("joint", "unit")}
    found.to_netcdf(path, engine="h5netcdf", encoding=packed | text)
    seal(path)


def tidy(found: xr.Dataset, path: Path) -> None:
    """A row for every attempt, time and joint; all but what has candidates."""
    table = found.drop_dims("candidate", errors="ignore")
    order = [dim for dim in ("sequence", *TRIES) if dim in table.sizes]
    table.to_dataframe(dim_order=order).to_csv(path, float_format="%.6g")
