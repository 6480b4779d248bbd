"""What of a movement cannot be meant, and what of it is bent: each named, with where and how much."""

from collections.abc import Collection

import numpy as np

from models.arrays import FloatArray
from models.errors import BodyError
from models.motion.trajectory import JointTrajectory, amount

SLOW_S, MANY = 1.0, 100
"""So many frames, or more, a second apart or more, are no movement: between them anything could have happened."""
NEVER_S = 5.0
"""No posture is held, nor the way to the next one taken, as long as this between all frames of a movement."""
GAP, GAP_S = 10.0, 0.5
"""A gap: frames this many times as far apart as frames mostly are, and this many seconds. A quick reach takes as long,
so a whole one may be missing."""
FASTEST = np.deg2rad(9000.0)
"""rad/s; the fastest joint of a human, a pitcher's shoulder, stays below 8000 deg/s (Fleisig et al. 1999)."""
SHOWS = np.deg2rad(0.1)
"""Radians beyond a range that are worth a line."""


def check_clock(name: str, time: FloatArray, *, declared: bool) -> None:
    """Refuse times (T,) that are hardly seconds; `declared`: the file says the unit itself, and is believed.

    Raises:
        BodyError: how far frames are apart, and how milliseconds are declared.
    """
    if declared or time.ndim != 1 or len(time) < 3 or not np.isfinite(time).all():
        return
    step = float(np.median(np.diff(time)))
    if step > NEVER_S or (step >= SLOW_S and len(time) >= MANY):
        raise BodyError(
            f"{name}: its {len(time)} frames are {step:g} s apart, {time[-1] - time[0]:g} s in all; if these are "
            "milliseconds call the column time_ms (time_us, time_ns), if they are seconds time_s"
        )


def check_pace(movement: JointTrajectory, slides: Collection[str] = ()) -> None:
    """Refuse a jump that no joint makes (of those that do not slide).

    Raises:
        BodyError: joint, frames, how far and how fast.
    """
    turns = [joint not in slides for joint in movement.joints]
    pace = np.abs(np.diff(movement.angles, axis=0)) / np.diff(movement.time)[:, None] * turns
    if pace.max() <= FASTEST:
        return
    frame, column = np.unravel_index(int(pace.argmax()), pace.shape)
    most, limit = np.rad2deg([pace.max(), FASTEST])
    way = float(np.rad2deg(np.ptp(movement.angles[frame : frame + 2, column])))
    mend = "unwrap it where it turns past 180 deg" if abs(way - 360) < 90 else "take bad frames out"
    if np.abs(movement.angles[:, column]).max() > 4 * np.pi:
        mend = "or are these degrees? declare that unit (# unit: deg, or --unit deg)"
    raise BodyError(
        f"{movement.name}: joint {movement.joints[column]!r} jumps by {way:.1f} deg from frame {frame + 1} to "
        f"{frame + 2}, {most:.0f} deg/s, where no joint is faster than {limit:.0f}; {mend}"
    )


def gaps(movement: JointTrajectory) -> tuple[str, ...]:
    """A line where frames are missing."""
    steps = np.diff(movement.time)
    usual = float(np.median(steps))
    wide = np.flatnonzero((steps > GAP * usual) & (steps > GAP_S))
    if not len(wide):
        return ()
    first, more = wide[0], f", and {len(wide) - 1} more" if len(wide) > 1 else ""
    return (
        f"{movement.name}: no frame for {steps[first]:.2f} s after {movement.time[first]:.2f} s (elsewhere every "
        f"{usual:.3g} s){more}; a smooth curve stands there",
    )


def beyond(movement: JointTrajectory, ranges: FloatArray, slides: Collection[str] = ()) -> tuple[str, ...]:
    """A line where the curve through a movement's frames leaves ranges (J, 2) that the frames keep: it is held at their
    ends."""
    over = np.maximum(ranges[:, 0] - movement.angles, movement.angles - ranges[:, 1])
    if over.max() <= SHOWS:
        return ()
    frame, column = np.unravel_index(int(over.argmax()), over.shape)
    joint, count = movement.joints[column], int((over.max(0) > SHOWS).sum())
    return (
        f"{movement.name}: between its frames joint {joint!r} would swing {amount(over.max(), joint in slides)} beyond "
        f"its range at {movement.time[frame]:.2f} s{f' (the most of {count} joints)' if count > 1 else ''}; it is held "
        "at the end of it",
    )
