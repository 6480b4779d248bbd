"""Is that somebody like me? P(body like mine | places seen), by one's own body image (chapter, section 2.2: "like me").

What moves there has parts that are seen, or not, where one's own hands, head, elbows and shoulders are. If it is a body
like mine, some posture of mine, turned somewhere, at some size, has its parts nearly there (r: what is missed by);
if it is a thing that was built to do the same, they are only roughly there:

    log P(seen | mine) - log P(seen | thing) = TEMPER ((n - 1) / n sum_p mean_t log t(r_pt) / N(r_pt)    n parts seen
                                                       + sum log MISSING_MINE / MISSING_THING)    parts missing

t is Student's with 3 degrees of freedom and DIFFERS in every direction (others differ from me, now and then by much), N
a Gaussian of ABOUT. One part is needed to know where to look; a part is one witness however often it was looked at.
"""

from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.stats import multivariate_normal, multivariate_t

from babbling.axes import FloatArray
from babbling.body_image import Image
from imitation.acting.reaching import places, reach

DIFFERS: Final = 0.006
"""m by which the parts of somebody like me lie elsewhere than mine would, typically."""
ABOUT: Final = 0.05
"""m by which those of a thing do."""
MISSING_MINE, MISSING_THING = 0.05, 0.5
"""P(a part is never seen)."""
TEMPER: Final = 1 / 3
"""Parts that hang together say nearly the same: so much of their number counts."""
LEAST_SIZE: Final = 0.2
"""Of somebody, relative to me: what is smaller is not one's like."""
ROUNDS: Final = 4
"""Of finding postures for a way of looking, and a way of looking for postures."""


def residuals(image: Image, seen: FloatArray) -> FloatArray:
    """(L, P) m that each part of (L, P, 3) is away from where one's own best posture has it, seen so; NaN is hidden."""
    there = np.isfinite(seen).all(-1)
    postures = np.tile(image.rest, (len(seen), 1))
    for _ in range(ROUNDS):
        turn, size, shift = _look(places(image, postures)[there], seen[there])
        targets = (seen - shift) @ turn / size
        postures, _ = reach(image, targets, postures)
    return np.asarray(np.linalg.norm(places(image, postures) - targets, axis=-1))


def like_me(missed: FloatArray) -> float:
    """log P(seen | a body like mine) - log P(seen | a thing) of `residuals`."""
    there = np.isfinite(missed).any(0)
    count = int(there.sum())
    mine = multivariate_t(np.zeros(3), DIFFERS**2 * np.eye(3), df=3)
    thing = multivariate_normal(np.zeros(3), ABOUT**2 * np.eye(3))
    away = np.nan_to_num(missed[:, there])[..., None] * np.array([1.0, 0.0, 0.0])
    logs = (mine.logpdf(away) - thing.logpdf(away)).reshape(len(missed), count)
    seen = np.nanmean(np.where(np.isfinite(missed[:, there]), logs, np.nan), 0) if count else np.zeros(1)
    hidden = (~there).sum() * np.log(MISSING_MINE / MISSING_THING)
    return float(TEMPER * (seen.sum() * (count - 1) / max(count, 1) + hidden))


def _look(mine: FloatArray, seen: FloatArray) -> tuple[FloatArray, float, FloatArray]:
    """Turn (3, 3) about the upright, size and shift (3,) with which (N, 3) `mine` come nearest to `seen`: least squares
    (Umeyama 1991, with one axis kept)."""
    ours, theirs = mine.mean(0), seen.mean(0)
    x, y = mine - ours, seen - theirs
    flat = np.sum((x[:, 0] - 1j * x[:, 1]) * (y[:, 0] + 1j * y[:, 1]))
    turn = Rotation.from_rotvec([0.0, 0.0, float(np.angle(flat))]).as_matrix()
    size = max(float((abs(flat) + (x[:, 2] * y[:, 2]).sum()) / max((x**2).sum(), 1e-12)), LEAST_SIZE)
    return turn, size, theirs - size * turn @ ours
