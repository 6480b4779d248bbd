"""What a run of `imitate intentions` found, in numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from babbling.axes import FloatArray
from babbling.play import Play
from experiments.intentions.agents import GOALS, Belief, Did
from experiments.intentions.options import CONDITIONS, Config
from experiments.intentions.showing import SHOWS, Shown, somebody
from experiments.intentions.study import USUAL, Answers
from experiments.intentions.trials import Trials
from experiments.shared.children import Child
from experiments.shared.judging import calibrations, interval_95, share_over_learners
from experiments.shared.playing import Tried
from imitation.acting.primitives import NAMES
from imitation.inference.meaning import Meant
from models.objects.states import SAME, STATES


@dataclass(frozen=True)
class Done:
    """One imitator."""

    config: Config
    child: Child
    """Who watched, with the play that is its own."""
    shown: Shown
    adult: tuple[Trials, Tried] | None
    """What was shown came from; None where nothing was."""
    meant: Meant
    belief: Belief
    did: Did
    tries: Sequence[Tried]
    """The physics of what it did."""

    @property
    def acts(self) -> list[tuple[str, str, str]]:
        """What it was after, what it did, and what became of the object."""
        return [
            (GOALS[goal], NAMES[act], STATES[state])
            for act, state, goal in zip(*(column.tolist() for column in self.did), strict=True)
        ]

    @property
    def metrics(self) -> dict[str, Any]:
        """For metrics.json."""
        return {
            "goal": dict(zip(GOALS, self.belief.goal.tolist(), strict=True)),
            "goal_inferred": GOALS[int(self.belief.goal.argmax())] if self.shown.seen else None,
            "agent": self.belief.somebody,
            "goal_by_presentation": self.meant.goal,
            "agent_by_presentation": self.meant.somebody,
            "shown": [
                {"taken_for": NAMES[int(one.movement.argmax())], "state": STATES[one.state or SAME], "again": one.again}
                for one in self.shown.seen
            ],
            "acts": [{"goal": goal, "act": act, "state": state} for goal, act, state in self.acts],
            "target": STATES[self.shown.target],
            "reached": bool((self.did.states == self.shown.target).any()),
            "play_body_minutes": self.child.play.minutes,
        }


@dataclass(frozen=True)
class Studied:
    """What every play's children did, and what was inferred."""

    plays: Sequence[Play]
    answers: Sequence[Mapping[str, Any]]
    hows: Sequence[str]
    """Ways of being an imitator."""
    films: Mapping[str, Any]
    wall_s: float

    def shares(self, how: str, what: str) -> dict[str, list[FloatArray]]:
        """Condition -> for each play, (N,) share of the objects of that condition with which each imitator did it."""
        found: dict[str, list[FloatArray]] = {}
        for condition, toys in CONDITIONS.items():
            for play in self.answers:
                some = [getattr(play[how][condition, toy], what) for toy in toys if (condition, toy) in play[how]]
                if some:
                    found.setdefault(condition, []).append(np.mean(some, 0))
        return found

    @property
    def first_means(self) -> list[FloatArray]:
        """For each play, (N,) of those whose first act parted the large dumbbell whether it was another than the
        adult's."""
        found = list[FloatArray]()
        for play in self.answers:
            answers: Answers = play[USUAL]["outsized", "outsized"]
            began = answers.first[answers.ours]
            found.append((began != NAMES.index(SHOWS["outsized"].act)).astype(float))
        return found

    @property
    def metrics(self) -> dict[str, Any]:
        """For metrics.json."""
        ours, mimic, emulate = (self.shares(USUAL, what) for what in ("ours", "mimic", "emulate"))
        share, interval = means(ours), intervals(ours)
        bodies = {
            body: [[somebody(play["bodies"][body], met) for play in self.answers] for met in (None, True, False)]
            for body in self.answers[0]["bodies"]
        }
        return {
            "rates": share,
            "rates_interval": interval,
            "rates_interval_over_plays": {
                name: share_over_learners(np.array([one.mean() for one in each])) for name, each in ours.items()
            },
            "rates_by_object": {
                condition: {
                    toy: float(
                        np.mean(
                            [
                                play[USUAL][condition, toy].ours.mean()
                                for play in self.answers
                                if (condition, toy) in play[USUAL]
                            ]
                        )
                    )
                    for toy in toys
                    if any((condition, toy) in play[USUAL] for play in self.answers)
                }
                for condition, toys in CONDITIONS.items()
            },
            "rates_first_act": means(self.shares(USUAL, "at_once")),
            "rates_mimicry": means(mimic),
            "rates_emulation": means(emulate),
            "rates_mimicry_interval": intervals(mimic),
            "rates_emulation_interval": intervals(emulate),
            **other_means(np.concatenate(self.first_means)),
            **{
                f"agent_posterior{end}": {body: float(np.mean(each[n])) for body, each in bodies.items()}
                for n, end in enumerate(("", "_looked", "_unlooked"))
            },
            "agent_log_odds": {
                body: float(np.mean([play["bodies"][body].mean() for play in self.answers])) for body in bodies
            },
            **inferences([play["inferred"] for play in self.answers]),
            "films": self.films,
            "agents": int(sum(map(len, ours["target"]))),
            "play_body_minutes": [play.minutes for play in self.plays],
            "tries_of_each": float(np.mean([play.each.sum((1, 2, 3, 4)).mean() for play in self.plays])),
            "study_wall_s": self.wall_s,
            "sensitivity": {how: means(self.shares(how, "ours")) for how in self.hows},
        }


def inferences(inferred: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """How well goals were inferred from single presentations, over plays."""
    ended = over_plays([one["rules"] for one in inferred])
    shares = {f"{one:g}": over_plays([play["by_share"][one] for play in inferred]) for one in inferred[0]["by_share"]}
    return {
        **calibrations("goal", [(one["sure"], one["right"]) for one in inferred]),
        "goal_presentations": sum(len(one["sure"]) for one in inferred),
        "goal_accuracy": ended[0],
        "goal_accuracy_interval_over_plays": ended[1],
        "goal_accuracy_by_share": {share: found for share, (found, _) in shares.items()},
        "goal_accuracy_by_share_interval_over_plays": {share: ends for share, (_, ends) in shares.items()},
    }


def over_plays(each: Sequence[Mapping[str, float]]) -> tuple[dict[str, float], dict[str, Any]]:
    """By rule, the mean of plays, and its 95 % interval (None of a single one)."""
    found = {rule: np.array([one[rule] for one in each]) for rule in each[0]}
    return {rule: float(one.mean()) for rule, one in found.items()}, {
        rule: share_over_learners(one) for rule, one in found.items()
    }


def other_means(other: FloatArray) -> dict[str, Any]:
    """Of those with whom the large dumbbell came apart, the share that began by other means than the adult's."""
    share = float(other.mean()) if len(other) else None
    return {"outsized_other_means": share, "outsized_other_means_interval": exact(other)}


def means(found: Mapping[str, Sequence[FloatArray]]) -> dict[str, float]:
    """Over all agents."""
    return {name: float(np.concatenate(list(each)).mean()) for name, each in found.items()}


def intervals(found: Mapping[str, Sequence[FloatArray]]) -> dict[str, tuple[float, float]]:
    """95 % over agents: exact where each met one object, else Student's t of each agent's own share."""
    return {name: exact(np.concatenate(list(each))) for name, each in found.items()}


def exact(each: FloatArray) -> tuple[float, float]:
    """See `intervals`."""
    if np.isin(each, (0, 1)).all():
        return interval_95(int(each.sum()), len(each)) if len(each) else (0.0, 1.0)
    return share_over_learners(each) or (0.0, 1.0)
