"""Every figure of acts on objects, over agents and independent plays: what `--study` measures, task by task."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.forward_model import ForwardModel
from babbling.play import Play
from experiments.objects.deciding import UNSEEN, decide, remembered, respond
from experiments.objects.showing import ROOM_TABLE_M, demonstrated, performed, watched
from experiments.objects.week import a_week_later
from experiments.shared.children import Child, born
from experiments.shared.playing import at_table
from experiments.shared.rounds import PLAYED, empty, play_on
from imitation.acting.aiming import aims
from imitation.acting.primitives import NAMES, possible
from imitation.deferred import ActMemory
from imitation.inference.bayes import action_posterior
from imitation.seeing.acts import likelihood
from models.objects import TOYS
from models.objects.states import LIT_BY_HAND, LIT_BY_HEAD, STATES

SUCCESS = (
    ("lift", "cup", "lift", "up"),
    ("press", "panel", "press", "lit by hand"),
    ("head", "panel", "press with the head", "lit by head"),
    ("spread narrow", "dumbbell", "spread", "apart"),
    ("bead", "cup", "carry", "joined"),
    ("loop", "loop", "carry", "joined"),
    ("stick", "box", "", "buzz"),
)
"""Name, object, primitive (none: the one that Eq. (1) finds likeliest) and the state it should bring about."""
PLACEMENTS = 40
"""For each play."""
CELL, TEST = 8, 6
"""Tries of every primitive with every kind that tables are made of, and that judge them."""
ANYTHING = -1
"""Goal of one who aims for nothing."""
NEW = {"wide-dumbbell": "apart", "square": "joined"}
"""Objects never played with, whose kinds were; and what is to be brought about."""
OWN_ROUNDS = 4
"""Rounds of play with those two, for comparison."""
PEER_MINUTES = 3.0
HEADS = (
    "live", "week", "room", "television", "peer", "pixels", "television by pixels", "none", "handled",
    "mimic", "emulate",
)  # fmt: skip
"""Conditions; the last two are peers, who do the movement that was seen, or bring the light about."""
ACTS, FILMED = 16, 8
"""Different acts that a teacher does, and that are filmed: agents share them, each sees one with noise of its own."""
SHOWN = 3
"""Times that somebody does every primitive with every kind, to be recognised."""
JUDGED = 7_000_000
"""Specimens from here on judge."""


@dataclass(frozen=True)
class Task:
    """One part of the study of one play."""

    part: str
    child: Child
    teacher: Child
    """Who shows it: another, where there are several."""
    number: int
    """Of the play."""
    agents: int
    acts: int
    selection: str
    seed: int


def measured(task: Task) -> dict[str, Any]:
    """What one part finds."""
    parts = {"success": success, "apart": apart, "tables": tables, "watching": watching, "new": new}
    return (parts | dict.fromkeys(HEADS, head))[task.part](task)


def specimens(task: Task, part: int) -> int:
    """First specimen of a part of the study, of its own for every play."""
    return JUDGED + 100_000 * task.number + 10_000 * part


def success(task: Task) -> dict[str, Any]:
    """How often primitives bring about what they are practised for, with specimens never met; and the peer who learned
    no aims and does them in the middle of where they may be done."""
    found, unaimed = {}, {}
    for number, (name, toy, act, state) in enumerate(SUCCESS):
        play, goal = task.child.play, STATES.index(state)
        kind = play.kinds.index(TOYS[toy].kind)
        goals = np.full(PLACEMENTS, goal)
        if act:
            which = np.full(PLACEMENTS, NAMES.index(act))
        else:
            which = decide(play, kind, 0, goals, "map")[0].probability.argmax(1)
        found[name] = did(task, toy, which, goals, specimens(task, number)) == goal
        unaimed[name] = did(task, toy, which, np.full(PLACEMENTS, ANYTHING), specimens(task, number)) == goal
    return {"success": found, "unaimed": unaimed}


def did(task: Task, toy: str, which: IntArray, goals: IntArray, first: int, play: Play | None = None) -> IntArray:
    """(N,) what became of specimens `first` and following: primitives aimed at goals as play taught, or at nothing."""
    play = play or task.child.play
    kind = play.kinds.index(TOYS[toy].kind)
    body = at_table(toy, len(which))
    body.set_out(first)
    rng = np.random.default_rng([task.seed, task.number, first])
    tried = task.child.player.tries(body, which, aims(play, kind, which, goals, "mean", rng), rng)
    return TOYS[toy].state(tried.true)


def apart(task: Task) -> dict[str, Any]:
    """Grip against dry friction: how far ends creep at 90 % of it, and when pulling parts them."""
    body = at_table("dumbbell", 32)
    body.set_out(specimens(task, 8))
    body.tug(0.9 * body.stiction)
    still = body.command_angles(np.clip(body.joint_angles, *body.joint_range.T))
    for _ in range(round(1 / body.tick_s)):
        body.act(still)
    creep = float(1e3 * np.abs(body.apart).max())
    count = 2 * PLACEMENTS
    body = at_table("dumbbell", count)
    body.set_out(specimens(task, 9))
    rng = np.random.default_rng([task.seed, task.number, 9])
    play, which = task.child.play, np.full(count, NAMES.index("pull"))
    goals = np.full(count, STATES.index("apart"))
    where = aims(play, play.kinds.index("dumbbell"), which, goals, "mean", rng)
    where[:, 4] = rng.uniform(0.1, 1, count)
    tried = task.child.player.tries(body, which, where, rng)
    ratio = where[:, 4] * body.grip_n / body.stiction
    parted = TOYS["dumbbell"].state(tried.true) == STATES.index("apart")
    return {"creep_mm_per_s": creep, "below": parted[ratio < 1], "above": parted[ratio > 1.5]}


def tables(task: Task) -> dict[str, Any]:
    """Tables of `CELL` tries a cell against tries that were held out."""
    play = task.child.play
    model = ForwardModel(
        play.outcomes.contexts, play.outcomes.action, play.outcomes.outcome, prior_strength=play.outcomes.prior_strength
    )
    held: list[tuple[IntArray, ...]] = []
    for number, thing in enumerate(PLAYED):
        toy, _, hands = thing.partition(":")
        kind, able = play.kinds.index(TOYS[toy].kind), possible(TOYS[toy].alone)
        which = np.tile(able, CELL + TEST)
        count = len(which)
        body = at_table(toy, count, busy=bool(hands))
        body.set_out(specimens(task, 10 + number))
        rng = np.random.default_rng([task.seed, task.number, 10 + number])
        where = aims(play, kind, which, play.practised(kind)[which], "mean", rng)
        tried = task.child.player.tries(body, which, where, rng)
        came = TOYS[toy].state(tried.seen)
        cell = np.stack([np.full(count, kind), np.full(count, int(bool(hands))), which, came])
        taught = np.arange(count) < len(able) * CELL
        rows = [values[taught, None] for values in cell]
        model.observe(rows[:2], rows[2], rows[3])
        held.append(tuple(cell[:, ~taught]))
    kinds, hand, acts, came = np.concatenate(held, 1)
    usual = model.counts[0].sum(2) + 1 / len(STATES)
    return {
        "table": scored(model.predictive[0, kinds, hand, acts], came),
        "kind_alone": scored((usual / usual.sum(-1, keepdims=True))[kinds, hand], came),
        "of_play": scored(play.outcomes.predictive[0, kinds, hand, acts], came),
    }


def watching(task: Task) -> dict[str, Any]:
    """Recognising what somebody else does with every kind of thing, seen across the table: points, and two retinas; and
    the peer to whom every place counts by itself."""
    right, play = dict[str, list[BoolArray]](), task.child.play
    for number, toy in enumerate(thing for thing in PLAYED if ":" not in thing):
        kind, rng = play.kinds.index(TOYS[toy].kind), np.random.default_rng([task.seed, task.number, 50 + number])
        able = possible(TOYS[toy].alone)
        which = np.tile(able, SHOWN)
        act = performed(task.teacher, toy, which, specimens(task, 50 + number))
        once = act.only(np.arange(len(able)))
        for by, seen in (("points", watched(act, "live", rng)), ("pixels", watched(once, "live", rng, "pixels"))):
            for name, alone in ((by, False), (f"{by}_alone", True)):
                taken = likelihood(play, kind, seen.tracks, seen.noise, alone=alone).argmax(1)
                right.setdefault(name, []).append(taken == which[: len(taken)])
    return {"recognised": {name: np.concatenate(each) for name, each in right.items()}}


def scored(probability: FloatArray, came: IntArray) -> tuple[FloatArray, BoolArray, float]:
    """Of (N, O) beliefs: (N,) confidence in the likeliest, whether it came, and log2 likelihood, bits."""
    bits = np.log2(np.maximum(probability[np.arange(len(came)), came], 1e-3)).mean()
    return probability.max(1), probability.argmax(1) == came, float(bits)


def new(task: Task) -> dict[str, Any]:
    """Objects never met, of known kinds: the first try by Eq. (1), and tries after playing with them."""
    child, things = task.child, tuple(NEW)
    own = play_on(child.mind, child.image, empty(child.mind, things), things, OWN_ROUNDS, 77 + task.number, 1)
    found = {}
    for number, (toy, state) in enumerate(NEW.items()):
        goals = np.full(PLACEMENTS, STATES.index(state))
        came = []
        for play in (child.play, own):
            kind = play.kinds.index(TOYS[toy].kind)
            which = decide(play, kind, 0, goals, "map")[0].probability.argmax(1)
            came.append(did(task, toy, which, goals, specimens(task, 20 + number), play) == goals)
        found[toy] = {"first": came[0], "own": came[1]}
    return {"new": found}


def head(task: Task) -> dict[str, Any]:
    """(N,) whether agents touch the panel with the forehead, after seeing it done in one way or another; and peers."""
    child, count, condition = task.child, task.agents, task.part
    play, rng = child.play, np.random.default_rng([task.seed, task.number, HEADS.index(condition)])
    first, goals, otherwise = specimens(task, 30 + HEADS.index(condition)) - JUDGED, np.full(count, UNSEEN), None
    if condition != "none":
        memories = remembered_head(task, rng)
        goals = np.array([memory.states[-1] for memory in memories])
        if condition == "week":
            response = a_week_later(child, memories, "panel", task.acts, task.selection, task.seed, first)
            return {"head": (condition, response.ever(LIT_BY_HEAD))}
        if condition == "mimic":  # does what was seen
            otherwise = np.stack([memory.primitive for memory in memories])
        if condition == "emulate":  # brings about what was seen, the light, by whatever means
            kind, goals = play.kinds.index(TOYS["panel"].kind), np.full(count, LIT_BY_HAND)
            lights = play.outcomes.predictive[0, kind, 0][:, [LIT_BY_HAND, LIT_BY_HEAD]].sum(1)
            one = action_posterior(lights, play.outcomes.habits[0, kind, 0]).probability
            otherwise = np.tile(one, (count, 1))
    response = respond(child, "panel", goals, task.acts, task.selection, rng, first=first, otherwise=otherwise)
    return {"head": (condition, response.ever(LIT_BY_HEAD))}


def remembered_head(task: Task, rng: np.random.Generator) -> list[ActMemory]:
    """What agents keep of an adult's or a peer's head touch, or of one who only handles the panel."""
    condition, seed = task.part, 1000 + 10 * task.number + task.seed
    view = next((one for one in ("room", "television") if condition.startswith(one)), "live")
    seeing = "pixels" if "pixels" in condition else "points"
    act = "lift with both" if condition == "handled" else "press with the head"
    teacher = peer(seed, task.child) if condition == "peer" else task.teacher
    state, table = None if condition == "handled" else "lit by head", ROOM_TABLE_M if condition == "room" else None
    count = ACTS if seeing == "points" else FILMED
    shown = demonstrated(teacher, "panel", act, state, count, seed, table=table, keep=seeing == "pixels")
    if seeing == "points":
        shown = shown.only(np.resize(np.arange(count), task.agents))
    memories = remembered(task.child.play, "panel", watched(shown, view, rng, seeing))
    return [memories[n % len(memories)] for n in range(task.agents)]


def peer(seed: int, like: Child) -> Child:
    """A smaller child with a mind and an image of its own, who has not played."""
    robot = "hoap2-seated-small"
    mind, image = born(seed, lambda share: None, None, robot, PEER_MINUTES)
    play = Play.empty(mind.fingerprint, like.play.kinds, NAMES, STATES, like.play.moved.shape[-1])
    return Child(mind, image, play, robot=robot)
