"""What a movement may depend on: the features of every explanation of it.

A forward model has to say which displacement w follows on a command. Which quantities matter is not known beforehand,
so a mind offers itself many and lets experience decide. Per factor with posture q, rate v, command c and the one before
it, c', all as postures:

    1, v, c' - q, tanh(v / r_i), q, q^2, max(q - k_i, 0)        what is there before one acts
    p_j - q,      dead(e, z_i) = sign(e) max(|e| - z_i, 0)      what acting adds
    sin q_k, cos q_k of every joint k                           what weighs on it

p_j is the command after a play (hysteresis operator) of half width h_j: p_j = min(max(p_j', c - h_j), c + h_j). A
weighted sum of plays is the Prandtl-Ishlinskii operator, which describes gears with backlash, dry friction and rubber
alike (Krasnosel'skii and Pokrovskii 1989). h_0 = 0 is the command itself. The effort e = sum_j share_j p_j - q is what
arrives of a command; dead zones bend its effect (stiction). All widths are in units of babbling's own jitter and speed.
"""

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from babbling.axes import FloatArray
from babbling.kinds import Numbers

WIDTHS = (0.0, 1 / 8, 1 / 4, 1 / 2, 1.0, 2.0, 4.0, 8.0, 16.0)
"""Half widths of the plays, in units of the jitter of babbling's commands."""
ZONES = (1 / 6, 1 / 2, 1.0, 5 / 3)
"""Half widths of the dead zones of effort, in units of the jitter."""
SLOW = (1 / 250, 1 / 25)
"""Rates below which a sign is not yet a sign, as shares of the speed that babbling goes up to."""
HINGES = 6
"""Postures at which a line may bend (a spring, a stop), evenly over the range."""

BEFORE = ("one", "rate", "before", "slow", "slower", "posture", "squared", *(f"hinge {i + 1}" for i in range(HINGES)))
PLAYS = ("action", *(f"play {j}" for j in range(1, len(WIDTHS))))
DEAD = tuple(f"zone {i + 1}" for i in range(len(ZONES)))
COLUMNS = (*BEFORE, *PLAYS, *DEAD)
"""The features of a joint's own, in order; those of the whole body come after them."""
LINES = {
    "line": ("rate", "action"),
    "posture": (*BEFORE[1:7], "action"),
    "play": COLUMNS[1:],
    "gravity": COLUMNS[1:],
}
"""What each explanation that is a line looks at, besides 1; gravity's looks at the whole body as well."""


def names(explanation: str, joints: int) -> tuple[str, ...]:
    """What a line looks at in a body of so many joints, besides 1."""
    weighs = [f"{turn} {k}" for turn in ("sin", "cos") for k in range(joints)] if explanation == "gravity" else ()
    return (*LINES[explanation], *weighs)


def weighing(posture: FloatArray) -> FloatArray:
    """(..., 2 F) sines and cosines of (..., F) postures: what weighs on every joint."""
    return np.concatenate([np.sin(posture), np.cos(posture)], axis=-1)


def along(columns: FloatArray, line: FloatArray) -> FloatArray:
    """(..., F) sums of (..., F, C) columns, each weighed by its (F, C)."""
    return np.asarray(np.einsum("...fc,fc->...f", columns, line))


class Echo(NamedTuple):
    """What earlier commands left: all that a body without a memory of its own needs of the past."""

    command: FloatArray
    """(..., F) the last command, as a posture."""
    plays: FloatArray
    """(..., F, J) where each play stands."""


@dataclass(frozen=True)
class Features:
    """The features of one body, in its own units; found by the pilot."""

    knots: Annotated[FloatArray, Numbers("motor hinge", "rad")]
    """(F, HINGES) postures k_i."""
    slow: Annotated[FloatArray, Numbers("motor sign", "rad/s", low=0, zero=False)]
    """(F, 2) rates r_i."""
    widths: Annotated[FloatArray, Numbers("motor play", "rad", low=0)]
    """(F, J) half widths h_j."""
    zones: Annotated[FloatArray, Numbers("motor zone", "rad", low=0, zero=False)]
    """(F, Z) z_i."""
    share: Annotated[FloatArray, Numbers("motor play")]
    """(F, J) how much of a command arrives through each play; sums to 1."""

    def start(self, posture: FloatArray) -> Echo:
        """Having rested at (..., F) for long."""
        return Echo(posture, np.broadcast_to(posture[..., None], (*posture.shape, self.widths.shape[1])))

    def plays(self, echo: Echo, command: FloatArray) -> FloatArray:
        """(..., F, J) where the plays come to under (..., F) commands."""
        told = command[..., None]
        return np.minimum(np.maximum(echo.plays, told - self.widths), told + self.widths)

    def after(self, echo: Echo, command: FloatArray) -> Echo:
        """Having been told (..., F) commands."""
        return Echo(command, self.plays(echo, command))

    def before(self, posture: FloatArray, rate: FloatArray, echo: Echo) -> FloatArray:
        """(..., F, BEFORE) of (..., F) postures and rates."""
        q, v = posture[..., None], rate[..., None]
        return np.concatenate(
            [np.ones_like(q), v, echo.command[..., None] - q, np.tanh(v / self.slow), q, q * q,
             np.maximum(q - self.knots, 0)],
            axis=-1,
        )  # fmt: skip

    def acted(self, plays: FloatArray) -> FloatArray:
        """(..., F, PLAYS + DEAD) of (..., F, J) plays minus posture."""
        return np.concatenate([plays, self.dead(self.effort(plays))], axis=-1)

    def dead(self, effort: FloatArray) -> FloatArray:
        """(..., F, Z) what dead zones let through of (..., F) efforts."""
        effort = effort[..., None]
        return np.asarray(effort - np.minimum(np.maximum(effort, -self.zones), self.zones))

    def effort(self, plays: FloatArray) -> FloatArray:
        """(..., F) e of (..., F, J) plays minus posture."""
        return along(plays, self.share)

    def of(self, posture: FloatArray, rate: FloatArray, command: FloatArray) -> FloatArray:
        """(T, B, F, COLUMNS + 2 F) of a run from rest: (T, B, F) postures, rates and the commands given there."""
        echo, rows = self.start(posture[0]), []
        for q, v, c in zip(posture, rate, command, strict=True):
            after = self.after(echo, c)
            rows.append(self.columns(q, v, echo, after.plays))
            echo = after
        return np.stack(rows)

    def columns(self, posture: FloatArray, rate: FloatArray, echo: Echo, plays: FloatArray) -> FloatArray:
        """(B, F, COLUMNS + 2 F) of (B, F) postures and rates, when the plays come to (B, F, J)."""
        weighs = np.broadcast_to(weighing(posture)[:, None], (*posture.shape, 2 * posture.shape[-1]))
        acted = self.acted(plays - posture[..., None])
        return np.concatenate([self.before(posture, rate, echo), acted, weighs], axis=-1)
