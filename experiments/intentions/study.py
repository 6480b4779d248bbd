"""Every condition, over many imitators of several plays, each with an experience of its own; beside two peers."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.play import HANDS
from experiments.intentions import films
from experiments.intentions.agents import Agent, Did, How, emulation
from experiments.intentions.inferring import inferred
from experiments.intentions.options import CONDITIONS
from experiments.intentions.showing import BODIES, SHOWS, Looks, likeness, looked_at, presented
from experiments.intentions.showing import somebody as by_looks
from experiments.intentions.trials import Trials, trials
from experiments.shared.children import Child
from experiments.shared.rounds import look_at_hands
from models.objects import TOYS
from models.objects.states import SAME

EACH, MEANS, CARELESS = 1, 4, 8
"""Tries of every primitive with every object, for each play; more of those that Eq. (1) would choose for what is shown;
and of the act that is shown, aimed anywhere: what fails, fails in physics."""
ADULT_ACTS, OUTLINE_MINUTES = 2, 6.0
"""Tries by which it is judged who is somebody; body time of watching one's own elbows and shoulders before that."""
USUAL = "as they are"
"""The way of being an imitator that counts; others show what depends on what."""
OBJECTS = (*dict.fromkeys(toy for toys in CONDITIONS.values() for toy in toys), "panel:busy")


@dataclass(frozen=True)
class Tries:
    """Physics: what one child does with one object."""

    child: Child
    number: int
    thing: str


def tried(task: Tries) -> Trials:
    """See `trials`."""
    toy, _, hands = task.thing.partition(":")
    first = 100_000 * task.number + 1000 * OBJECTS.index(task.thing)
    how = {"each": EACH, "means": MEANS, "careless": CARELESS}
    return trials(task.child, toy, SHOWS[toy].act, SHOWS[toy].target, first, busy=bool(hands), **how)


@dataclass(frozen=True)
class Population:
    """One play's children, who watch the tries of another play's."""

    child: Child
    adult: Child
    number: int
    own: dict[str, Trials]
    """By object: what becomes of what they do."""
    adults: dict[str, Trials]
    agents: int
    hows: dict[str, How]
    """What of an imitator is not learned, by name; see `USUAL`."""
    seed: int


@dataclass
class Answers:
    """N imitators in one condition with one object."""

    ours: BoolArray
    """(N,) whether the target came about."""
    first: IntArray
    """(N,) the first act of ours."""
    at_once: BoolArray
    """(N,) whether the first act brought it about."""
    mimic: BoolArray
    emulate: BoolArray


def answered(task: Population) -> dict[str, Any]:
    """What all of them do, for every way of being an imitator; and who is somebody, by body."""
    rng = np.random.default_rng([task.seed, task.number, 0x12])
    looks = {thing: looked_at(task.child.play, one, rng) for thing, one in task.adults.items()}
    image = look_at_hands(task.child.mind, task.seed, task.child.robot, outline=True, minutes=OUTLINE_MINUTES)
    seen = looks["dumbbell"].trials.outline[:ADULT_ACTS]
    bodies = {body: likeness(image, seen, body, rng) for body in BODIES}
    goals = inferred(task.child, task.adult, task.adults, task.seed + 10 * task.number)
    found: dict[str, Any] = {"bodies": bodies, "inferred": goals}
    children = [task.child.play.alone(n) for n in range(task.agents)]
    for name, how in task.hows.items():
        agents = [Agent(play, how) for play in children]
        conditions = {
            (condition, toy): each_answers(task, looks, bodies, condition, toy, agents)
            for condition, toys in CONDITIONS.items()
            for toy in toys
        }
        found[name] = {key: one for key, one in conditions.items() if one is not None}
    return found


def part(task: "Population | range") -> dict[str, Any]:
    """A population, or the films that observers of these seeds see."""
    return answered(task) if isinstance(task, Population) else films.films(task)


def each_answers(
    task: Population,
    looks: dict[str, Looks],
    bodies: dict[str, FloatArray],
    condition: str,
    toy: str,
    agents: Sequence[Agent],
) -> Answers | None:
    """What every child of one play does in one condition."""
    play, kind = task.child.play, task.child.play.kinds.index(TOYS[toy].kind)
    other = kind if SHOWS[toy].other is None else play.kinds.index(TOYS[SHOWS[toy].other or ""].kind)
    rows = list[tuple[bool, int, bool, bool, bool]]()
    for n, agent in enumerate(agents):
        rng = np.random.default_rng([task.seed, task.number, n, *condition.encode(), *toy.encode()])
        shown = presented(condition, toy, looks, agent.how.shown, rng, agent.how.as_itself)
        if shown is None:
            return None
        world = world_of(task.own[toy], rng)
        belief = agent.nothing_seen
        if shown.seen:
            likely = by_looks(bodies[shown.body], shown.contact)
            belief, _ = agent.believes(shown.seen, kind, other, shown.hands, likely)
        ours = agent.responds(belief, kind, world, rng)
        moved = (
            np.mean([one.movement for one in shown.seen], 0)
            if shown.seen
            else agent.play.liking[kind, HANDS.index("free")]
        )
        ends = emulation(shown.seen) or agent.nothing_seen
        peers = (agent.mimics(moved, world, rng), agent.responds(ends, kind, world, rng))
        mimic, emulate = (ever(peer, shown.target) for peer in peers)
        at_once = bool(ours.states[0] == shown.target)
        rows.append((ever(ours, shown.target), int(ours.primitives[0]), at_once, mimic, emulate))
    return Answers(*(np.array(column) for column in zip(*rows, strict=True)))


def ever(did: Did, state: int) -> bool:
    """Whether a state came about."""
    return bool((did.states == state).any())


def world_of(own: Trials, rng: np.random.Generator) -> Callable[[int, int], int]:
    """What becomes of the object: one of the tries of this play that nobody learned from; what cannot be done with it
    leaves it as it is."""

    def world(act: int, goal: int) -> int:
        rows = np.flatnonzero((own.which == act) & ~own.careless)
        return int(own.states[rng.choice(rows)]) if len(rows) else SAME

    return world
