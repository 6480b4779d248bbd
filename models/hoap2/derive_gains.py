"""Derive the position gains of the 25 servos from one bandwidth and one damping ratio.

The law, joint by joint, all other joints held still:

    I q'' + (damping + kv) q' + kp q = kp command        =>   kp = I w^2,   kv = 2 zeta I w - damping

I (kg·m²) is the joint's diagonal entry of the joint-space inertia at `home` with the torso fixed, armature included.
The diagonal, and not the inverse of the inverse's diagonal, because the other joints are servos too: they hold, they
do not swing freely. w (rad/s) follows from the bandwidth b, the frequency at which an isolated joint's answer to its
command has fallen by 3 dB:   b = w / 2 pi * sqrt(1 - 2 zeta^2 + sqrt((1 - 2 zeta^2)^2 + 1)).

    python -m models.hoap2.derive_gains           # the table; exit 1 if hoap2.xml says something else
    python -m models.hoap2.derive_gains --write   # writes the gains into hoap2.xml
"""

import re
import sys
from typing import Final, NamedTuple

import mujoco
import numpy as np

from models.errors import BodyError
from models.hoap2 import ROBOT
from models.hoap2.facts import DAMPING, HOME_DEG, JOINTS, joint_class

BANDWIDTH_HZ: Final = 8.0
"""-3 dB, within the 7 to 15 Hz of small servos; README.md argues for it."""
DAMPING_RATIO: Final = 0.9
"""Overshoot 0.2 %, which no eye would see; a ratio of 1 needs 34 % more stiffness for the same bandwidth."""


class Gains(NamedTuple):
    """What one servo gets: `inertia` kg·m², `kp` N·m/rad, `kv` N·m·s/rad."""

    inertia: float
    kp: float
    kv: float


def natural_frequency_hz() -> float:
    """Undamped natural frequency of the second-order loop whose answer is down by 3 dB at BANDWIDTH_HZ."""
    a = 1 - 2 * DAMPING_RATIO**2
    return float(BANDWIDTH_HZ / np.sqrt(a + np.sqrt(a**2 + 1)))


def derive(model: mujoco.MjModel) -> dict[str, Gains]:
    """Gains of every joint, rounded to the four digits that stand in the file.

    The inertia leaves the torso's own six directions out: it is fixed.
    """
    data = mujoco.MjData(model)
    for joint, angle in HOME_DEG.items():
        data.joint(joint).qpos[0] = np.deg2rad(angle)
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    w, gains = 2 * np.pi * natural_frequency_hz(), {}
    for joint in JOINTS:
        inertia = float(np.diag(full)[model.joint(joint).dofadr[0]])
        kv = 2 * DAMPING_RATIO * inertia * w - DAMPING[joint_class(joint)]
        gains[joint] = Gains(inertia, float(f"{inertia * w**2:.4g}"), float(f"{kv:.4g}"))
    return gains


def with_gains(robot: str, gains: dict[str, Gains]) -> str:
    """Text of hoap2.xml with the gains in its actuators."""
    for joint, gain in gains.items():
        pattern = rf'(<position name="{joint}" [^>]*?)kp="[^"]*" kv="[^"]*"'
        robot, found = re.subn(pattern, rf'\g<1>kp="{gain.kp:g}" kv="{gain.kv:g}"', robot)
        if found != 1:
            raise BodyError(f'hoap2.xml: {found} actuators <position name="{joint}" ... kp= kv=>, one is needed')
    return robot


def main() -> int:
    """Print the table; compare or write; the exit status says whether the file on disk is up to date."""
    gains = derive(mujoco.MjModel.from_xml_path(str(ROBOT)))
    hz = natural_frequency_hz()
    print(f"-3 dB at {BANDWIDTH_HZ:g} Hz, damping ratio {DAMPING_RATIO:g}: natural frequency {hz:.2f} Hz")
    for joint, gain in gains.items():
        print(f"{joint:18} I {gain.inertia:.5f} kg m2   kp {gain.kp:8g} N m/rad   kv {gain.kv:8g} N m s/rad")
    text = with_gains(ROBOT.read_text(), gains)
    if "--write" in sys.argv[1:]:
        ROBOT.write_text(text)
    current = ROBOT.read_text() == text
    print(f"{ROBOT.name} is {'up to date' if current else 'not what this derives: run with --write'}")
    return 0 if current else 1


if __name__ == "__main__":
    sys.exit(main())
