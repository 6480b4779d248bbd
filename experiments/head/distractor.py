"""Things of the face's own colours that cross the view, and how well each way of tracking keeps to the face."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import bootstrap

from babbling.axes import FloatArray
from experiments.shared.caregiver import FACE, FRAME_S, NUMBERS
from experiments.shared.judging import Verdict, over_learners_above_zero, rmse_deg
from experiments.shared.palette import CYCLE, PLAIN, THEIRS
from experiments.shared.tables import table
from imitation.seeing.features import COLOURS, find_features
from imitation.seeing.finding import candidates
from imitation.seeing.pose import Appearance, Watched, watch
from imitation.seeing.trackers import TRACKERS
from imitation.seeing.tracking import TrackOptions
from models.biclops.movements import TICK_S
from models.biclops.room import FACE_PREFIX, TEACHER, Ball
from models.robots import EYE_HEIGHT
from models.seeing_body import SeeingBody

IMITATED = "kalman"
"""The way of tracking that is imitated from where things of the face's colours are about; all are measured."""
PARTS = ("nose", "left_eye", "right_eye", "left_ear", "right_ear")
"""Parts of a face, in the order of `FACE`."""
BALLS = tuple(Ball(f"stray_{colour}", (0.4, 2.0, 0.2), COLOURS[colour], 0.011) for colour in FACE)
NEARNESS = 0.7
"""Share of the way to the face at which they pass: they look as large as what they are mistaken for, and hide it."""
SPEED = 0.2
"""m/s across; at 0.7 m between the heads they are in view for some two and a half seconds."""
MISS, LAG_S = 0.005, 0.1
"""m and s, standard deviations of how closely each passes its look-alike's place at rest, and when: a face."""
INKS = dict(zip(TRACKERS, (CYCLE[2], THEIRS, PLAIN, CYCLE[5], CYCLE[4]), strict=True))
"""Of every way of tracking."""
CANDIDATES = 4
"""Things of one colour in one eye that are looked at."""
BRISK = 60.0
"""px/s^2 at 120 rows: a nose 0.1 m before the axis, seen from 0.6 m, of a head that turns at 2.5 rad/s^2."""
WRONG_PX = 3.0
"""A thing followed further than this from where the face's own would appear is another one."""


class Strays:
    """Five balls of the face's colours cross the view of every copy, each close by its look-alike; what is then found.

    Args:
        body: heads with a teacher before them and `BALLS`.
        lengths: s, how long each copy's sequence is.
        rng: whence and when they come.
    """

    def __init__(self, body: SeeingBody, lengths: list[float], rng: np.random.Generator) -> None:
        self.body = body
        parts = body.whereabouts([f"{TEACHER}{FACE_PREFIX}{part}" for part in PARTS])
        eye, shape = np.array([0.0, 0.0, EYE_HEIGHT]), (body.copies, len(PARTS))
        self.meeting = eye + NEARNESS * (parts - eye)
        self.meeting = self.meeting + MISS * rng.standard_normal((*shape, 3)) * (0, 0, 1)
        middle = rng.uniform(0.3, 0.7, (body.copies, 1)) * np.array(lengths)[:, None]
        self.when = middle + LAG_S * rng.standard_normal(shape)
        self.speed = SPEED * rng.choice([-1.0, 1.0], (body.copies, 1))
        self.found: list[FloatArray] = []

    def places(self, time_s: float) -> FloatArray:
        """(B, K, 3) m, where they are at this time, in the table's frame."""
        return np.asarray(self.meeting + (self.speed * (time_s - self.when))[..., None] * (0, 1, 0))

    def move(self, time_s: float) -> None:
        """Put them there."""
        for k, ball in enumerate(BALLS):
            self.body.place(ball.name, self.places(time_s)[:, k])

    def note(self) -> None:
        """Keep all candidates of this moment's images."""
        self.found.append(np.array([[candidates(find_features(eye), FACE, CANDIDATES) for eye in pair]
                                    for pair in self.body.images]))  # fmt: skip

    @property
    def sightings(self) -> FloatArray:
        """(T, B, 2 eyes, K, n, 3) candidates of every frame."""
        return np.array(self.found)


class Kept(NamedTuple):
    """One sequence of T frames through one way of tracking."""

    place: FloatArray
    """(T, 2 eyes, K, 2) where each part of the face is believed to be; NaN where nothing is believed."""
    spread: FloatArray
    """(T, 2, K) pixels."""
    numbers: FloatArray
    """(ticks, M) what is told to the pose filter; NaN on ticks without an image."""
    watched: Watched
    """The pose that comes of it."""


def keep(name: str, sightings: FloatArray, height: int, appearance: Appearance, ticks: int, seed: int) -> Kept:
    """Follow each part of the face in each eye of (T, 2, K, n, 3) candidates, then the pose of the whole."""
    follow, rng = TRACKERS[name], np.random.default_rng([seed, 0x57A])
    scale = height / 120
    options = TrackOptions(
        FRAME_S, acceleration=BRISK * scale, start_speed=BRISK / 2 * scale, clutter=TrackOptions().clutter / scale**2
    )
    every = [[follow(sightings[:, eye, k], options, rng) for k in range(len(FACE))] for eye in range(2)]
    place, spread, numbers = (
        np.moveaxis(np.array([[getattr(one, what) for one in row] for row in every]), 2, 0)
        for what in ("place", "spread", "numbers")
    )
    told = np.full((ticks, numbers[0].size), np.nan)
    told[:: round(FRAME_S / TICK_S)] = numbers.swapaxes(1, 2).reshape(len(numbers), -1)
    return Kept(place, spread, told, watch(appearance, told, TICK_S))


@dataclass(frozen=True)
class Crossed:
    """What came of sequences with strays in the view, by way of tracking; for those who judge."""

    strays: Strays
    kept: dict[str, list[Kept]]
    truths: list[FloatArray]
    """(T, 2) rad of each sequence; NaN between frames."""
    appearance: Appearance
    seed: int

    @cached_property
    def sequence_deg(self) -> dict[str, FloatArray]:
        """RMS error of the pose in each sequence."""
        return {
            name: np.array([rmse_deg(o.watched.pose, t) for o, t in zip(runs, self.truths, strict=True)])
            for name, runs in self.kept.items()
        }

    @cached_property
    def metrics(self) -> dict[str, dict[str, Any]]:
        """Each by way of tracking: `distractor_rmse_deg` of the pose with a 95 % interval (bootstrap over sequences;
        none for fewer than three); and of what was told to the pose filter: RMS px from where the parts appear at
        the true pose by the learned appearance, the share further than `WRONG_PX`, the share of parts that was told.
        """
        rows: dict[str, tuple[Any, ...]] = {}
        for name, runs in self.kept.items():
            away = np.concatenate([_away(o, t, self.appearance) for o, t in zip(runs, self.truths, strict=True)])
            told = away[np.isfinite(away)]
            rows[name] = (
                rmse_deg(np.concatenate([one.watched.pose for one in runs]), np.concatenate(self.truths)),
                self._interval(self.sequence_deg[name]),
                float(np.sqrt(np.mean(told**2))) if len(told) else None,
                float(np.mean(told > WRONG_PX)) if len(told) else None,
                len(told) / away.size,
            )
        found = ("rmse_deg", "interval_95_deg", "feature_rmse_px", "wrong_share", "told_share")
        columns = (dict(zip(rows, column, strict=True)) for column in zip(*rows.values(), strict=True))
        metrics = {f"distractor_{what}": column for what, column in zip(found, columns, strict=True)}
        return metrics | {"distractor_closer": {name: v.numbers for name, v in self.closer.items()}}

    @property
    def closer(self) -> dict[str, Verdict]:
        """Whether the way that is imitated from is closer to the true pose than each other way, over sequences."""
        missed = self.sequence_deg
        others = missed.keys() - {IMITATED} if IMITATED in missed else ()
        return {name: over_learners_above_zero(missed[name] - missed[IMITATED]) for name in sorted(others)}

    def _interval(self, each: FloatArray) -> FloatArray | None:
        if len(each) < 3:
            return None
        rng = np.random.default_rng([self.seed, 0xB0])
        low, high = bootstrap((each**2,), np.mean, n_resamples=2000, method="percentile", rng=rng).confidence_interval
        return np.sqrt([low, high])

    @property
    def summary(self) -> str:
        """Markdown."""
        pose, interval, px, wrong, told, _ = self.metrics.values()
        rows = [
            (
                name,
                f"{pose[name]:.3f}"
                + ("" if interval[name] is None else f" ({interval[name][0]:.3f} to {interval[name][1]:.3f})"),
                *(("-", "-") if px[name] is None else (f"{px[name]:.2f}", f"{100 * wrong[name]:.1f}")),
                f"{100 * told[name]:.0f}",
                self.closer[name].told("+.3f") if name in self.closer else "",
            )
            for name in self.kept
        ]
        header = (
            "tracking",
            "pose, deg RMS",
            "features, px RMS",
            "wrong thing, %",
            "told, %",
            f"{IMITATED} closer, deg",
        )
        return f"\n## Things of the face's colours cross the view\n\n{table(rows, header)}\n"


def _away(one: Kept, truth: FloatArray, appearance: Appearance) -> FloatArray:
    """(T, 2 K) distance of what was told from where the parts appear at the true pose, pixels; NaN untold."""
    frames = np.isfinite(truth[:, 0])
    apart = one.numbers[frames] - appearance.expect(truth[frames])
    return np.asarray(np.linalg.norm(apart.reshape(len(apart), -1, NUMBERS)[..., :2], axis=-1))


def keep_all(
    strays: Strays, ticks: list[int], height: int, appearance: Appearance, seed: int, report: Callable[[float], None]
) -> dict[str, list[Kept]]:
    """`keep` for every way there is and every sequence of so many ticks."""
    every, kept, sightings = round(FRAME_S / TICK_S), dict[str, list[Kept]](), strays.sightings
    for number, name in enumerate(TRACKERS):
        kept[name] = []
        for b, count in enumerate(ticks):
            own = sightings[: -(-count // every), b]
            kept[name].append(keep(name, own, height, appearance, count, seed + b))
            report((number + (b + 1) / len(ticks)) / len(TRACKERS))
    return kept
