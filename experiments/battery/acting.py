"""Stages three and four: acts on objects that were seen once, and what somebody meant to do."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.play import HANDS
from experiments.battery.films import OFF, Camera, Shot, handling
from experiments.battery.life import UNPLAYED_CONDITIONS, Adult, Grown, Life, unplayed
from experiments.battery.parameters import Parameters
from experiments.battery.table import IMITATOR, WHOLE, Trial, joined
from experiments.intentions.agents import Agent, How, sharpened
from experiments.intentions.options import CONDITIONS
from experiments.intentions.showing import SHOWS, Looks, likeness, looked_at
from experiments.intentions.study import ADULT_ACTS, USUAL, Population, each_answers
from experiments.intentions.trials import done as tried_out
from experiments.objects.deciding import UNSEEN, remembered, respond
from experiments.objects.showing import watched
from experiments.shared.children import Child
from imitation.acting.primitives import NAMES
from imitation.inference.bayes import action_posterior
from models.objects.states import LIT_BY_HEAD

VIEWS = {"live": 0, "a week before": 7, "another room": 0, "television": 0, "nothing": 0, "handled": 0}
"""How a head touch was seen, and how many days before."""
UNPLAYED_VIEWS: tuple[str, ...] = ("live", "nothing")
"""Of those who never played: what play is for."""
MOVERS: tuple[str, ...] = ("person", "poles and pincers")
"""Bodies that show intentions."""
LIT = "lit by head"


def acting(who: Grown, lives: Sequence[Life], adult: Adult, camera: Camera = OFF) -> Iterator[Trial]:
    """All rows of these stages, of lives that began as this one; those who never played among them."""
    for without, one in ((WHOLE, who), ("play", unplayed(who))):
        seen = _looks(one, adult)
        for life in lives:
            yield from _touches(without, replace(one, life=life), adult, camera)
            yield from _intentions(without, replace(one, life=life), adult, *seen, camera)


def _looks(who: Grown, adult: Adult) -> tuple[dict[str, Looks], dict[str, FloatArray]]:
    """How an adult's tries look to it, and how like itself persons and devices are."""
    rng = who.life.rng(7)
    looks = {thing: looked_at(who.child.play, tries, rng) for thing, tries in adult.tries.items()}
    outline = looks["dumbbell"].trials.outline[:ADULT_ACTS]
    return looks, {body: likeness(who.hands, outline, body, rng) for body in MOVERS}


def _touches(without: str, who: Grown, adult: Adult, camera: Camera) -> Iterator[Trial]:
    """A light panel that somebody lit with the forehead (Meltzoff 1988)."""
    life, play, rng = who.life, who.child.play, who.life.rng(6)
    goals, views = list[int](), tuple(VIEWS) if without == WHOLE else UNPLAYED_VIEWS
    for view in views:
        act = adult.touches.get({"another room": "room"}.get(view, view), adult.touches["live"])
        one = act.only(rng.integers(0, len(act.rows), 1))
        how = {"another room": "room", "television": "television"}.get(view, "live")
        [memory] = remembered(play, "panel", watched(one, how, rng))
        gone = view == "nothing" or rng.random() < 1 - (1 - life.how.forgets) ** VIEWS[view]
        goals.append(UNSEEN if gone else int(memory.states[-1]))
    kind, free = play.kinds.index("panel"), HANDS.index("free")
    likely = [
        np.ones(len(NAMES)) if goal == UNSEEN else play.outcomes.predictive[0, kind, free, :, goal] for goal in goals
    ]
    priors = [play.liking[kind, free] if goal == UNSEEN else play.outcomes.habits[0, kind, free] for goal in goals]
    weights = np.stack([chances(*pair, life.how) for pair in zip(likely, priors, strict=True)])
    done = respond(who.child, "panel", np.array(goals), life.how.acts, "matching", rng, first=100 * life.seed,
                   otherwise=weights, keep=camera.on)  # fmt: skip
    live = views.index("live")
    first = NAMES[done.primitives[live, 0]]
    camera.take("touch-2", lambda: handling(f"an agent: {first}", "panel", done.tried[0], live))
    for number, view in enumerate(views):
        first = NAMES[done.primitives[number, 0]]
        lit = float(done.ever(LIT_BY_HEAD)[number])
        yield Trial(
            life.agent, life.seed, without, IMITATOR, 3, "head touch", view, 0, first, LIT, lit,
            options=joined(NAMES), likelihood=joined(likely[number]), prior=joined(priors[number]),
        )  # fmt: skip


def chances(likelihood: FloatArray, prior: FloatArray, how: Parameters) -> FloatArray:
    """(A,) P(choice) by Eq. (1): proportional to (likelihood prior^trust)^exponent; the prior alone where no action is
    known to lead there."""
    habit = sharpened(prior, how.trust)
    posterior = action_posterior(likelihood, habit)
    return sharpened(posterior.probability if posterior.informed else habit, how.exponent)


def _intentions(
    without: str, who: Grown, adult: Adult, looks: dict[str, Looks], bodies: dict[str, FloatArray], camera: Camera
) -> Iterator[Trial]:
    """What was meant, and what is then done (Meltzoff 1995; Gergely et al. 2002; Carpenter et al. 1998)."""
    life, child = who.life, who.child
    how = How(**{name: getattr(life.how, name) for name in vars(How()) if hasattr(life.how, name)})
    task = Population(child, child, 0, who.own, adult.tries, 1, {USUAL: how}, life.seed)
    agent = Agent(child.play, how)
    for condition in CONDITIONS if without == WHOLE else UNPLAYED_CONDITIONS:
        toys = CONDITIONS[condition]
        for toy in (toy for toy in toys if toy in who.own):
            found = each_answers(task, looks, bodies, condition, toy, [agent])
            if found is None:  # no try of the adult's was such a one
                continue
            meant = f"{toy} {SHOWS[toy].target}"
            if (condition, toy) == ("failed", "dumbbell"):
                camera.take("intentions-2", partial(_does, child, toy, found.first[:1], life.seed))
            rows = [(IMITATOR, NAMES[int(found.first[0])], found.ours)]
            if without == WHOLE:
                rows += [("repeats the movement", "", found.mimic), ("wants the end seen", "", found.emulate)]
            for peer, first, came in rows:
                yield Trial(
                    life.agent, life.seed, without, peer, 4, "intention", condition.replace("_", " "),
                    toys.index(toy), first, meant, float(came[0]),
                )  # fmt: skip


def _does(child: Child, toy: str, which: IntArray, number: int) -> Shot:
    """An act of its own, done once more to be filmed."""
    _, tried = tried_out(child, toy, which, np.zeros(1, bool), number, keep=True)
    return handling(f"an agent: {NAMES[int(which[0])]}", toy, tried, 0)
