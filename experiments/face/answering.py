"""What infants make of what they see: whose organ it was, and tries to do the same, in physics."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.dark import FaceMind
from babbling.relations import MOUTH_M
from experiments.face.infants import Group, Infant, joint_of_motor
from experiments.face.judging import MAIN, ORGAN_SHOWN, RANGE, labels, largest_change, organs
from experiments.face.watching import Look
from imitation.acting.matching import Tried, tries
from imitation.correspondence.own_acts import OwnActs, given_still, likeliest, owned
from imitation.deferred import FaceMemory
from imitation.inference.inverse import InverseModel, LinearInverse
from imitation.seeing.face_fit import Seen
from models.body import SimulatedBody
from models.face.relations import Truth


@dataclass(frozen=True, eq=False)
class Answers:
    """Of I infants to L looks each; K tries."""

    gesture: IntArray
    """(I, L) that was shown."""
    strong: BoolArray
    """(I, L)"""
    metres: FloatArray
    """(I, L) from where."""
    front: BoolArray
    """(I, L) whether the face looked straight at it."""
    organ: FloatArray
    """(I, L, 6) P(organ), nothing last."""
    peers: IntArray
    """(2, I, L) organs by the largest change, and by own acts whose relations are weighed apart."""
    labels: IntArray
    """(I, L, K) what a judge saw it do."""
    missed: FloatArray
    """(I, L, K) what it did minus what was shown, in the relation shown: share of the range."""
    felt: FloatArray
    """(I, L, K) what it felt that it missed, there: share of the range."""
    tongue_mm: FloatArray
    """(I, L, K) how far the tongue's place beyond the lips was off, mm."""
    line: FloatArray
    """(I, L) the first try's miss where a line stands for the table."""

    @property
    def right(self) -> BoolArray:
        """(I, L) whether the most probable organ is the one that was moved."""
        return np.asarray(self.organ.argmax(-1) == ORGAN_SHOWN[self.gesture])


def together(parts: Sequence[Answers]) -> Answers:
    """Of all groups."""
    return Answers(
        **{
            name: np.concatenate([getattr(part, name) for part in parts], axis=int(name == "peers"))
            for name in vars(parts[0])
        }
    )


def comparable(mind: FaceMind, seen: Seen, neutral: FloatArray) -> FloatArray:
    """(8,) relations as seen, the other's face at rest held against one's own at rest."""
    relations = seen.relations - neutral + mind.still
    return np.asarray(np.where(np.diag(seen.information) > 0, relations, mind.still))


def understood(acts: OwnActs, seen: Seen, neutral: FloatArray) -> tuple[FaceMemory, FloatArray]:
    """What to do to do the same, and P(motors moved): the organ first, then what it has to come to."""
    mind = acts.mind
    relations = comparable(mind, seen, neutral)
    belief = acts.posterior(relations, seen.information, seen.tongue)
    moved = owned(mind, likeliest(acts, belief))
    target = given_still(relations, seen.information, moved, mind.still)
    return FaceMemory(mind.fingerprint, target, moved.astype(np.int64)), belief.probability


def answered(
    group: Group, infants: Sequence[Infant], looks: Sequence[Sequence[Look]], count: int, *, line: bool = False
) -> tuple[Answers, list[FaceMemory]]:
    """Every infant's answers to its own (I, L) looks, and what they remember of them, one infant after the other."""
    body = group.body(len(infants) * len(looks[0]))
    joints = joint_of_motor(body)
    memories, beliefs, peers = list[FaceMemory](), list[FloatArray](), list[tuple[int, int]]()
    for infant, mine in zip(infants, looks, strict=True):
        acts = OwnActs(infant.mind)
        for look in mine:
            seen, relations = look.seen[-1], comparable(infant.mind, look.seen[-1], look.neutral)
            memory, probability = understood(acts, seen, look.neutral)
            apart = acts.posterior(relations, np.diag(np.diag(seen.information)), seen.tongue).probability
            memories.append(memory)
            beliefs.append(organs(acts, probability, joints))
            peers.append((int(largest_change(relations, infant.mind.still)), int(organs(acts, apart, joints).argmax())))
    minds = [infant.mind for infant in infants]
    tried, true = acted(body, minds, memories, count)
    every, shape = [look for mine in looks for look in mine], (len(infants), len(looks[0]))
    rough = true[:1]
    if line:
        _, rough = acted(group.body(len(every)), minds, memories, 1, [LinearInverse(m.forward_model) for m in minds])
    gesture = np.array([look.shown.gesture for look in every])
    wanted = np.stack([look.true for look in every])
    targets = np.stack([memory.relations for memory in memories])
    main = MAIN[gesture]

    def share(off: FloatArray) -> FloatArray:
        """(K, B, 8) relations missed to (I, L, K) of the one that was shown."""
        each = np.abs(np.take_along_axis(off, main[None, :, None], -1))[..., 0] / RANGE[main]
        return np.asarray(np.moveaxis(each, 0, -1).reshape(*shape, -1))

    answers = Answers(
        gesture=gesture.reshape(shape),
        strong=np.array([look.shown.strong for look in every]).reshape(shape),
        metres=np.array([look.looking.view.distance for look in every]).reshape(shape),
        front=np.array([look.looking.view.straight for look in every]).reshape(shape),
        organ=np.stack(beliefs).reshape(*shape, -1),
        peers=np.array(peers).T.reshape(2, *shape),
        labels=np.moveaxis(labels(true), 0, -1).reshape(*shape, -1),
        missed=share(true - wanted),
        felt=share(targets - tried.felt),
        tongue_mm=1e3 * MOUTH_M * np.moveaxis(np.abs(true - wanted)[..., 1], 0, -1).reshape(*shape, -1),
        line=share(rough - wanted)[..., 0],
    )
    return answers, memories


def acted(
    body: SimulatedBody,
    minds: Sequence[FaceMind],
    memories: Sequence[FaceMemory],
    count: int,
    inverses: Sequence[InverseModel] = (),
    *,
    reset: bool = True,
) -> tuple[Tried, FloatArray]:
    """Tries at what is remembered, and (K, B, 8) true relations at their ends."""
    ends: list[FloatArray] = []
    targets = np.stack([memory.relations for memory in memories])
    moved = np.stack([memory.moved for memory in memories]) > 0
    if reset:
        body.reset()
    tried = tries(body, minds, targets, moved, count, inverses, lambda: ends.append(np.array(body.batch.qpos)))
    return tried, Truth(body.model).of(np.stack(ends))
