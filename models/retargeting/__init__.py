"""Retargeting: a teacher's limb directions as HOAP-2's joint angles."""

from models.retargeting.chain import hoap2_directions
from models.retargeting.retarget import Retargeted, retarget

__all__ = ["Retargeted", "hoap2_directions", "retarget"]
