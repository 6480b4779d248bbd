"""Keeping an eye on one thing among look-alikes: a place on the image followed through noise, hiding and confusion.

State (u, v, du/dt, dv/dt); a thing keeps its velocity but for white acceleration. A frame brings any number of
detections of the thing's colour, perhaps none. With detection probability D and clutter density L (false detections
per square pixel) the likelihood of a frame's detections z_1..z_K is, up to a factor that the state does not enter,

    p(z_1..z_K | s) ~ (1 - D) + (D / L) sum over i of N(z_i; position(s), R).

The particle filter uses it as it stands; the Kalman filter keeps the mixture's mean and covariance (probabilistic
data association, Y. Bar-Shalom and E. Tse, 1975). A look-alike that stays is no random clutter: detections that the
followed thing does not explain start tracks of their own, and what those explain better is kept from the thing, which
is what lets a thing be hidden beside a look-alike without being taken for it. For the same reason a thing that has been
hidden for some frames is taken up again only where something new has been seen three times.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from babbling.axes import FloatArray
from babbling.kalman import Belief, System, constant_velocity, predict, update
from imitation.filters import particles as pf

CONFIRMED = 3  # sightings after which a look-alike counts as a thing
DOUBT_FRAMES = 2.5  # frames unseen after which one flash no longer counts as the thing come back


@dataclass(frozen=True)
class TrackOptions:
    """What is known of things and eyes beforehand; pixels and seconds."""

    dt: float = 1.0 / 30.0
    """Time between frames."""
    acceleration: float = 300.0
    """Standard deviation of a thing's acceleration, pixels/s^2."""
    noise: float = 0.3
    """Standard deviation of a detection, pixels."""
    start_speed: float = 60.0
    """Standard deviation of the velocity of a new thing, pixels/s."""
    detection: float = 0.95
    """D, probability that a thing in view is detected."""
    clutter: float = 5e-5
    """L, false detections per square pixel: one a frame at 160 x 120."""
    gate: float = 16.0
    """Squared Mahalanobis distance beyond which a detection is not the thing's (chi-square: 3 in 10 000 true ones)."""
    forget_s: float = 1.0
    """A look-alike unseen for so long is forgotten."""

    @property
    def system(self) -> System:
        """The constant-velocity system of one thing."""
        return constant_velocity(self.dt, acceleration=self.acceleration, noise=self.noise, axes=2)


class LookAlike(NamedTuple):
    """A thing of the same colour that is not the one followed."""

    belief: Belief
    sightings: int
    """Frames it was seen in; from `CONFIRMED` on it competes for detections."""
    unseen: int
    """Frames since."""
    age: int
    """Frames since the first of them."""
    place: int
    """Which detection of this frame it explains; -1 for none."""


class Track(NamedTuple):
    """The followed thing: all that the next frame needs."""

    belief: Belief | pf.Particles
    """Over (u, v, du/dt, dv/dt)."""
    look_alikes: tuple[LookAlike, ...] = ()
    unseen_s: float = 0.0

    @property
    def position(self) -> FloatArray:
        """E[(u, v)] (2,), pixels."""
        return self.belief.mean[..., :2]

    @property
    def covariance(self) -> FloatArray:
        """Cov[(u, v)] (2, 2), pixels^2."""
        return self.belief.covariance[..., :2, :2]


def start(place: npt.ArrayLike, options: TrackOptions, rng: np.random.Generator, particles: int = 0) -> Track:
    """A track from a first detection (2,): Gaussian, or of so many `particles`."""
    belief = _new(np.asarray(place, float), options)
    if not particles:
        return Track(belief)
    deviation = np.sqrt(np.diagonal(belief.covariance))
    return Track(pf.gather(belief.mean + deviation * rng.standard_normal((particles, 4))))


def follow(
    track: Track, detections: npt.ArrayLike, options: TrackOptions, rng: np.random.Generator
) -> tuple[Track, FloatArray]:
    """One frame later, with its detections (K, 2); and the probability (K,) that each of them is the thing."""
    seen = np.asarray(detections, float).reshape(-1, 2)
    system = options.system
    belief = _ahead(track.belief, options, rng)
    others = [
        other._replace(belief=predict(system, other.belief), unseen=other.unseen + 1, age=other.age + 1, place=-1)
        for other in track.look_alikes
    ]

    known = [other for other in others if other.sightings >= CONFIRMED]
    fresh = [other for other in others if other.sightings < CONFIRMED]
    owner = _assign([belief, *(other.belief for other in known)], seen, options)
    free = np.flatnonzero(owner <= 0)
    share = np.zeros(len(seen))
    doubtful = track.unseen_s > DOUBT_FRAMES * options.dt
    if not doubtful:
        belief, share[free] = _look(belief, seen[free], options, rng)
    known = [_meet(other, seen, np.flatnonzero(owner == k), system) for k, other in enumerate(known, start=1)]

    rest = np.flatnonzero((owner <= 0) & (share < 0.5))
    owner = _assign([other.belief for other in fresh], seen[rest], options)
    fresh = [_meet(other, seen, rest[owner == k], system) for k, other in enumerate(fresh)]
    fresh += [LookAlike(_new(seen[place], options), 1, 0, 0, int(place)) for place in rest[owner < 0]]
    patience = round(options.forget_s / options.dt)
    kept = [other for other in known if other.unseen <= patience] + [other for other in fresh if other.unseen <= 1]
    if doubtful:
        back = _reappeared(belief, kept, round(track.unseen_s / options.dt), options)
        if back >= 0:
            share[kept[back].place] = 1.0
            belief = _adopt(belief, kept.pop(back).belief, rng)

    unseen = 0.0 if 1.0 - share.sum() < 0.5 else track.unseen_s + options.dt
    return Track(belief, tuple(kept), unseen), share


def _reappeared(belief: Belief | pf.Particles, others: list[LookAlike], frames: int, options: TrackOptions) -> int:
    """Which confirmed newcomer is the likeliest to be the thing that has been hidden for so many frames; -1 for none
    within its gate. What was already there when the thing vanished is another one."""
    places = np.stack([other.belief.mean[:2] for other in others]) if others else np.zeros((0, 2))
    value = _log_density(belief, places, options)
    value[[other.sightings < CONFIRMED or other.place < 0 or other.age > frames for other in others]] = -np.inf
    return int(value.argmax()) if np.isfinite(value).any() else -1


def _adopt(belief: Belief | pf.Particles, found: Belief, rng: np.random.Generator) -> Belief | pf.Particles:
    """The newcomer's belief, in the shape of ours."""
    if isinstance(belief, Belief):
        return found
    root = np.linalg.cholesky(found.covariance)
    return pf.gather(found.mean + rng.standard_normal(belief.states.shape) @ root.T)


def _new(place: FloatArray, options: TrackOptions) -> Belief:
    """A thing seen once."""
    deviation = np.array([options.noise, options.noise, options.start_speed, options.start_speed])
    return Belief(np.concatenate([place, np.zeros(2)]), np.diag(deviation**2))


def _ahead(belief: Belief | pf.Particles, options: TrackOptions, rng: np.random.Generator) -> Belief | pf.Particles:
    """The belief one frame later, before looking."""
    system = options.system
    if isinstance(belief, Belief):
        return predict(system, belief)

    def drift(rng: np.random.Generator, states: FloatArray) -> FloatArray:
        push = options.acceleration * rng.standard_normal((*states.shape[:-1], 2))
        kick = np.concatenate([0.5 * options.dt**2 * push, options.dt * push], axis=-1)
        return np.asarray(states @ system.transition.T + kick)

    return pf.step(rng, belief, drift, None)


def _look(
    belief: Belief | pf.Particles, seen: FloatArray, options: TrackOptions, rng: np.random.Generator
) -> tuple[Belief | pf.Particles, FloatArray]:
    """The belief after the mixture likelihood of detections (K, 2), and each one's responsibility (K,).

    beta_i = (D/L) q_i / (1 - D + (D/L) sum q), q_i = p(z_i | belief) if z_i is the thing's.
    """
    if not len(seen):
        return belief, np.zeros(0)
    ratio = options.detection / options.clutter
    if isinstance(belief, Belief):
        density = np.exp(_log_density(belief, seen, options))
        share = ratio * density / (1.0 - options.detection + ratio * density.sum())
        system = options.system
        after, gain = update(system, belief, share @ seen + (1.0 - share.sum()) * (system.observation @ belief.mean))
        away = seen - system.observation @ belief.mean
        combined = share @ away
        scatter = np.einsum("k,ki,kj->ij", share, away, away) - np.outer(combined, combined)
        hidden = 1.0 - share.sum()
        covariance = hidden * belief.covariance + (1.0 - hidden) * after.covariance
        return Belief(after.mean, covariance + gain @ scatter @ gain.T), share
    away = belief.states[:, None, :2] - seen
    variance = options.noise**2
    density = np.exp(-0.5 * (away**2).sum(axis=-1) / variance) / (2.0 * np.pi * variance)  # (P, K)
    explained = belief.weights @ density
    share = ratio * explained / (1.0 - options.detection + ratio * explained.sum())
    log_likelihood = np.log(1.0 - options.detection + ratio * density.sum(axis=1))
    return pf.step(rng, belief, None, lambda _: log_likelihood), share


def _log_density(belief: Belief | pf.Particles, seen: FloatArray, options: TrackOptions) -> FloatArray:
    """log p(z | belief) (K,), the belief taken as Gaussian; -inf beyond the gate."""
    spread = belief.covariance[:2, :2] + options.noise**2 * np.eye(2)
    away = seen - belief.mean[:2]
    distance = np.einsum("ki,ij,kj->k", away, np.linalg.inv(spread), away)
    value = -0.5 * (distance + np.log(np.linalg.det(spread))) - np.log(2.0 * np.pi)
    return np.where(distance <= options.gate, value, -np.inf)


def _assign(beliefs: list[Belief | pf.Particles], seen: FloatArray, options: TrackOptions) -> npt.NDArray[np.intp]:
    """The likeliest assignment of detections to things: (K,) index of the thing, -1 for nobody's."""
    owner = np.full(len(seen), -1)
    if not beliefs or not len(seen):
        return owner
    gain = np.stack([_log_density(belief, seen, options) for belief in beliefs])
    gain += np.log(options.detection / options.clutter)
    miss = np.where(np.eye(len(beliefs), dtype=bool), np.log(1.0 - options.detection), -np.inf)
    cost = -np.maximum(np.hstack([gain, miss]), -1e9)
    for thing, place in zip(*linear_sum_assignment(cost), strict=True):
        if place < len(seen) and np.isfinite(gain[thing, place]):
            owner[place] = thing
    return owner


def _meet(other: LookAlike, seen: FloatArray, mine: npt.NDArray[np.intp], system: System) -> LookAlike:
    """A look-alike after this frame; `mine` is the index of the detection assigned to it, or empty."""
    if not len(mine):
        return other
    place = int(mine[0])
    return LookAlike(update(system, other.belief, seen[place])[0], other.sightings + 1, 0, other.age, place)
