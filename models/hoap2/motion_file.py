"""The real HOAP-2's motion files, as its walking sample uses them (Webots HOAP-2 controller and its `walk` file).

27 comma-separated numbers per line and no header: sampling interval in ms, a skipped field, right leg 1-6, right arm
1-4, left leg 1-6, left arm 1-4, waist, hand field, three flags. Joint fields are encoder pulses, 209 to a degree, with
a sign of their own. Head joints have no field and stay at 0; what the hand field (60 in the sample) means is not
known, so the hands stay at 0 as well; the flags are not used.
"""

import numpy as np

from models.errors import BodyError
from models.hoap2.facts import ENCODER_PULSES_PER_DEGREE, JOINTS, PULSE_SIGNS
from models.motion.trajectory import JointTrajectory
from models.tables import Table

FIELDS = 27
FIRST_JOINT_FIELD = 2


def looks_like_motion_file(rows: Table) -> bool:
    """Whether there are 27 fields or so, the first a number: other tables begin with names."""
    return (
        len(rows.cells) > 0 and abs(rows.cells.shape[1] - FIELDS) <= 2 and rows.cells[0, 0].strip("+-")[:1].isdecimal()
    )


def parse_motion_file(rows: Table) -> JointTrajectory:
    """The movement in a motion file. All 25 joints, radians, first line at 0 s."""
    if rows.cells.shape[1] != FIELDS:
        raise BodyError(f"{rows.where(0)} has {rows.cells.shape[1]} fields where a HOAP-2 motion file has {FIELDS}")
    fields = rows.numbers(slice(None), range(FIELDS), [f"field {field + 1}" for field in range(FIELDS)])
    for row in np.flatnonzero(fields[:, 0] <= 0).tolist():
        raise BodyError(f"{rows.where(row)}: sampling interval {fields[row, 0]:g} ms; it must be above 0")
    time = np.concatenate([[0.0], np.cumsum(fields[:-1, 0])]) / 1000
    angles = np.zeros((len(fields), len(JOINTS)))
    for field, (joint, sign) in enumerate(PULSE_SIGNS.items(), start=FIRST_JOINT_FIELD):
        angles[:, JOINTS.index(joint)] = np.deg2rad(sign * fields[:, field] / ENCODER_PULSES_PER_DEGREE)
    return JointTrajectory(str(rows.path), time, JOINTS, angles)
