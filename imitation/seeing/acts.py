"""Recognising what somebody does with a thing: P(seen movement | primitive) from one's own play.

In play one has seen one's own hands and forehead move around things. Another's are seen from elsewhere, of another
size, or on a screen: for every primitive the likeliest way of looking at it is found, and what then remains decides,

    log P(seen | kind, primitive) = - TEMPER / 2 (r' C^-1 r + log |C|),   r = seen - (look of one's own mean),

C being how one's own movements vary about their means, all places and moments together, at that size (one C for all
kinds and primitives, for few were done of each), and how exactly one sees. A look at places is a similarity: a turn
about any axis, a size, a shift; a look at a screen is an affine camera (one image shows no depth). Where the camera is
need not be known.
"""

from collections.abc import Callable
from typing import Final

import numpy as np

from babbling.axes import FloatArray
from babbling.play import FINE, Play
from imitation.errors import ImitationError

TEMPER: Final = 0.2
"""Others move nearly as one does oneself: so much of what is seen counts. With it one is right as often as one is sure,
in two plays by which nothing else is judged."""
LEAST_M: Final = 0.003
"""m added to how much one's own movements vary: no better are they seen."""
PARTS: Final = 3
Misfit = Callable[[FloatArray], FloatArray]
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


def log_likelihood(play: Play, kind: int, tracks: FloatArray, noise: float, *, alone: bool = False) -> FloatArray:
    """(N, A) log P(seen | kind, primitive) of (N, L, 5, d) tracks, up to a constant for each of the N.

    Args:
        play: one's own.
        kind: of thing that is handled.
        tracks: places in m, any frame (d = 3), or positions on one image (d = 2); NaN is hidden.
        noise: standard deviation of what is seen, in the unit of the tracks.
        alone: the simpler peer: C is its own diagonal, every place is weighed by itself.

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
    found, covariance = np.full((count, len(play.outcomes.action.labels)), NEVER), one_s_covariance(play)
    covariance = np.diag(np.diag(covariance)) if alone else covariance
    weight = there / np.diag(covariance).reshape(-1, PARTS).mean(1)
    fits = (_on_places if points.shape[-1] == PARTS else _on_a_screen)(points, weight, covariance, noise)
    for primitive in np.flatnonzero(play.tried[kind]):
        found[:, primitive] = -TEMPER / 2 * fits(one_s_own(play, kind, int(primitive)))
    return found


def likelihood(play: Play, kind: int, tracks: FloatArray, noise: float, *, alone: bool = False) -> FloatArray:
    """(N, A) P(seen | primitive) / that of the likeliest."""
    logs = log_likelihood(play, kind, tracks, noise, alone=alone)
    return np.asarray(np.exp(logs - logs.max(1, keepdims=True)))


def one_s_own(play: Play, kind: int, primitive: int) -> FloatArray:
    """(P, 3) m, mean places of the points of `described`."""
    return np.asarray(play.moved[kind, primitive] * FINE / play.tried[kind, primitive]).reshape(-1, 3)


def one_s_covariance(play: Play) -> FloatArray:
    """(D, D) m^2, how the numbers of `described` vary about the means of all kinds and primitives, pooled; correlations
    shrunk, the more the fewer the tries, to none (oracle approximating shrinkage: Chen et al. 2010, eq. 23)."""
    count, sums = play.tried.reshape(-1, 1), play.moved.reshape(-1, play.moved.shape[-1]) * FINE
    done = count[:, 0] > 0
    within = play.moved_products * FINE**2 - sums[done].T @ (sums[done] / count[done])
    free, size = max(int(count.sum() - done.sum()), 1), len(within)
    found = within / free + LEAST_M**2 * np.eye(size)
    alone = np.diag(found)
    squares = (found**2 / np.outer(alone, alone)).sum()
    shrunk = ((1 - 2 / size) * squares + size**2) / ((free + 1 - 2 / size) * max(squares - size, 1e-9))
    keep = 1 - min(shrunk, 1.0)
    return np.asarray(keep * found + (1 - keep) * np.diag(alone))


def _on_places(points: FloatArray, weight: FloatArray, covariance: FloatArray, noise: float) -> Misfit:
    """(P, 3) means to (N,) r' C^-1 r + log |C| of (N, P, 3) points, in one's own frame; hidden ones have no weight."""
    patterns, which = np.unique(np.repeat(weight > 0, PARTS, 1), axis=0, return_inverse=True)
    alike = [
        (np.flatnonzero(which.ravel() == number), seen, *np.linalg.eigh(covariance[np.ix_(seen, seen)]))
        for number, seen in enumerate(patterns)
    ]

    def misfit(mean: FloatArray) -> FloatArray:
        off, size = _similar(mean, points, weight)
        turns = np.cross(np.eye(PARTS)[:, None], mean)
        nearly = np.concatenate([turns, mean[None], np.repeat(np.eye(PARTS)[:, None], len(mean), 1)]).reshape(7, -1)
        found = np.empty(len(points))
        for rows, seen, variance, axes in alike:
            total = variance + (noise / size[rows, None]) ** 2
            along, free = off[rows].reshape(len(rows), -1)[:, seen] @ axes, nearly[:, seen] @ axes
            known = (free / total[:, None]) @ free.T
            found[rows] = (along**2 / total + np.log(total)).sum(1) - _given_way(known, (along / total) @ free.T)
        return found

    return misfit


def _on_a_screen(points: FloatArray, weight: FloatArray, covariance: FloatArray, noise: float) -> Misfit:
    """The same of (N, P, 2) points, at one's own size."""
    count = points.shape[1]
    own = covariance.reshape(count, PARTS, count, PARTS).swapaxes(1, 2)

    def misfit(mean: FloatArray) -> FloatArray:
        off, camera, size = _affine(mean, points, weight)
        free = np.kron(np.column_stack([mean, np.ones(count)]), np.eye(2))
        found = np.empty(len(points))
        for n, seen in enumerate(weight > 0):
            look, rows = camera[n] / size[n], np.repeat(seen, 2)
            shown = (look @ own[np.ix_(seen, seen)] @ look.T).swapaxes(1, 2).reshape(rows.sum(), -1)
            whole, missed = shown + (noise / size[n]) ** 2 * np.eye(len(shown)), (off[n, seen] / size[n]).ravel()
            known = np.linalg.solve(whole, np.column_stack([free[rows], missed]))
            left = _given_way(free[rows].T @ known[None, :, :-1], (free[rows].T @ known[:, -1])[None])
            found[n] = missed @ known[:, -1] - left[0] + np.linalg.slogdet(whole)[1]
        return found

    return misfit


def _given_way(known: FloatArray, along: FloatArray) -> FloatArray:
    """(N,) by how much r' C^-1 r falls if one looks a little otherwise, as fits best by C: b' A^-1 b, A = J' C^-1 J (N,
    K, K), b = J' C^-1 r (N, K), J what such a change does to what is seen."""
    return np.asarray((along * np.linalg.solve(known, along[..., None])[..., 0]).sum(1))


def _similar(mean: FloatArray, points: FloatArray, weight: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Weighted Procrustes (Umeyama 1991): s R mean + t nearest to the points; (N, P, 3) what remains, turned and scaled
    back, R' (points - t) / s - mean, and (N,) s."""
    total = weight.sum(1)[:, None]
    ours = (weight[..., None] * mean).sum(1) / total
    theirs = (weight[..., None] * points).sum(1) / total
    x, y = mean - ours[:, None], points - theirs[:, None]
    u, s, vt = np.linalg.svd(np.einsum("np,npi,npj->nij", weight, y, x))
    sign = np.ones_like(s)
    sign[:, 2] = np.sign(np.linalg.det(u @ vt))
    turn = (u * sign[:, None]) @ vt
    size = (s * sign).sum(1) / np.einsum("np,npi->n", weight, x**2)
    size = np.maximum(size, 1e-9)
    return np.einsum("nji,npj->npi", turn, y) / size[:, None, None] - x, size


def _affine(mean: FloatArray, points: FloatArray, weight: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Weighted least squares: M mean + t nearest to the points; (N, P, 2) what remains, (N, 2, 3) M, (N,) its size."""
    given = np.concatenate([mean, np.ones((len(mean), 1))], 1)
    gram = np.einsum("np,pi,pj->nij", weight, given, given)
    camera = np.linalg.solve(gram, np.einsum("np,pi,npj->nij", weight, given, points))
    look = camera[:, :PARTS].swapaxes(1, 2)
    size = np.maximum(np.sqrt((look**2).sum((1, 2)) / 2), 1e-9)
    return points - np.einsum("pi,nij->npj", given, camera), look, size
