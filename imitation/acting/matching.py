"""Match to target without seeing oneself: act, feel what came of it, aim better (chapter, section 2.2 and Figure 9).

The target is what was seen of another, in relations that one's own organs can be felt in. Eq. (1) turns the forward
model round for the motors of the identified organ; all else stays at rest. What was felt to miss shifts the next aim
(`imitation.acting.attempts`); nobody says whether it was right.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from babbling.axes import BoolArray, FloatArray
from babbling.body import Body
from babbling.dark import FaceMind, gaps
from imitation.acting.attempts import Practice
from imitation.errors import ImitationError
from imitation.inference.inverse import BayesianInverse, InverseModel, Term


class Tried(NamedTuple):
    """K tries of B copies."""

    commands: FloatArray
    """(K, B, M) motor lines."""
    senses: FloatArray
    """(K, B, S) at their ends."""
    felt: FloatArray
    """(K, B, 8) relations."""


def chosen(mind: FaceMind, aims: FloatArray, moved: BoolArray, inverse: InverseModel) -> FloatArray:
    """(B, M) motor lines that lead to (B, 8) relations where `moved`; the rest stays at rest."""
    outcome = mind.forward_model.outcome
    aims = np.where(moved, np.clip(aims, outcome.low, outcome.high), mind.still)
    term = Term(mind.forward_model, (gaps(aims[:, 0], aims.shape[1]),), aims)
    action = inverse.choose([term], np.random.default_rng(0)).action  # ties hardly occur
    lines = np.tile(mind.rest, (len(aims), 1))
    for relation, motor in enumerate(mind.motors):
        lines[:, motor] = np.where(moved[:, relation], action[:, relation], lines[:, motor])
    return lines


def tries(
    body: Body,
    minds: Sequence[FaceMind],
    targets: FloatArray,
    moved: BoolArray,
    count: int,
    inverses: Sequence[InverseModel] = (),
    heed: Callable[[], None] = lambda: None,
) -> Tried:
    """So many tries at each target from where the body is, each followed by rest.

    Args:
        body: an act is one tick of it; as many copies as targets.
        minds: whose they are, the first for the first copies and so on, equally many each.
        targets: (B, 8) relations.
        moved: (B, 8) those that the identified motors move.
        count: K.
        inverses: of each mind; none is Eq. (1) with an even prior and its most probable action.
        heed: called when a try is done, for those who judge.

    Raises:
        ImitationError: no tries, or targets that do not go evenly round.
    """
    if count < 1 or len(targets) != body.copies or body.copies % len(minds):
        raise ImitationError(
            f"{count} tries at {len(targets)} targets by {len(minds)} minds in {body.copies} copies: at least one try, "
            "a target for each copy and equally many copies for each mind are needed"
        )
    for mind in minds:
        mind.check(body)
    inverses = inverses or [BayesianInverse(mind.forward_model, "map", trust=0.0) for mind in minds]
    share = body.copies // len(minds)
    mine = [slice(n * share, (n + 1) * share) for n in range(len(minds))]
    practice = Practice.empty(1, *targets.shape)
    rest = np.repeat(np.stack([mind.rest for mind in minds]), share, axis=0)
    done = []
    for _ in range(count):
        aims = targets + practice.aim[0]
        lines = [chosen(m, aims[s], moved[s], i) for m, s, i in zip(minds, mine, inverses, strict=True)]
        commands = np.concatenate(lines)
        senses = body.act(commands)
        heed()
        felt = np.concatenate([m.landmarks.relations(senses[s]) for m, s in zip(minds, mine, strict=True)])
        done.append((commands, senses, felt))
        practice = practice.after(np.where(moved, targets - felt, 0.0)[None])
        body.act(rest)
    commands, senses, felt = (np.stack(each) for each in zip(*done, strict=True))
    return Tried(commands, senses, felt)
