"""Trying: first the right part, then the right way to move it (chapter, section 2.2: infants correct their response).

The first try is drawn from Eq. (1)'s posterior over postures one has been in: the part is right, the way is rough.
From then on the imitator looks at itself after every try and corrects by what it sees it missed by, through the slope
of its body image at the posture it feels: matching to target, the loop of the chapter's Figure 9.
"""

from collections.abc import Callable

import numpy as np

from babbling.axes import FloatArray
from babbling.body_image import Image
from imitation.correspondence.organ import owners
from imitation.inference.bayes import action_posterior

GAIN = 0.7
"""Share of what was missed that the next try corrects."""
DAMPING = 0.02
"""Keeps a correction small where a posture hardly changes the direction."""
ROUGH = 0.3
"""rad: how far off a remembered posture may look and still be taken for a try."""


def try_again(
    image: Image,
    part: int,
    wanted: FloatArray,
    start: FloatArray,
    look: Callable[[FloatArray], FloatArray],
    count: int,
    rng: np.random.Generator,
) -> FloatArray:
    """(count + 1, F) postures, the first `start`: only the senses of the identified part are moved.

    Args:
        image: the body image.
        part: its number.
        wanted: (3,) where it should point.
        start: (F,) posture before the first try.
        look: what is seen of that part in a posture (F,): (3,), with noise.
        count: tries.
        rng: chance of the first try.
    """
    own = np.flatnonzero(owners(image.moves) == part)
    one = image.images[image.parts[part]]
    tried = [start.copy()]
    if count:
        remembered = np.tile(start, (len(image.library), 1))
        remembered[:, own] = image.library[:, own]
        misses = ((one.expected(remembered) - wanted) ** 2).sum(1)
        likelihood = np.exp(-(misses - misses.min()) / (2 * ROUGH**2))
        comfort = np.exp(-((remembered - start) ** 2).sum(1) / 2)
        posterior = action_posterior(likelihood, comfort / comfort.sum()).probability
        tried.append(remembered[rng.choice(len(posterior), p=posterior)])
    for _ in range(count - 1):
        here = tried[-1]
        _, slope = one.slope(here[None], own)
        miss = wanted - look(here)
        step = np.linalg.solve(slope[0].T @ slope[0] + DAMPING * np.eye(len(own)), slope[0].T @ miss)
        after = here.copy()
        after[own] = np.clip(here[own] + GAIN * step, image.low[own], image.high[own])
        tried.append(after)
    return np.stack(tried)
