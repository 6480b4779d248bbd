"""Trials of looking: unseen saccades to predict, things to fixate."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray
from babbling.looking import LookingMind, saccades
from babbling.loop import Transitions, explore, flat
from babbling.regression import regress
from imitation.gaze.fixation import Fixation
from models.seeing_body import SeeingBody

CENTRAL = 0.8
"""Share of the field, along each side, in which things are to be fixated."""


class Predicted(NamedTuple):
    """Unseen saccades of both motors: one row for each thing seen wholly before and after."""

    before: FloatArray
    """(N, 4) pixels from the middle, left and right eye."""
    after: FloatArray
    """(N, 4) where it was found afterwards."""
    posture: FloatArray
    """(N, 2) rad."""
    change: FloatArray
    """(N, 2) rad."""

    def error(self, guess: FloatArray) -> FloatArray:
        """(2 N) pixels between a guess (N, 4) and the truth, each eye by itself, where it saw the thing."""
        away = np.hypot(guess[:, 0::2] - self.after[:, 0::2], guess[:, 1::2] - self.after[:, 1::2])
        return away[np.isfinite(away)]


class Fixated(NamedTuple):
    """Trials of looking at something: pixels from the middle of the left eye, before and after one and two saccades."""

    start: FloatArray
    """(N, 2)"""
    once: FloatArray
    """(N,)"""
    twice: FloatArray
    """(N,)"""
    uninformed: int


def unseen_saccades(mind: LookingMind, body: SeeingBody, count: int, seed: int) -> Predicted:
    """Saccades of both motors at once among toys that were never looked at."""
    stream = saccades(
        mind.pilot.reach, mind.pilot.schema, body.copies, np.random.default_rng([seed, 77]), together=True
    )
    before, motors, after = flat(*explore(body, stream, count))
    was, now = (mind.pilot.retina.things(s) for s in (before, after))
    posture = mind.pilot.posture(before)
    change = mind.pilot.schema.efference(motors) - posture
    things = was.shape[1]
    rows = Predicted(
        was.reshape(-1, 4), now.reshape(-1, 4), np.repeat(posture, things, axis=0), np.repeat(change, things, axis=0)
    )
    seen = np.isfinite(rows.before + rows.after)
    keep = seen[:, :2].all(1) | seen[:, 2:].all(1)
    return Predicted(*(part[keep] for part in rows))


def expected(mind: LookingMind, trials: Predicted, *, table: bool = True) -> FloatArray:
    """(N, 4) where things are expected after a saccade; without `table` by the efference copy alone (a peer)."""
    return mind.expect(trials.before, trials.posture, trials.change, table=table)


def least_squares(mind: LookingMind, notes: list[Transitions], trials: Predicted) -> FloatArray:
    """The peer: least squares of the efference copy's terms on the very experience that the table counted, chained."""
    every = Transitions(
        tuple(np.concatenate(values) for values in zip(*(note.context for note in notes), strict=True)),
        np.concatenate([note.action for note in notes]),
        np.concatenate([note.outcome for note in notes]),
    )
    line = mind.pilot.fit(every).coefficients[:, 0]
    return expected(replace(mind, pilot=replace(mind.pilot, line=line)), trials, table=False)


def straight_lines(mind: LookingMind, body: SeeingBody, trials: Predicted, seed: int) -> FloatArray:
    """One straight line for each image coordinate, fitted to other saccades of both motors: the plainest peer."""

    def features(seen: Predicted) -> FloatArray:
        """(N, 4, 7) 1, postures, changes, and where the coordinate's own eye saw the thing."""
        own = np.repeat(seen.before.reshape(-1, 2, 2), 2, axis=1)
        shared = np.column_stack([np.ones(len(own)), seen.posture, seen.change])[:, None]
        return np.concatenate([np.broadcast_to(shared, (*own.shape[:2], 5)), own], axis=-1)

    others = unseen_saccades(mind, body, 10, seed + 1)
    fit = regress(features(others), (others.after - others.before)[..., None])
    return np.asarray(trials.before + fit.mean(features(trials))[..., 0])


def fixate(
    mind: LookingMind,
    body: SeeingBody,
    rounds: int,
    selection: str,
    seed: int,
    report: Callable[[float], None] = lambda done: None,
) -> Fixated:
    """Look at toys seen anywhere in the central part of the left eye's field: one saccade, and a second."""
    fixation = Fixation(mind, selection)
    rng = np.random.default_rng([seed, 78])
    reach, schema, retina = mind.pilot.reach, mind.pilot.schema, mind.pilot.retina
    starts, errors, uninformed = [], [], 0
    copies = np.arange(body.copies)
    for round_ in range(rounds):
        body.reset()
        middle = (reach.low + reach.high) / 2
        posture = middle + (reach.high - reach.low) / 2 * 0.4 * (2 * rng.random((body.copies, 2)) - 1)
        senses = body.act(schema.motors(posture))
        things, posture = retina.things(senses), mind.pilot.posture(senses)
        target = np.full(body.copies, -1)
        for copy in copies:
            central = np.abs(things[copy, :, :2]) < CENTRAL * retina.half[:2]
            possible = np.flatnonzero(central.all(1) & within_reach(mind, things[copy], posture[copy]))
            if len(possible):
                target[copy] = rng.choice(possible)
        tried = target >= 0
        starts.append(things[copies, target, :2][tried])
        for _ in range(2):
            thing = things[copies, target]
            posture = mind.pilot.posture(senses)
            saccade = fixation.choose(np.nan_to_num(thing), posture, rng)
            uninformed += int(saccade.uninformed[tried].sum())
            senses = body.act(schema.motors(posture + saccade.change))
            things = retina.things(senses)
            away = np.hypot(*things[copies, target, :2].T)
            errors.append(np.where(np.isfinite(away), away, np.inf)[tried])
        report((round_ + 1) / rounds)
    return Fixated(np.concatenate(starts), np.concatenate(errors[0::2]), np.concatenate(errors[1::2]), uninformed)


def within_reach(mind: LookingMind, things: FloatArray, posture: FloatArray) -> BoolArray:
    """(K,) whether a thing can be looked at at all: the saccade there ends at a posture within reach."""
    reach, movers = mind.pilot.reach, mind.pilot.movers
    per_px = 1.0 / mind.pilot.line[movers * mind.pilot.retina.coordinates + (0, 1), 0]
    goal = posture[movers] - np.nan_to_num(things[:, :2]) * per_px
    inside = (goal > reach.low[movers]) & (goal < reach.high[movers])
    return np.asarray(inside.all(1) & np.isfinite(things[:, 0]))
