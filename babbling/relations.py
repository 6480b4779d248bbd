"""Felt relations: how one's own organs stand to each other, as joints and touch tell it in the dark.

Infants learn by babbling which commands bring the tongue to, between and beyond the lips (chapter, section 2.1, after
Meltzoff & Moore 1997). What is felt of it has no unit but one's own: lengths in widths of the mouth, angles in quarter
turns, so that it can be held against what is seen of somebody else. Innate are which sense belongs to which relation
(in the dark nothing could tell) and the sizes below; where lips part and where the tongue meets them is found by touch:

    gap = 2 J sin((jaw - jaw_0) / 2)        beyond = (slide - slide_0) / W - L
    side = T sin yaw cos pitch   up = T sin pitch            purse = F lips / W        brow = brows / W
"""

from dataclasses import dataclass
from typing import Annotated, Final

import numpy as np

from babbling.axes import FloatArray
from babbling.errors import BabblingError
from babbling.kinds import Numbers

RELATIONS: Final = ("gap", "beyond", "side", "up", "purse", "brow", "turn", "nod")
"""In the order of the joints' senses: how far the lower lip has gone from where lips part; how far the tongue, were it
straight, comes out beyond the lower lip; how far its tip is to the left, and up; lips forward; brows up; head turned to
the left, and nodding."""
UNITS: Final = (*("widths of the mouth",) * 6, *("quarter turns",) * 2)
"""In which people read them."""
MOUTH_M: Final = 0.026
"""W, of one's own mouth."""
JAW, LIP, TONGUE, FORWARD = 1.74, 0.19, 0.56, 0.8
"""J, L and T, widths of the mouth: from the jaw's hinge to the lips, through a lip, from the tongue's hinge to its tip;
F, how far lips go forward for all that they go."""
LIPS, TIP = slice(16, 20), 20
"""Senses of touch, after those of eight joints and their speeds: upper and lower lip, left and right; tongue."""
TOUCHED_N: Final = 0.01
STRAIGHT: Final = 0.25
"""rad up to which a tongue is not bent."""
SHUT: Final = 0.05
"""rad beyond which, from where lips part, the tongue may already pass."""


@dataclass(frozen=True)
class Landmarks:
    """What touch has told."""

    parted: Annotated[float, Numbers(unit="rad", low=-1, high=1)]
    """jaw_0, at which the lips part."""
    met: Annotated[float, Numbers(unit="m", low=-1, high=1)]
    """slide_0, at which the tongue meets the lips from inside."""

    @classmethod
    def felt(cls, senses: FloatArray) -> "Landmarks":
        """Out of the (N, S) senses at the ends of acts. For a tongue that never met the lips: as far as ever it came
        behind them.

        Raises:
            BabblingError: the lips never touched.
        """
        lips = (senses[:, LIPS] > TOUCHED_N).any(1)
        tongue = senses[:, TIP] > TOUCHED_N
        shut = lips & ~tongue
        if not shut.any():
            raise BabblingError("the lips were never felt to touch: babble longer")
        parted = float(np.median(senses[shut, 0]))
        behind = senses[:, 0] < parted + SHUT
        met = tongue & lips & behind & (np.abs(senses[:, 2:4]) < STRAIGHT).all(1)
        slide = senses[:, 1] - FORWARD * senses[:, 4]  # it pushes them
        return cls(parted, float(np.median(slide[met]) if met.any() else slide[behind].max()))

    def relations(self, senses: FloatArray) -> FloatArray:
        """(..., 8) `RELATIONS` of (..., S) senses."""
        jaw, slide, yaw, pitch, lips, brows, turn, nod = np.moveaxis(senses[..., :8], -1, 0)
        purse = FORWARD * lips / MOUTH_M
        return np.stack(
            [
                2 * JAW * np.sin((jaw - self.parted) / 2),
                (slide - self.met) / MOUTH_M - LIP,
                TONGUE * np.sin(yaw) * np.cos(pitch),
                TONGUE * np.sin(pitch),
                purse,
                brows / MOUTH_M,
                turn / (np.pi / 2),
                nod / (np.pi / 2),
            ],
            axis=-1,
        )
