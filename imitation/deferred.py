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

    def check(self, fingerprint: str) -> None:
        """Refuse to act on somebody else's memory.

        Raises:
            ImitationError: it belongs to another body.
        """
        _check(self.body, fingerprint, "the play of the one who watched")


def _check(remembers: str, fingerprint: str, give: str) -> None:
    if remembers != fingerprint:
        raise ImitationError(
            f"this memory belongs to another body (fingerprint {remembers}, this body has {fingerprint}); give {give}"
        )
