"""Rounds of play: every kind of thing in turn, many children at once, each round with the skill of those before."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from babbling.axes import IntArray
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
from imitation.acting.primitives import NAMES, possible
from imitation.seeing.acts import described
from models.errors import BodyError, unknown
from models.loading import load_body
from models.objects import TOYS
from models.objects.sight import Hands
from models.objects.states import STATES

CHILDREN = 20
"""Who play side by side."""
LOOKING_COPIES, LOOKING_MINUTES = 64, 12.0
"""Of looking at one's own hands and head while moving them."""
FEATURES = 9 * len(LOOKED_AT) + 6
PLAYED = ("dumbbell", "outsized", "panel", "panel:busy", "box", "loop", "cup")
"""What is played with; `busy`: while one's hands are bound."""
LEARNING = 6.5
"""Rounds after which nothing but one's skill is practised; before, ever fewer new aims are tried."""
KEPT_EVERY = 4
"""Rounds after which what was learned is kept."""
SPECIMENS = 10_000_000
"""Specimens from here on are played with; those that an experiment judges by come before."""


def look_at_hands(
    mind: Mind, seed: int, robot: str = SEATED, *, outline: bool = False, minutes: float | None = None
) -> BodyImage:
    """Where hands and forehead (and elbows and shoulders) are seen in every posture, learned by moving and looking."""
    body = load_body(robot, copies=LOOKING_COPIES, seed=seed)
    rest = body.reset()[:, mind.pilot.schema.posture].mean(0)
    seen = mirror_babble(
        body, Hands(body, seed, outline=outline), mind.pilot.schema, mind.pilot.motors, minutes or LOOKING_MINUTES, seed
    )
    return learn_image(seen, find_organs(seen), mind.pilot.low, mind.pilot.high, rest, seed, mind.fingerprint)


@dataclass(frozen=True)
class Task:
    """Some rounds with things of one kind: what one learns of one kind does not depend on the others."""

    mind: Mind
    image: BodyImage
    eyes: OwnEyes | None
    play: Play
    things: tuple[tuple[int, str], ...]
    """With their numbers."""
    rounds: range
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
    return Play.empty(mind.fingerprint, kinds(things), NAMES, STATES, FEATURES, CHILDREN)


def round_minutes(things: Sequence[str]) -> float:
    """Body-minutes of a round."""
    return len(things) * CHILDREN * TICKS * TICK_S / 60


def rounds_of(minutes: float, things: Sequence[str]) -> int:
    """Rounds that take so many body-minutes, at least."""
    return ceil(minutes / round_minutes(things) - 1e-9)


def played(task: Task) -> Play:
    """What these things taught in these rounds."""
    player, play, taught = Player(task.mind, task.image, sight(task.eyes, task.image)), task.play, task.play.nothing()
    for number in task.rounds:
        for more in [tried_out(player, play, thing, number, task) for thing in task.things]:
            play, taught = play.merged(more), taught.merged(more)
    return taught


def tried_out(player: Player, play: Play, thing: tuple[int, str], number: int, task: Task) -> Play:
    """What one thing taught in one round: every child does something with a specimen of its own."""
    toy, _, hands = thing[1].partition(":")
    hands, rng = hands or HANDS[0], np.random.default_rng([task.seed, number, thing[0], 0x91A7])
    kind = play.kinds.index(TOYS[toy].kind)
    body = at_table(toy, CHILDREN, busy=hands == HANDS[1])
    body.set_out(SPECIMENS + ((task.seed * 1000 + number) * 100 + thing[0]) * CHILDREN)
    which = chosen(play, kind, HANDS.index(hands), possible(TOYS[toy].alone), rng)
    new = rng.random(CHILDREN) < 1 - number / LEARNING
    where = aims(play, kind, which, np.where(new, -1, play.practised(kind)[which]), "matching", rng)
    tried = player.tries(body, which, where, rng)
    return play.nothing().after(
        kind,
        HANDS.index(hands),
        which,
        TOYS[toy].state(tried.seen),
        where,
        described(tried.tracks),
        tried.strain(player.image.rest),
        np.arange(CHILDREN),
        tried.minutes,
    )


def chosen(play: Play, kind: int, hands: int, able: IntArray, rng: np.random.Generator) -> IntArray:
    """(C,) what each child does next: of all that is possible what it has never tried, in any order; later what
    appeals."""
    untried = play.each[:, kind, hands].sum(-1)[:, able] == 0
    order = np.where(untried, rng.random(untried.shape), np.inf)
    liked = rng.choice(len(play.comfort(kind)), len(untried), p=play.appeal(kind))
    return np.where(untried.any(1), able[order.argmin(1)], liked)


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
    """From where a play stands to its last round; `after` is told every `KEPT_EVERY` rounds."""
    alike: dict[str, list[tuple[int, str]]] = {}
    for number, thing in enumerate(things):
        alike.setdefault(TOYS[thing.partition(":")[0]].kind, []).append((number, thing))
    longest_first = sorted(alike.values(), key=len, reverse=True)
    while play.rounds < rounds:
        some = range(play.rounds, min(play.rounds + KEPT_EVERY, rounds))
        tasks = [Task(mind, image, eyes, play, tuple(group), some, seed) for group in longest_first]
        for more in in_parallel(played, tasks, workers, f"round {some[-1] + 1} of {rounds}"):
            play = play.merged(more)
        play = replace(play, rounds=some[-1] + 1)
        after(play)
    return play
