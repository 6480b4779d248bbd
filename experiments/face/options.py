"""Options of `imitate face`."""

from typing import Annotated, Literal

from experiments.errors import ExperimentError
from experiments.face.theories import GESTURES
from experiments.shared.options import (
    DEG,
    Flag,
    M,
    N,
    Options,
    Seed,
    ToRead,
    choices,
    known,
    one_of,
    options,
    within,
    written,
)
from models.face import FACES
from models.face import find as find_face

FACE = written(f"{choices(FACES)}|FILE.xml")


@options
class Config(Options):
    """Options of `imitate face`."""

    gesture: Annotated[str, one_of("gesture", GESTURES), written(choices(GESTURES))] = "tongue out"
    """What the adult shows."""
    strength: Literal["strong", "weak"] = "strong"
    """How strongly; a weak tongue comes 1 to 3 mm beyond the lips, in a newborn's measure."""
    face: Annotated[str, known(find_face), FACE] = "newborn"
    """The infant's face; a file is an MJCF with the same parts."""
    adult: Annotated[str, known(find_face), FACE] = "adult"
    """Who shows it."""
    distance: Annotated[float, within(0.2, 0.8, "m"), M] = 0.3
    """From the infant's eyes to the adult's face."""
    yaw_deg: Annotated[float, within(-30, 30, "degrees"), DEG] = 0.0
    """How far the adult's face is turned away."""
    pitch_deg: Annotated[float, within(-30, 30, "degrees"), DEG] = 0.0
    """How far it is bowed."""
    acts: Annotated[int, within(60, 100_000), N] = 600
    """Acts of babbling in the dark, .3 s each."""
    tries: Annotated[int, within(1, 100), N] = 5
    """Tries at doing the same."""
    scramble: Annotated[Seed | None, written("SEED", "wired straight")] = None
    """Seed of an unknown wiring of the motors. Senses cannot be permuted: in the dark nothing tells whose they are."""
    pacifier: Flag = False
    """A pacifier stops the infant's mouth while it watches; it answers 2.5 minutes of a passive face later."""
    correspondence: Literal["innate", "learned"] = "innate"
    """Whether faces are understood by an innate template, or by what a mirror showed of one's own."""
    mind: Annotated[ToRead | None, written("FILE.nc", "babbles anew")] = None
    """What an infant babbled before: `mind.nc` of an earlier run."""
    memory: Annotated[ToRead | None, written("FILE.nc", "is shown the gesture")] = None
    """What it saw before, a day later: `memory.nc` of an earlier run; with --mind."""
    study: Flag = False
    """Every gesture, view and condition, and the power of published scores against rival theories (minutes)."""
    infants: Annotated[int, within(20, 100_000), N] = 200
    """Infants of the study, each babbling by itself."""
    workers: Annotated[int, within(1, 256), N] = 2
    """Processes; the result does not depend on it."""

    def check(self) -> None:
        """See `Options`."""
        if self.memory is not None and self.mind is None:
            raise ExperimentError(
                "--memory: what was seen is remembered in terms of one's own body; give its --mind too"
            )
        for name in ("mind", "memory"):
            if self.study and getattr(self, name) is not None:
                raise ExperimentError(f"--{name}: this is for one infant; leave out --study")
        super().check()
