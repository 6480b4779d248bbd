"""What a face does, as organs stand to each other: dimensionless, so that a newborn's and an adult's can be compared.

Lengths are in widths of the own mouth W, angles in quarter turns (Meltzoff & Moore 1997: "organ relations"; chapter,
section 2.2). For those who judge: the truth of a configuration, which no mind is told.
"""

from typing import Final

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.body import resting

RELATIONS: Final = ("gap", "beyond", "side", "up", "purse", "brow", "turn", "nod")
"""Between the lips; tip of the tongue in front of the lower lip, to the left, upwards (all in the jaw's frame); lips
forward; brows upwards; head to the left, downwards."""


class Truth:
    """Relations of one model's configurations."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model, self.data = model, mujoco.MjData(model)
        self.rest = resting(model)
        self._lip = 2 * float(model.geom("upper_lip_left").size[2])
        start = self._points(self.rest)
        self.mouth = float(np.linalg.norm(start["corner_left"] - start["corner_right"]))
        """W, m."""
        self._zero = start

    def of(self, configurations: FloatArray) -> FloatArray:
        """(..., 8) `RELATIONS` of (..., nq) configurations."""
        flat = configurations.reshape(-1, self.model.nq)
        found = np.array([self._relations(self._points(one)) for one in flat])
        return found.reshape(*configurations.shape[:-1], len(RELATIONS))

    def _points(self, configuration: FloatArray) -> dict[str, FloatArray]:
        """Sites in the head's frame, those of the tongue in the jaw's."""
        data = self.data
        data.qpos[:] = configuration
        mujoco.mj_kinematics(self.model, data)
        head, jaw = data.body("head"), data.body("jaw")
        turn, jaws = head.xmat.reshape(3, 3).copy(), jaw.xmat.reshape(3, 3)
        points = {name: (data.site(name).xpos - head.xpos) @ turn for name in ("upper_front", "lower_front")}
        points |= {name: (data.site(name).xpos - head.xpos) @ turn for name in ("corner_left", "corner_right")}
        points |= {half: (data.geom(f"{half}_lip_left").xpos - head.xpos) @ turn for half in ("upper", "lower")}
        tip, lip = ((data.site(name).xpos - jaw.xpos) @ jaws for name in ("tip", "lower_front"))
        points["tongue"] = tip - (lip[0], 0, 0)
        points["brow"] = (data.geom("brow_left").xpos - head.xpos) @ turn
        points["turn"] = turn
        return points

    def _relations(self, now: dict[str, FloatArray]) -> FloatArray:
        zero, width = self._zero, self.mouth
        gap = np.linalg.norm(now["upper"] - now["lower"]) - self._lip
        tongue = now["tongue"] - (0, 0, zero["tongue"][2])
        turned = zero["turn"].T @ now["turn"]
        return np.array(
            [
                gap / width,
                *(tongue / width),
                (now["upper_front"] - zero["upper_front"])[0] / width,
                (now["brow"] - zero["brow"])[2] / width,
                np.arctan2(turned[1, 0], turned[0, 0]) / (np.pi / 2),
                np.arcsin(-turned[2, 0]) / (np.pi / 2),
            ]
        )
