"""A mirror before an infant: what it would learn of faces, had it not been born with it."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from babbling.axes import BoolArray
from babbling.dark import FaceMind
from experiments.face.answering import understood
from experiments.face.infants import Group, Infant, joint_of_motor
from experiments.face.judging import ORGAN_SHOWN, organs
from experiments.face.theories import GESTURES
from experiments.face.watching import Look
from imitation.correspondence.own_acts import OwnActs
from imitation.seeing.face_fit import look_at
from imitation.seeing.mirrored import Mirrored
from models.body import SimulatedBody
from models.face import Face
from models.face.looks import Onlooker, View

LOOKS: Final = 150
"""Into the mirror, .3 m away, one for each act."""
MOST: Final = 3
"""Motors moved at once."""


class Compared(NamedTuple):
    """How well a mirror's pupil names organs."""

    condition: tuple[str, ...]
    right: BoolArray


def before_mirror(body: SimulatedBody, face: Face, mind: FaceMind, seed: int, looks: int = LOOKS) -> Mirrored:
    """Acts of one to three motors, each looked at and felt; the mirror does not swap sides."""
    rng = np.random.default_rng([seed, 0x311])
    onlooker, low, high = Onlooker(face, View()), mind.forward_model.action.low, mind.forward_model.action.high
    body.reset()
    body.act(mind.rest[None])
    neutral = look_at(onlooker.look(np.array(body.batch.qpos[0]), rng))
    seen, felt = [], []
    for _ in range(looks):
        command = mind.rest.copy()
        for relation in rng.choice(len(mind.motors), rng.integers(1, MOST + 1), replace=False):
            command[mind.motors[relation]] = rng.uniform(low[relation], high[relation])
        felt.append(mind.landmarks.relations(body.act(command[None])[0]))
        seen.append(look_at(onlooker.look(np.array(body.batch.qpos[0]), rng)))
    return Mirrored.learned(np.stack(seen), np.stack(felt), neutral)


def compared(task: tuple[Group, Infant, Sequence[Look]]) -> Compared:
    """One pupil, and everything in the bank."""
    group, infant, bank = task
    body = group.body(1)
    mirror = before_mirror(body, group.face, infant.mind, group.seed + group.number)
    acts, joints = OwnActs(infant.mind), joint_of_motor(body)
    acted = [look for look in bank if look.shown.gesture < len(GESTURES)]
    right = []
    for look in acted:
        passive, end = look.numbers
        neutral = mirror.see(passive, passive).relations
        belief = organs(acts, understood(acts, mirror.see(end, passive), neutral)[1], joints)
        right.append(belief.argmax() == ORGAN_SHOWN[look.shown.gesture])
    conditions = tuple(look.looking.condition for look in acted)
    return Compared(conditions, np.array(right))
