"""What a run leaves of its movements: labelled arrays in NetCDF-4 for xarray, MATLAB and R, and a table for the rest.

Dimensions are `time` (ticks of the movement), `joint`, `attempt` (1, 2, ...) and `candidate` (actions that Eq. (1)
weighed). Joints are shown in the units of people, each joint's own in the coordinate `unit`.
"""

import io
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from babbling.axes import FloatArray, IntArray
from babbling.files import FORMAT, sealed
from models.body import SimulatedBody

if TYPE_CHECKING:
    import xarray as xr

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
    names, factors = zip(*(PEOPLES[unit] for unit in body.units), strict=True)
    return names, np.array(factors)


def labelled(
    joints: Sequence[str], units: Sequence[str], tick_s: float, tracks: Mapping[str, Track], **notes: Any
) -> "xr.Dataset":
    """Tracks by name, their joints and times as coordinates; `notes` become the attributes of the whole."""
    arrays = {
        name: (dims, values, {"long_name": about} | ({"units": unit} if unit else {}))
        for name, (dims, values, unit, about) in tracks.items()
    }
    import xarray as xr  # takes a second to load

    found = xr.Dataset(arrays, attrs={"format": KIND, "Conventions": "CF-1.11", **notes})
    coordinates = {
        "time": ("time", np.arange(found.sizes["time"]) * tick_s, {"units": "s", "long_name": "since it began"}),
        "joint": ("joint", np.array(joints, str), {"long_name": "name of the joint"}),
        "unit": ("joint", np.array(units, str), {"long_name": "in which this joint's numbers are"}),
    }
    coordinates["attempt"] = ("attempt", np.arange(1, found.sizes["attempt"] + 1), {"long_name": "first, second ..."})
    return found.assign_coords(coordinates)


def trajectories(
    body: SimulatedBody,
    order: IntArray,
    shown: Mapping[str, tuple[FloatArray, str]],
    attempts: Sequence[tuple[FloatArray, Mapping[str, NDArray[Any]]]],
    **notes: Any,
) -> "xr.Dataset":
    """A movement, and how it was imitated.

    Args:
        body: who imitates.
        order: (J,) factor of each joint, -1 where babbling found none.
        shown: (T, J) joint angles by name, and what they are in words; the first are the sub-goals.
        attempts: of each (T, J) true joint angles and the fields of `Info` through the time that there were any, 1 tick
            to T; the rest of it is not a number.
        notes: see `labelled`.
    """
    units, factor = peoples(body)
    posture, rate = (" and ".join(dict.fromkeys(f"{unit}{per}" for unit in units)) for per in ("", "/s"))
    count = len(next(iter(shown.values()))[0])

    def by_joint(values: NDArray[Any], scale: FloatArray | float = 1.0) -> NDArray[Any]:
        """(T, J, ...) of (t, F, ...): nothing where no choice was made, or babbling did not find the joint."""
        fill, kind = (NEVER, "i1") if values.dtype == bool else (np.nan, "f4")
        found = np.full((count, len(order), *values.shape[2:]), fill, kind)
        found[: len(values), order >= 0] = (values[:, order] * scale)[:, order >= 0]
        return found

    def tries(name: str, about: str, unit: str = "1", which: int = 0) -> Track:
        """A field of every attempt: of copy 0, and if there are several numbers of each joint, this one."""
        each = [info[name][:, 0] for _, info in attempts]
        scale = factor if unit in (posture, rate) else 1.0
        values = [by_joint(one[..., which] if one.ndim == 3 else one, scale) for one in each]
        return TRIES, np.stack(values), unit, about

    last, no_choice = attempts[-1][1], f"; {NEVER}: there was no choice"
    untried = np.stack([by_joint(info["familiarity"] < 1) for _, info in attempts])
    tracks: dict[str, Track] = {
        name: (TRIES[1:], (angles * factor).astype("f4"), posture, about) for name, (angles, about) in shown.items()
    }
    imitated = np.stack([angles * factor for angles, _ in attempts]).astype("f4")
    tracks |= {
        "imitated": (TRIES, imitated, posture, "true posture of the imitator"),
        "commanded": tries("commands", "commanded posture (efference copy)", posture),
        "believed": tries("believed", "believed posture", posture, 0),
        "believed_rate": tries("believed", "believed rate", rate, 1),
        "believed_bias": tries("believed", "believed bias", posture, 2),
        "origin": tries("origin", "posture from which actions are counted", posture),
        "entropy": tries("entropy", "entropy of the posterior of Eq. (1)", "bit"),
        "evidence": tries("evidence", "evidence of Eq. (1), its normaliser"),
        "never_tried": (TRIES, untried, "1", f"action never tried here while babbling{no_choice}"),
        "uninformed": tries("uninformed", f"asked beyond the axes of the table{no_choice}"),
    }
    actions, probable = by_joint(last["candidates"], factor[:, None]), by_joint(last["posterior"])
    about = "actions weighed in the last attempt: commanded posture less `origin`"
    tracks["action"] = (CHOICES, actions.round(5), posture, about)
    tracks["posterior"] = (CHOICES, probable.round(5), "1", "P(action) of Eq. (1) in the last attempt, to 5 decimals")
    return labelled(body.joints, units, body.tick_s, tracks, **notes)


def left(found: "xr.Dataset", *, csv: bool) -> dict[str, Callable[[Path], None]]:
    """Files of a result: name -> writer."""
    files: dict[str, Callable[[Path], None]] = {"trajectories.nc": lambda path: write(found, path)}
    return files | ({"trajectories.csv": lambda path: tidy(found, path)} if csv else {})


def write(found: "xr.Dataset", path: Path) -> None:
    """NetCDF-4, packed; text as letters, which every reader knows."""
    packed = {name: {"zlib": True, "complevel": 4, "shuffle": True} for name in found.data_vars}
    text: dict[Any, Any] = {name: {"dtype": "S1"} for name in ("joint", "unit")}
    content = io.BytesIO()  # HDF5 dies of a full disk
    found.to_netcdf(content, engine="h5netcdf", encoding=packed | text)
    path.write_bytes(sealed(content.getbuffer()))


def tidy(found: "xr.Dataset", path: Path) -> None:
    """A row for every attempt, time and joint; all but what has candidates."""
    table = found.drop_dims("candidate", errors="ignore")
    table.to_dataframe(dim_order=[*TRIES]).to_csv(path, float_format="%.6g")
