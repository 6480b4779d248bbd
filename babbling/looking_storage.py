"""What a babbler learned of looking, on disk: the same kind of file as other minds (`babbling.storage`)."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from babbling.axes import Axis
from babbling.errors import BabblingError
from babbling.looking import LookingPilot, Reach, Retina, copy_terms
from babbling.schema import BodySchema
from babbling.sight import LookingMind
from babbling.storage import LARGEST_CELLS, read_dataset, write_dataset

FORMAT, VERSION = "imitation-laboratory eyes", 2
_PILOT = {"centre": "coordinate", "half": "coordinate", "low": "motor", "high": "motor", "largest": "motor",
          "posture": "motor", "offset": "motor", "slope": "motor", "noise": "motor"}  # fmt: skip


def save_looking(mind: LookingMind, path: Path, **notes: str | int | float) -> None:
    """Write what was learned of looking; `notes` become attributes of the file.

    Raises:
        BabblingError: the place cannot be written.
    """
    pilot, model = mind.pilot, mind.forward_model
    held = {**pilot.retina._asdict(), **vars(pilot.reach), **vars(pilot.schema)}
    variables: dict[str, Any] = {name: ((dim,), held[name]) for name, dim in _PILOT.items()}
    variables |= {
        "counts": (("factor", "u", "v", "other", "action", "outcome"), model.counts),
        "moments": (("factor", "channel", "channel_"), model.moments.sums),
        "outside": (("factor",), model.outside),
        "information": (("motor", "sense"), pilot.schema.information),
        "efference_copy": (("factor", "term"), pilot.line),
        "outcome_high": (("factor",), pilot.outcome.high, {"units": pilot.outcome.unit}),
    }
    attributes = {
        "format": FORMAT, "version": VERSION, "fingerprint": pilot.fingerprint, "minutes": mind.minutes,
        "pilot_minutes": pilot.minutes, "first": pilot.retina.first, **notes,
    }  # fmt: skip
    dataset = xr.Dataset(variables, coords={"factor": list(model.factors)}, attrs=attributes)
    write_dataset(dataset, path, compressed=("counts",))


def load_looking(path: Path) -> LookingMind:
    """Read what was learned of looking.

    Raises:
        BabblingError: see `babbling.storage.read_dataset`; or contents that do not fit together.
    """
    dataset = read_dataset(path, FORMAT, VERSION)
    try:
        return _mind(dataset)
    except (KeyError, ValueError, TypeError, IndexError) as error:
        raise BabblingError(f"{path}: its contents do not fit together ({error}); babble anew") from error


def _mind(dataset: xr.Dataset) -> LookingMind:
    def array(name: str) -> Any:
        value = dataset[name].to_numpy().copy()
        if value.dtype.kind not in "fi" or not np.isfinite(value).all():
            raise ValueError(f"{name!r} holds other things than finite numbers")
        return value

    held = {name: array(name) for name in _PILOT}
    coordinates, motors = len(held["centre"]), len(held["low"])
    if (
        motors != 2
        or coordinates not in (2, 4)
        or any(held[n].shape != held[_first(d)].shape for n, d in _PILOT.items())
    ):
        raise ValueError("two motors and one or two eyes were expected")
    line, high = array("efference_copy"), array("outcome_high")
    terms = copy_terms(*np.zeros((2 + motors, 1))).shape[-1]
    if line.shape != (motors * coordinates, terms) or high.shape != (len(line),):
        raise ValueError("the efference copy has another shape")
    first = int(dataset.attrs["first"])
    if not ((0 <= held["posture"]) & (held["posture"] < first)).all():
        raise ValueError("a sense line that does not exist")
    counts = dataset["counts"]
    if counts.ndim != 6 or counts.dtype != np.int64 or counts.size > LARGEST_CELLS or int(counts.min()) < 0:
        raise ValueError("counts must be a bounded table of whole numbers from 0")
    none = np.zeros(0)
    pilot = LookingPilot(
        Retina(first, coordinates, held["centre"], held["half"]),
        Reach(held["low"], held["high"], held["largest"]),
        BodySchema(
            held["posture"],
            none.astype(np.int64),
            held["offset"],
            held["slope"],
            held["noise"],
            none,
            array("information"),
        ),
        line,
        Axis("outcome", "px", -high, high, counts.shape[-1]),
        str(dataset.attrs["fingerprint"]),
        float(dataset.attrs["pilot_minutes"]),
    )
    model = pilot.forward_model()
    moments, outside = array("moments"), array("outside")
    if counts.shape != model.counts.shape or moments.shape != model.moments.sums.shape or outside.shape != high.shape:
        raise ValueError("counts of another shape")
    model.counts[:], model.moments.sums[:], model.outside[:] = counts.to_numpy(), moments, outside
    return LookingMind(pilot, model, float(dataset.attrs["minutes"]))


def _first(dim: str) -> str:
    return "centre" if dim == "coordinate" else "low"
