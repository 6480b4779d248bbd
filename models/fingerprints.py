"""Which body it is: a mind is used with the one that babbled, or not at all."""

import hashlib
from collections.abc import Sequence

import mujoco
import numpy as np

from models.wear import Wear
from models.wiring import Wiring


def fingerprint(model: mujoco.MjModel, wear: Wear, wiring: Wiring, tick_s: float, parts: Sequence[str]) -> str:
    """Of all that one learns by babbling; `parts` are motors and sensors that were chosen."""
    digest = hashlib.sha256()
    for part in (
        model.names, model.body_parentid, model.body_pos, model.body_quat, model.body_mass, model.body_inertia,
        model.body_ipos, model.jnt_axis, model.jnt_range, model.dof_armature, model.dof_damping, model.dof_frictionloss,
        model.actuator_gainprm, model.actuator_biasprm, model.actuator_ctrlrange, model.actuator_forcerange,
        wiring.motor, wiring.gain, wiring.offset, wiring.sense,
        model.jnt_stiffness, model.qpos_spring, model.actuator_gear, model.body_gravcomp, model.opt.gravity,
        model.tendon_stiffness, model.tendon_lengthspring, model.wrap_objid, model.wrap_prm, model.eq_data,
        np.array([*wear.backlash, *wear.shares[1:], tick_s, model.opt.timestep]),
        wear.bending, "\n".join(parts).encode(),
    ):  # fmt: skip
        digest.update(part if isinstance(part, bytes) else np.ascontiguousarray(part).tobytes())
    return digest.hexdigest()[:16]
