"""Inference and judgement over many trials."""

from typing import NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray
from experiments.gaze.trials import Trials, Watcher, located
from imitation.gaze.reader import Preferences


class Judged(NamedTuple):
    """N trials, inferred."""

    probability: FloatArray
    """(N, G) P(g); zero for what was not seen."""
    right: BoolArray
    """(N,) whether the most probable toy was the one looked at."""


def infer(
    who: Watcher,
    trials: Trials,
    toys: tuple[str, ...],
    likes: Preferences | None = None,
    *,
    even: bool = False,
    sees: float = 1.0,
) -> FloatArray:
    """(N, G) Eq. (2) for each trial, over the toys that were seen in both eyes; prior: salience and preferences."""
    places = located(trials, who.gaze.geometry)
    probability = np.zeros(places.shape[:2])
    for i in range(len(places)):
        there = np.flatnonzero(np.isfinite(places[i]).all(1))
        if not len(there):
            continue
        labels = tuple(toys[k] for k in there)
        salience = np.ones(len(there)) if even else trials.salience[i, there]
        probability[i, there] = prior = (likes or Preferences()).prior(labels, salience)
        if np.isfinite(trials.pose[i]).all():
            posterior = who.gaze.read(trials.pose[i], places[i, there], who.head, prior, sees)
            probability[i, there] = posterior.probability if posterior.informed else prior
    return probability


def judge(
    who: Watcher, trials: Trials, toys: tuple[str, ...], likes: Preferences | None = None, *, even: bool = False
) -> Judged:
    """Infer and compare with the truth."""
    probability = infer(who, trials, toys, likes, even=even)
    return Judged(probability, probability.argmax(1) == trials.target)


def preferences(who: Watcher, trials: Trials, toys: tuple[str, ...]) -> Preferences:
    """What a teacher likes, learned from what it seemed to look at; nobody says what it was."""
    likes = Preferences()
    for i in range(len(trials.target)):
        likes.observe(toys, infer(who, trials.rows(slice(i, i + 1)), toys, likes)[0])
    return likes
