"""Recognising what somebody does with a thing: P(seen movement | primitive) from one's own play.

In play one has seen one's own hands and forehead move around things. Another's are seen from elsewhere, of another
size, or on a screen: for every primitive the best way of looking at it is found, and what then remains decides,

    log P(seen | kind, primitive) = - TEMPER / 2 sum_i (r_i^2 / v_i + log v_i),   r = seen - (look of one's own mean),

v being how much one's own movements with such things vary about their means, at that size (one v for all primitives,
for few were done of each). A look at places is a similarity: a turn about any axis, a size, a shift; a look at a screen
is an affine camera (one image shows no depth). Where the camera is need not be known.
"""

from typing import Final

import numpy as np

from babbling.axes import FloatArray
from babbling.play import FINE, Play
from imitation.errors import ImitationError

TEMPER: Final = 1 / 6
"""Neighbouring looks and coordinates say nearly the same: so much of their number counts."""
LEAST_M: Final = 0.003
"""m added to how much one's own movements vary: no better are they seen."""
PARTS: Final = 3
NEVER: Final = -1e6
"""Log likelihood of what one has never done with such a thing."""


def canonical(tracks: FloatArray) -> FloatArray:
    """(N, L, 5, d) tracks of left hand, right hand, forehead, a and b as if the right hand had moved more: what one
    does with either hand is one primitive. Places (d = 3) are mirrored from left to right, hands change names."""
    travel = np.nansum(np.linalg.norm(np.diff(tracks[:, :, :2], axis=1), axis=-1), axis=1)
    swap = travel[:, 0] > travel[:, 1]
    found = tracks.copy()
    found[swap] = tracks[swap][:, :, [1, 0, 2, 3, 4]]
    if tracks.shape[-1] == PARTS:
        found[swap, ..., 1] *= -1
    return found


def described(tracks: FloatArray) -> FloatArray:
    """(N, D) numbers of (N, L, 5, 3) tracks: parts at every look, then a and b at the first, m from the middle of the
    thing as it was first seen."""
    tracks = canonical(tracks)
    away = tracks - tracks[:, :1, PARTS:].mean(2, keepdims=True)
    count = len(tracks)
    return np.concatenate([away[:, :, :PARTS].reshape(count, -1), away[:, 0, PARTS:].reshape(count, -1)], 1)


def log_likelihood(play: Play, kind: int, tracks: FloatArray, noise: float) -> FloatArray:
    """(N, A) log P(seen | kind, primitive) of (N, L, 5, d) tracks, up to a constant for each of the N.

    Args:
        play: one's own.
        kind: of thing that is handled.
        tracks: places in m, any frame (d = 3), or positions on one image (d = 2); NaN is hidden.
        noise: standard deviation of what is seen, in the unit of the tracks.

    Raises:
        ImitationError: so many looks as in play are needed.
    """
    seen = canonical(tracks)
    count, looks = seen.shape[:2]
    if looks * PARTS * 3 + 6 != play.moved.shape[-1]:
        raise ImitationError(f"{looks} looks at an act; play had {(play.moved.shape[-1] - 6) // 9}, as many are needed")
    middle = np.nanmean(seen[:, :1, PARTS:], axis=2, keepdims=True)
    seen = seen - middle
    points = np.concatenate([seen[:, :, :PARTS].reshape(count, looks * PARTS, -1), seen[:, 0, PARTS:]], 1)
    there = np.isfinite(points).all(-1)
    points = np.where(there[..., None], points, 0)
    found = np.full((count, len(play.outcomes.action.labels)), NEVER)
    spread = one_s_spread(play, kind)
    weight = there / spread**2
    for primitive in np.flatnonzero(play.tried[kind]):
        mean = one_s_own(play, kind, int(primitive))
        shown, size = _similar(mean, points, weight) if points.shape[-1] == 3 else _affine(mean, points, weight)
        variance = (size[:, None] * spread) ** 2 + noise**2
        missed = ((points - shown) ** 2).sum(-1) / variance + points.shape[-1] * np.log(variance / size[:, None] ** 2)
        found[:, primitive] = -TEMPER / 2 * (missed * there).sum(1)
    return found


def likelihood(play: Play, kind: int, tracks: FloatArray, noise: float) -> FloatArray:
    """(N, A) P(seen | primitive) / that of the likeliest."""
    logs = log_likelihood(play, kind, tracks, noise)
    return np.asarray(np.exp(logs - logs.max(1, keepdims=True)))


def one_s_own(play: Play, kind: int, primitive: int) -> FloatArray:
    """(P, 3) m, mean places of the points of `described`."""
    return np.asarray(play.moved[kind, primitive] * FINE / play.tried[kind, primitive]).reshape(-1, 3)


def one_s_spread(play: Play, kind: int) -> FloatArray:
    """(P,) m per axis, how much each point varies about the means of all primitives, pooled."""
    count = play.tried[kind][:, None]
    mean = play.moved[kind] * FINE / np.maximum(count, 1)
    within = (play.moved_squares[kind] * FINE**2 - count * mean**2).sum(0)
    variance = np.maximum(within, 0) / max(int(count.sum()) - len(count), 1)
    return np.asarray(np.sqrt(variance.reshape(-1, 3).mean(1) + LEAST_M**2))


def _similar(mean: FloatArray, points: FloatArray, weight: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Weighted Procrustes (Umeyama 1991): (N, P, 3) s R mean + t nearest to the points, and (N,) s."""
    total = weight.sum(1)[:, None]
    ours = (weight[..., None] * mean).sum(1) / total
    theirs = (weight[..., None] * points).sum(1) / total
    x, y = mean - ours[:, None], points - theirs[:, None]
    u, s, vt = np.linalg.svd(np.einsum("np,npi,npj->nij", weight, y, x))
    sign = np.ones_like(s)
    sign[:, 2] = np.sign(np.linalg.det(u @ vt))
    turn = (u * sign[:, None]) @ vt
    size = (s * sign).sum(1) / np.einsum("np,npi->n", weight, x**2)
    return size[:, None, None] * np.einsum("nij,npj->npi", turn, x) + theirs[:, None], size


def _affine(mean: FloatArray, points: FloatArray, weight: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Weighted least squares: (N, P, 2) M mean + t nearest to the points, and (N,) the size of M per axis."""
    given = np.concatenate([mean, np.ones((len(mean), 1))], 1)
    gram = np.einsum("np,pi,pj->nij", weight, given, given)
    camera = np.linalg.solve(gram, np.einsum("np,pi,npj->nij", weight, given, points))
    size = np.sqrt((camera[:, :3] ** 2).sum((1, 2)) / 2)
    return np.einsum("pi,nij->npj", given, camera), np.maximum(size, 1e-9)
