"""Movements in joint angles and the files they come in."""

from models.motion.archives import write_archive
from models.motion.files import MotionError
from models.motion.formats import FORMATS, read_motion
from models.motion.tables import write_table
from models.motion.trajectory import JointTrajectory

__all__ = ["FORMATS", "JointTrajectory", "MotionError", "read_motion", "write_archive", "write_table"]
