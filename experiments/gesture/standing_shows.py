"""What a teacher shows of standing: a squat, one leg and the other, walking on the spot; and who judges it."""

from collections.abc import Mapping

import numpy as np

from babbling.axes import BoolArray, FloatArray
from experiments.shared.standing import Performance
from models.body import SimulatedBody
from models.hoap2 import facts

SQUAT_DEG, SQUAT_S = 110.0, 6.0
SWAY_DEG, SWAY_S = 13.0, 1.5
"""How far hips and ankles roll to shift the weight onto one foot, and how long that takes."""
LIFT_DEG, LIFT_S, HELD_S = 35.0, 1.0, 9.0
"""How far the hip of the lifted leg bends, its knee twice as far; how long lifting takes, and how long it is held."""
STEPS, STEP_S = 4, 0.6
"""Of walking on the spot: how many, and how long a foot is held up."""

LIFTED_M = 0.03
"""m that a foot is lifted if it is up: by its height, for a leg may touch the other."""


def resting(hung: SimulatedBody) -> FloatArray:
    """(J,) the posture at home."""
    hung.reset()
    return np.array(hung.joint_angles[0])


def squat(hung: SimulatedBody) -> FloatArray:
    """(T, J) down until the knees are bent by `SQUAT_DEG`, and up again."""
    home = resting(hung)
    down = (1 - np.cos(np.linspace(0, 2 * np.pi, round(SQUAT_S / hung.tick_s)))) / 2
    more = np.deg2rad(SQUAT_DEG) - home[hung.joints.index("left_leg_joint_4")]
    return np.asarray(home + down[:, None] * sum(more * _crouch(hung, side) for side in facts.SIDES))


def on_leg(hung: SimulatedBody, side: str, held_s: float = HELD_S) -> FloatArray:
    """(T, J) the weight goes onto one leg, the other is lifted and held up; and back."""
    [other] = set(facts.SIDES) - {side}
    sway = np.zeros(len(hung.joints))
    for each in facts.SIDES:
        for joint, sign in (("2", 1.0), ("6", -1.0)):
            sway[hung.joints.index(f"{each}_leg_joint_{joint}")] = sign * np.deg2rad(SWAY_DEG)
    sway *= {"left": -1, "right": 1}[side]
    lift = np.deg2rad(2 * LIFT_DEG) * _crouch(hung, other)
    back = SWAY_S + 2 * LIFT_S + held_s
    second = np.asarray(np.arange(round((back + SWAY_S) / hung.tick_s)) * hung.tick_s, float)[:, None]
    shifted = _eased(second / SWAY_S) - _eased((second - back) / SWAY_S)
    lifted = _eased((second - SWAY_S) / LIFT_S) - _eased((second - SWAY_S - LIFT_S - held_s) / LIFT_S)
    return np.asarray(resting(hung) + shifted * sway + lifted * lift)


def shows(hung: SimulatedBody) -> Mapping[str, FloatArray]:
    """(T, J) joint angles, by what is shown."""
    steps = [on_leg(hung, facts.SIDES[number % 2], STEP_S) for number in range(STEPS)]
    legs = {f"{side} leg": on_leg(hung, side) for side in facts.SIDES}
    return {"squat": squat(hung), **legs, "walking on the spot": np.concatenate(steps)}


def knees_deg(performance: Performance, hung: SimulatedBody) -> FloatArray:
    """(B,) how far the less bent knee was bent at most, of those who do not fall; else 0."""
    knees = [hung.joints.index(f"{side}_leg_joint_4") for side in facts.SIDES]
    return np.asarray(np.rad2deg(performance.angles[..., knees].min(-1).max(0)) * ~performance.fell)


def stood_on_one_leg(performance: Performance, tick_s: float, side: str) -> FloatArray:
    """(B,) s that each stood longest on this leg alone, the other foot `LIFTED_M` up and its own down; 0 who falls."""
    alone = _alone(performance)[..., facts.SIDES.index(side)]
    longest = np.zeros(alone.shape[1])
    now = longest.copy()
    for each in alone:
        now = (now + tick_s) * each
        longest = np.maximum(longest, now)
    return longest * ~performance.fell


def steps_on_the_spot(performance: Performance) -> FloatArray:
    """(B,) how often a foot came up, the other down, in those who do not fall; else 0."""
    return np.asarray((np.diff(_alone(performance).astype(int), axis=0) > 0).sum((0, 2)) * ~performance.fell)


def _alone(performance: Performance) -> BoolArray:
    """(T, B, 2) on the leg of each side alone."""
    high = performance.lifted > LIFTED_M
    return np.asarray(~high & high[..., ::-1] & performance.upright[..., None])


def _crouch(hung: SimulatedBody, side: str) -> FloatArray:
    """(J,) one leg shortened by a rad of its knee."""
    beside = np.zeros(len(hung.joints))
    for joint, share in (("3", -0.5), ("4", 1.0), ("5", -0.5)):
        beside[hung.joints.index(f"{side}_leg_joint_{joint}")] = share
    return beside


def _eased(share: FloatArray) -> FloatArray:
    """Least jerk from 0 to 1."""
    s = np.clip(share, 0, 1)
    return np.asarray(s**3 * (10 - 15 * s + 6 * s**2))
