"""Movements in joint angles and the files they come in."""

from models.motion.formats import FORMATS, read_motion
from models.motion.trajectory import JointTrajectory

__all__ = ["FORMATS", "JointTrajectory", "read_motion"]
