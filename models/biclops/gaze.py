"""Where a teacher has to turn its head to look at something, and toys laid out on the table between two heads."""

from typing import NamedTuple

import numpy as np

from models.arrays import BoolArray, FloatArray
from models.biclops.facts import CAMERA_HEIGHT, PAN_HEIGHT
from models.errors import BodyError

BALL_RADIUS = 0.022
"""m, of toys on the table."""
TABLE_X, TABLE_Y = (0.32, 0.66), 0.26
"""m: where toys may lie, at 0.95 m between the heads; scaled with the distance."""
WIDEST_DEG = 40.0
"""A teacher does not turn further than this to either side."""
TRIES, BATCH = 200_000, 500


def look_at(target: FloatArray, distance: float) -> FloatArray:
    """(..., 2) pan and tilt, rad, with which a teacher `distance` ahead, facing us, has (..., 3) targets in its view's
    middle: the line midway between its cameras runs through them. Targets in the table's frame, m.
    """
    ahead, left = distance - target[..., 0], -target[..., 1]
    level = np.hypot(ahead, left)
    above = target[..., 2] - PAN_HEIGHT
    tilt = np.arcsin(CAMERA_HEIGHT / np.hypot(level, above)) - np.arctan2(above, level)
    return np.stack([np.arctan2(left, ahead), tilt], axis=-1)


def separation(one: FloatArray, other: FloatArray, distance: float) -> FloatArray:
    """(...) angle, rad, between (..., 3) places as seen from between the teacher's cameras at rest."""
    eye = np.array([distance, 0.0, PAN_HEIGHT + CAMERA_HEIGHT])
    a, b = one - eye, other - eye
    cosine = (a * b).sum(-1) / (np.linalg.norm(a, axis=-1) * np.linalg.norm(b, axis=-1))
    return np.asarray(np.arccos(np.clip(cosine, -1, 1)))


class View(NamedTuple):
    """What a watcher can see of the table: half the field, and how its eyes are held."""

    half_u: float
    """tan of half the horizontal field."""
    half_v: float
    tilt: float
    """rad, down."""
    half_baseline: float
    """m"""

    def shows(self, place: FloatArray) -> BoolArray:
        """(...) whether (..., 3) places of the table's frame are well inside both eyes' images."""
        x, y, z = place[..., 0], place[..., 1], place[..., 2] - PAN_HEIGHT - CAMERA_HEIGHT
        depth = x * np.cos(self.tilt) - z * np.sin(self.tilt)
        up = x * np.sin(self.tilt) + z * np.cos(self.tilt)
        margin = BALL_RADIUS + 0.01
        wide = (np.abs(y) + self.half_baseline + margin) < self.half_u * depth
        return np.asarray(wide & (np.abs(up) + margin < self.half_v * depth) & (depth > 0))


def lay_out(
    rng: np.random.Generator,
    count: int,
    distance: float,
    view: View,
    apart_deg: tuple[float, float],
    radius: float = BALL_RADIUS,
) -> FloatArray:
    """(count, 3) toys on the table, each between `apart_deg[0]` and `apart_deg[1]` from the nearest other one as the
    teacher sees them.

    Raises:
        BodyError: no room for them.
    """
    scale = distance / 0.95
    for _ in range(TRIES // BATCH):
        x, y = rng.uniform(*TABLE_X, (BATCH, count)) * scale, rng.uniform(-TABLE_Y, TABLE_Y, (BATCH, count)) * scale
        if apart_deg[1] < 180.0:  # close ones are rare: lay each near one that lies already
            near = min(np.deg2rad(apart_deg[1]) / 2, 0.25) * scale
            for k in range(1, count):
                beside = np.arange(BATCH), rng.integers(k, size=BATCH)
                x[:, k] = x[beside] + near * rng.normal(size=BATCH)
                y[:, k] = y[beside] + near * rng.normal(size=BATCH)
        places = np.stack([x, y, np.full((BATCH, count), radius)], axis=-1)
        on_table = (np.abs(x / scale - np.mean(TABLE_X)) <= np.ptp(TABLE_X) / 2) & (np.abs(y) <= TABLE_Y * scale)
        fit = np.flatnonzero(on_table.all(-1) & possible(places, distance, view, apart_deg, radius))
        if len(fit):
            return np.asarray(places[fit[0]])
    raise BodyError(f"no room on the table for {count} toys {apart_deg[0]:g} degrees apart; fewer, or closer")


def possible(
    places: FloatArray, distance: float, view: View, apart_deg: tuple[float, float], radius: float = BALL_RADIUS
) -> BoolArray:
    """(...) whether both heads can look at all of (..., G, 3) toys, each as far from the nearest other one as asked."""
    turn = np.rad2deg(np.abs(look_at(places, distance)[..., 0]))
    fit = (view.shows(places) & (turn <= WIDEST_DEG)).all(-1)
    one, other = places[..., :, None, :], places[..., None, :, :]
    itself = 360.0 * np.eye(places.shape[-2])
    nearest = (np.rad2deg(separation(one, other, distance)) + itself).min(-1)  # 360: there is no other
    within = (nearest >= apart_deg[0]) & ((nearest <= apart_deg[1]) | (nearest >= 360.0))
    aside = np.abs(np.arctan2(one[..., 1], one[..., 0]) - np.arctan2(other[..., 1], other[..., 0])) + itself
    down = np.abs(np.arctan2(0.18, one[..., 0]) - np.arctan2(0.18, other[..., 0]))
    merged = (aside < 0.06 * radius / BALL_RADIUS) & (down < 0.10 * radius / BALL_RADIUS)
    return np.asarray(fit & within.all(-1) & ~merged.any((-1, -2)))
