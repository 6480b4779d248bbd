"""Body images on disk, like minds (`babbling.storage`): labelled numbers in NetCDF-4, no code."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from babbling.body_image import MOST_JOINTS, BodyImage, PartImage
from babbling.errors import BabblingError
from babbling.organs import Organs, empty_amounts
from babbling.storage import read_dataset, write_dataset

FORMAT, VERSION = "imitation-laboratory body image", 1
MOST_PARTS, MOST_POSTURES = 64, 1 << 16
_TABLES = {"low": ("factor",), "high": ("factor",), "rest": ("factor",), "library": ("posture", "factor"),
           "doubt": ("posture", "part")}  # fmt: skip


def save_image(image: BodyImage, path: Path, fingerprint: str, **notes: str | int | float) -> None:
    """Write a body image of the body with this fingerprint; `notes` become attributes of the file.

    Raises:
        BabblingError: the place cannot be written.
    """
    variables: dict[str, Any] = {name: (dims, getattr(image, name)) for name, dims in _TABLES.items()}
    variables["amounts"] = (("part", "motor", "amount"), image.organs.amounts.counts)
    variables["information"] = (("part", "factor"), image.organs.information)
    for part, one in image.images.items():
        variables[f"{part}_joints"] = ((f"{part}_joint",), one.joints)
        variables[f"{part}_centre"] = ((f"{part}_joint",), one.centre, {"units": "rad"})
        variables[f"{part}_weights"] = ((f"{part}_harmonic", "coordinate"), one.weights.reshape(-1, 3))
        variables[f"{part}_noise"] = ((), one.noise, {"units": "rad"})
    attributes: dict[str, Any] = {
        "format": FORMAT, "version": VERSION, "fingerprint": fingerprint, "minutes": image.minutes, **notes,
    }  # fmt: skip
    write_dataset(xr.Dataset(variables, coords={"part": list(image.parts)}, attrs=attributes), path)


def load_image(path: Path, fingerprint: str) -> BodyImage:
    """Read the body image of the body with this fingerprint.

    Raises:
        BabblingError: see `read_dataset`; another body's image; arrays missing, misshapen or not finite.
    """
    dataset = read_dataset(path, FORMAT, VERSION)
    found = dataset.attrs.get("fingerprint")
    if found != fingerprint:
        raise BabblingError(
            f"{path}: this is another body's image (fingerprint {found}, this body has {fingerprint}): the same robot, "
            "wear and scramble are needed; look into the mirror anew"
        )
    try:
        return _image(dataset)
    except (KeyError, ValueError, TypeError, IndexError) as error:
        raise BabblingError(f"{path}: its contents do not fit together ({error}); make it anew") from error


def _image(dataset: xr.Dataset) -> BodyImage:
    parts = tuple(str(part) for part in dataset["part"].to_numpy())
    factors = int(dataset["low"].size)
    if not 0 < len(parts) <= MOST_PARTS or dataset["library"].shape[0] > MOST_POSTURES:
        raise ValueError(f"{len(parts)} parts and {dataset['library'].shape[0]} postures")

    def array(name: str, *shape: int) -> Any:
        value = dataset[name].to_numpy().copy()
        if value.shape != shape or value.dtype.kind not in "fi" or not np.isfinite(value).all():
            raise ValueError(f"{name!r} is no finite table of shape {shape}")
        return value

    postures = int(dataset["library"].shape[0])
    sizes = {"factor": factors, "posture": postures, "part": len(parts)}
    tables = {name: array(name, *(sizes[dim] for dim in dims)) for name, dims in _TABLES.items()}
    model = empty_amounts(parts, factors)
    counts = array("amounts", *model.counts.shape)
    if counts.dtype != np.int64:
        raise ValueError("amounts are not counts")
    model.add(counts)
    images = {}
    for part in parts:
        joints = array(f"{part}_joints", dataset[f"{part}_joints"].size)
        count = len(joints)
        if not 0 < count <= MOST_JOINTS or joints.dtype.kind != "i" or (joints < 0).any() or (joints >= factors).any():
            raise ValueError(f"the {part} is moved by senses that do not exist")
        weights = array(f"{part}_weights", 3**count, 3).reshape(*(3,) * count, 3)
        images[part] = PartImage(joints, array(f"{part}_centre", count), weights, float(array(f"{part}_noise")))
    organs = Organs(model, array("information", len(parts), factors))
    return BodyImage(images, organs=organs, minutes=float(dataset.attrs["minutes"]), **tables)
