"""A movement in joint angles: what every reader of motion files gives and every body can be asked to do."""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from models.arrays import BoolArray, FloatArray
from models.errors import BodyError, unknown

MIN_FRAMES = 3
"""Two frames are a jump; three are the least that has a velocity and an acceleration."""
MAX_FRAMES = 1_000_000
RANGE_TOLERANCE = 1e-4
"""Radians beyond a range that are taken for rounding (an encoder pulse of HOAP-2 is 8e-5 rad)."""


@dataclass(frozen=True, eq=False)
class JointTrajectory:
    """Joint angles through time.

    name: what people call the movement.
    time: (T,) seconds, strictly increasing from 0, T >= 3; need not be evenly spaced.
    joints: J distinct joint names.
    angles: (T, J) radians (metres of what slides), finite.
    The arrays are copied and read-only. A value that breaks this raises BodyError.
    """

    name: str
    time: FloatArray
    joints: tuple[str, ...]
    angles: FloatArray

    def __post_init__(self) -> None:
        time = np.array(self.time, dtype=float)
        angles = np.array(self.angles, dtype=float)
        joints = tuple(self.joints)
        for joint, times in Counter(joints).most_common(1):
            if times > 1:
                raise BodyError(f"{self.name}: joint {joint!r} appears twice; name each joint once")
        if time.ndim != 1 or angles.shape != (len(time), len(joints)):
            raise BodyError(
                f"{self.name}: time has shape {time.shape}, angles {angles.shape} and there are {len(joints)} joint "
                "names; they must be (T,), (T, J) and J"
            )
        if not joints:
            raise BodyError(f"{self.name}: names no joint; there must be at least one besides time")
        if len(time) < MIN_FRAMES:
            raise BodyError(f"{self.name}: has {len(time)} frames; a movement needs at least {MIN_FRAMES}")
        if not np.isfinite(time).all():
            raise BodyError(f"{self.name}: time of frame {_first(~np.isfinite(time))} is not a finite number")
        if not np.isfinite(angles).all():
            frame, joint = np.argwhere(~np.isfinite(angles))[0]
            raise BodyError(f"{self.name}: frame {frame + 1}, joint {joints[joint]!r} is not a finite number")
        if (np.diff(time) <= 0).any():
            frame = _first(np.diff(time) <= 0)
            raise BodyError(
                f"{self.name}: time does not increase from frame {frame} ({time[frame - 1]:g} s) to frame "
                f"{frame + 1} ({time[frame]:g} s); put the frames in order"
            )
        time -= time[0]
        time.setflags(write=False)
        angles.setflags(write=False)
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "angles", angles)
        object.__setattr__(self, "joints", joints)

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return float(self.time[-1])

    def resampled(self, dt: float) -> "JointTrajectory":
        """The movement at 0, dt, 2 dt ... seconds by the not-a-knot cubic spline through all frames.

        Position, velocity and acceleration are continuous. A spline may swing beyond sharp corners of its frames.
        """
        time = frame_times(self.duration, dt, self.name)
        return JointTrajectory(self.name, time, self.joints, CubicSpline(self.time, self.angles, axis=0)(time))

    def reordered(self, joints: Sequence[str], rest: FloatArray | None = None) -> "JointTrajectory":
        """The same movement with its joints in this order, and no other; those that it lacks stay at `rest` (J,) rad,
        or are an error where there is none."""
        for joint in self.joints:
            if joint not in joints:
                raise BodyError(f"{self.name}: {unknown('joint', joint, joints)}")
        for joint in joints:
            if joint not in self.joints and rest is None:
                raise BodyError(f"{self.name}: joint {joint!r} is missing; add a column for it")
        angles = np.tile(np.zeros(len(joints)) if rest is None else rest, (len(self.time), 1))
        angles[:, [list(joints).index(joint) for joint in self.joints]] = self.angles
        return JointTrajectory(self.name, self.time, tuple(joints), angles)

    def check_ranges(self, ranges: Mapping[str, tuple[float, float]], slides: Collection[str] = ()) -> None:
        """Raise BodyError unless every joint is in `ranges` (radians; metres for `slides`) and stays inside its own."""
        for joint in self.joints:
            if joint not in ranges:
                raise BodyError(f"{self.name}: {unknown('joint', joint, ranges)}")
        low, high = np.array([ranges[joint] for joint in self.joints]).T
        beyond = np.maximum(low - self.angles, self.angles - high)
        if beyond.max() <= RANGE_TOLERANCE:
            return
        frame, column = np.unravel_index(int(beyond.argmax()), beyond.shape)
        joint, length = self.joints[column], self.joints[column] in slides
        as_degrees = self.angles * np.where([one in slides for one in self.joints], 1, np.pi / 180)
        guess = (
            "; the numbers would fit as degrees: declare that unit (# unit: deg, or --unit deg)"
            if ((as_degrees >= low - RANGE_TOLERANCE) & (as_degrees <= high + RANGE_TOLERANCE)).all()
            else "; keep the movement inside the joint's range"
        )
        raise BodyError(
            f"{self.name}: joint {joint!r} is at {amount(self.angles[frame, column], length)} in frame {frame + 1}, "
            f"{amount(beyond[frame, column], length)} beyond its range "
            f"{amount(low[column], length, 0).split()[0]} .. {amount(high[column], length, 0)}{guess}"
        )


def amount(value: float, length: bool, digits: int = 1) -> str:
    """An angle in degrees, or a length in millimetres, for people."""
    return f"{1000 * value:.{digits}f} mm" if length else f"{np.rad2deg(value):.{digits}f} deg"


def frame_times(duration: float, dt: float, name: str) -> FloatArray:
    """Times 0, dt, 2 dt ... up to `duration` seconds: at least 3 and at most a million of them."""
    if not dt > 0:
        raise BodyError(f"{name}: a time step of {dt:g} s is impossible; give more than 0")
    count = duration / dt + 1e-9
    if count > MAX_FRAMES:
        raise BodyError(f"{name}: lasts {duration:g} s, more than {MAX_FRAMES} frames of {dt:g} s; cut it shorter")
    if count < MIN_FRAMES - 1:
        raise BodyError(f"{name}: lasts {duration:g} s, less than {MIN_FRAMES} frames of {dt:g} s; give a longer one")
    return np.asarray(np.arange(int(count) + 1) * dt, dtype=float)


def _first(where: BoolArray) -> int:
    """Position of the first true element, counted from 1."""
    return int(np.argmax(where)) + 1
