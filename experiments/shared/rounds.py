"""Rounds of play: every kind of thing in turn, many children at once, each round with the skill of those before."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from babbling.body_image import BodyImage, learn_image
from babbling.mind import Mind
from babbling.mirroring import mirror_babble
from babbling.organs import find_organs
from babbling.own_eyes import OwnEyes
from babbling.play import HANDS, Play
from experiments.shared.parallel import in_parallel
from experiments.shared.pixels import sight
from experiments.shared.playing import LOOKED_AT, SEATED, TICK_S, TICKS, Player, at_table
from imitation.acting.aiming import aims
from imitation.acting.primitives import NAMES
from imitation.seeing.acts import described
from models.errors import BodyError, unknown
from models.loading import load_body
from models.objects import TOYS
from models.objects.sight import Hands
from models.objects.states import STATES

COPIES = 32
"""Children that play at once."""
LOOKING_COPIES, LOOKING_MINUTES = 64, 12.0
"""Of looking at one's own hands and head while moving them."""
FEATURES = 9 * len(LOOKED_AT) + 6
PLAYED = ("dumbbell", "outsized", "panel", "panel:busy", "box", "loop", "cup")
"""What is played with; `busy`: while one's hands are bound."""
LEARNING = 0.5
"""Share of the rounds after which nothing but one's skill is practised; before, ever less is tried out."""
ENOUGH = 3
"""Times that everything is tried with every kind before one does what is comfortable."""
SPECIMENS = 1_000_000
"""Specimens from here on are played with; those that an experiment judges by come before."""


def look_at_hands(mind: Mind, seed: int, robot: str = SEATED) -> BodyImage:
    """Where hands and forehead are seen in every posture, learned by moving and looking."""
    body = load_body(robot, copies=LOOKING_COPIES, seed=seed)
    rest = body.reset()[:, mind.pilot.schema.posture].mean(0)
    seen = mirror_babble(body, Hands(body, seed), mind.pilot.schema, mind.pilot.motors, LOOKING_MINUTES, seed)
    return learn_image(seen, find_organs(seen), mind.pilot.low, mind.pilot.high, rest, seed, mind.fingerprint)


@dataclass(frozen=True)
class Task:
    """One kind of thing in one round."""

    mind: Mind
    image: BodyImage
    eyes: OwnEyes | None
    play: Play
    thing: str
    number: int
    round: int
    rounds: int
    seed: int


def usable(things: Sequence[str]) -> tuple[str, ...]:
    """Things as they are named, `toy` or `toy:busy`.

    Raises:
        BodyError: no such object, or hands in another state.
    """
    for thing in things:
        toy, _, hands = thing.partition(":")
        if toy not in TOYS:
            raise BodyError(unknown("object", toy, TOYS))
        if hands and hands not in HANDS:
            raise BodyError(unknown("state of hands", hands, HANDS))
    return tuple(things)


def kinds(things: Sequence[str]) -> tuple[str, ...]:
    """What these are taken for, each once."""
    return tuple(dict.fromkeys(TOYS[thing.partition(":")[0]].kind for thing in things))


def empty(mind: Mind, things: Sequence[str] = PLAYED) -> Play:
    """Before play."""
    return Play.empty(mind.fingerprint, kinds(things), NAMES, STATES, FEATURES)


def round_minutes(things: Sequence[str]) -> float:
    """Body-minutes of a round."""
    return len(things) * COPIES * TICKS * TICK_S / 60


def rounds_of(minutes: float, things: Sequence[str]) -> int:
    """Rounds that take so many body-minutes, at least."""
    return ceil(minutes / round_minutes(things) - 1e-9)


def played(task: Task) -> Play:
    """What one kind of thing taught in one round."""
    toy, _, hands = task.thing.partition(":")
    hands = hands or HANDS[0]
    play, rng = task.play, np.random.default_rng([task.seed, task.round, task.number, 0x91A7])
    kind, states = play.kinds.index(TOYS[toy].kind), play.practised(play.kinds.index(TOYS[toy].kind))
    body = at_table(toy, COPIES, busy=hands == HANDS[1])
    body.set_out(SPECIMENS + 10_000 * task.seed + (task.round * 100 + task.number) * COPIES)
    which = rng.choice(len(NAMES), COPIES, p=play.comfort(kind))
    todo = np.repeat(np.arange(len(NAMES)), np.maximum(ENOUGH - play.tried[kind], 0))
    which[: len(todo)] = rng.permutation(todo)[:COPIES]
    new = rng.random(COPIES) < 1 - task.round / (LEARNING * task.rounds)
    where = aims(play, kind, which, np.where(new, -1, states[which]), "matching", rng)
    tried = Player(task.mind, task.image, sight(task.eyes, task.image)).tries(body, which, where, rng)
    return play.nothing().after(
        kind,
        HANDS.index(hands),
        which,
        TOYS[toy].state(tried.seen),
        where,
        described(tried.tracks),
        tried.strain(task.image.rest),
        tried.minutes,
    )


def play_on(
    mind: Mind,
    image: BodyImage,
    play: Play,
    things: Sequence[str],
    rounds: int,
    seed: int,
    workers: int,
    eyes: OwnEyes | None = None,
    after: Callable[[Play], None] = lambda play: None,
) -> Play:
    """From where a play stands to its last round; `after` is told of every round."""
    for number in range(play.rounds, rounds):
        tasks = [Task(mind, image, eyes, play, thing, i, number, rounds, seed) for i, thing in enumerate(things)]
        for more in in_parallel(played, tasks, workers, f"round {number + 1} of {rounds}"):
            play = play.merged(more)
        play = replace(play, rounds=number + 1)
        after(play)
    return play
