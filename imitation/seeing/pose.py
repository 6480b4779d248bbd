"""The pose of another's head from what it looks like: learned from being mirrored, estimated by Kalman filtering.

A caregiver repeats what the infant's head just did, and the infant sees what that looks like: pairs of own posture and
the places of a face's features. From them a smooth account of each number of the image is fitted (*appearance*), in
terms of one's *own* posture: the correspondence between the other's body and one's own is learned with it. Watching
is that account turned round (chapter, section 3.2: states s_t from raw inputs I_t by Kalman filtering):

    s_t = (pan, tilt, their rates),   z_t = h(s_t) + noise,   an extended Kalman filter, and its smoother afterwards.

Numbers that are missing, or that no pose near the believed one would explain (a feature half hidden), are left out.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.kalman import Belief, System, constant_velocity, predict, smooth, update
from babbling.regression import regress
from imitation.errors import ImitationError

DEGREE = 4
"""Of the polynomial in pan and tilt: a head that turns by 30 degrees hides and shows parts of its features."""
OUTLIER = 4.0
"""Residuals beyond so many standard deviations are left out of the next fit."""
GATE = 12.0
"""Squared deviations beyond which a number is not explained by the believed pose."""
LEAST_NUMBERS = 4
"""Numbers needed for a pose from one frame alone."""
ROUNDS = 8
UNKNOWN = Belief(np.zeros(4), np.eye(4))
"""Before the first pose."""


@dataclass(frozen=True, eq=False)
class Appearance:
    """What a head at a given posture looks like: M numbers as polynomials of P = 2 angles."""

    coefficients: FloatArray
    """(M, terms); zero rows for numbers hardly ever seen."""
    noise: FloatArray
    """(M,) standard deviation of each number about its polynomial; infinite where hardly ever seen."""
    scale: FloatArray
    """(2,) angle that counts as one, rad."""
    low: FloatArray
    """(2,) least angles of the lessons, rad."""
    high: FloatArray
    """(2,) greatest angles of the lessons, rad."""
    group: IntArray
    """(M,) which feature each number belongs to: one that fails takes the others of its feature with it."""

    @classmethod
    def learned(cls, postures: FloatArray, numbers: FloatArray, group: IntArray) -> "Appearance":
        """From (N, 2) own postures and the (N, M) numbers seen when they were mirrored; NaN unseen.

        Raises:
            ImitationError: no feature of the face was seen often enough to learn from.
        """
        low, high = postures.min(0), postures.max(0)
        scale = np.maximum(np.abs(np.stack([low, high])).max(0), 1e-3)
        terms = _terms(postures / scale)
        fit = regress(terms[:, None], numbers[..., None], outlier=OUTLIER, rounds=3)
        often = fit.samples >= 3 * terms.shape[1]
        coefficients = np.where(often[:, None], fit.coefficients[:, 0], 0.0)
        noise = np.where(often, np.maximum(fit.noise[:, 0], 1e-3), np.inf)
        if np.isfinite(noise).sum() < LEAST_NUMBERS:
            raise ImitationError(
                f"of {len(postures)} mirrored postures too few showed a feature of the face to learn what it looks "
                "like; the caregiver must be in view"
            )
        return cls(coefficients, noise, scale, low, high, group)

    def expect(self, posture: FloatArray) -> FloatArray:
        """(..., 2) postures to (..., M) numbers."""
        return np.asarray(_terms(posture / self.scale) @ self.coefficients.T)

    def slope(self, posture: FloatArray) -> FloatArray:
        """(2,) posture to (M, 2) derivatives of the numbers, per rad."""
        step = 1e-4
        sides = posture + step * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])
        values = self.expect(sides)
        return np.stack([values[0] - values[1], values[2] - values[3]], axis=1) / (2 * step)


class Watched(NamedTuple):
    """A movement that was watched, T ticks; angles in rad."""

    pose: FloatArray
    """(T, 2) knowing the whole movement (smoothed)."""
    deviation: FloatArray
    """(T, 2) its standard deviation."""
    live: FloatArray
    """(T, 2) knowing the past only (filtered)."""
    raw: FloatArray
    """(T, 2) of each frame by itself; the last one is held where nothing can be made out."""
    used: IntArray
    """(T,) numbers that the filter used."""


def frame_pose(appearance: Appearance, numbers: FloatArray) -> FloatArray:
    """(2,) likeliest pose of one frame (M,) by itself: weighted Gauss-Newton from the best of a coarse grid of poses.

    NaN when fewer than `LEAST_NUMBERS` numbers were seen.
    """
    seen = np.isfinite(numbers) & np.isfinite(appearance.noise)
    if seen.sum() < LEAST_NUMBERS:
        return np.full(2, np.nan)
    grid = np.stack(np.meshgrid(*(np.linspace(a, b, 9) for a, b in zip(appearance.low, appearance.high, strict=True))))
    poses = grid.reshape(2, -1).T
    weight = 1.0 / appearance.noise[seen]
    away = (numbers[seen] - appearance.expect(poses)[:, seen]) * weight
    pose = poses[np.minimum(away**2, GATE).sum(1).argmin()]
    for _ in range(ROUNDS):
        slope = appearance.slope(pose)[seen] * weight[:, None]
        rest = (numbers[seen] - appearance.expect(pose)[seen]) * weight
        pose = pose + np.linalg.lstsq(slope, rest, rcond=None)[0]
        pose = np.clip(pose, appearance.low, appearance.high)
    return np.asarray(pose)


def watch(appearance: Appearance, numbers: FloatArray, dt: float, acceleration: float = 2.5) -> Watched:
    """Poses of a head from (T, M) numbers, NaN unseen (whole rows on ticks without an image).

    Args:
        appearance: what a head at a posture looks like.
        numbers: what was seen.
        dt: s between ticks.
        acceleration: rad/s^2, standard deviation of how briskly heads turn.

    Raises:
        ImitationError: there is not one frame that shows a pose.
    """
    raw = np.array([frame_pose(appearance, row) for row in numbers])
    known = np.flatnonzero(np.isfinite(raw[:, 0]))
    if not len(known):
        raise ImitationError("no frame shows enough of a face to tell its pose; is the teacher in view?")
    raw = raw[known[np.maximum(np.searchsorted(known, np.arange(len(raw)), side="right") - 1, 0)]]
    watching = LiveWatch(appearance, dt, acceleration)
    ahead, seen, used = zip(
        *((watching.ahead(), watching.see(row), watching.used) for row in numbers[known[0] :]), strict=True
    )
    filtered = Belief.stacked(seen)
    after = smooth(watching.system, filtered, Belief.stacked(ahead))
    lead = ((known[0], 0), (0, 0))
    deviation = np.sqrt(np.diagonal(after.covariance, axis1=1, axis2=2)[:, :2])
    return Watched(
        np.pad(after.mean[:, :2], lead, mode="edge"),
        np.pad(deviation, lead, mode="edge"),
        np.pad(filtered.mean[:, :2], lead, mode="edge"),
        raw,
        np.pad(used, lead[0]),
    )


class LiveWatch:
    """The extended Kalman filter, frame by frame."""

    def __init__(self, appearance: Appearance, dt: float, acceleration: float = 2.5) -> None:
        self.appearance = appearance
        self.system = constant_velocity(dt, acceleration=acceleration, noise=1.0, axes=2)
        self.belief: Belief | None = None
        self.used = 0

    def ahead(self) -> Belief:
        """The belief one tick later, before looking; before the first pose, a broad one."""
        if self.belief is not None:
            self.belief = predict(self.system, self.belief)
        return self.belief or UNKNOWN

    def see(self, numbers: FloatArray) -> Belief:
        """The belief after a frame's (M,) numbers; the first frame that shows a pose starts the filter."""
        self.used = 0
        if self.belief is None:
            pose = frame_pose(self.appearance, numbers)
            if np.isnan(pose[0]):
                return UNKNOWN
            self.belief = Belief(np.concatenate([pose, [0.0, 0.0]]), np.diag([0.01, 0.01, 0.5, 0.5]))
        there = np.isfinite(numbers) & np.isfinite(self.appearance.noise)
        if there.any():
            self.belief = self._correct(self.belief, numbers, there)
        return self.belief

    def _correct(self, belief: Belief, numbers: FloatArray, there: BoolArray) -> Belief:
        look = self.appearance
        variance = np.where(np.isfinite(look.noise), look.noise, 1.0) ** 2
        after, keep = belief, there
        for round_ in range(3):  # iterated: the slope is taken where the belief goes
            point = np.clip(after.mean[:2], look.low, look.high)
            slope = look.slope(point)
            observation = np.concatenate([slope, np.zeros_like(slope)], axis=1)
            system = System(self.system.transition, self.system.process_noise, observation, np.diag(variance))
            measured = np.where(there, numbers - look.expect(point) + slope @ point, 0.0)
            if round_ == 0:
                spread = np.einsum("mi,ij,mj->m", observation, belief.covariance, observation) + variance
                surprise = np.where(there, (measured - observation @ belief.mean) ** 2 / spread, 0.0)
                keep = there & ~np.isin(look.group, look.group[surprise > GATE])
                if not keep.any():
                    return belief
            after, _ = update(system, belief, measured, keep)
        self.used = int(keep.sum())
        return after


def _terms(angles: FloatArray) -> FloatArray:
    """(..., 2) scaled angles to (..., terms) monomials up to `DEGREE`."""
    x, y = angles[..., 0], angles[..., 1]
    return np.stack([x**i * y**j for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i)], axis=-1)
