"""What did they mean to do? Failed attempts, devices, accidents; what is done then (chapter, sections 2.4, 3.5)."""

import time
from dataclasses import asdict, replace
from functools import partial
from math import ceil
from typing import Any

import numpy as np

from babbling.axes import FloatArray
from babbling.files import load, save
from experiments.errors import ExperimentError
from experiments.intentions.agents import GOALS, Agent, Belief, How
from experiments.intentions.figures import figures, study_figures
from experiments.intentions.found import Done, Studied
from experiments.intentions.options import Config
from experiments.intentions.recording import record
from experiments.intentions.showing import (
    HANDLING,
    IN_VAIN,
    NOTHING,
    SHOWS,
    TWO_EFFECTS,
    likeness,
    looked_at,
    presented,
    somebody,
)
from experiments.intentions.study import OBJECTS, USUAL, Population, Tries, part, tried
from experiments.intentions.trials import Trials, done
from experiments.objects.deciding import IMITATORS
from experiments.shared.children import Child, meet
from experiments.shared.experiment import Result
from experiments.shared.growing import kind_of, who
from experiments.shared.parallel import in_parallel
from experiments.shared.playing import Tried, at_table
from experiments.shared.rounds import CHILDREN, look_at_hands
from experiments.shared.tables import table
from imitation.acting.aiming import aims
from imitation.acting.primitives import NAMES
from imitation.deferred import IntentMemory
from imitation.inference.meaning import Meant
from models.objects import TOYS
from models.objects.states import STATES

SHOWN_TRIES = 12
"""That the adult makes, of which those are shown that are asked for."""
FILM_SEEDS = range(5)
SENSITIVITY: dict[str, dict[str, Any]] = {
    "1 act": {"acts": 1},
    "2 acts": {"acts": 2},
    "5 acts": {"acts": 5},
    "shown once": {"shown": 1},
    "never gives up": {"gives_up": 0.0},
    "gives up half the time": {"gives_up": 0.5},
    "never goes on": {"goes_on": 0.0},
    "goes on one time in five": {"goes_on": 0.2},
    "things repeat exactly": {"repeats": 1.0},
    "things do anything": {"repeats": 0.0},
    "everything is somebody": {"all_somebody": True},
    "own play weighs 1": {"own_weight": 1.0},
    "own play weighs .01": {"own_weight": 0.01},
    "most probable": {"selection": "map"},
    "other read as itself": {"as_itself": True},
    "prior of .1": {"prior_strength": 0.1},
    "prior of 2": {"prior_strength": 2.0},
    "all goals alike": {"even_goals": True},
}
"""Rows of the table of sensitivity: what is otherwise."""


def run(config: Config) -> Result:
    """Watch, infer, act; or the study."""
    config.check()
    wants = wanted(config)
    if config.study:
        return study(config)
    kept = None if config.memory is None else load(config.memory, IntentMemory)
    if config.play is None and (config.child or 0) >= CHILDREN:
        raise ExperimentError(f"--child {config.child}: {CHILDREN} children will play, counted from 0")
    child = who(config.play, config.seed, config.workers)
    if config.child is not None and config.child >= len(child.play.each):
        raise ExperimentError(f"--child {config.child}: {len(child.play.each)} children played, counted from 0")
    found = one(config, child, wants, kept)
    rows = [
        ("what was shown", f"{config.condition}, the {config.toy}"),
        *(
            (f"presentation {n}", f"taken for {shown['taken_for']!r}: {shown['state']}" + again(shown["again"]))
            for n, shown in enumerate(found.metrics["shown"], 1)
        ),
        ("somebody", f"P = {found.belief.somebody:.3f}"),
        ("meant, it seems", f"{found.metrics['goal_inferred'] or '-'} (P = {found.belief.goal.max():.2f})"),
        *((f"act {n}", f"for {goal!r}: {act}: {state}") for n, (goal, act, state) in enumerate(found.acts, 1)),
    ]
    summary = f"# What was meant\n\n{table(rows)}"
    memory = IntentMemory(child.play.fingerprint, TOYS[config.toy].kind, *found.belief)
    files = {"memory.nc": partial(save, memory)}
    return Result(found.metrics, summary, figures(found), lambda path: record(path, found, summary), files)


def again(more: bool) -> str:
    """For people."""
    return ", and taken up again" if more else ", and left"


def one(config: Config, group: Child, wants: FloatArray | None, kept: IntentMemory | None) -> Done:
    """One child watches an adult with the skill of its playmates, and acts in physics."""
    number = 0 if config.child is None else config.child
    child = group if config.child is None else replace(group, play=group.play.alone(number))
    rng = np.random.default_rng([config.seed, number, 0x1D])
    how = how_of(config)
    agent, toy = Agent(child.play, how), config.toy
    kind, other = kind_of(group, toy), SHOWS[toy].other or toy
    adult, looks = None, {}
    condition = config.condition if config.memory is None else NOTHING[0]
    if not condition.endswith(NOTHING):
        busy = config.condition == "head_bound"
        adult = shown_by(group, config, busy)
        looks = {f"{toy}:busy" if busy else toy: looked_at(group.play, adult[0], rng)}
    shown = presented(condition, toy, looks, config.shown, rng, how.as_itself)
    if shown is None:
        raise ExperimentError(
            f"--condition {config.condition}: none of {SHOWN_TRIES} tries with the {toy} was such a one; "
            "choose another --seed, or a longer play"
        )
    likely = 0.0
    if kept is not None:
        kept.check(child.play.fingerprint, TOYS[toy].kind, len(GOALS), len(STATES))
        likely = kept.somebody
    if adult is not None:
        image = look_at_hands(group.mind, config.seed, group.robot, outline=True)
        likely = somebody(likeness(image, adult[0].outline[shown.rows], shown.body, rng), shown.contact)
    prior = agent.wants(kind) if wants is None else wants
    belief, believed = agent.believes(
        shown.seen, kind, child.play.kinds.index(TOYS[other].kind), shown.hands, likely, prior
    )
    if kept is not None:
        belief = Belief(kept.goal / kept.goal.sum(), kept.somebody, kept.effects)
        believed = Meant(belief.goal[None], np.array([kept.somebody]))
    tries = list[Tried]()

    def world(act: int, goal: int) -> int:
        body = at_table(toy, 1)
        body.set_out(IMITATORS + 1000 * config.seed + 100 * number + len(tries))
        which, play = np.array([act]), child.play
        aimed = np.array([goal]) if goal < len(STATES) else play.practised(kind)[which]
        tries.append(child.player.tries(body, which, aims(play, kind, which, aimed, "mean", rng), rng, keep=True))
        return int(TOYS[toy].state(tries[-1].true)[0])

    did = agent.responds(belief, kind, world, rng, prior)
    return Done(config, child, shown, adult, believed, belief, did, tries)


def how_of(config: Config) -> How:
    """What is not learned."""
    chosen = {name: getattr(config, name) for name in ("acts", "shown", "gives_up", "own_weight", "selection")}
    return How(**chosen, as_itself=config.reads == "itself")


def wanted(config: Config) -> FloatArray | None:
    """(G,) P(g) as it was told; None: that of one's own play.

    Raises:
        ExperimentError: what is no goal, no number, or sums to nothing.
    """
    if not config.wants:
        return None
    weights = np.zeros(len(GOALS))
    for told in config.wants:
        name, _, weight = told.partition("=")
        try:
            weights[GOALS.index(name)] = float(weight)
        except ValueError:
            raise ExperimentError(
                f"--wants {told!r}: it must be STATE=WEIGHT, a state being one of {', '.join(GOALS)}"
            ) from None
    if not (np.isfinite(weights).all() and weights.min() >= 0 and weights.sum() > 0):
        raise ExperimentError(f"--wants {' '.join(config.wants)}: weights must be 0 or more and sum to something")
    return np.asarray(weights / weights.sum())


def shown_by(group: Child, config: Config, busy: bool) -> tuple[Trials, Tried]:
    """An adult's tries: skilled, or carelessly where something is to fail."""
    toy, acts = config.toy, [SHOWS[config.toy].act]
    if config.condition == "manipulation":
        acts = list(HANDLING)
    if config.condition in ("intended", "accidental"):
        acts = [acts[0], TWO_EFFECTS[toy][0]]
    which = np.resize([NAMES.index(name) for name in acts], SHOWN_TRIES)
    fails = config.condition in IN_VAIN
    return done(group, toy, which, np.full(SHOWN_TRIES, fails), 1000 * config.seed, busy=busy, keep=True)


def study(config: Config) -> Result:
    """Every condition."""
    began = time.perf_counter()
    children = [meet(path) for path in config.plays or ([] if config.play is None else [config.play])]
    each = ceil(config.agents / max(len(children), 1))
    fewest = min((len(child.play.each) for child in children), default=CHILDREN)
    if each > fewest:
        raise ExperimentError(
            f"--agents {config.agents}: {each} of every play, but {fewest} children played; name more --plays"
        )
    children = children or [who(None, config.seed, config.workers)]
    tasks = [Tries(child, number, thing) for thing in OBJECTS for number, child in enumerate(children)]
    pools: list[dict[str, Trials]] = [{} for _ in children]
    for task, trials in zip(tasks, in_parallel(tried, tasks, config.workers, "tries in physics"), strict=True):
        pools[task.number][task.thing] = trials
    usual = how_of(config)
    hows = {USUAL: usual}
    if config.sensitivity:
        hows |= {name: replace(usual, **change) for name, change in SENSITIVITY.items()}
    populations = [
        Population(child, children[(n + 1) % len(children)], n, pools[n], pools[(n + 1) % len(children)], each, hows,
                   config.seed)
        for n, child in enumerate(children)
    ]  # fmt: skip
    parts: list[Population | range] = [*populations, FILM_SEEDS]
    *answers, seen = in_parallel(part, parts, config.workers, "watching and acting")
    found = Studied([child.play for child in children], answers, list(hows), seen, time.perf_counter() - began)
    metrics = found.metrics | {"how": asdict(usual)}
    return Result(metrics, "# Intentions\n\n" + table(told(metrics)), study_figures(found, metrics))


def told(metrics: dict[str, Any]) -> list[tuple[str, str]]:
    """For people."""
    rates, peers = metrics["rates"], (metrics["rates_mimicry"], metrics["rates_emulation"])
    rows = [("target comes about", "ours (95 %); on the first act; mimicry; emulation")]
    for name, share in rates.items():
        low, high = metrics["rates_interval"][name]
        first, (mimic, emulate) = metrics["rates_first_act"][name], (peer[name] for peer in peers)
        rows.append((name, f"{share:.0%} ({low:.0%} to {high:.0%}); {first:.0%}; {mimic:.0%}; {emulate:.0%}"))
    low, high = metrics["outsized_other_means_interval"]
    by_share = metrics["goal_accuracy_by_share"]
    return [
        *rows,
        ("failed - baseline", f"{100 * (rates['failed'] - rates['baseline']):.0f} points"),
        ("device failed - baseline", f"{100 * (rates['device_failed'] - rates['baseline']):.0f} points"),
        (
            "head touch on the first act, hands free - bound",
            f"{100 * (metrics['rates_first_act']['head_free'] - metrics['rates_first_act']['head_bound']):.0f} points",
        ),
        (
            "large dumbbell: begins by other means than the adult",
            f"{metrics['outsized_other_means'] or 0:.0%} ({low:.0%} to {high:.0%})",
        ),
        ("P(goal): calibration error", f"{metrics['goal_calibration_error']:.3f}"),
        *((f"goal by {rule}", f"{share:.0%}") for rule, share in metrics["goal_accuracy"].items()),
        (
            "goal by share of the movement",
            ", ".join(f"{share}: {rules['Eq. (2)']:.0%}" for share, rules in by_share.items()),
        ),
        *((f"P(somebody): {body}", f"{likely:.3f}") for body, likely in metrics["agent_posterior"].items()),
    ]
