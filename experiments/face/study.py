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
COURSES: Final = 5
"""Infants whose beliefs are followed through acts, and of those that act a day later."""


class Answering(NamedTuple):
    """A group, and what its infants are shown."""

    group: Group
    infants: list[Infant]
    looks: dict[str, list[list[Look]]]
    """Condition -> infant -> looks."""
    passive: list[Look]
    line: bool
    tries: int


class Answered(NamedTuple):
    """What came of it."""

    answers: dict[str, Answers]
    pacified: AfterPacifier | None


@dataclass(frozen=True, eq=False)
class Studied:
    """Before it is told."""

    config: Config
    fresh: dict[str, Answers]
    """By condition."""
    pacified: list[AfterPacifier]
    day: IntArray
    """(B, K) labels a day later, of the first infants' usual looks."""
    day_gesture: IntArray
    day_strong: BoolArray
    day_at_once: IntArray
    """(B, K) labels of the same at once."""
    worn: Answers
    course: FloatArray
    """(infants x acts, times, 6) P(organ)."""
    course_gesture: IntArray
    course_strong: BoolArray
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
    face = face_of(config.face)
    count = config.infants // TOGETHER
    groups = [Group(face, n, TOGETHER, config.acts, config.seed, config.scramble) for n in range(count)]
    worn = [replace(groups[0], face=FACES["newborn-worn"], number=1000 + n) for n in range(WORN_GROUPS)]
    scrambled = replace(groups[0], number=2000, acts=SCRAMBLED_ACTS, scramble=config.seed + 1)
    lookings = [
        Looking(condition, name, view, EACH, 100 * config.seed + 10 * n + k)
        for n, (condition, views) in enumerate(VIEWS.items())
        for k, (name, view) in enumerate(views)
    ]
    lookings += [Looking("course", *VIEWS["usual"][k], 2, 100 * config.seed + 90 + k, True) for k in (0, 2)]
    everybody = [*groups, *worn, scrambled]
    raised_ = in_parallel(raised, everybody, config.workers, "babbling in the dark")
    bank = [look for each in in_parallel(watched, lookings, config.workers, "faces are looked at") for look in each]
    answering = [
        _answering(g, infants, bank, config.seed, usual_only=g.number >= 1000)
        for g, infants in zip([*groups, *worn], raised_, strict=False)
    ]
    answers = in_parallel(answer, answering, config.workers, "identifying organs, trying")
    pupils = [(groups[0], infant, bank) for infant in raised_[0][:PUPILS]]
    mirrored = in_parallel(compared, pupils, config.workers, "before a mirror")
    own = answers[: len(groups)]
    fresh = {name: together([each.answers[name] for each in own]) for name in VIEWS}
    first = replace(groups[0], count=COURSES)
    at_once, memories = answered(first, raised_[0][:COURSES], answering[0].looks["usual"][:COURSES], TRIES)
    day = after_day(first, raised_[0][:COURSES], memories, TRIES)
    joints = joint_of_motor(groups[0].body(1))
    course = [look for look in bank if look.looking.condition == "course" and look.shown.gesture < len(GESTURES)]
    beliefs = []
    for infant in raised_[0][:COURSES]:
        acts = OwnActs(infant.mind)
        for look in course:
            beliefs.append([organs(acts, understood(acts, s, look.neutral)[1], joints) for s in look.seen])
    right = joint_of_motor(scrambled.body(1))
    found = [right[infant.mind.motors] == np.arange(len(infant.mind.motors)) for infant in raised_[-1]]
    usual = fresh["usual"]
    infants = Infants(
        np.concatenate([[infant.habit for infant in each] for each in raised_[: len(groups)]]),
        np.stack(
            [usual.labels[:, _of(usual, gesture)].reshape(len(usual.labels), -1) for gesture in range(len(GESTURES))], 1
        ),
    )
    ns = [n for n in NS if n <= len(infants.habit)]
    powers = power(infants, ns=ns, rng=np.random.default_rng([config.seed, 0x90E4]))
    return Studied(
        config, fresh, [each.pacified for each in own if each.pacified is not None], day,
        at_once.gesture.ravel(), at_once.strong.ravel(), at_once.labels.reshape(-1, TRIES),
        together([each.answers["usual"] for each in answers[len(groups):]]),
        np.array(beliefs), np.tile([look.shown.gesture for look in course], COURSES),
        np.tile([look.shown.strong for look in course], COURSES), float(np.mean(found)), mirrored, powers,
        infants,
        time.perf_counter() - began,
    )  # fmt: skip


def _of(answers: Answers, gesture: int) -> IntArray:
    """Columns in which every infant saw this gesture strongly: looks stand in the same order for all."""
    return np.flatnonzero((answers.gesture == gesture).all(0) & answers.strong.all(0))


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
    return Answering(group, infants, looks, passive, True, WORN_TRIES if usual_only else TRIES)


def answer(task: Answering) -> Answered:
    """All conditions of one group."""
    answers, pacified = {}, None
    for condition, looks in task.looks.items():
        answers[condition], memories = answered(
            task.group, task.infants, looks, task.tries, line=task.line and condition == "usual"
        )
        if condition == "usual" and len(task.looks) > 1:
            pacified = after_pacifier(task.group, task.infants, memories, task.passive, TRIES)
    return Answered(answers, pacified)
