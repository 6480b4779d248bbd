"""Minds on disk: labelled arrays in NetCDF-4 (xarray through h5netcdf), which MATLAB, R and Julia open too.

A file holds numbers and labels, never code. It is written beside its name and renamed, so that it is whole or absent.
`format`, `version` and `fingerprint` are checked on the way in; sizes are bounded before anything is read.
"""

import os
import warnings
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from babbling.axes import Axis
from babbling.dynamics import LinearDynamics
from babbling.errors import BabblingError
from babbling.exploration import MotorRange
from babbling.forward_model import ForwardModel
from babbling.mind import Mind, Temper
from babbling.pilot import Pilot
from babbling.schema import BodySchema

FORMAT, VERSION = "imitation-laboratory mind", 1
LARGEST_BYTES = 1 << 30
LARGEST_CELLS = 1 << 28
LARGEST_UNPACKED = 1 << 32
LEAST_EXPERIENCE = 10
"""Transitions per factor below which no line can be fitted."""
_DYNAMICS = {
    "transition": (3, 3), "control": (3,), "offset": (3,), "noise": (3, 3), "bias_variance": (), "coasting": (),
}  # fmt: skip
_DIMS = {
    "posture": ("factor",), "rate": ("factor",), "offset": ("factor",), "slope": ("factor",), "noise": ("factor",),
    "rate_noise": ("factor",), "information": ("factor", "sense"),
}  # fmt: skip


def save_mind(mind: Mind, path: Path, **notes: str | int | float) -> None:
    """Write a mind; `notes` become attributes of the file.

    Raises:
        BabblingError: the place cannot be written.
    """
    model, pilot = mind.forward_model, mind.pilot
    variables: dict[str, Any] = {
        "counts": (("factor", "rate_bin", "action_bin", "outcome_bin"), model.counts),
        "moments": (("factor", "channel", "channel_"), model.moments.sums),
        "outside": (("factor",), model.outside),
        "coasting": (("factor",), pilot.coasting),
        "eagerness": (("factor",), mind.temper.eagerness),
        "habit": (("factor",), mind.temper.habit),
    }
    for name, dims in _DIMS.items():
        variables[f"schema_{name}"] = (dims, getattr(pilot.schema, name))
    for field in fields(MotorRange):
        variables[f"motor_{field.name}"] = (("factor",), getattr(pilot.motors, field.name))
    for name, value in pilot.dynamics._asdict().items():
        variables[f"dynamics_{name}"] = (("factor", "state", "state_")[: value.ndim], value)
    for axis in model.axes:
        variables[f"{axis.name}_low"] = (("factor",), axis.low, {"units": axis.unit})
        variables[f"{axis.name}_high"] = (("factor",), axis.high, {"units": axis.unit})
    attributes: dict[str, Any] = {
        "format": FORMAT, "version": VERSION, "fingerprint": mind.fingerprint, "seed": mind.seed,
        "pilot_minutes": pilot.minutes, "prior_strength": model.prior_strength, "unit": model.unit, **notes,
    }  # fmt: skip
    dataset = xr.Dataset(variables, coords={"factor": list(model.factors)}, attrs=attributes)
    write_dataset(dataset, path, compressed=("counts",))


def write_dataset(dataset: xr.Dataset, path: Path, compressed: tuple[str, ...] = ()) -> None:
    """NetCDF-4, written beside and renamed.

    Raises:
        BabblingError: the place cannot be written.
    """
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        dataset.to_netcdf(
            beside, engine="h5netcdf", encoding={name: {"zlib": True, "complevel": 3} for name in compressed}
        )
        os.replace(beside, path)
    except OSError as error:
        raise BabblingError(f"{path}: cannot be written ({error.strerror or error}); name a place that can") from error
    finally:
        with suppress(OSError):
            beside.unlink(missing_ok=True)


def read_dataset(path: Path, kind: str, version: int) -> xr.Dataset:
    """A NetCDF file of ours, after checking size, format and version.

    Raises:
        BabblingError: missing, a directory, too large, truncated, of another kind, or newer than this program.
    """
    if not path.exists():
        raise BabblingError(f"{path}: there is no such file")
    if path.is_dir():
        raise BabblingError(f"{path}: this is a directory; name the file in it")
    if path.stat().st_size > LARGEST_BYTES:
        raise BabblingError(f"{path}: {path.stat().st_size} bytes; more than {LARGEST_BYTES} are not read")
    try:
        found, unpacked = _header(path)
    except (OSError, RuntimeError, ValueError, KeyError, TypeError) as error:  # whatever h5py finds damaged
        raise BabblingError(
            f"{path}: not a readable NetCDF-4 file (truncated, or something else); make it anew"
        ) from error
    if found != kind:
        raise BabblingError(f"{path}: this is not a file of kind {kind!r}; make one with `imitate babble`")
    if unpacked > LARGEST_UNPACKED:
        raise BabblingError(f"{path}: unpacks to {unpacked} bytes; more than {LARGEST_UNPACKED} are not read")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what matters is checked; a stranger's file is not to talk to the user
            dataset = xr.load_dataset(path, engine="h5netcdf")
    except Exception as error:  # h5py, h5netcdf and xarray raise many kinds on damaged files
        raise BabblingError(f"{path}: this NetCDF-4 file is damaged; make it anew") from error
    found = dataset.attrs.get("version")
    if not isinstance(found, int | np.integer) or found > version:
        raise BabblingError(
            f"{path}: written in version {found}, this program reads up to {version}; update the program"
        )
    return dataset


def check_kind(path: Path) -> None:
    """Look whether a file is a mind, by its header alone.

    Raises:
        BabblingError: it is something else.
    """
    try:
        found, _ = _header(path)
    except (OSError, RuntimeError, ValueError, KeyError, TypeError):
        found = None
    if found != FORMAT:
        raise BabblingError(f"{path}: this is no forward model and would be lost; choose another name")


def _header(path: Path) -> tuple[object, int]:
    """What a file says it is, and how many bytes its arrays unpack to; the arrays themselves stay unread."""
    with h5py.File(path, "r") as file:
        sizes: list[int] = []

        def note(_: str, item: object) -> None:
            if isinstance(item, h5py.Dataset):
                sizes.append(int(item.size or 0) * item.dtype.itemsize)

        file.visititems(note)
        found = file.attrs.get("format")
        return found.decode() if isinstance(found, bytes) else found, sum(sizes)


def load_mind(path: Path) -> tuple[Mind, Mapping[str, Any]]:
    """Read a mind and its notes.

    Raises:
        BabblingError: see `read_dataset`; or a file whose arrays are missing, misshapen or not finite.
    """
    dataset = read_dataset(path, FORMAT, VERSION)
    try:
        return _mind(dataset), dict(dataset.attrs)
    except (KeyError, ValueError, TypeError, IndexError) as error:
        raise BabblingError(f"{path}: its contents do not fit together ({error}); babble anew") from error


def _mind(dataset: xr.Dataset) -> Mind:
    counts = dataset["counts"]
    if counts.ndim != 4 or counts.dtype != np.int64 or counts.size > LARGEST_CELLS or int(counts.min()) < 0:
        raise ValueError("counts must be a bounded (factor, rate, action, outcome) table of non-negative integers")
    factors = counts.shape[0]

    def array(name: str, *each: int) -> Any:
        value = dataset[name].to_numpy().copy()
        if value.shape != (factors, *each) or value.dtype.kind not in "fi" or not np.isfinite(value).all():
            raise ValueError(f"{name!r} is not {factors} rows of {each} finite numbers")
        return value

    sizes = dict(zip(("rate", "action", "outcome"), counts.shape[1:], strict=True))
    axes = {
        name: Axis(name, str(dataset[f"{name}_low"].attrs["units"]), array(f"{name}_low"), array(f"{name}_high"), size)
        for name, size in sizes.items()
    }
    senses = int(dataset["schema_information"].shape[1])
    schema = BodySchema(**{name: array(f"schema_{name}", *(senses,) * (len(dims) - 1)) for name, dims in _DIMS.items()})
    if (schema.slope == 0).any() or (schema.noise <= 0).any() or (schema.rate_noise <= 0).any():
        raise ValueError("a motor that does nothing, or a sense without any noise")
    for lines in (schema.posture, schema.rate):
        if lines.dtype.kind != "i" or (lines < 0).any() or (lines >= senses).any():
            raise ValueError("a sense line that does not exist")
    pilot = Pilot(
        schema=schema,
        motors=MotorRange(**{field.name: array(f"motor_{field.name}") for field in fields(MotorRange)}),
        coasting=array("coasting"),
        dynamics=LinearDynamics(**{name: array(f"dynamics_{name}", *more) for name, more in _DYNAMICS.items()}),
        **axes,
        minutes=float(dataset.attrs["pilot_minutes"]),
    )
    model = ForwardModel(
        (pilot.rate,), pilot.action, pilot.outcome,
        factors=[str(label) for label in dataset["factor"].to_numpy()],
        prior_strength=float(dataset.attrs["prior_strength"]),
    )  # fmt: skip
    if model.unit != int(dataset.attrs["unit"]):
        raise ValueError("counts of another unit")
    model.counts[:], model.outside[:] = counts.to_numpy(), array("outside")
    model.moments.sums[:] = array("moments", *model.moments.sums.shape[1:])
    if (model.moments.samples < LEAST_EXPERIENCE).any():
        raise ValueError("next to no experience")
    temper = Temper(array("eagerness"), array("habit"))
    return Mind(str(dataset.attrs["fingerprint"]), int(dataset.attrs["seed"]), pilot, model, temper)
