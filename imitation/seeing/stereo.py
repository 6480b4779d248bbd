"""Places from two eyes, once one's own looking has told how each of them stands in the head.

A thing at rest in direction n of the head's frame (ahead, left, up) is, after the neck has turned by
M = R(after)^T R(before), in direction

    n' = M n + (M - I) k, up to length,     R = R_up(pan) R_left(tilt),     k = place of the eye / distance of the thing

(places from where the neck's hinges cross). An eye that stands turned by E sees E^T n through its pinhole. What the
mind expects of saccades has this form, for things about as far as those it looked at: pixels per radian, E and k of
either eye are where the form misses the expectations least (a turning camera's self-calibration: Hartley 1994). Nothing
is asked of the difference between the eyes: it is left for depth.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from babbling.axes import FloatArray
from babbling.looking import LookingMind

ACROSS, SHARES = np.linspace(-0.8, 0.8, 7), (-1.0, -0.5, 0.5, 1.0)
"""Saccades imagined: of things and from postures across their range, by shares of the largest change."""


@dataclass(frozen=True)
class Geometry:
    """How positions in two eyes become places; learned, or a unit (the distance between the eyes)."""

    focal_px: float
    """Pixels per radian of one's own turning, at the middle of the image."""
    stand: FloatArray = field(default_factory=lambda: np.zeros((2, 3)))
    """(2, 3) how the left and the right eye stand in the head: rotation vectors about ahead, left, up, rad."""

    @classmethod
    def of(cls, mind: LookingMind) -> "Geometry":
        """What oculomotor babbling says of one's own eyes."""
        pilot, reach = mind.pilot, mind.pilot.reach
        grid = np.meshgrid(ACROSS, ACROSS, ACROSS, SHARES, np.arange(2))
        u, v, held, share, motor = (values.reshape(-1, 1) for values in grid)
        was = np.tile(np.hstack([u, v]), 2) * pilot.retina.half
        posture = (reach.low + reach.high) / 2 + held * (reach.high - reach.low) / 2
        change = np.where(motor == np.arange(2), share * reach.largest, 0.0)
        now = mind.expect(was, posture, change)
        seen = (np.abs(now) < pilot.retina.half).all(-1)
        before, after = (Rotation.from_euler("ZY", p[seen][:, pilot.movers]) for p in (posture, posture + change))
        turn = after.inv() * before

        def eyes(x: FloatArray) -> Geometry:
            return cls(float(x[0] * pilot.retina.half[0]), x[1:7].reshape(2, 3))

        def missed(x: FloatArray) -> FloatArray:
            way, shift = eyes(x).ways(was[seen]), x[7:].reshape(2, 3)
            way = way / np.linalg.norm(way, axis=-1, keepdims=True) + shift
            moved = np.stack([turn.apply(way[:, eye]) for eye in range(2)], 1) - shift
            return np.asarray((eyes(x).project(moved) - now[seen]).ravel())

        return eyes(least_squares(missed, np.r_[1.0, np.zeros(12)]).x)

    def ways(self, things: FloatArray) -> FloatArray:
        """(..., 4) things (left u, v, right u, v from the middle) to (..., 2, 3): along which line either eye sees
        them, ahead, left and up in the head's frame; of no special length."""
        sight = np.reshape(things, (*np.shape(things)[:-1], 2, 2)) / -self.focal_px
        sight = np.concatenate([np.ones((*sight.shape[:-1], 1)), sight], axis=-1)
        return np.asarray(np.einsum("eij,...ej->...ei", Rotation.from_rotvec(self.stand).as_matrix(), sight))

    def project(self, ways: FloatArray) -> FloatArray:
        """Inverse of `ways`."""
        sight = np.einsum("eji,...ej->...ei", Rotation.from_rotvec(self.stand).as_matrix(), ways)
        return np.reshape(-self.focal_px * sight[..., 1:] / sight[..., :1], (*ways.shape[:-2], 4))

    def locate(self, things: FloatArray, tilt: float | FloatArray) -> FloatArray:
        """(..., 4) things to (..., 3) places: ahead, left, up of the middle between the eyes, levelled by the felt tilt
        (down is positive), in units of the distance between the eyes: 1 / the difference in how far left they lie.
        """
        ways = self.ways(things)
        slopes = ways[..., 1:] / ways[..., :1]
        depth = 1 / (slopes[..., 1, 0] - slopes[..., 0, 0])
        left, up = np.moveaxis(depth[..., None] * slopes.mean(-2), -1, 0)
        c, s = np.cos(tilt), np.sin(tilt)
        return np.stack([depth * c + up * s, left, up * c - depth * s], axis=-1)

    def appear(self, places: FloatArray, tilt: float) -> FloatArray:
        """Inverse of `locate`: (..., 3) places to (..., 4) things."""
        c, s = np.cos(tilt), np.sin(tilt)
        depth = places[..., 0] * c - places[..., 2] * s
        up = places[..., 0] * s + places[..., 2] * c
        eyes = (np.stack([depth, places[..., 1] + side, up], axis=-1) for side in (-0.5, 0.5))
        return self.project(np.stack([*eyes], axis=-2))
