"""Balance: what the soles will feel of a posture once it has settled, learned on one's own feet.

A body that stands feels loads on its soles and has an organ that feels how it leans. Four things are found, in this
order, each from what the one before left to be asked:

1. Pressure. Somebody rocks it gently while it stands still. Its loads (as shares of their sum) then change in two ways
   only, their first two principal components; turned so that each goes with one sense of the organ, they are the two
   directions of pressure x, -1 .. 1 from edge to edge.
2. What carries. It wiggles all joints a little: shares' = A (c - home). Joints whose column of A stands out carry it.
   Two of them whose effects on all but pressure cancel when they move together are a pair (both ankles; a hip and the
   ankle below it): what of a posture pairs can do without changing the loads is safe to do (`following`). What turns
   the organ in a way that no pressure goes with (a hip that turns about the upright) twists the legs, and stays home.
3. Synergies. Of all that pairs can do, the least movement that changes pressure along one direction, and nothing else.
4. Settled pressure. It moves ever further about, balanced by what it knows so far. The centre of pressure first goes
   the wrong way when an ankle pushes (it is non-minimum-phase), so what is learned is where it comes to:

       P(x, SETTLED ticks later | lean, offset),     lean = w . (1, c, c c') of the planned posture c,

   a Dirichlet table per direction: how far a posture without any offset would lean, in units of pressure, and how far
   along the synergy one is. Where the sole's edge is reached (|x| > SATURATED) nothing more can be felt, nor counted.
"""

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from babbling.axes import Axis, BoolArray, FloatArray, IntArray
from babbling.body import OfOneBody
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel
from babbling.kinds import Numbers, kind
from babbling.regression import Regression, regress
from babbling.synergies import find_pairs, synergies

SETTLED = 4
"""Ticks after which the pressure of a command is felt."""
SATURATED = 0.95
TRANSIENT_S = 1.0
"""What the first second after getting up feels like is not counted."""
UNEVEN = 0.1
"""Rocked every way, the soles feel the second direction at least so much as the first."""
CARRIES = 1 / 3
"""A joint carries if it changes the loads by more than this share of what the fourth strongest does."""
TWISTS = 0.2
"""A joint twists the legs if it turns the organ this much of its own pace, in a way that no synergy does."""
NOISES = 12.0
"""Singular values of A below so many times the noise of one of its entries are noise's."""
STRENGTH = 30.0
"""Pseudo-counts of the table's linear-Gaussian prior."""
LEAN, OFFSET, CELLS = 4.0, 0.5, (65, 65, 31)
"""How far axes reach: units of pressure, rad; and their sizes."""
PRODUCTS = (1.0, 0.3, 0.1, 0.03, 1e-6)
"""Prior standard deviations of the weights of products of joints, pressure per rad^2, widest first."""
PRIORS = {"one": 0.5, "joint": 0.3, "offset": 10.0, "moving": 0.3}
"""The same of other weights, about those that wiggling found."""
WORSE = 1.03
"""The narrowest prior is taken that foretells held-out copies at most this much worse than the best."""
EVERY = 5
"""Ticks between the rows that lean is fitted to: neighbours say the same."""


class Stood(NamedTuple):
    """A run on one's own feet: T ticks of B copies."""

    planned: FloatArray
    """(T, B, F) postures without offsets."""
    offset: FloatArray
    """(T, B, 2) along the synergies, rad."""
    told: FloatArray
    """(T, B, F) postures asked for."""
    loads: FloatArray
    """(T, B, L) felt at the end of each tick."""
    turning: FloatArray
    """(T, B, 3) what the balance organ felt of turning, rad/s."""
    upright: BoolArray
    """(T, B) not fallen, nor about to."""

    @property
    def moving(self) -> FloatArray:
        """(T, B, 2 F) how the command moved of late: pace (rad/s) and bend (10 rad/s^2) over some ticks."""
        then = [np.concatenate([self.told[:1].repeat(n, 0), self.told[:-n]]) for n in (2, 3, 4, 6)]
        return np.concatenate([(self.told - then[2]) / 0.08, (self.told - 2 * then[1] + then[3]) / 0.036], -1)

    def settled(self, tick_s: float, weight: float) -> tuple[slice, slice, BoolArray]:
        """Ticks of commands, those when they have settled, and (T - SETTLED, B) which of these count: soles that carry
        less than half the weight are in the air."""
        kept = self.upright & (self.loads.sum(-1) > weight / 2)
        kept[: round(TRANSIENT_S / tick_s)] = False
        return slice(None, -SETTLED), slice(SETTLED, None), kept[SETTLED:]


def shares(loads: FloatArray) -> FloatArray:
    """(..., L) loads as shares of their sum, of 1 N at least."""
    return np.asarray(loads / np.maximum(loads.sum(-1, keepdims=True), 1.0))


def find_pressure(loads: FloatArray, organ: FloatArray) -> tuple[FloatArray, list[int]]:
    """(2, L) weights of the shares of loads that are pressure, from (T, B, L) loads and (T, B, O) senses of the balance
    organ while one is rocked; and which two senses gave their directions.

    Raises:
        BabblingError: the loads do not change in two ways.
    """
    split = shares(loads)
    felt, rest = ((v - v.mean(0)).reshape(-1, v.shape[-1]) for v in (organ, split))  # everybody about its own mean
    _, size, axes = np.linalg.svd(rest, full_matrices=False)
    if size[1] <= UNEVEN * size[0]:
        raise BabblingError("rocked, it feels nothing of it in its soles: is it standing on them?")
    moved = rest @ axes[:2].T
    told = np.linalg.lstsq(moved, felt, rcond=None)[0]  # (2, O)
    right = 1 - ((felt - moved @ told) ** 2).sum(0) / np.maximum((felt**2).sum(0), 1e-12)
    first = int(right.argmax())
    apart = np.abs(told[0] * told[1, first] - told[1] * told[0, first]) / np.linalg.norm(told, axis=0)
    second = int((right * apart).argmax())
    weights = told[:, [first, second]].T @ axes[:2]
    return weights / np.abs(weights).max(1, keepdims=True), [first, second]


@kind("balance", "make one with `imitate babble --stand`")
@dataclass(frozen=True)
class Balance(OfOneBody):
    """What one body has learned of standing; see the module. L loads, F motors, X features of lean."""

    fingerprint: str
    home: Annotated[FloatArray, Numbers("motor", "rad")]
    """(F,) the posture that wiggling was about."""
    reach: Annotated[FloatArray, Numbers("end motor", "rad")]
    """(2, F) how far joints go."""
    lines: Annotated[IntArray, Numbers("load", low=0, high=1e6)]
    """(L,) sense lines of the loads."""
    weight: Annotated[float, Numbers(unit="N", low=0, zero=False)]
    """Sum of the loads at rest."""
    pressing: Annotated[FloatArray, Numbers("direction load")]
    """(2, L) pressure x = pressing . shares."""
    effects: Annotated[FloatArray, Numbers("load motor")]
    """(L, F) A, shares per rad."""
    carries: Annotated[FloatArray, Numbers("motor", low=0, high=1)]
    """(F,) 1 for joints that carry, else 0."""
    following: Annotated[FloatArray, Numbers("motor motor")]
    """(F, F) what of a posture beside home can be done with both soles flat."""
    synergy: Annotated[FloatArray, Numbers("direction motor")]
    """(2, F) rad of each joint per rad of offset."""
    rest: Annotated[FloatArray, Numbers("direction")]
    """(2,) pressure at home."""
    weights: Annotated[FloatArray, Numbers("direction feature")]
    """(2, X) w."""
    forward_model: Annotated[ForwardModel, Numbers("direction")]
    """P(settled pressure | lean, offset)."""
    minutes: Annotated[FloatArray, Numbers("stage", "min", low=0)]
    """Body time of rocking, wiggling and every further stage."""
    falls: Annotated[FloatArray, Numbers("stage", low=0)]
    """How often it fell meanwhile."""
    there: Annotated[FloatArray, Numbers("side direction")]
    """(2, 2) sub-goals of pressure from which one leg can be lifted (`babbling.one_leg`); 0 where none was found."""
    free: Annotated[FloatArray, Numbers("side motor", low=0, high=1)]
    """(2, F) 1 for carrying joints that do not carry then, else 0."""

    def pressed(self, loads: FloatArray) -> FloatArray:
        """(..., 2) pressure of (..., L) loads."""
        return np.asarray(shares(loads) @ self.pressing.T)

    def safe(self, postures: FloatArray) -> FloatArray:
        """(..., F) what of (..., F) postures can be done with both soles flat."""
        return np.clip(self.home + (postures - self.home) @ self.following.T, *self.reach)

    def leaning(self, planned: FloatArray) -> FloatArray:
        """(..., 2) where pressure would settle in (..., F) postures without any offset."""
        return np.asarray(features(planned - self.home) @ self.weights.T)


def features(beside: FloatArray) -> FloatArray:
    """(..., X) 1, (..., F) angles, and all products of two."""
    one, two = np.triu_indices(beside.shape[-1])
    return np.concatenate([np.ones((*beside.shape[:-1], 1)), beside, beside[..., one] * beside[..., two]], -1)


def wiggled(
    run: Stood,
    home: FloatArray,
    reach: FloatArray,
    pressure: FloatArray,
    lines: IntArray,
    tick_s: float,
    fingerprint: str,
) -> Balance:
    """Points 2 and 3: what carries, pairs, synergies; no table yet, and a lean that is the line of the wiggles.

    Raises:
        BabblingError: fewer than two joints carry.
    """
    weight = float(np.median(run.loads[:, run.upright.all(0)].sum(-1)))
    before, after, kept = run.settled(tick_s, weight)
    x = np.concatenate([(run.told - home)[before], run.moving[after]], -1)
    y, count = shares(run.loads)[after], len(home)

    def slopes(copies: slice) -> FloatArray:
        rows, keep = (x[:, copies], y[:, copies]), kept[:, copies]
        own = [v - (v * keep[..., None]).sum(0) / np.maximum(keep.sum(0), 1)[:, None] for v in rows]
        return regress(own[0][keep][:, None], own[1][keep][:, None]).coefficients[0, :, :count]

    effects = slopes(slice(None))
    noise = float((slopes(slice(0, None, 2)) - slopes(slice(1, None, 2))).std() / 2)
    size = np.linalg.norm(effects, axis=0)
    carries = size > CARRIES * np.sort(size)[-4]
    patterns: FloatArray = np.asarray(np.linalg.pinv(pressure), float)  # (L, 2) what unit pressure does to the shares
    pairs = find_pairs(effects - patterns @ (pressure @ effects), carries)
    if not pairs:
        raise BabblingError("no joints carry it in pairs; who stands has two of each, or a hip and an ankle")
    together = np.stack([np.eye(count)[i] + sign * np.eye(count)[j] for i, j, sign in pairs], 1)
    synergy = synergies(effects @ together, pressure) @ together.T
    pace = [(v - v.mean(0))[after][kept] for v in (run.moving[..., :count], run.turning)]  # rad/s
    turns = regress(pace[0][:, None], pace[1][:, None]).coefficients[0]  # (3, F)
    mended = np.linalg.qr(turns @ synergy.T)[0]
    carries |= np.linalg.norm(turns - mended @ (mended.T @ turns), axis=0) > TWISTS
    paired = np.where(carries, 0.0, 1.0) * np.eye(count) + together @ together.T / 2
    gain = (effects * carries).T @ (effects * carries) / (NOISES * noise) ** 2
    following = paired @ np.linalg.inv(np.eye(count) + gain @ gain) @ paired
    rest = pressure @ y[kept].mean(0)
    products = np.zeros((2, count * (count + 1) // 2))
    lean = np.column_stack([rest, pressure @ effects, products])
    return Balance(
        fingerprint, home, reach, lines, weight, pressure, effects, carries.astype(float), following, synergy, rest,
        lean, _empty(fingerprint), np.zeros(0), np.zeros(0), np.zeros((2, 2)), np.zeros((2, count)),
    )  # fmt: skip


def settled(found: Balance, runs: list[Stood], tick_s: float) -> tuple[FloatArray, ForwardModel]:
    """Point 4: the weights of lean and the table, from all runs so far. What moving adds to pressure at the time
    (`Stood.moving`) is fitted too, and taken out of what the table counts."""
    count, parts = len(found.home), list[tuple[FloatArray, FloatArray, FloatArray, FloatArray, IntArray]]()
    for number, run in enumerate(runs):
        before, after, kept = run.settled(tick_s, found.weight)
        copy = np.broadcast_to(np.arange(kept.shape[1]) + 1000 * number, kept.shape)
        x, felt = features((run.planned - found.home)[before][kept]), found.pressed(run.loads[after])
        parts.append((x, run.offset[before][kept], run.moving[after][kept], felt[kept], copy[kept]))
    x, offset, moving, felt, copy = (np.concatenate(part) for part in zip(*parts, strict=True))
    held_out, lean, steady = np.isin(copy, np.unique(copy)[::4]), [], felt.copy()
    scale = np.concatenate([
        [PRIORS["one"]], np.full(count, PRIORS["joint"]), np.full(x.shape[1] - 1 - count, np.nan),
        np.full(2, PRIORS["offset"]), np.full(2 * count, PRIORS["moving"]),
    ])  # fmt: skip
    z = np.concatenate([x, offset, moving], 1)
    for k in (0, 1):
        known = np.zeros(len(scale))
        known[0], known[1 : 1 + count] = found.rest[k], found.pressing[k] @ found.effects
        known[x.shape[1] : x.shape[1] + 2] = found.pressing[k] @ found.effects @ found.synergy.T
        inside = np.abs(felt[:, k]) < SATURATED
        rows = np.flatnonzero(inside)[::EVERY]
        rest = felt[:, k] - z @ known

        def fit(which: IntArray, width: float, rest: FloatArray = rest) -> FloatArray:
            wide = np.where(np.isnan(scale), width, scale)
            sums = Regression(1, len(wide), 1)
            sums.observe((z[which] * wide)[:, None], rest[which][:, None, None])
            return np.asarray(sums.fit_with_noise()[0].coefficients[0, 0] * wide)

        own, others = rows[~held_out[rows]], rows[held_out[rows]]
        misses = [float(((rest[others] - z[others] @ fit(own, width)) ** 2).mean()) for width in PRODUCTS]
        width = [w for w, miss in zip(PRODUCTS, misses, strict=True) if miss <= WORSE * min(misses)][-1]
        weights = known + fit(rows, width)
        lean.append(weights[: x.shape[1]])
        steady[:, k] -= moving @ weights[x.shape[1] + 2 :]
    told = np.where((np.abs(felt) < SATURATED) & (np.abs(steady) < 1), steady, np.nan)
    table = _empty(found.fingerprint)
    table.observe((x @ np.stack(lean).T,), offset, told)
    return np.stack(lean), table


def _empty(fingerprint: str) -> ForwardModel:
    names, reach = (("leaning", "1"), ("shift", "rad"), ("settled", "1")), (LEAN, OFFSET, 1.0)
    lean, offset, pressure = (
        Axis(*name, np.full(2, -most), np.full(2, most), size)
        for name, most, size in zip(names, reach, CELLS, strict=True)
    )
    two = ("direction 0", "direction 1")
    return ForwardModel((lean,), offset, pressure, factors=two, prior_strength=STRENGTH, fingerprint=fingerprint)
