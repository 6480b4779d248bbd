"""Whose goal is it, judged early: Eq. (2) and its filter over many unseen walks, against rules of thumb."""

from collections import defaultdict
from typing import Any

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from experiments.maze.mind import Experience, half_for_the_first, infer, junctions, step_likelihood, watched
from experiments.shared.judging import intervals_95
from experiments.shared.progress import Report
from imitation.acting.follow import believed
from models.maze import Maze, MazeBody, demonstrate

SHARES = np.arange(1, 11) / 10
"""Of a walk that was seen when its goal is judged; at 1 the walker stands on it."""


def rules_of_thumb(maze: Maze, states: IntArray) -> dict[str, FloatArray]:
    """(T + 1, G) scores of each goal after each step of a walk; the greatest is the guess.

    The nearest goal; and the straightest path, the goal whose distance has fallen most since the start (the least
    detour, Masters and Sardina 2017). Distances are as the crow flies, or along the ways: then the rule is told every
    wall.
    """
    places, goals = np.array([maze.place(cell) for cell in states]), np.array(maze.goals)
    flown = np.hypot(*(places[:, None] - goals).transpose(2, 0, 1))
    ways = np.array([maze.distances(goal)[states] for goal in maze.goals]).T
    return {
        f"{rule}, {told}": sign * (distance - from_where)
        for told, distance in (("as the crow flies", flown), ("told the walls", ways))
        for rule, sign, from_where in (("nearest goal", -1.0, 0.0), ("straightest path", -1.0, distance[0]))
    }


def intents(observers: Experience, seed: int, smoothing: float, report: Report) -> dict[str, Any]:
    """Each observer judges one unseen walk to each goal; the goal prior is uniform, as the walks are balanced."""
    maze, goals, copies = observers.maze, len(observers.maze.goals), observers.body.copies
    body = MazeBody(maze, copies=copies, seed=(seed, 24))
    even, uneven = np.full(goals, 1 / goals), half_for_the_first(goals)
    crossing, tables = junctions(maze), believed(observers.forward_model)
    rows: dict[str, list[float]] = defaultdict(list)
    entropy: dict[str, list[float]] = {"uniform": [], "uneven": []}
    by_share: dict[str, list[BoolArray]] = defaultdict(list)
    toss = np.random.default_rng([seed, 26])
    for goal in range(goals):
        walks = demonstrate(body, goal + 1, np.random.default_rng([seed, 25, goal]))
        for k, (walk, priors) in enumerate(zip(walks, observers.priors, strict=True)):
            episode = watched(walk, maze)
            seen = infer(priors, episode, even, smoothing)
            unseen = infer(priors, episode, even, smoothing, step_likelihood(maze, tables[k], episode))
            for name, belief in {
                "filter": seen.filtered,
                "step": seen.by_step,
                "unseen_filter": unseen.filtered,
                "unseen_step": unseen.by_step,
            }.items():
                right = belief.probability.argmax(1) == goal
                rows[f"intent_{name}_accuracy"].append(right.mean() if name.endswith("step") else right[-1])
                rows[f"intent_{name}_log_loss"].append(-np.log2(belief.probability[:, goal]).mean())
                rows[f"intent_{name}_uninformed_steps"].append(belief.uninformed_steps)
            at_crossing = np.isin(episode.states[:-1], crossing)
            for name, one in (("uniform", seen), ("uneven", infer(priors, episode, uneven, smoothing))):
                entropy[name].extend(one.by_step.entropy[at_crossing])
            by_now = np.ceil(SHARES * walk.steps).astype(int)
            votes = {rule: each[1:] for rule, each in rules_of_thumb(maze, episode.states).items()}
            votes |= {"filter": seen.filtered.probability, "filter, places alone": unseen.filtered.probability}
            for rule, scores in votes.items():  # ties are tossed for
                vote = scores[by_now - 1]
                best = np.isclose(vote, vote.max(1, keepdims=True), rtol=0, atol=1e-9)
                by_share[rule].append(np.where(best, toss.random(vote.shape), -1.0).argmax(1) == goal)
            report((goal + (k + 1) / len(walks)) / goals)
    return {
        **{name: float(np.mean(values)) for name, values in rows.items()},
        "intent_walks": goals * copies,
        "intent_by_share": {
            rule: {"share": SHARES, "accuracy": np.mean(right, 0), "interval": intervals_95(np.array(right))}
            for rule, right in by_share.items()
        },
        "junctions": [maze.place(cell) for cell in crossing],
        "junction_entropy_bits": {name: float(np.mean(v)) if v else None for name, v in entropy.items()},
    }
