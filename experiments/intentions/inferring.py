"""How well is a goal inferred? Adults pursue goals by Eq. (1), children judge by Eq. (2): one presentation, or less."""

from typing import Any, Final

import numpy as np

from babbling.axes import FloatArray, IntArray
from experiments.intentions.agents import GOALS, MEMBERS, Agent, How
from experiments.intentions.showing import ACROSS
from experiments.intentions.trials import Trials
from experiments.shared.children import Child
from experiments.shared.playing import SEEING_M
from imitation.inference.meaning import GIVES_UP, Knowing, Presentation, meant
from imitation.seeing.acts import likelihood
from models.objects import TOYS
from models.objects.states import STATES

SHARES: Final = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0)
"""Of the movement that is seen."""
PRESENTATIONS: Final = 50
"""Of every object, for each play."""


def inferred(child: Child, adult: Child, adults: dict[str, Trials], seed: int) -> dict[str, Any]:
    """Accuracy by share of the movement, and with its end; calibration; and two rules that do without Eq. (2).

    An adult draws a goal from its P(g) and an act from P(a | g), both by its own play, and it is a try in physics of
    that act that is seen. It stops when it has reached its goal, and otherwise with probability `GIVES_UP`.
    """
    rng = np.random.default_rng([seed, 0x14F])
    right: dict[float, dict[str, list[bool]]] = {share: {} for share in SHARES}
    ended: dict[str, list[bool]] = {}
    sure, hits = list[float](), list[bool]()
    teacher = Agent(adult.play, How())
    for thing, trials in adults.items():
        if ":" in thing:
            continue
        kind = child.play.kinds.index(TOYS[thing].kind)
        knows, wants = teacher.knowing(kind), teacher.wants(kind)
        goals, rows = pursued(knows, wants, trials, rng)
        looks = [partly(child, kind, trials, rows, share, rng) for share in SHARES]
        states = trials.states[rows]
        reached = MEMBERS[goals, states]
        again = ~reached & (rng.random(len(rows)) > GIVES_UP)
        for n, goal in enumerate(goals.tolist()):
            agent = Agent(child.play.alone(int(rng.integers(len(child.play.each)))), How())
            mine, prior = agent.knowing(kind), agent.wants(kind)
            usual = int(prior[: len(STATES)].argmax())
            for share, movement in zip(SHARES, looks, strict=True):
                found = meant([Presentation(movement[n], None, False)], mine, prior, 1.0).goal[-1]
                guesses = {"Eq. (2)": int(found.argmax()), **peers(movement[n], mine, usual)}
                for rule, guess in guesses.items():
                    right[share].setdefault(rule, []).append(guess == goal)
            whole = Presentation(looks[-1][n], int(states[n]), bool(again[n]))
            found = meant([whole], mine, prior, 1.0).goal[-1]
            guesses = {"Eq. (2)": int(found.argmax()), **peers(looks[-1][n], mine, usual), "end": int(states[n])}
            for rule, guess in guesses.items():
                ended.setdefault(rule, []).append(guess == goal)
            sure.append(float(found.max()))
            hits.append(guesses["Eq. (2)"] == goal)
    return {
        "sure": np.array(sure),
        "right": np.array(hits),
        "rules": {rule: float(np.mean(each)) for rule, each in ended.items()},
        "by_share": {
            share: {rule: float(np.mean(each)) for rule, each in rules.items()} for share, rules in right.items()
        },
    }


def peers(movement: FloatArray, mine: Knowing, usual: int) -> dict[str, int]:
    """What rules without goals would say: what the likeliest primitive mostly brings about; what mostly comes about."""
    return {"last motion": int(mine.outcomes[movement.argmax()].argmax()), "most frequent": usual}


def pursued(knows: Knowing, wants: FloatArray, trials: Trials, rng: np.random.Generator) -> tuple[IntArray, IntArray]:
    """(N,) goals of an adult, and (N,) tries of the acts that it chose for them."""
    goals = rng.choice(len(GOALS), PRESENTATIONS, p=wants)
    rows = list[int]()
    able = np.bincount(trials.which[~trials.careless], minlength=len(knows.habit)) > 0
    by_goal = np.where(able, knows.means, 0)
    for goal in goals:
        means = by_goal[goal]
        act = rng.choice(len(means), p=means / means.sum())
        rows.append(int(rng.choice(np.flatnonzero((trials.which == act) & ~trials.careless))))
    return goals, np.array(rows)


def partly(
    child: Child, kind: int, trials: Trials, rows: IntArray, share: float, rng: np.random.Generator
) -> FloatArray:
    """(N, A) P(movement | primitive) of which only the first share was seen."""
    tracks = trials.tracks[rows] @ ACROSS
    tracks = tracks + SEEING_M * rng.standard_normal(tracks.shape)
    tracks[:, max(round(share * tracks.shape[1]), 1) :] = np.nan
    return likelihood(child.play, kind, tracks, SEEING_M)
