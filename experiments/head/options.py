"""Options of `imitate head`."""

from typing import Annotated

import numpy as np

from experiments.shared.options import (
    DEG,
    EyeOptions,
    Flag,
    M,
    Minutes,
    N,
    S,
    Selection,
    TableOptions,
    ToRead,
    choices,
    known,
    options,
    within,
    written,
)
from models.biclops.movements import MOVEMENTS, movement

MOST_SEQUENCES = 64


@options
class Config(TableOptions, EyeOptions):
    """Options of `imitate head`."""

    movement: Annotated[
        str, known(lambda name: movement(name, np.random.default_rng(0))), written(choices(MOVEMENTS))
    ] = "random"
    """What the teacher does."""
    sequences: Annotated[int, within(1, MOST_SEQUENCES), N] = 1
    """How many such sequences; the first one is recorded."""
    study: Flag = False
    """20 random sequences."""
    deferred: Flag = False
    """Imitate in a new process, from the memory file alone, in another room."""
    memory: Annotated[ToRead | None, written("FILE.nc", "watches a teacher")] = None
    """Imitate from the memory file that an earlier run left (its mind.nc beside it), without a teacher."""
    distance: Annotated[float, within(0.4, 1.2, "m, where a face is made out"), M] = 0.7
    """Metres between the heads."""
    distractor: Flag = False
    """Things of the face's own colours cross the view; Kalman, particles and simpler ways of tracking are compared."""
    occlusion_s: Annotated[float, within(0, 3, "seconds"), S] = 0.3
    """How long a card hides the face, somewhere in each sequence; 0 for none."""
    babbling_minutes: Minutes = 8.0
    """Body-minutes of babbling with the neck, over all copies."""
    lessons: Annotated[int, within(100, 5000, "mirrored postures"), N] = 400
    """Postures that the caregiver mirrors."""
    selection: Selection = "map"
    """Selection rule on Eq. (1)'s posterior."""
    start_pan_deg: Annotated[float, within(-90, 90, "degrees"), DEG] = 0.0
    """Where the imitator happens to look at first; it searches when it sees no face there."""
    search_s: Annotated[float, within(0, 120, "seconds", above=True), S] = 12.0
    """Seconds after which a search for a face is given up."""
    absent: Flag = False
    """Nobody is there."""
