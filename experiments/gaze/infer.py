"""Inference over many trials."""

import numpy as np

from babbling.axes import FloatArray
from experiments.gaze.trials import Trials, Watcher, located
from imitation.gaze.reader import Preferences


def infer(
    who: Watcher,
    trials: Trials,
    toys: tuple[str, ...],
    likes: Preferences | None = None,
    sees: FloatArray | None = None,
) -> FloatArray:
    """(N, G) Eq. (2) for each trial, over the toys that were seen in both eyes, 0 for the others; prior: salience and
    preferences; `sees` (N,) P(the teacher sees), 1 if not given."""
    places = located(trials, who.gaze.geometry)
    probability = np.zeros(places.shape[:2])
    for i in range(len(places)):
        there = np.flatnonzero(np.isfinite(places[i]).all(1))
        if not len(there):
            continue
        labels = tuple(toys[k] for k in there)
        probability[i, there] = prior = (likes or Preferences()).prior(labels, trials.salience[i, there])
        if np.isfinite(trials.pose[i]).all():
            posterior = who.gaze.read(
                trials.pose[i], places[i, there], who.head, prior, 1.0 if sees is None else sees[i]
            )
            probability[i, there] = posterior.probability if posterior.informed else prior
    return probability


def preferences(who: Watcher, trials: Trials, toys: tuple[str, ...]) -> Preferences:
    """What a teacher likes, learned from what it seemed to look at; nobody says what it was."""
    likes = Preferences()
    for i in range(len(trials.target)):
        likes.observe(toys, infer(who, trials.rows(slice(i, i + 1)), toys, likes)[0])
    return likes
