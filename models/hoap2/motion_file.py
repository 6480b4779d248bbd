"""The real HOAP-2's motion files, as its walking sample uses them (Webots HOAP-2 controller and its `walk` file).

27 comma-separated numbers per line and no header: sampling interval in ms, a skipped field, right leg 1-6, right arm
1-4, left leg 1-6, left arm 1-4, waist, hand field, three flags. Joint fields are encoder pulses, 209 to a degree, with
a sign of their own. Head joints have no field and stay at 0; what the hand field (60 in the sample) means is not
known, so the hands stay at 0 as well; the flags are not used.
"""

from pathlib import Path

import numpy as np

from models.errors import BodyError
from models.files import finite, table
from models.hoap2.facts import ENCODER_PULSES_PER_DEGREE, JOINTS, PULSE_SIGNS
from models.motion.trajectory import JointTrajectory

FIELDS = 27
FIRST_JOINT_FIELD = 2


def looks_like_motion_file(content: str) -> bool:
    """Whether the first line that is not blank has 27 fields or so, a number first: a table begins with names."""
    first = next((line for line in content.splitlines() if line.strip()), "").split(",")
    return abs(len(first) - FIELDS) <= 2 and first[0].lstrip(" +-")[:1].isdecimal()


def parse_motion_file(content: str, path: Path) -> JointTrajectory:
    """Read a motion file from its text; `path` names it in errors. All 25 joints, radians, first line at 0 s."""
    rows = []
    for where, cells in table(content, path):
        if len(cells) != FIELDS:
            raise BodyError(f"{where} has {len(cells)} fields where a HOAP-2 motion file has {FIELDS}")
        rows.append([finite(cell, f"{where}, field {field}") for field, cell in enumerate(cells, start=1)])
        if rows[-1][0] <= 0:
            raise BodyError(f"{where}: sampling interval {cells[0]} ms; it must be above 0")
    fields = np.array(rows)
    time = np.concatenate([[0.0], np.cumsum(fields[:-1, 0])]) / 1000
    angles = np.zeros((len(fields), len(JOINTS)))
    for field, (joint, sign) in enumerate(PULSE_SIGNS.items(), start=FIRST_JOINT_FIELD):
        angles[:, JOINTS.index(joint)] = np.deg2rad(sign * fields[:, field] / ENCODER_PULSES_PER_DEGREE)
    return JointTrajectory(str(path), time, JOINTS, angles)
