"""Options of `imitate head`."""

from typing import Annotated

import numpy as np

from experiments.shared.options import EyeOptions, Minutes, Selection, TableOptions, ToRead, known, options, within
from models.biclops.movements import movement

MOST_SEQUENCES = 64


@options
class Config(TableOptions, EyeOptions):
    """Options of `imitate head`."""

    movement: Annotated[str, known(lambda name: movement(name, np.random.default_rng(0)))] = "random"
    """What the teacher does: nod, shake, look_around or random."""
    sequences: Annotated[int, within(1, MOST_SEQUENCES)] = 1
    """How many such sequences; the first one is recorded."""
    study: bool = False
    """20 random sequences."""
    deferred: bool = False
    """Imitate in a new process, from the memory file alone, in another room."""
    memory: ToRead | None = None
    """Imitate from the memory file that an earlier run left (its mind.nc beside it), without a teacher."""
    distance: Annotated[float, within(0.4, 1.2, "m, where a face is made out")] = 0.7
    """m between the heads."""
    distractor: bool = False
    """Things of the face's own colours cross the view; Kalman, particles and simpler ways of tracking are compared."""
    occlusion_s: Annotated[float, within(0, 3, "seconds")] = 0.3
    """How long a card hides the face, somewhere in each sequence; 0 for none."""
    babbling_minutes: Minutes = 8.0
    """Body-minutes of babbling with the neck, over all copies."""
    lessons: Annotated[int, within(100, 5000, "mirrored postures")] = 400
    """Postures that the caregiver mirrors."""
    selection: Selection = "map"
    """Selection rule on Eq. (1)'s posterior: mean, map or matching."""
    start_pan_deg: Annotated[float, within(-90, 90, "degrees")] = 0.0
    """Where the imitator happens to look at first; it searches when it sees no face there."""
    search_s: Annotated[float, within(0, 120, "seconds", above=True)] = 12.0
    """Seconds after which a search for a face is given up."""
    absent: bool = False
    """Nobody is there."""
