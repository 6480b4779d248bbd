"""Which nameless part of somebody else is which of one's own? (chapter, sections 2.2 and 3.2)

Eq. (2) over assignments, all as likely beforehand: limb by limb, would my own parts point so?

    P(assignment | seen) = c prod_t prod_limbs P(d_1 .. d_k at t | limb)
    P(d_1 .. d_k | limb) = (1 - e) mean_n prod_i vMF(d_i; E[direction of part i | q_n], COARSE^-2) + e (4 pi)^-k

with the learned body image in postures q_n anywhere in one's range and, evenly, on the way there from rest: whatever
could be, and rather what is comfortable. Left and right are told apart by how far one's joints go to either side.

Directions alone decide little: where a limb has two joints for every part, it can show any movement of as many
directions within its range, so an arm may well be taken for a leg. Which parts touch, if that is seen too, says what
belongs together. A movement that is the same in its mirror image leaves left and right open, and so do parts at rest.
"""

from collections.abc import Iterator
from itertools import combinations, permutations

import numpy as np

from babbling.axes import BoolArray, FloatArray
from babbling.body_image import Image
from imitation.correspondence.inversion import COARSE
from imitation.correspondence.limbs import OwnLimb, own_limbs
from imitation.errors import ImitationError

FORGIVING = 0.02
"""Share of moments in which a limb of somebody else points in a way that one's own cannot."""
IMAGINED = 500
"""Postures q_n."""
GLANCE_S = 0.25
"""Time between two looks: moments any nearer say the same."""


def recognised(
    image: Image, seen: FloatArray, tick_s: float, rng: np.random.Generator, touching: BoolArray | None = None
) -> dict[int, int]:
    """Own part's number -> which of the A parts seen is it, the most probable assignment of all.

    Args:
        image: the learned body image.
        seen: (T, A, 3) directions in the torso's frame, one per tick; NaN where not seen.
        tick_s: duration of a tick.
        rng: which postures are imagined.
        touching: (A, A) whether two of them touch; None where that is not seen.

    Raises:
        ImitationError: more parts than one has, or parts that hang together as none of one's own do.
    """
    count = seen.shape[1]
    far = rng.uniform(image.low, image.high, (IMAGINED, len(image.low)))
    shown = image.expected(image.rest + rng.random((IMAGINED, 1)) * (far - image.rest))
    looks = seen[:: max(round(GLANCE_S / tick_s), 1)]
    kernel = (np.einsum("tax,npx->aptn", looks, shown) - 1) / COARSE**2 - np.log(2 * np.pi * COARSE**2)
    hidden = np.isnan(kernel)
    kernel = np.exp(np.where(hidden, -np.log(4 * np.pi), kernel)).astype(np.float32)
    best: dict[frozenset[int], tuple[float, dict[int, int]]] = {frozenset(): (0.0, {})}
    for limb in own_limbs(image.moves):
        guesses: dict[frozenset[int], tuple[float, dict[int, int]]] = {}
        for guess in _guesses(limb, image.moves, count, touching):
            dense = np.prod([kernel[a, p] for p, a in guess.items()], axis=0, dtype=np.float32)
            mean = (1 - FORGIVING) * dense.mean(-1) + FORGIVING * (4 * np.pi) ** -len(guess) if guess else np.ones(1)
            _keep(guesses, frozenset(guess.values()), float(np.log(mean).sum()), guess)
        after: dict[frozenset[int], tuple[float, dict[int, int]]] = {}
        for taken, (value, found) in best.items():
            for more, (gain, guess) in guesses.items():
                if not taken & more:
                    _keep(after, taken | more, value + gain, found | guess)
        best = after
    if (every := frozenset(range(count))) not in best:
        own = len(image.parts)
        raise ImitationError(f"{count} parts are seen that do not hang together as one's own {own} do; name them")
    return best[every][1]


def _keep(
    table: dict[frozenset[int], tuple[float, dict[int, int]]], key: frozenset[int], value: float, found: dict[int, int]
) -> None:
    if key not in table or value > table[key][0]:
        table[key] = value, found


def _guesses(limb: OwnLimb, moves: BoolArray, count: int, touching: BoolArray | None) -> Iterator[dict[int, int]]:
    """Own part -> seen part, in all ways in which what touches stays together; with parts left out where too few are
    seen. Own parts touch where the one hangs from the other: the next inwards that only senses of its own move."""
    parts, spare = limb.parts, len(moves) - count
    for size in range(max(len(parts) - spare, 0), min(len(parts), count) + 1):
        for chosen in combinations(parts, size):
            inner = [[j for j in range(i) if (moves[chosen[j]] <= moves[one]).all()] for i, one in enumerate(chosen)]
            hangs = [(i, j[-1]) for i, j in enumerate(inner) if j and size == len(parts)]
            for taken in permutations(range(count), size):
                if touching is not None and taken:
                    if touching[list(taken)].sum() > touching[np.ix_(taken, taken)].sum():
                        continue
                    if not all(touching[taken[i], taken[j]] for i, j in hangs):
                        continue
                yield dict(zip(chosen, taken, strict=True))
