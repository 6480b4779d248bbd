"""Inverse-dynamics feedforward with the true model: the limit that knowing one's body exactly would give.

Not the imitator's: it reads the body's own equations (MuJoCo's inverse dynamics, friction and damping included).
"""

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

from models.arrays import FloatArray
from models.body import SimulatedBody


def feedforward_angles(body: SimulatedBody, angles: FloatArray) -> FloatArray:
    """(T, J) servo commands that would hold a body to (T, J) joint angles.

    Law: tau = mj_inverse(q, v, a) at the middle of each tick; a servo with tau = kp (c - q) - kv v is then asked for
    c = q + (tau + kv v) / kp. Row t is the command to hold from tick t to t + 1.
    """
    model = body.model
    data = mujoco.MjData(model)
    spline = CubicSpline(np.arange(len(angles)) * body.tick_s, angles)
    times = np.minimum((np.arange(len(angles)) + 0.5) * body.tick_s, (len(angles) - 1) * body.tick_s)
    joints = model.actuator_trnid[:, 0]
    qpos, dof = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
    kp, kv = model.actuator_gainprm[:, 0], -model.actuator_biasprm[:, 2]
    commands = np.empty_like(angles)
    for t, time in enumerate(times):
        data.qpos[:] = body.configurations(spline(time)[None])[0]
        data.qvel[:], data.qacc[:] = 0, 0
        data.qvel[dof], data.qacc[dof] = spline(time, 1), spline(time, 2)
        mujoco.mj_inverse(model, data)
        commands[t] = data.qpos[qpos] + (data.qfrc_inverse[dof] + kv * data.qvel[dof]) / kp
    return commands
