"""Options of `imitate head`."""

from pathlib import Path

import numpy as np

from experiments.shared.options import EyeOptions, options
from models.biclops.movements import movement

MOST_SEQUENCES = 64


@options
class Config(EyeOptions):
    """Options of `imitate head`."""

    movement: str = "random"
    """What the teacher does: nod, shake, look_around or random."""
    sequences: int = 1
    """How many such sequences; the first one is recorded."""
    study: bool = False
    """20 random sequences."""
    deferred: bool = False
    """Imitate in a new process, from the memory file alone, in another room."""
    memory: Path | None = None
    """Imitate from the memory file that an earlier run left (its mind.nc beside it), without a teacher."""
    distance: float = 0.7
    """m between the heads."""
    occlusion_s: float = 0.3
    """How long a card hides the face, somewhere in each sequence; 0 for none."""
    babbling_minutes: float = 8.0
    """Body-minutes of babbling with the neck, over all copies."""
    lessons: int = 400
    """Postures that the caregiver mirrors."""
    selection: str = "mean"
    """Selection rule on Eq. (1)'s posterior: mean, map or matching."""
    start_pan_deg: float = 0.0
    """Where the imitator happens to look at first; it searches when it sees no face there."""
    search_s: float = 12.0
    """Seconds after which a search for a face is given up."""
    absent: bool = False
    """Nobody is there."""

    def check(self) -> None:
        """See `Options`."""
        super().check()
        self.check_range("sequences", 1, MOST_SEQUENCES)
        self.check_range("occlusion_s", 0.0, 3.0, "seconds")
        self.check_range("search_s", 0.0, 120.0, "seconds", above=True)
        self.check_range("lessons", 100, 5000, "mirrored postures")
        self.check_range("start_pan_deg", -90, 90, "degrees")
        self.check_range("distance", 0.4, 1.2, "m, where a face is made out")
        movement(self.movement, np.random.default_rng(0))
