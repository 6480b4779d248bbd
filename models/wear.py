"""Worn gears, soft muscles, limbs that touch a spring or carry something."""

from dataclasses import dataclass

import numpy as np

from models.arrays import FloatArray
from models.errors import BodyError

STEEL = 7850.0
"""kg/m^3, of what is carried: a ball."""


def ball_radius(kg: float) -> float:
    """Metres, of a steel ball."""
    return float(np.cbrt(3 * kg / (4 * np.pi * STEEL)))


@dataclass(frozen=True)
class Wear:
    """What years, or air instead of a gear, do to a servo.

    Law: the servo follows sum_i p_i F_i[command], a Prandtl-Ishlinskii operator (Krasnosel'skii & Pokrovskii 1989),
    with shares p_i and plays F_i, each within half its width of the command. One play alone is a gear's backlash.

    Raises:
        BodyError: a width below 0, or shares that are not one for each width, above 0 and 1 together.
    """

    friction_factor: float = 1.0
    """Multiplies every joint's dry friction (stiction)."""
    backlash: tuple[float, ...] = (0.0,)
    """Widths of the plays, rad."""
    shares: tuple[float, ...] = (1.0,)
    """Shares of the plays."""

    def __post_init__(self) -> None:
        widths, shares = self.backlash, self.shares
        if len(widths) != len(shares) or min(widths) < 0 or min(shares) <= 0 or abs(sum(shares) - 1) > 1e-9:
            raise BodyError(
                f"plays of widths {widths} with shares {shares}: each width needs a share above 0, all shares make 1"
            )

    def follow(self, played: FloatArray, command: FloatArray) -> FloatArray:
        """(B, M) angles that the servos follow; the (P, B, M) plays are moved in place to where they now are."""
        half = np.array(self.backlash)[:, None, None] / 2
        np.clip(played, command - half, command + half, out=played)
        return np.asarray((np.array(self.shares)[:, None, None] * played).sum(0))


@dataclass(frozen=True)
class Spring:
    """An elastic stop: from `low` down and from `high` up (rad) it drives its joint back, N m/rad; between, nothing."""

    stiffness: float
    low: float = -1e3  # nowhere
    high: float = 1e3
