"""`imitate face --study`: populations of infants that babbled apart, every gesture, view and condition."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from experiments.face.answering import Answers, answered, together, understood
from experiments.face.infants import TOGETHER, Group, Infant, joint_of_motor, raised
from experiments.face.judging import organs
from experiments.face.later import AfterPacifier, after_day, after_pacifier
from experiments.face.mirroring import Compared, compared
from experiments.face.options import Config
from experiments.face.scores import NS, Powers, power
from experiments.face.theories import GESTURES, Infants
from experiments.face.watching import VIEWS, Look, Looking, watched
from experiments.shared.parallel import in_parallel
from imitation.correspondence.own_acts import OwnActs
from models.face import FACES, face_of

EACH: Final = 6
"""Acts of every kind seen from one view, in the bank that all infants draw their looks from."""
TWICE: Final = 2
"""Looks of every kind that each infant has in the usual condition; one in the others."""
TRIES, WORN_TRIES = 3, 5
WORN_GROUPS: Final = 2
SCRAMBLED_ACTS: Final = 240
PUPILS: Final = 2
"""Infants before a mirror, for comparison."""
SOME: Final = 5
"""Infants whose beliefs are followed through acts, and who act a day later."""
FOLLOWED: Final = 0, 2
"""Of the usual views, those from which acts are looked at all through."""


class Answering(NamedTuple):
    """A group, and what its infants are shown."""

    group: Group
    infants: list[Infant]
    looks: dict[str, list[list[Look]]]
    """Condition -> infant -> looks."""
    passive: list[Look]
    tries: int


class Answered(NamedTuple):
    """What came of it."""

    answers: dict[str, Answers]
    pacified: AfterPacifier | None


class Course(NamedTuple):
    """Beliefs all through acts."""

    organ: FloatArray
    """(infants x acts, times, 6) P(organ)."""
    gesture: IntArray
    strong: BoolArray


@dataclass(frozen=True, eq=False)
class Studied:
    """Before it is told."""

    fresh: dict[str, Answers]
    """By condition."""
    pacified: list[AfterPacifier]
    at_once: Answers
    """Of some infants to their usual looks."""
    day: IntArray
    """(B, K) labels of what they do about the same a day later."""
    worn: Answers
    course: Course
    motors_right: float
    """Share of relations whose own motor was found, of infants with permuted motors and few acts."""
    mirrored: list[Compared]
    """Infants that learned of faces before a mirror."""
    powers: Powers
    infants: Infants
    took_s: float


def studied(config: Config) -> Studied:
    """All of it."""
    began = time.perf_counter()
    face, starts = face_of(config.face), range(0, config.infants, TOGETHER)
    sizes = [min(TOGETHER, config.infants - start) for start in starts]
    groups = [Group(face, n, size, config.acts, config.seed, config.scramble) for n, size in enumerate(sizes)]
    worn = [replace(groups[0], face=FACES["newborn-worn"], number=1000 + n) for n in range(WORN_GROUPS)]
    scrambled = replace(groups[0], number=2000, acts=SCRAMBLED_ACTS, scramble=config.seed + 1)
    *nurseries, shuffled = in_parallel(raised, [*groups, *worn, scrambled], config.workers, "babbling in the dark")
    looked = in_parallel(watched, lookings(config.seed), config.workers, "faces are looked at")
    bank = [look for each in looked for look in each]
    answering = [
        _answering(group, infants, bank, config.seed, usual_only=group.face != face)
        for group, infants in zip([*groups, *worn], nurseries, strict=True)
    ]
    answers = in_parallel(answer, answering, config.workers, "identifying organs, trying")
    pupils = [(groups[0], infant, bank) for infant in nurseries[0][:PUPILS]]
    mirrored = in_parallel(compared, pupils, config.workers, "before a mirror")
    some, those = replace(groups[0], count=SOME), nurseries[0][:SOME]
    at_once, memories = answered(some, those, answering[0].looks["usual"][:SOME], TRIES)
    own = answers[: len(groups)]
    fresh = {name: together([each.answers[name] for each in own]) for name in VIEWS}
    infants = judged([infant for each in nurseries[: len(groups)] for infant in each], fresh["usual"])
    samples = [n for n in NS if n <= config.infants]
    found = joint_of_motor(scrambled.body(1))[np.stack([infant.mind.motors for infant in shuffled])]
    return Studied(
        fresh=fresh,
        pacified=[each.pacified for each in own if each.pacified is not None],
        at_once=at_once,
        day=after_day(some, those, memories, TRIES),
        worn=together([each.answers["usual"] for each in answers[len(groups) :]]),
        course=_course(groups[0], those, bank),
        motors_right=float((found == np.arange(found.shape[1])).mean()),
        mirrored=mirrored,
        powers=power(infants, ns=samples, rng=np.random.default_rng([config.seed, 0x90E4])),
        infants=infants,
        took_s=time.perf_counter() - began,
    )


def lookings(seed: int) -> list[Looking]:
    """Every view of the bank; two of them all through the acts."""
    views = [(condition, *one) for condition, ones in VIEWS.items() for one in ones]
    views += [("course", *VIEWS["usual"][k]) for k in FOLLOWED]
    return [
        Looking(condition, face, view, 2 if condition == "course" else EACH, 100 * seed + n, condition == "course")
        for n, (condition, face, view) in enumerate(views)
    ]


def judged(infants: Sequence[Infant], usual: Answers) -> Infants:
    """What a judge saw of them: own acts, and answers to strong gestures."""
    strong = [usual.labels[:, (usual.gesture[0] == g) & usual.strong[0]] for g in range(len(GESTURES))]
    imitated = np.stack([labels.reshape(len(labels), -1) for labels in strong], axis=1)
    return Infants(np.stack([infant.habit for infant in infants]), imitated)


def _course(group: Group, infants: Sequence[Infant], bank: Sequence[Look]) -> Course:
    joints = joint_of_motor(group.body(1))
    looks = [look for look in bank if look.looking.condition == "course" and look.shown.gesture < len(GESTURES)]
    beliefs = [
        [organs(acts, understood(acts, seen, look.neutral)[1], joints) for seen in look.seen]
        for acts in (OwnActs(infant.mind) for infant in infants)
        for look in looks
    ]
    shown = [look.shown for look in looks] * len(infants)
    return Course(np.array(beliefs), np.array([one.gesture for one in shown]), np.array([one.strong for one in shown]))


def _answering(group: Group, infants: list[Infant], bank: Sequence[Look], seed: int, usual_only: bool) -> Answering:
    """Every infant has looks of its own, of every kind equally many, in the same order of kinds."""
    rng = np.random.default_rng([seed, 0xA45, group.number])
    kinds = [(gesture, strong) for gesture in range(len(GESTURES)) for strong in (True, False)]
    looks = {}
    for condition in list(VIEWS)[: 1 if usual_only else None]:
        mine = [look for look in bank if look.looking.condition == condition]
        each = TWICE if condition == "usual" else 1
        of = {kind: [look for look in mine if (look.shown.gesture, look.shown.strong) == kind] for kind in kinds}
        looks[condition] = [
            [of[kind][n] for kind in kinds for n in rng.choice(len(of[kind]), each, replace=False)] for _ in infants
        ]
    passive = [look for look in bank if look.looking.condition == "usual" and look.shown.gesture == len(GESTURES)]
    return Answering(group, infants, looks, passive, WORN_TRIES if usual_only else TRIES)


def answer(task: Answering) -> Answered:
    """All conditions of one group."""
    answers, pacified = {}, None
    for condition, looks in task.looks.items():
        answers[condition], memories = answered(task.group, task.infants, looks, task.tries, line=condition == "usual")
        if condition == "usual" and len(task.looks) > 1:
            pacified = after_pacifier(task.group, task.infants, memories, task.passive, TRIES)
    return Answered(answers, pacified)
