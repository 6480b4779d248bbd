"""The real HOAP-2's motion files, as its walking sample uses them (Webots HOAP-2 controller and its `walk` file).

27 comma-separated numbers per line and no header: sampling interval in ms, a skipped field, right leg 1-6, right arm
1-4, left leg 1-6, left arm 1-4, waist, hand field, three flags. Joint fields are encoder pulses, 209 to a degree, with
a sign of their own. Head joints have no field and stay at 0; what the hand field (60 in the sample) means is not
known, so the hands stay at 0 as well; the flags are not used.
"""

from pathlib import Path

import numpy as np

from models.hoap2.facts import ENCODER_PULSES_PER_DEGREE, JOINTS, PULSE_SIGNS
from models.motion.files import MotionError
from models.motion.trajectory import JointTrajectory

FIELDS = 27
FIRST_JOINT_FIELD = 2


def looks_like_motion_file(content: str) -> bool:
    """Whether the first line that is not blank holds numbers only, 27 of them or so: a table begins with names."""
    first = next((line for line in content.splitlines() if line.strip()), "")
    cells = first.split(",")
    return len(cells) > 1 and all(_is_number(cell) for cell in cells) and abs(len(cells) - FIELDS) <= 2


def parse_motion_file(content: str, path: Path) -> JointTrajectory:
    """Read a motion file from its text; `path` names it in errors. All 25 joints, radians, first line at 0 s."""
    rows = []
    for number, line in enumerate(content.splitlines(), start=1):
        if not line.strip():
            continue
        cells = line.strip().split(",")
        if len(cells) != FIELDS:
            raise MotionError(
                f"{path}: line {number} has {len(cells)} fields where a HOAP-2 motion file has {FIELDS}; "
                "download it again or mend the line"
            )
        for field, cell in enumerate(cells, start=1):
            if not _is_number(cell) or not np.isfinite(float(cell)):
                raise MotionError(f"{path}: line {number}, field {field}: {cell.strip()!r} is not a number")
        rows.append([float(cell) for cell in cells])
        if rows[-1][0] <= 0:
            raise MotionError(f"{path}: line {number}: sampling interval {cells[0].strip()} ms; it must be above 0")
    fields = np.array(rows).reshape(-1, FIELDS)
    time = np.concatenate([[0.0], np.cumsum(fields[:-1, 0])]) / 1000
    angles = np.zeros((len(fields), len(JOINTS)))
    for field, (joint, sign) in enumerate(PULSE_SIGNS.items(), start=FIRST_JOINT_FIELD):
        angles[:, JOINTS.index(joint)] = np.deg2rad(sign * fields[:, field] / ENCODER_PULSES_PER_DEGREE)
    return JointTrajectory(str(path), time[: len(fields)], JOINTS, angles)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
