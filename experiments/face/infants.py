"""Infants that babble in the dark, each by itself, and what a judge would call their own acts."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.dark import Acts, FaceMind, babble, learn
from experiments.face.judging import labels
from models.body import SimulatedBody
from models.face import JOINTS, Face
from models.face.body import face_body, face_model
from models.face.relations import Truth
from models.servos import resting

TOGETHER: Final = 20
"""Infants whose bodies are stepped side by side; results depend on it as little as on the number of processes."""
HABITS: Final = {
    "tongue": (("tongue",), 0.30),
    "tongue to the side": (("tongue_yaw", "tongue_pitch"), 0.05),
    "mouth": (("jaw",), 0.25),
    "lips": (("upper_lip_left",), 0.10),
    "brows": (("brows",), 0.10),
    "head": (("neck_yaw", "neck_pitch"), 0.20),
}
"""Whose motors infants move by themselves, and how often: assumed (tongue protrusion and retraction is a stereotypy of
the first months: Keven & Akins 2017). What comes of it is up to the body: with a shut mouth no tongue comes out."""
ALIKE: Final = 12.0
"""How like each other infants are in that (a Dirichlet's concentration)."""
HABIT_ACTS: Final = 200
"""Acts of its own kept of each."""


@dataclass(frozen=True)
class Group:
    """Infants that are raised side by side."""

    face: Face
    number: int
    """Of the group; infants are counted on through all groups."""
    count: int
    acts: int
    seed: int
    scramble: int | None = None

    def body(self, copies: int, *, pacifier: bool = False) -> SimulatedBody:
        """Bodies of theirs."""
        return face_body(
            self.face, copies=copies, pacifier=pacifier, scramble=self.scramble, threads=1, seed=self.seed + self.number
        )


@dataclass(frozen=True, eq=False)
class Infant:
    """What babbling left, and what it does by itself."""

    mind: FaceMind
    habit: IntArray
    """(H,) labels of its spontaneous acts."""
    habits: FloatArray
    """(H, M) their motor lines."""


def rest_lines(body: SimulatedBody) -> FloatArray:
    """(M,) motor lines that leave a body at rest: what it is born knowing."""
    configuration = resting(body.model)
    joints = [int(body.model.joint(joint).qposadr[0]) for joint in body.joints]
    return body.command_angles(configuration[joints])


def joint_of_motor(body: SimulatedBody) -> IntArray:
    """(M,) joint that each motor line moves, for those who judge."""
    return np.argsort(body.wiring.motor)


def raised(group: Group) -> list[Infant]:
    """Babbling, learning, and the labels of what each does by itself."""
    body = group.body(group.count)
    rngs = [np.random.default_rng([group.seed, 0xFACE, group.number, n]) for n in range(group.count)]
    ends: list[FloatArray] = []
    acts = babble(body, group.acts, rest_lines(body), rngs, lambda act: ends.append(np.array(body.batch.qpos)))
    true = Truth(face_model(group.face))
    joints = joint_of_motor(body)
    infants = []
    for copy, (mine, rng) in enumerate(zip(acts, rngs, strict=True)):
        drawn = _spontaneous(mine, joints, rng)
        seen = labels(true.of(np.stack([ends[act][copy] for act in drawn])))
        infants.append(Infant(learn(mine, body.fingerprint), seen, mine.commands[drawn]))
    return infants


def _spontaneous(acts: Acts, joints: IntArray, rng: np.random.Generator) -> IntArray:
    """(H,) numbers of own acts, of one motor alone or with the mouth, drawn as often as this infant moves whose they
    are."""
    third = len(acts.commands) // 3
    moved = np.abs(acts.commands[: 2 * third] - acts.rest) > 1e-9
    names = np.array(JOINTS)[joints]
    liking = rng.dirichlet(ALIKE * np.array([share for _, share in HABITS.values()]))
    weight = np.zeros(2 * third)
    for (parts, _), share in zip(HABITS.values(), liking, strict=True):
        mine = moved[:, np.isin(names, parts)].any(1)
        if parts == ("jaw",):
            mine &= moved.sum(1) == 1
        weight[mine] += share / max(mine.sum(), 1)
    return np.asarray(rng.choice(2 * third, HABIT_ACTS, p=weight / weight.sum()))
