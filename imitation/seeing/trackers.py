"""Ways to keep to one thing among look-alikes through a whole sequence: one dict, `TRACKERS`, one entry per way.

A sequence is (T, n, 3) candidates of one colour in one eye (`imitation.seeing.finding.candidates`): u, v, area, NaN for
none. Two ways filter (chapter, section 3.2): the Kalman filter and the particle filter of `imitation.seeing.tracking`;
the others are what one would try first.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from babbling.axes import FloatArray
from imitation.seeing.finding import alone
from imitation.seeing.tracking import Track, TrackOptions, follow, start

PARTICLES = 500


class Followed(NamedTuple):
    """One thing through T frames."""

    numbers: FloatArray
    """(T, 3) u, v and area of the candidate taken for the thing; NaN where none was."""
    place: FloatArray
    """(T, 2) where the thing is believed to be, pixels; NaN where nothing is believed."""
    spread: FloatArray
    """(T,) standard deviation of that belief along an axis, pixels; NaN for ways that have none."""


Tracker = Callable[[FloatArray, TrackOptions, np.random.Generator], Followed]


def by_filter(found: FloatArray, options: TrackOptions, rng: np.random.Generator, particles: int = 0) -> Followed:
    """A Bayes filter from a frame with one candidate only: Kalman, or of so many `particles`.

    What has been unseen for `options.forget_s` is given up, and taken up anew like the first time.
    """
    numbers, place, spread = _unfiltered(np.full((len(found), 3), np.nan))
    track: Track | None = None
    for t, (frame, only) in enumerate(zip(found, alone(found), strict=True)):
        here = frame[np.isfinite(frame[:, 0])]
        if track is not None and track.unseen_s > options.forget_s:
            track = None
        if track is None:
            if np.isnan(only[0]):
                continue
            track, chosen = start(only[:2], options, rng, particles), only
        else:
            track, share = follow(track, here[:, :2], options, rng)
            chosen = here[share.argmax()] if (share > 0.5).any() else np.full(3, np.nan)
        numbers[t], place[t], spread[t] = chosen, track.position, np.sqrt(np.trace(track.covariance) / 2)
    return Followed(numbers, place, spread)


def undoubted(found: FloatArray, options: TrackOptions, rng: np.random.Generator) -> Followed:
    """No filter: each frame by itself, and nothing where there are several."""
    return _unfiltered(alone(found))


def largest(found: FloatArray, options: TrackOptions, rng: np.random.Generator) -> Followed:
    """The largest one, whatever else there is."""
    return _unfiltered(np.where(np.isnan(found[:, 0, :1]), np.nan, found[:, 0]))


def nearest(found: FloatArray, options: TrackOptions, rng: np.random.Generator) -> Followed:
    """The one nearest to where the thing was last, from the first frame with one candidate only."""
    followed = _unfiltered(np.full((len(found), 3), np.nan))
    last = np.full(2, np.nan)
    for numbers, place, frame, only in zip(followed.numbers, followed.place, found, alone(found), strict=True):
        here = frame[np.isfinite(frame[:, 0])]
        if np.isnan(last[0]):
            numbers[:] = only
        elif len(here):
            numbers[:] = here[np.linalg.norm(here[:, :2] - last, axis=1).argmin()]
        last = np.where(np.isnan(numbers[:2]), last, numbers[:2])
        place[:] = last
    return followed


TRACKERS: dict[str, Tracker] = {
    "kalman": by_filter,
    "particles": partial(by_filter, particles=PARTICLES),
    "none": undoubted,
    "nearest": nearest,
    "largest": largest,
}


def _unfiltered(numbers: FloatArray) -> Followed:
    return Followed(numbers, numbers[:, :2].copy(), np.full(len(numbers), np.nan))
