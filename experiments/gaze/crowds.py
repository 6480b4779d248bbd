"""Beads that lie close, teachers whose heads do not turn as a reader takes it: where simple rules fall behind."""

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.special import softmax

from babbling.axes import FloatArray, IntArray
from experiments.gaze.infer import infer, preferences
from experiments.gaze.options import Config
from experiments.gaze.trials import COPIES, TOYS, Trials, Watcher, located, run_trials, shown, straight, table_body
from experiments.shared.caregiver import TURN_S
from experiments.shared.judging import Sweep, constant_confidence, over_learners, scores
from experiments.shared.kept import once

BEAD = 0.005
"""m, radius: beads touch where they lie 1 degree apart."""
SPACINGS = (1.0, 2.0, 3.0, 4.5, 6.5, 9.0, 13.0)
"""Degrees, as the teacher sees it, from each bead to the nearest other one; up to a quarter more."""
LESSONS, LESSONS_APART = 80, (10.0, 180.0)
HEAD_SHARE = 0.689
"""Of the way from straight ahead that the head turns; the eyes do the rest (Stiefelhagen and Zhu 2002)."""
LIKES = (0.6, 0.25, 0.1, 0.05)
"""How often a teacher with preferences looks at each."""


def jerky(aim: FloatArray, spread: float, rng: np.random.Generator) -> FloatArray:
    """Heavy tails: Student's t of 2 degrees of freedom where a reader takes it to be Gaussian."""
    return aim + spread * rng.standard_t(2, aim.shape)


def with_eyes(aim: FloatArray, spread: float, rng: np.random.Generator) -> FloatArray:
    """Gaze off the head's axis: the head turns only part of the way aside."""
    return straight(aim * (HEAD_SHARE, 1.0), spread, rng)


TEACHERS = {
    "as the reader takes it": (straight, straight, None),
    "heavy tails": (jerky, jerky, None),
    "eyes turn too": (with_eyes, with_eyes, None),
    "eyes turn too, unbeknown": (straight, with_eyes, None),
    "with preferences": (straight, straight, LIKES),
}
"""How the head turns in the lessons and afterwards, and what is liked."""
RULES = ("Eq. (2)", "nearest, line fitted, counts", "nearest to the seen line")
SAID = (*RULES[:2], "constant confidence")


class Simple(NamedTuple):
    """The strongest simple rule: nearest to a line fitted in the lessons, liking what was often looked at in them."""

    slope: FloatArray
    """(3, 2) pose = (1, pan, tilt of a look straight at it) @ slope."""
    spread: float
    """rad, root mean square of what the fit leaves over."""
    counts: FloatArray
    """(G,)"""

    @classmethod
    def learned(cls, looks: FloatArray, pose: FloatArray, target: IntArray) -> "Simple":
        """From (N, G, 2) straight looks at all, (N, 2) poses and which was looked at."""
        terms = np.pad(looks[np.arange(len(target)), target], ((0, 0), (1, 0)), constant_values=1.0)
        slope = np.asarray(np.linalg.lstsq(terms, pose, rcond=None)[0], float)
        counts = np.bincount(target, minlength=looks.shape[1]) + np.ones(1)
        return cls(slope, float(np.sqrt(((pose - terms @ slope) ** 2).mean())), counts)

    def read(self, looks: FloatArray, pose: FloatArray) -> FloatArray:
        """(N, G) n_k exp(-|pose - line_k|^2 / 2 spread^2) / sum."""
        line = np.pad(looks, ((0, 0), (0, 0), (1, 0)), constant_values=1.0) @ self.slope
        away = ((pose[:, None] - line) ** 2).sum(-1)
        return np.asarray(softmax(np.log(self.counts) - away / (2 * self.spread**2), axis=1))


class Crowds(NamedTuple):
    """What the study came to, by teacher."""

    sweeps: dict[str, Sweep]
    scores: dict[str, FloatArray]
    """(S, 3, 3) for each learner and each of `SAID`: log loss, Brier score, calibration error, over all spacings."""
    seen: float
    """Share of trials in which every bead was seen by both eyes; the others are left out."""

    def numbers(self) -> dict[str, Any]:
        """For metrics.json; scores, and how much less Eq. (2) loses, are mean and half of the 95 % interval."""
        kinds = ("log_loss", "brier", "calibration_error")
        score = {name: np.stack(over_learners(values), -1) for name, values in self.scores.items()}
        return {
            "gaze_crowds": {name: sweep.numbers() for name, sweep in self.sweeps.items()},
            "gaze_crowds_scores": {
                name: {who: dict(zip(kinds, row, strict=True)) for who, row in zip(SAID, rows, strict=True)}
                for name, rows in score.items()
            },
            "gaze_crowds_less_log_loss": {
                name: dict(zip(SAID[1:], np.stack(over_learners(loss[:, 1:] - loss[:, :1]), -1), strict=True))
                for name, loss in ((name, values[..., 0]) for name, values in self.scores.items())
            },
            "gaze_crowds_seen": self.seen,
        }


def crowds(pupils: list[Watcher], count: int, report: Callable[[float], None]) -> Crowds:
    """Every pupil meets every teacher; `count` trials at each spacing."""
    met = []
    for p, naive in enumerate(pupils):
        met.append(once(_meets, naive.config, count, naive=naive))
        report((p + 1) / len(pupils))
    right, said, kept = zip(*met, strict=True)
    label = "degrees to the nearest bead"
    found = {name: Sweep(label, SPACINGS, RULES, np.stack(right, 1)[t]) for t, name in enumerate(TEACHERS)}
    return Crowds(found, dict(zip(TEACHERS, np.stack(said, 1), strict=True)), float(np.mean(kept)))


def _meets(config: Config, count: int, naive: Watcher) -> tuple[FloatArray, FloatArray, FloatArray]:
    """One pupil: by teacher, how often (R, K) rules were right, (3, 3) scores of what was said, and the share of trials
    kept at each spacing."""
    right, said = np.empty((len(TEACHERS), len(RULES), len(SPACINGS))), np.empty((len(TEACHERS), len(SAID), 3))
    kept = np.empty((len(TEACHERS), len(SPACINGS)))
    body = table_body(config, COPIES, config.seed + 31, TURN_S, BEAD)
    rng = np.random.default_rng([config.seed, 0xC20])
    for t, (before, after, likes) in enumerate(TEACHERS.values()):
        meet = partial(run_trials, body, naive, rng=rng, radius=BEAD, preference=likes)
        lessons = _clear(meet(LESSONS, turn=before, apart_deg=LESSONS_APART), naive)
        who = shown(naive, lessons)
        liked = preferences(who, lessons, TOYS)
        simple = Simple.learned(_looks(who, lessons), lessons.pose, lessons.target)
        beliefs, targets = [], []
        for s, spacing in enumerate(SPACINGS):
            trials = _clear(meet(count, turn=after, apart_deg=(spacing, 1.25 * spacing)), who)
            kept[t, s] = len(trials.target) / count
            looks = _looks(who, trials)
            near = -np.linalg.norm(trials.pose[:, None] - looks, axis=-1)
            beliefs.append((infer(who, trials, TOYS, liked), simple.read(looks, trials.pose), near))
            targets.append(trials.target)
            right[t, :, s] = [(ranks.argmax(1) == trials.target).mean() for ranks in beliefs[-1]]
        target = np.concatenate(targets)
        ours, simply, _ = (np.concatenate(column) for column in zip(*beliefs, strict=True))
        constant = constant_confidence(ours, target)
        said[t] = [scores(belief, target) for belief in (ours, simply, constant)]
    return right, said, kept


def _clear(trials: Trials, who: Watcher) -> Trials:
    """Those in which all beads and the pose were made out, so that all rules judge the same."""
    there = np.isfinite(located(trials, who.gaze.geometry)).all((1, 2)) & np.isfinite(trials.pose).all(1)
    return trials.rows(there)


def _looks(who: Watcher, trials: Trials) -> FloatArray:
    """(N, G, 2) how a head where the other's is would point straight at each bead, nothing learned of the other."""
    places = located(trials, who.gaze.geometry)
    return who.gaze.imagined(places.reshape(-1, 3), who.head, np.zeros(3)).reshape(*places.shape[:2], 2)
