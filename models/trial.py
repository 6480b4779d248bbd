"""Strangers' bodies: read in silence after they were tried, and what a body must do in a trial."""

import os
import time
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

import mujoco
import numpy as np

from models.apart import tried
from models.body import SimulatedBody
from models.errors import BodyError
from models.hush import silence
from models.markup import look
from models.servos import resting

HOUSE = Path(__file__).resolve().parent
TICKS, GENTLY = 10, 0.05
"""Ticks of a trial's movement; share of its range that each motor is told to go."""
SLOWEST, FURTHEST, MOST_MOTORS, MOST_FREE = 1.0, 1e5, 150, 600
"""s of computing for a second of a body; the largest number that a sense, or the posture at rest, may reach; motors
that can be babbled with; degrees of freedom."""


def strange(path: Path) -> bool:
    """Whether a file is none of this program's own."""
    return HOUSE not in Path(os.path.abspath(path)).parents


def spec_of(path: Path, work: str) -> mujoco.MjSpec:
    """An MJCF, parsed; a stranger's only after `look`, and after `work` ("module:function", of its path) was tried.

    Raises:
        BodyError: what either says, or MuJoCo cannot read it.
    """
    if strange(path):
        tried(work, path, look(path).bytes)
    with quiet(path):
        return mujoco.MjSpec.from_file(str(path))


def quiet(path: Path) -> AbstractContextManager[None]:
    """A block in which nothing is heard of what native code says of a stranger's file, nor is a log of it left.

    Raises:
        BodyError: there is no memory for it.
    """
    return silence(path) if strange(path) else nullcontext()


def moved(body: SimulatedBody) -> None:
    """See that a stranger's body moves as numbers do, at a reasonable cost: from rest gently to either side.

    Raises:
        BodyError: it does not.
    """
    count = len(body.joints)
    if count > MOST_MOTORS:
        raise BodyError(f"{body.name}: it has {count} motors; bodies of up to {MOST_MOTORS} can babble")
    if body.model.nv > MOST_FREE:
        raise BodyError(f"{body.name}: it has {body.model.nv} degrees of freedom; {MOST_FREE} are possible")
    if not (body.sense_low < body.sense_high).all():
        raise BodyError(f"{body.name}: a sense of it has an empty range; mend the range of its joint, or speed_limit")
    senses = np.abs([body.sense_low, body.sense_high]).max()
    for what, furthest in (("a sense of it may read", senses), ("its rest is at", np.abs(resting(body.model)).max())):
        if not furthest <= FURTHEST:
            raise BodyError(f"{body.name}: {what} {furthest:g}; {FURTHEST:g} is possible, mend its ranges")
    with silence(Path(body.name)):
        body.reset()
        rest, started = body.command_angles(body.joint_angles), time.process_time()
        for tick in range(TICKS):
            try:
                body.act(np.clip(rest + GENTLY * (1 - 2 * (tick % 2)), -1, 1))
            except BodyError:  # is said where it moves, after a card
                return
            cost = (time.process_time() - started) / (tick + 1) / body.tick_s
            if cost > SLOWEST and tick:
                raise BodyError(
                    f"{body.name}: a body-minute of it takes {cost:.0f} minutes of computing, {SLOWEST:g} are "
                    "possible; give it a longer timestep or fewer parts"
                )
