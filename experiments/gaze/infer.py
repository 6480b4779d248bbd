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
    """(..., N, G) Eq. (2) for each trial, over the toys that were seen in both eyes, 0 for the others; prior: salience
    and preferences; `sees` (..., N) P(the teacher sees), 1 if not given."""
    places = located(trials, who.gaze.geometry)
    found = np.asarray(np.isfinite(places).all(-1), bool)
    sees = np.ones(len(places)) if sees is None else sees
    expected, probability = np.zeros((*found.shape, 2)), np.zeros((*sees.shape, found.shape[1]))
    expected[found] = who.gaze.expected(places[found], who.head)
    for i in np.flatnonzero(found.any(1)):
        there = np.flatnonzero(found[i])
        prior = (likes or Preferences()).prior(tuple(toys[k] for k in there), trials.salience[i, there])
        told = np.isfinite(trials.pose[i]).all()
        for some in np.ndindex(sees.shape[:-1]):
            posterior = who.gaze.read(trials.pose[i], expected[i, there], prior, sees[(*some, i)]) if told else None
            probability[(*some, i, there)] = posterior.probability if posterior and posterior.informed else prior
    return probability


def preferences(who: Watcher, trials: Trials, toys: tuple[str, ...]) -> Preferences:
    """What a teacher likes, learned from what it seemed to look at; nobody says what it was."""
    likes = Preferences()
    for i in range(len(trials.target)):
        likes.observe(toys, infer(who, trials.rows(slice(i, i + 1)), toys, likes)[0])
    return likes
