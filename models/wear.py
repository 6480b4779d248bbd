"""Worn gears, soft muscles, limbs that touch a spring or carry something."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

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
    with shares p_i and plays F_i, each within half its width of the command. One play alone is a gear's backlash. Skin
    and sinews follow along a sigmoid besides, x and the result as shares of the range:

        (f(x) - f(0)) / (f(1) - f(0)),   f(x) = 1 / (1 + exp(-K (x - 1/2)))

    (K is `steepness`, 0 for none), as the surface of the robot face Affetto does (Ishihara et al. 2018, Front Robot AI
    5:119).

    Raises:
        BodyError: a width or steepness below 0, or shares that are not one for each width, above 0 and 1 together.
    """

    friction_factor: float = 1.0
    """Multiplies every joint's dry friction (stiction)."""
    backlash: tuple[float, ...] = (0.0,)
    """Widths of the plays, rad, or shares of each motor's range."""
    shares: tuple[float, ...] = (1.0,)
    """Shares of the plays."""
    of_range: bool = False
    """Whether widths are shares of the range."""
    steepness: float = 0.0
    """Of the sigmoid, K; 0 for none."""

    def __post_init__(self) -> None:
        widths, shares = self.backlash, self.shares
        uneven = len(widths) != len(shares) or min(shares) <= 0 or abs(sum(shares) - 1) > 1e-9
        if uneven or min(widths) < 0 or not self.steepness >= 0:
            raise BodyError(
                f"plays of widths {widths} with shares {shares}, a sigmoid of steepness {self.steepness:g}: each width "
                "needs a share above 0, all shares make 1, and nothing is below 0"
            )

    @property
    def bending(self) -> FloatArray:
        """What else than plays tells worn bodies apart; nothing where there is nothing else."""
        return np.array([self.of_range, self.steepness] if self.of_range or self.steepness else [], float)

    def follow(self, played: FloatArray, command: FloatArray, low: ArrayLike, high: ArrayLike) -> FloatArray:
        """(B, M) positions that the servos follow; the (P, B, M) plays are moved in place to where they now are.

        Args:
            played: where the plays were.
            command: (B, M).
            low: (M,) least command.
            high: (M,) largest command.
        """
        low, span = np.asarray(low, float), np.subtract(high, low)
        half = np.array(self.backlash)[:, None, None] / 2 * (span if self.of_range else 1.0)
        np.clip(played, command - half, command + half, out=played)
        followed = (np.array(self.shares)[:, None, None] * played).sum(0)
        if self.steepness:
            bent, end = (np.tanh(self.steepness / 2 * (x - 0.5)) for x in ((followed - low) / span, 1.0))  # 2 f - 1
            followed = low + span * (bent + end) / (2 * end)
        return np.asarray(followed)


@dataclass(frozen=True)
class Spring:
    """An elastic stop: from `low` down and from `high` up (rad) it drives its joint back, N m/rad; between, nothing."""

    stiffness: float
    low: float = -1e3  # nowhere
    high: float = 1e3
