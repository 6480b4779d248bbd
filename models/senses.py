"""Senses as declared channels: a body says once what it feels; its sense lines, their ranges and names follow.

A channel is one kind of reading taken at one or several places: the angle of every joint, the place of every coloured
thing in both eyes, the load on every corner of a sole. Channels stand one after the other in the sense vector, or on
lines that an unknown wiring has permuted. Names are for bodies, experiments and people; a mind sees numbers and ranges.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arrays import FloatArray, IntArray
from models.errors import BodyError, unknown

Kind = Literal[
    "angle", "speed", "image position", "area", "place", "attitude", "velocity", "touch", "force", "torque", "load",
    "gyro", "accelerometer", "reading",
]  # fmt: skip


@dataclass(frozen=True)
class Channel:
    """Readings of one kind at places called `labels`, each an array over `parts`: (L, *parts) numbers.

    low, high, noise (a standard deviation) broadcast to that shape; pulses: an encoder's counts per unit, 0 for none.
    suffix: said after a label, where the label alone would be taken for another channel's.
    """

    name: str
    kind: Kind
    unit: str
    labels: tuple[str, ...]
    low: ArrayLike
    high: ArrayLike
    parts: tuple[tuple[str, ...], ...] = ()
    noise: ArrayLike = 0.0
    pulses: float = 0.0
    suffix: str = ""

    @property
    def shape(self) -> tuple[int, ...]:
        """(L, *parts)."""
        return len(self.labels), *map(len, self.parts)

    @property
    def names(self) -> tuple[str, ...]:
        """What each number is, in order."""
        parts = [""]
        for names in self.parts:
            parts = [f"{part} {name}" for part in parts for name in names]
        end = f" {self.suffix}" if self.suffix else ""
        return tuple(f"{label}{part}{end}" for label in self.labels for part in parts)

    def rows(self, labels: Sequence[str]) -> list[int]:
        """Where these labels stand.

        Raises:
            BodyError: there is no such label.
        """
        for label in labels:
            if label not in self.labels:
                raise BodyError(unknown(f"label of sense {self.name!r}", label, self.labels))
        return [self.labels.index(label) for label in labels]

    def only(self, labels: Sequence[str]) -> "Channel":
        """The channel of these labels alone."""
        rows = self.rows(labels)
        low, high, noise = (np.broadcast_to(v, self.shape)[rows] for v in (self.low, self.high, self.noise))
        return replace(self, labels=tuple(labels), low=low, high=high, noise=noise)

    def measured(self, true: FloatArray, rng: np.random.Generator) -> FloatArray:
        """What the sense reads of a true (..., L, *parts): with noise, in whole pulses."""
        noise = np.asarray(self.noise, float)
        if (noise > 0).any():
            true = true + noise * rng.standard_normal(true.shape)
        return np.rint(true * self.pulses) / self.pulses if self.pulses > 0 else true


class Senses:
    """The layout of a sense vector: channels one after the other, `order` saying which number stands on each line.

    Raises:
        BodyError: two channels of one name.
    """

    def __init__(self, channels: Sequence[Channel], order: IntArray | None = None) -> None:
        self.channels = {channel.name: channel for channel in channels}
        if len(self.channels) < len(channels):
            names = [channel.name for channel in channels]
            raise BodyError(f"sense channels {', '.join(names)}: each needs a name of its own")
        ends = np.cumsum([0, *(np.prod(channel.shape) for channel in channels)])
        self.order: IntArray = np.arange(ends[-1]) if order is None else order
        line_of = np.argsort(self.order)
        self._lines = {c.name: line_of[a:b] for c, a, b in zip(channels, ends[:-1], ends[1:], strict=True)}
        names = [name for channel in channels for name in channel.names]
        self.labels = tuple(names[i] for i in self.order)
        """(S,) what stands on each line."""
        self.low, self.high = (
            np.concatenate([np.broadcast_to(v, c.shape).ravel() for c, v in ends])[self.order].astype(float)
            for ends in ([(c, c.low) for c in channels], [(c, c.high) for c in channels])
        )

    def __len__(self) -> int:
        """S."""
        return len(self.order)

    def __getitem__(self, name: str) -> Channel:
        """The channel of this name.

        Raises:
            BodyError: there is none.
        """
        if name not in self.channels:
            raise BodyError(unknown("sense", name, self.channels))
        return self.channels[name]

    def lines(self, name: str, labels: Sequence[str] | None = None) -> IntArray:
        """(L, *parts) lines of a channel, or of some of its labels."""
        channel = self[name]
        lines = self._lines[name].reshape(channel.shape)
        return lines if labels is None else lines[channel.rows(labels)]

    def read(self, senses: FloatArray, name: str, labels: Sequence[str] | None = None) -> FloatArray:
        """(..., L, *parts) a channel's readings out of (..., S) senses, or those of some of its labels."""
        return np.take(senses, self.lines(name, labels), axis=-1)

    def vector(self, readings: Mapping[str, NDArray[Any]]) -> FloatArray:
        """(..., S) senses from (..., L, *parts) readings by channel; NaN where a channel is not given."""
        flat = {name: r.reshape(*r.shape[: r.ndim - len(self[name].shape)], -1) for name, r in readings.items()}
        senses = np.full((*next(iter(flat.values())).shape[:-1], len(self)), np.nan)
        for name, reading in flat.items():
            senses[..., self._lines[name]] = reading
        return senses


_XYZ = (("x", "y", "z"),)
_S = mujoco.mjtSensor
_WEIGHTS = 4.0
_SENSORS: Mapping[mujoco.mjtSensor, tuple[Kind, str, tuple[tuple[str, ...], ...], float]] = {
    _S.mjSENS_TOUCH: ("touch", "N", (), np.inf),
    _S.mjSENS_FORCE: ("force", "N", _XYZ, np.inf),
    _S.mjSENS_TORQUE: ("torque", "N m", _XYZ, np.inf),
    _S.mjSENS_ACTUATORFRC: ("load", "N m", (), np.inf),
    _S.mjSENS_JOINTACTFRC: ("load", "N m", (), np.inf),
    _S.mjSENS_GYRO: ("gyro", "rad/s", _XYZ, 10.0),
    _S.mjSENS_ACCELEROMETER: ("accelerometer", "m/s^2", _XYZ, 50.0),
    _S.mjSENS_VELOCIMETER: ("velocity", "m/s", _XYZ, 5.0),
    _S.mjSENS_FRAMELINVEL: ("velocity", "m/s", _XYZ, 5.0),
    _S.mjSENS_FRAMEANGVEL: ("gyro", "rad/s", _XYZ, 10.0),
    _S.mjSENS_FRAMEPOS: ("place", "m", _XYZ, 5.0),
    _S.mjSENS_FRAMEQUAT: ("attitude", "1", (("w", "x", "y", "z"),), 1.0),
    _S.mjSENS_FRAMEZAXIS: ("attitude", "1", _XYZ, 1.0),
}
"""Kind, unit, parts and, where the MJCF gives no cutoff, largest reading; infinite: 4 times the model's weight (and as
much at an arm of 1 m)."""


def sensor_channels(model: mujoco.MjModel, names: Sequence[str]) -> list[tuple[Channel, IntArray]]:
    """Channels of a model's <sensor> elements, and which columns of its sensor data each reads.

    Sensors of one kind make one channel, called like the MJCF's element, its labels their names; ranges are their
    `cutoff`, noise is their `noise`.

    Raises:
        BodyError: no such sensor, or one of a kind that no body has.
    """
    known = [model.sensor(i).name for i in range(model.nsensor)]
    groups: dict[mujoco.mjtSensor, list[int]] = {}
    for name in names:
        if name not in known:
            raise BodyError(unknown("sensor", name, known))
        groups.setdefault(_S(model.sensor_type[known.index(name)]), []).append(known.index(name))
    weight = float(model.body_subtreemass[0] * np.linalg.norm(model.opt.gravity))
    found = []
    for sort, ids in groups.items():
        element = sort.name.removeprefix("mjSENS_").lower()
        if sort not in _SENSORS:
            raise BodyError(f"sensor {known[ids[0]]!r}: a body does not feel a <{element}>")
        kind, unit, parts, largest = _SENSORS[sort]
        cutoff = model.sensor_cutoff[ids]
        high = np.where(cutoff > 0, cutoff, largest if np.isfinite(largest) else _WEIGHTS * weight)
        high, noise = (v.reshape(-1, *(1 for _ in parts)) for v in (high, model.sensor_noise[ids]))
        labels = tuple(known[i] for i in ids)
        columns = [np.arange(model.sensor_adr[i], model.sensor_adr[i] + model.sensor_dim[i]) for i in ids]
        channel = Channel(element, kind, unit, labels, 0.0 if kind == "touch" else -high, high, parts, noise)
        found.append((channel, np.array(columns).reshape(channel.shape)))
    return found


def numeric(model: mujoco.MjModel, name: str, default: float) -> float:
    """A number that an MJCF tells under `<custom>`, or else `default`."""
    identity = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_NUMERIC, name)
    return default if identity < 0 else float(model.numeric_data[model.numeric_adr[identity]])
