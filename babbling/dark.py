"""Body babbling in the dark: act, hold still, feel; and what is learned of it (chapter, sections 2.1 and 3.1).

A third of all acts moves one motor from rest, a third one motor while the mouth is opened (by the motor that was felt
to part the lips), a third all at once. From these one learns which motor is whose, and

    P(relation p | gap between the lips, command of p's own motor),

eight factors of one forward model: with the mouth shut the tongue is stopped by the lips, which is all that an infant
can find of "tongue-to-lips" and "tongue-beyond-lips". Nothing is ever seen.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Final, NamedTuple

import numpy as np

from babbling.axes import Axis, FloatArray, IntArray
from babbling.body import Body, OfOneBody
from babbling.errors import BabblingError
from babbling.forward_model import ForwardModel
from babbling.kinds import Numbers, kind
from babbling.relations import LIPS, RELATIONS, TOUCHED_N, Landmarks

GRID_GAP, GRID_ACTION, GRID_OUTCOME = 10, 13, 25
PRIOR_STRENGTH: Final = 1.0
MARGIN: Final = 0.03
"""By which axes reach beyond what was felt, as a share of it."""
FEWEST_ACTS: Final = 60
STILL_ACTS: Final = 5
"""Acts of doing nothing, before all others: what rest feels like."""
FLAT: Final = 0.05
"""Share of what a joint can do within which it is at its end."""


class Acts(NamedTuple):
    """N acts of one infant; a third of each kind, in order."""

    commands: FloatArray
    """(N, M) motor lines, held until all was still."""
    senses: FloatArray
    """(N, S) at their ends."""
    nothing: FloatArray
    """(n, S) after acts of doing nothing, before all others."""
    rest: FloatArray
    """(M,) motor lines that leave it at rest."""
    reach: FloatArray
    """(2, M) least and greatest command that still makes a difference."""


@kind("face mind", "`imitate face` leaves such files")
@dataclass(frozen=True)
class FaceMind(OfOneBody):
    """What babbling in the dark leaves."""

    fingerprint: str
    forward_model: Annotated[ForwardModel, Numbers("relation")]
    """Outcomes are relations, contexts the gap between the lips, actions commands of each relation's own motor."""
    motors: Annotated[IntArray, Numbers("relation", low=0, high=1000)]
    """(8,) whose own motor each is."""
    rest: Annotated[FloatArray, Numbers("motor", low=-1, high=1)]
    """(M,) motor lines at rest."""
    still: Annotated[FloatArray, Numbers("relation", low=-10, high=10)]
    """(8,) relations at rest."""
    landmarks: Landmarks

    def __post_init__(self) -> None:
        if len(self.motors) != len(RELATIONS) or self.motors.max(initial=0) >= len(self.rest):
            raise BabblingError(f"motors {self.motors.tolist()} of relations; {len(RELATIONS)} of {len(self.rest)}")


def babble(
    body: Body,
    acts: int,
    rest: FloatArray,
    rngs: Sequence[np.random.Generator],
    heed: Callable[[int], None] = lambda act: None,
) -> list[Acts]:
    """So many acts of every copy, each with randomness of its own.

    Args:
        body: an act is one tick of it.
        acts: a third of each kind.
        rest: (M,) motor lines that leave it at rest.
        rngs: one for each copy.
        heed: told of every act once it is done: for those who judge, and for progress.

    Raises:
        BabblingError: fewer acts than show anything.
    """
    if acts < FEWEST_ACTS:
        raise BabblingError(f"{acts} acts: at least {FEWEST_ACTS} are needed to learn a face from")
    motors, copies, third = len(rest), body.copies, acts // 3
    order = np.stack([rng.permutation(np.resize(np.arange(motors), third)) for rng in rngs], 1)
    level = np.stack([rng.random((acts, motors)) for rng in rngs], 1)
    commands, senses = np.empty((acts, copies, motors)), np.empty((acts, copies, len(body.sense_low)))
    nothing = np.empty((STILL_ACTS, copies, len(body.sense_low)))
    ends = np.stack([np.tile(end, (copies, 1)) for end in (body.motor_low, body.motor_high)])
    everyone = np.arange(copies)
    body.reset()
    for act in range(STILL_ACTS):
        nothing[act] = body.act(np.tile(rest, (copies, 1)))
    for act in range(acts):
        if act in (third, 2 * third):  # first the opener's own reach; then, with the mouth open, that of all others
            last = slice(act - third, act)
            reach = np.stack([_reach(order[:, c], commands[last, c], senses[last, c]) for c in everyone], 1)
        if act == third:
            opener = _opener(order, senses[:third])
            ends[:, everyone, opener] = reach[:, everyone, opener]
        if act == 2 * third:
            reach[:, everyone, opener] = ends[:, everyone, opener]
            ends = reach
        command, chosen = np.tile(rest, (copies, 1)), ends[0] + level[act] * (ends[1] - ends[0])
        if act < 2 * third:
            mover = order[act % third]
            command[everyone, mover] = chosen[everyone, mover]
        if third <= act < 2 * third:
            command[everyone, opener] = chosen[everyone, opener]
        if act >= 2 * third:
            command = chosen
        commands[act], senses[act] = command, body.act(command)
        heed(act)
    return [Acts(commands[:, c], senses[:, c], nothing[:, c], rest, ends[:, c]) for c in everyone]


def learn(acts: Acts, fingerprint: str) -> FaceMind:
    """Own motors, landmarks and the forward model out of one infant's acts."""
    landmarks = Landmarks.felt(np.concatenate([acts.nothing, acts.senses]))
    relations = landmarks.relations(acts.senses)
    motors = _own_motors(acts.commands, relations)
    low, high = relations.min(0), relations.max(0)
    spare = MARGIN * np.maximum(high - low, 1e-3)
    factors, one = len(RELATIONS), np.ones(len(RELATIONS))
    gap = Axis("gap", "W", (low[0] - spare[0]) * one, (high[0] + spare[0]) * one, GRID_GAP)
    action = Axis("command", "1", acts.reach[0, motors], acts.reach[1, motors], GRID_ACTION)
    outcome = Axis("amount", "W", low - spare, high + spare, GRID_OUTCOME)
    model = ForwardModel(
        [gap], action, outcome, factors=RELATIONS, prior_strength=PRIOR_STRENGTH, fingerprint=fingerprint
    )
    commands = np.clip(acts.commands[:, motors], action.low, action.high)  # more makes no difference
    model.observe([gaps(relations[:, 0], factors)], commands, relations)
    still = np.median(landmarks.relations(acts.nothing), 0)
    return FaceMind(fingerprint, model, motors, acts.rest, still, landmarks)


def gaps(gap: FloatArray, factors: int) -> FloatArray:
    """(..., F) the gap as context of every relation but itself, for which it is always none."""
    context = np.repeat(gap[..., None], factors, axis=-1)
    context[..., 0] = 0.0
    return context


def _opener(order: IntArray, senses: FloatArray) -> IntArray:
    """(B,) the motor whose acts most often ended without a touch of the lips."""
    apart = np.logical_not((senses[..., LIPS] > TOUCHED_N).any(-1))
    motors = range(int(order.max()) + 1)
    share = [[apart[mine == motor, copy].mean() for motor in motors] for copy, mine in enumerate(order.T)]
    return np.asarray(np.argmax(share, axis=1))


def _reach(order: IntArray, commands: FloatArray, senses: FloatArray) -> FloatArray:
    """(2, M) commands between which the joint that goes with a motor most closely moves: those beyond leave it where
    its extremes are. Where nothing can be told, all commands there were."""
    found = np.stack([commands.min(0), commands.max(0)])
    for motor in range(found.shape[1]):
        mine = order == motor
        command, joints = commands[mine, motor], senses[mine, : len(RELATIONS)]
        away = joints - joints.mean(0)
        along = (command - command.mean()) @ away / np.maximum(np.linalg.norm(away, axis=0), 1e-12)
        best = int(np.abs(along).argmax())
        felt = joints[:, best] * np.sign(along[best])
        flat = FLAT * np.ptp(felt)
        ends = command[felt < felt.min() + flat].max(), command[felt > felt.max() - flat].min()
        if ends[0] < ends[1]:
            found[:, motor] = ends
    return found


def _own_motors(commands: FloatArray, relations: FloatArray) -> IntArray:
    """(8,) for each relation the motor whose commands go with it most closely (squared correlation, all acts)."""
    c, r = commands - commands.mean(0), relations - relations.mean(0)
    shared = (c.T @ r) ** 2 / ((c**2).sum(0)[:, None] * np.maximum((r**2).sum(0), 1e-12))
    return np.asarray(shared.argmax(0))
