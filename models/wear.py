"""Worn gears."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Wear:
    """What years do to a servo."""

    friction_factor: float = 1.0
    """Multiplies every joint's dry friction (stiction)."""
    backlash: float = 0.0
    """Play of the gear, rad: the joint follows its motor's angle as a play (hysteresis) operator of this width."""
