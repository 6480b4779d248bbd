"""Derive the position gains of the 25 servos from one bandwidth and one damping ratio.

The law is that of `models.servos`, at `home` with the torso fixed; models/hoap2/README.md argues for the bandwidth.

    python -m models.hoap2.derive_gains           # the table; exit 1 if hoap2.xml says something else
    python -m models.hoap2.derive_gains --write   # writes the gains into hoap2.xml
"""

import re
import sys

import mujoco
import numpy as np

from models.errors import BodyError
from models.hoap2 import ROBOT
from models.hoap2.facts import DAMPING, HOME_DEG, JOINTS, joint_class
from models.servos import BANDWIDTH_HZ, DAMPING_RATIO, Gains, gains, natural_frequency_hz


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
    found = {}
    for joint in JOINTS:
        inertia = float(np.diag(full)[model.joint(joint).dofadr[0]])
        found[joint] = gains(inertia, DAMPING[joint_class(joint)])
    return found


def with_gains(robot: str, found: dict[str, Gains]) -> str:
    """Text of hoap2.xml with the gains in its actuators."""
    for joint, gain in found.items():
        pattern = rf'(<position name="{joint}" [^>]*?)kp="[^"]*" kv="[^"]*"'
        robot, times = re.subn(pattern, rf'\g<1>kp="{gain.kp:g}" kv="{gain.kv:g}"', robot)
        if times != 1:
            raise BodyError(f'hoap2.xml: {times} actuators <position name="{joint}" ... kp= kv=>, one is needed')
    return robot


def main() -> int:
    """Print the table; compare or write; the exit status says whether the file on disk is up to date."""
    found = derive(mujoco.MjModel.from_xml_path(str(ROBOT)))
    hz = natural_frequency_hz()
    print(f"-3 dB at {BANDWIDTH_HZ:g} Hz, damping ratio {DAMPING_RATIO:g}: natural frequency {hz:.2f} Hz")
    for joint, gain in found.items():
        print(f"{joint:18} I {gain.inertia:.5f} kg m2   kp {gain.kp:8g} N m/rad   kv {gain.kv:8g} N m s/rad")
    text = with_gains(ROBOT.read_text(), found)
    if "--write" in sys.argv[1:]:
        ROBOT.write_text(text)
    current = ROBOT.read_text() == text
    print(f"{ROBOT.name} is {'up to date' if current else 'not what this derives: run with --write'}")
    return 0 if current else 1


if __name__ == "__main__":
    sys.exit(main())
