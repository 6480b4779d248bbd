"""A world of two soles that is known to the last number: loads are lines in the posture, pressure leans with a product.

Ten joints: four pairs that carry (two of them mirrored), and two arms. What pressure does when a posture was just
changed is the wrong way round for some ticks, as in a body.
"""

from dataclasses import replace
from itertools import islice

import numpy as np

from babbling.axes import FloatArray
from babbling.balance import Balance, Stood, settled, wiggled
from babbling.exploration import MotorRange, smooth

TICK, WEIGHT, COUNT = 0.02, 70.0, 10
PAIRS = {(0, 1, 1), (2, 3, -1), (4, 5, 1), (6, 7, -1)}
"""Joints (i, j, sign) that strain nothing when i and sign j move together."""
PRESSURE = np.zeros((2, COUNT))
"""Pressure per rad of each joint."""
PRESSURE[0, :2], PRESSURE[1, 2:4], PRESSURE[0, 4:6], PRESSURE[1, 6:8] = 3.0, (2.0, -2.0), -1.5, (1.5, -1.5)
FRONT, LEFT = np.array([1, 1, -1, -1, 0.8, 0.8, -0.8, -0.8]), np.array([1, 1, 1, 1, -1, -1, -1, -1.0])
PATTERNS: FloatArray = np.linalg.pinv(np.stack([FRONT, LEFT]))
"""(8, 2) shares per unit of pressure."""
STRAINS = np.linalg.qr(np.column_stack([np.ones(8), FRONT, LEFT, np.eye(8)[:, :5]]))[0][:, 3:7].T
"""(4, 8) what each pair does to the loads beside pressure, when it moves against itself."""
EFFECTS = PATTERNS @ PRESSURE
for _one, (_i, _j, _sign) in zip(STRAINS, sorted(PAIRS), strict=True):
    EFFECTS[:, _i] += _one
    EFFECTS[:, _j] -= _sign * _one
HOME = np.linspace(-0.3, 0.4, COUNT)
REACH = HOME + np.array([[-2.0], [1.5]])
REST = np.array([-0.1, 0.05])
WRONG = np.array([-0.1, -0.15])
"""Pressure a moment after a rad/s of pressure per second: the wrong way."""
PRODUCT, MUCH = (0, 8), 2.0
"""Two joints whose product leans, in the first direction, pressure per rad^2."""


TURNS = np.stack([PRESSURE[0] / 6, PRESSURE[1] / 4, np.zeros(COUNT)])
"""What each joint turns of the balance organ, rad/s per rad/s: a lean, and nothing about the upright."""


def turning(told: FloatArray, rng: np.random.Generator, turns: FloatArray = TURNS) -> FloatArray:
    """(T, B, 3) what the organ feels of (T, B, COUNT) commands."""
    pace = np.diff(told, axis=0, prepend=told[:1]) / TICK
    return np.asarray(pace @ turns.T + 0.01 * rng.standard_normal((*told.shape[:2], 3)))


def moves(reach: FloatArray | float, copies: int, seconds: float, rng: np.random.Generator, width: int) -> FloatArray:
    """(T, B, width) about 0."""
    most, still = np.broadcast_to(reach, width), np.zeros(width)
    span = MotorRange(-most, most, still, np.full(width, 0.6), still)
    return np.array(list(islice(smooth(span, copies, TICK, rng, decades=0.9), round(seconds / TICK))))


def settling(pressure: FloatArray) -> FloatArray:
    """(T, B, 2) pressure as it is felt, four ticks later and the wrong way first, of what commands settle to."""
    held = np.concatenate([pressure[:1].repeat(6, 0), pressure])
    return np.asarray(held[2:-4] + WRONG * (held[6:] - held[2:-4]) / 0.08)


def felt(shares: FloatArray, rng: np.random.Generator) -> FloatArray:
    """(T, B, 8) loads of individuals: everyone weighs something else, and every load is a little noisy."""
    weight = WEIGHT * rng.uniform(0.9, 1.1, (shares.shape[1], 1))
    return np.asarray(weight * (shares + 1e-3 * rng.standard_normal(shares.shape)))


def wiggle(rng: np.random.Generator, copies: int = 12, uneven: float = 0.02, turns: FloatArray = TURNS) -> Stood:
    """Everyone moves all joints a little, about an own way of standing."""
    beside = moves(0.04, copies, 8.0, rng, COUNT)
    late = np.concatenate([beside[:1].repeat(4, 0), beside[:-4]])
    own = 1 / 8 + PATTERNS @ REST + uneven * rng.uniform(-1, 1, (copies, 8))
    strain = late @ (EFFECTS - PATTERNS @ PRESSURE).T
    loads = felt(own + strain + settling(beside @ PRESSURE.T) @ PATTERNS.T, rng)
    nothing = np.zeros((*beside.shape[:2], 2))
    told = HOME + beside
    return Stood(told, nothing, told, loads, turning(told, rng, turns), np.ones(beside.shape[:2], bool))


def learned(rng: np.random.Generator, turns: FloatArray = TURNS) -> Balance:
    """What wiggling teaches."""
    return wiggled(wiggle(rng, turns=turns), HOME, REACH, np.stack([FRONT, LEFT]), np.arange(8), TICK, "soles")


def lean(postures: FloatArray, product: float = MUCH) -> FloatArray:
    """(..., 2) where pressure settles without an offset."""
    beside = postures - HOME
    more = product * beside[..., PRODUCT[0]] * beside[..., PRODUCT[1]]
    return np.asarray(REST + beside @ PRESSURE.T + np.stack([more, 0 * more], -1))


def stand(
    rng: np.random.Generator,
    synergy: FloatArray,
    *,
    product: float = MUCH,
    offsets: float = 0.15,
    copies: int = 12,
    gain: float = 1.0,
    legs: float = 0.12,
) -> Stood:
    """Everyone moves about and explores offsets; beyond the soles' edges nothing more is felt."""
    beside = moves(np.where(np.arange(COUNT) < 8, legs, 0.8), copies, 8.0, rng, COUNT)
    beside[:, ::2, 1:8] *= 0.3
    offset = moves(offsets, copies, 8.0, rng, 2)
    planned, told = HOME + beside, HOME + beside + offset @ synergy
    pressure = settling(lean(planned, product) + gain * offset @ (PRESSURE @ synergy.T).T)
    pressure = np.clip(pressure + 0.02 * rng.standard_normal(pressure.shape), -1, 1)
    loads = felt(1 / 8 + pressure @ PATTERNS.T, rng)
    return Stood(planned, offset, told, loads, turning(told, rng), np.ones(beside.shape[:2], bool))


def stood(rng: np.random.Generator, bouts: int = 2) -> Balance:
    """What wiggling and some bouts of moving about teach."""
    known = learned(rng)
    weights, table = settled(known, [stand(rng, known.synergy) for _ in range(bouts)], TICK)
    once = np.ones(1 + bouts)
    return replace(known, weights=weights, forward_model=table, minutes=1.6 * once, falls=0 * once)
