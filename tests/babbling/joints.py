"""Joints without physics, for laws of forward models: where they go is a rule of effort, rate and posture."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from babbling.explanations import Explanations
from babbling.features import WIDTHS, ZONES, Echo, Features
from babbling.frame import Frame, shares

FloatArray = np.ndarray
Rule = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
"""(..., F) displacement at postures, rates and (..., F, J) plays minus posture."""
JITTER, TICK, PULL = 0.01, 0.02, 0.3


def linear(q: FloatArray, v: FloatArray, plays: FloatArray) -> FloatArray:
    """A servo: some of the way."""
    return PULL * plays[..., 0] + 0.002 * v


def bent(q: FloatArray, v: FloatArray, plays: FloatArray) -> FloatArray:
    """It hangs, and leans on a spring from 0.08 rad on, one of the knots."""
    return linear(q, v, plays) - 0.01 * q**2 - 0.2 * np.maximum(q - 0.08, 0)


def slack(q: FloatArray, v: FloatArray, plays: FloatArray) -> FloatArray:
    """Backlash of two jitters to either side."""
    return PULL * plays[..., 5] + 0.002 * v


def sticky(q: FloatArray, v: FloatArray, plays: FloatArray) -> FloatArray:
    """Dry friction holds what rests three times as well as what moves: a product of rate and effort, no sum."""
    hold = np.where(np.abs(v) < 0.2, 0.03, 0.01)
    return PULL * np.sign(plays[..., 0]) * np.maximum(np.abs(plays[..., 0]) - hold, 0)


def features(factors: int = 2) -> Features:
    """Of a body that babbles from -0.5 to 0.5 rad at up to 5 rad/s; everything arrives at once."""
    one = np.ones((factors, 1))
    widths, direct = np.array(WIDTHS) * JITTER * one, np.eye(1, len(WIDTHS)) * one
    slow, zones = np.array([0.02, 0.2]) * one, np.array(ZONES) * JITTER * one
    return Features(np.linspace(-0.4, 0.4, 6) * one, slow, widths, zones, direct)


def run(rule: Rule, ticks: int, seed: int, factors: int = 2, copies: int = 4, noise: float = 1e-3) -> list[FloatArray]:
    """(T, B, F) postures, rates, commands and outcomes of a run from rest: smooth ways with jitter."""
    rng, mine = np.random.default_rng(seed), features(factors)
    size, pace, phase = rng.uniform([0.25, 0.2, 0], [0.35, 6, 6], (copies, factors, 3)).transpose(2, 0, 1)
    time = np.arange(ticks)[:, None, None] * TICK
    commands = size * np.sin(pace * time + phase) + 0.1 * np.sin(0.7 * time)
    commands += JITTER * rng.standard_normal(commands.shape)
    q, v = np.zeros((2, copies, factors))
    echo, rows = mine.start(q), []
    for command in commands:
        echo = mine.after(echo, command)
        w = rule(q, v, echo.plays - q[..., None]) + noise * rng.standard_normal(q.shape)
        rows.append((q, v, command, w))
        q, v = q + w, w / TICK
    return [np.stack(one) for one in zip(*rows, strict=True)]


def lived(
    rule: Rule, ticks: int, seed: int, factors: int = 2, copies: int = 4, noise: float = 1e-3
) -> tuple[FloatArray, FloatArray]:
    """(N, F, COLUMNS) features and (N, F) outcomes of `run`."""
    *walk, outcome = run(rule, ticks, seed, factors, copies, noise)
    columns = features(factors).of(*walk)
    return columns.reshape(-1, *columns.shape[2:]), outcome.reshape(-1, factors)


def met(rule: Rule, ticks: int, seed: int, copies: int = 20) -> tuple[FloatArray, FloatArray, Echo, FloatArray]:
    """(B, 2) postures, rates, echoes and outcomes of as many copies at the end of a run."""
    mine, (posture, rate, command, outcome) = features(), run(rule, ticks, seed, copies=copies)
    echo = mine.start(posture[0])
    for told in command[:-1]:
        echo = mine.after(echo, told)
    return posture[-1], rate[-1], echo, outcome[-1]


def frame(rule: Rule, seed: int = 0, factors: int = 2) -> Frame:
    """What a pilot of 1600 transitions would find."""
    columns, outcome = lived(rule, 400, seed, factors)
    return Frame.found(replace(features(factors), share=shares(columns, outcome)), columns, outcome)


def learned(rule: Rule, ticks: int = 1500, seed: int = 0, factors: int = 2) -> Explanations:
    """What is known after so much babbling in four copies, the pilot's counted in."""
    model = Explanations.empty(frame(rule, seed, factors), "joints")
    model.observe(*lived(rule, 400, seed, factors), foretell=False)
    model.observe(*lived(rule, ticks, seed + 1, factors))
    return model
