"""What lasts until another day: what was felt and what was seen, kept for imitation in another process.

Infants imitate after a day or a week what they have only watched (Meltzoff 1988; chapter, section 2.2). What has to
last is small: the counts of one's own babbling, and what was watched.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from babbling.axes import FloatArray, IntArray, same_axes
from babbling.forward_model import ForwardModel
from babbling.kinds import Numbers, kind
from imitation.episodes import Episode
from imitation.errors import ImitationError

LONGEST = 100_000
"""Ticks of a movement that are believed."""


@kind("maze memory", "`imitate maze` leaves such files", ImitationError)
@dataclass(frozen=True, eq=False)
class StepMemory:
    """Babbling and demonstrations in discrete states."""

    forward_model: Annotated[ForwardModel, Numbers("factor")]
    """What was felt: outcomes counted while babbling."""
    episodes: Annotated[tuple[Episode, ...], Numbers("demonstration")]
    """What was watched."""

    def check(self, empty: ForwardModel) -> None:
        """Refuse to act on somebody else's memory.

        Args:
            empty: the forward model of the body that is to imitate, before it learned anything.

        Raises:
            ImitationError: it belongs to another body or world.
        """
        if self.forward_model.fingerprint != empty.fingerprint or not same_axes(self.forward_model.axes, empty.axes):
            raise ImitationError(
                f"this memory belongs to body {self.forward_model.fingerprint}, not to {empty.fingerprint}; recall it "
                "in the maze it was made in"
            )


@kind("head memory", "`imitate head` leaves such files", ImitationError)
@dataclass(frozen=True, eq=False)
class HeadMemory:
    """States s_1 .. s_N of somebody's head, in terms of one's own."""

    body: str
    """Fingerprint of the body in whose terms they are."""
    tick_s: Annotated[float, Numbers(unit="s", low=1e-3, high=1.0)]
    name: str
    pose: Annotated[FloatArray, Numbers("tick axis:2", "rad", low=-np.pi, high=np.pi)]
    """(T, 2) pan and tilt, rad."""
    deviation: Annotated[FloatArray, Numbers("tick axis:2", "rad", low=0)]
    """(T, 2) how surely they were seen, rad."""

    def __post_init__(self) -> None:
        if not 3 <= len(self.pose) <= LONGEST:
            raise ImitationError(f"a head movement of {len(self.pose)} postures; 3 to {LONGEST} are possible")

    def check(self, fingerprint: str) -> None:
        """Refuse to act on somebody else's memory.

        Raises:
            ImitationError: it belongs to another body.
        """
        _check(self.body, fingerprint, "the robot that watched")


@kind("act memory", "`imitate objects` leaves such files", ImitationError)
@dataclass(frozen=True, eq=False)
class ActMemory:
    """An act on an object, as it was seen: states of the object, and the movement by what oneself does so."""

    body: str
    """Fingerprint of the body in whose terms it is."""
    thing: str
    """What kind of thing it was."""
    states: Annotated[IntArray, Numbers("visit", low=0)]
    """(N,) s_1 .. s_N of the object, as numbers of one's own states."""
    primitive: Annotated[FloatArray, Numbers("primitive", low=0, high=1)]
    """(A,) P(primitive | movement)."""

    def check(self, fingerprint: str, states: int) -> None:
        """Refuse to act on somebody else's memory.

        Raises:
            ImitationError: it belongs to another body, or knows more than so many states of things.
        """
        _check(self.body, fingerprint, "the play of the one who watched")
        if self.states.max(initial=0) >= states:
            raise ImitationError(f"this memory knows of state {self.states.max()}; 0 to {states - 1} are possible")


@kind("intention memory", "`imitate intentions` leaves such files", ImitationError)
@dataclass(frozen=True, eq=False)
class IntentMemory:
    """What somebody seems to have meant to do with a thing, and what was seen to come about."""

    body: str
    """Fingerprint of the body in whose terms it is."""
    thing: str
    """What kind of thing it was."""
    goal: Annotated[FloatArray, Numbers("goal", low=0, high=1)]
    """(G,) P(g | somebody pursues one)."""
    somebody: Annotated[float, Numbers(low=0, high=1)]
    """P(somebody pursues a goal)."""
    effects: Annotated[IntArray, Numbers("state", low=0)]
    """(O,) how often each state was seen to come about."""

    def check(self, fingerprint: str, thing: str, goals: int, states: int) -> None:
        """Refuse to act on somebody else's memory, or with another thing.

        Raises:
            ImitationError: it belongs to another body, thing, or list of goals or states.
        """
        _check(self.body, fingerprint, "the play of the one who watched")
        if self.thing != thing:
            raise ImitationError(f"this memory is of a {self.thing}, not of a {thing}")
        if len(self.goal) != goals or len(self.effects) != states or not self.goal.sum() > 0:
            raise ImitationError(
                f"this memory holds {len(self.goal)} goals and {len(self.effects)} states; {goals} and {states} are "
                "needed, and goals that sum to something"
            )


@kind("face memory", "`imitate face` leaves such files", ImitationError)
@dataclass(frozen=True, eq=False)
class FaceMemory:
    """What somebody's face did, in terms of one's own: for imitation after a pacifier, or a day."""

    body: str
    """Fingerprint of the body in whose terms it is."""
    relations: Annotated[FloatArray, Numbers("relation", low=-10, high=10)]
    """(8,) to come to, see `babbling.relations`."""
    moved: Annotated[IntArray, Numbers("relation", low=0, high=1)]
    """(8,) 1 for those that the identified motors move."""

    def check(self, fingerprint: str, relations: int) -> None:
        """Refuse to act on somebody else's memory.

        Raises:
            ImitationError: it belongs to another body, or knows another number of relations.
        """
        _check(self.body, fingerprint, "the face that watched")
        if len(self.relations) != relations:
            raise ImitationError(f"this memory holds {len(self.relations)} relations; {relations} are needed")


def _check(remembers: str, fingerprint: str, give: str) -> None:
    if remembers != fingerprint:
        raise ImitationError(
            f"this memory belongs to another body (fingerprint {remembers}, this body has {fingerprint}); give {give}"
        )
