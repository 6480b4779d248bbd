"""Whether a body can be where a demonstration wants it: told to people, never to the mind."""

import sys

import numpy as np

from babbling.axes import FloatArray
from experiments.shared.minds import body_of
from experiments.shared.options import BodyOptions
from models.body import SimulatedBody
from models.card import closed
from models.servos import BANDWIDTH_HZ, DAMPING_RATIO

FRAMES, RAMP_S, HELD_S = 24, 1.0, 1.5
"""Frames that are held, after so long a way there, for so long."""
OFF = {"deg": 2.0, "mm": 2.0}
"""What is further off than so much, once it had time, is said."""


def given(body: SimulatedBody) -> tuple[str, ...]:
    """The servos that a body was given, in a line; nothing where it was given none."""
    if not body.given:
        return ()
    kp = [gains.kp for gains in body.given.values()]
    line = (
        f"{len(kp)} of {len(body.joints)} motors were given position servos: -3 dB at {BANDWIDTH_HZ:g} Hz, damping "
        f"ratio {DAMPING_RATIO:g} by the inertia at rest, kp {min(kp):.3g} to {max(kp):.3g} N m/rad (N/m of slides), "
        "torque limits kept"
    )
    print(f"imitate: {line}", file=sys.stderr)
    return (line,)


def held(options: BodyOptions, angles: FloatArray) -> tuple[str, ...]:
    """A line for the joint that is furthest off when frames of (T, M) angles are commanded and held, with the reason;
    nothing where all are nearly reached. Such frames nobody can imitate by sending postures alone."""
    frames = angles[np.unique(np.linspace(0, len(angles) - 1, FRAMES).astype(int))]
    body = body_of(options, len(frames), stream=7)
    start = body.joint_angles.copy()
    for share in np.clip(np.arange(1, (RAMP_S + HELD_S) / body.tick_s + 1) * body.tick_s / RAMP_S, 0, 1):
        body.act(body.command_angles(start + share * (frames - start)))
    missed = body.shown_scale * (body.joint_angles - frames)
    worst = np.abs(missed) / [OFF[unit] for unit in body.shown_units]
    frame, joint = map(int, np.unravel_index(int(worst.argmax()), worst.shape))
    if worst[frame, joint] <= 1:
        return ()
    line = (
        f"joint {body.joints[joint]!r} stays {abs(missed[frame, joint]):.1f} {body.shown_units[joint]} off where it is "
        f"told to hold still: {_why(body, frame, joint)} ({int((worst > 1).any(0).sum())} of {len(body.joints)} joints "
        f"stay off by more than {OFF['deg']:g} deg or {OFF['mm']:g} mm)"
    )
    print(f"imitate: {line}", file=sys.stderr)
    return (line,)


def _why(body: SimulatedBody, frame: int, joint: int) -> str:
    """What keeps it: its torque limit, a closed chain, or a load that bends its servo."""
    model, actuator, moved = body.model, body.actuators[joint], body.moved[joint].joints[0]
    kp = model.actuator_gainprm[actuator, 0]
    force = kp * (body.batch.ctrl[frame, actuator] - body.joint_angles[frame, joint])
    limits = [
        np.abs(ends).max() if has else np.inf
        for has, ends in (
            (model.actuator_forcelimited[actuator], model.actuator_forcerange[actuator]),
            (model.jnt_actfrclimited[moved], model.jnt_actfrcrange[moved]),
        )
    ]
    limit = min(limits)
    unit = "N m" if body.units[joint] == "rad" else "N"
    if abs(force) >= 0.98 * limit:
        return f"its torque limit of {limit:.3g} {unit} is reached"
    if closed(model):
        return "its chain is closed, so that joints cannot go everywhere one by one; this demonstration is out of reach"
    return f"its servo of {kp:.3g} {unit}/{body.units[joint]} gives way under {min(abs(force), limit):.3g} {unit}"
