"""What a face does, as organs stand to each other: dimensionless, so that a newborn's and an adult's can be compared.

Lengths are in widths of the own mouth W, angles in quarter turns (Meltzoff & Moore 1997: "organ relations"; chapter,
section 2.2). For those who judge: the truth of a configuration, which no mind is told.
"""

from typing import Final

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.servos import resting

RELATIONS: Final = ("gap", "beyond", "side", "up", "purse", "brow", "turn", "nod")
"""How far the lower lip has gone from where lips part; how far the tongue, were it straight, comes
out beyond where the lower lip rests; its tip to the left, upwards (all in the jaw's frame); lips
forward; brows upwards; head to the left, downwards."""


class Truth:
    """Relations of one model's configurations."""

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model, self.data = model, mujoco.MjData(model)
        self._zero = zero = self._points(resting(model))
        self.mouth = float(np.linalg.norm(zero["corner_left"] - zero["corner_right"]))
        """W, m."""
        self._lever = float(np.linalg.norm((zero["lower"] - zero["hinge"])[[0, 2]]))
        apart = 2 * float(model.geom("upper_lip_left").size[2]) - float((zero["upper"] - zero["lower"])[2])
        self._parted = apart / float((zero["lower"] - zero["hinge"])[0])

    def of(self, configurations: FloatArray) -> FloatArray:
        """(..., 8) `RELATIONS` of (..., nq) configurations."""
        flat = configurations.reshape(-1, self.model.nq)
        found = np.array([self._relations(self._points(one)) for one in flat])
        return found.reshape(*configurations.shape[:-1], len(RELATIONS))

    def _points(self, configuration: FloatArray) -> dict[str, FloatArray]:
        """Places in the head's frame, those of tongue and lower lip's front in the jaw's; how head and jaw stand."""
        data = self.data
        data.qpos[:] = configuration
        mujoco.mj_kinematics(self.model, data)
        head, jaw = data.body("head"), data.body("jaw")
        turn, jaws = head.xmat.reshape(3, 3).copy(), jaw.xmat.reshape(3, 3).copy()
        places = {name: data.site(name).xpos for name in ("upper_front", "corner_left", "corner_right")}
        places |= {half: data.geom(f"{half}_lip_left").xpos for half in ("upper", "lower")}
        places |= {"brow": data.geom("brow_left").xpos, "hinge": data.joint("jaw").xanchor}
        points = {name: (place - head.xpos) @ turn for name, place in places.items()}
        inside = {"tip": data.site("tip"), "lip": data.site("lower_front"), "root": data.body("tongue_tip")}
        points |= {name: (thing.xpos - jaw.xpos) @ jaws for name, thing in inside.items()}
        return points | {"turn": turn, "jaw": turn.T @ jaws}

    def _relations(self, now: dict[str, FloatArray]) -> FloatArray:
        zero, width = self._zero, self.mouth
        opened = np.arctan2(-now["jaw"][2, 0], now["jaw"][0, 0]) - self._parted
        turned = zero["turn"].T @ now["turn"]
        return np.array(
            [
                2 * self._lever * np.sin(opened / 2) / width,
                (now["root"] + zero["tip"] - zero["root"] - zero["lip"])[0] / width,
                now["tip"][1] / width,
                (now["tip"] - zero["tip"])[2] / width,
                (now["upper_front"] - zero["upper_front"])[0] / width,
                (now["brow"] - zero["brow"])[2] / width,
                np.arctan2(turned[1, 0], turned[0, 0]) / (np.pi / 2),
                np.arcsin(-turned[2, 0]) / (np.pi / 2),
            ]
        )
