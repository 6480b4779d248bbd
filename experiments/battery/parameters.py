"""What of an agent's life and mind is a parameter: everything here can be varied."""

from dataclasses import dataclass
from typing import Annotated

from experiments.shared.options import within

THINGS = ("dumbbell", "outsized", "panel", "box", "loop", "cup")
"""What agents play with."""
FEW_THINGS = ("dumbbell", "panel")


@dataclass(frozen=True)
class Parameters:
    """Of one agent; none was chosen by infants' rates."""

    babbling_minutes: Annotated[float, within(1, 1000)] = 12.333
    """Body-minutes of babbling on the seat, the pilot counted."""
    rehearsal_s: Annotated[float, within(2, 60)] = 10.0
    """Length of the movements that it makes up to rehearse."""
    mirror_minutes: Annotated[float, within(2.2, 600)] = 6.0
    """Body-minutes before a mirror, and twice again of looking at one's own hands, head and arms."""
    movements: Annotated[int, within(1, 2)] = 2
    """Movements of other robots that it is shown."""
    looking_minutes: Annotated[float, within(1, 600)] = 3.0
    """Body-minutes of saccades."""
    gaze_lessons: Annotated[int, within(20, 1000)] = 40
    """Looks of a teacher's of which it is shown afterwards what was meant."""
    face_acts: Annotated[int, within(60, 10_000)] = 600
    """Acts of the face in the dark."""
    play_rounds: Annotated[int, within(1, 1000)] = 2
    """Rounds of play, each twenty tries with every thing."""
    acts: Annotated[int, within(1, 20)] = 3
    """Acts that there is time for."""
    shown: Annotated[int, within(1, 20)] = 3
    """How often an intention is shown."""
    exponent: Annotated[float, within(0, 100)] = 1.0
    """Of matching: P(choice) proportional to posterior^exponent; 1 is probability matching, 0 chance."""
    trust: Annotated[float, within(0, 100)] = 1.0
    """In habit, P(a | s) of Eq. (1), as its exponent."""
    own_weight: Annotated[float, within(0, 1000, above=True)] = 0.1
    """How much one's own play weighs in what one wants, against one effect that was just seen."""
    gives_up: Annotated[float, within(0, 1)] = 0.1
    """P(somebody stops | the goal is not reached)."""
    goes_on: Annotated[float, within(0, 1)] = 0.02
    """P(somebody does it again at once | the goal is reached)."""
    repeats: Annotated[float, within(0, 1)] = 0.8
    """P(a thing does what it did before)."""
    all_somebody: bool = False
    """Whether whatever moves is taken for somebody: the prior for persons against devices."""
    as_itself: bool = False
    """Whether the other is taken to have one's own hands, not an adult's."""
    even_goals: bool = False
    """Whether all goals that ever came about are wanted alike."""
    forgets: Annotated[float, within(0, 1)] = 0.0
    """P(what was seen is forgotten within a day)."""
    aim_deg: Annotated[float, within(0, 20, above=True)] = 3.0
    """How exactly a teacher's head points at what it looks at."""
    seeing_noise_deg: Annotated[float, within(0, 30)] = 0.0
    """Noise of every direction that is seen in the mirror and of teachers."""


ALIKE: dict[str, tuple[str, ...]] = {
    "face": ("face_acts",),
    "gaze": ("looking_minutes", "gaze_lessons", "aim_deg"),
    "body": ("babbling_minutes", "rehearsal_s", "mirror_minutes", "movements", "play_rounds", "seeing_noise_deg"),
}
"""What newborns' faces, eyes, and bodies that move and play depend on; whatever is not here makes a difference only
once an agent is grown. Agents who are alike in one of these, and of one seed, have that part of their life once."""
QUICK = Parameters(babbling_minutes=3.0, rehearsal_s=2.0, mirror_minutes=2.5, movements=1, looking_minutes=1.0,
                   play_rounds=1, gaze_lessons=20, face_acts=300)  # fmt: skip
"""Shorter lives, for a first look."""
ELSE = {"forgets": 0.5, "seeing_noise_deg": 5.0}
"""What those may be that are 0."""
