"""What a run of `imitate objects` found, in numbers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from babbling.axes import BoolArray
from experiments.objects.deciding import UNSEEN, Response
from experiments.objects.options import Config
from experiments.objects.showing import Act
from experiments.shared.children import Child
from experiments.shared.judging import calibrations, interval_95, interval_over_learners, share_over_learners
from imitation.acting.primitives import NAMES
from imitation.deferred import ActMemory
from models.objects.states import STATES


@dataclass(frozen=True)
class Done:
    """One imitator, one object."""

    config: Config
    child: Child
    act: Act | None
    memory: ActMemory | None
    response: Response

    @property
    def goal(self) -> str:
        """The state it was after."""
        goal = int(self.response.goals[0])
        return "none: it saw nothing" if goal == UNSEEN else STATES[goal]

    @property
    def acts(self) -> list[tuple[str, str]]:
        """What it did, and what became of the object."""
        done = zip(self.response.primitives[0].tolist(), self.response.states[0].tolist(), strict=True)
        return [(NAMES[act], STATES[state]) for act, state in done if act >= 0]

    @property
    def metrics(self) -> dict[str, Any]:
        """For metrics.json."""
        memory = self.memory
        posterior = dict(zip(NAMES, self.response.posteriors[0].tolist(), strict=True))
        return {
            "goal": self.goal,
            "acts": [{"act": act, "state": state} for act, state in self.acts],
            "reached": bool((self.response.states[0] == self.response.goals[0]).any()),
            "posterior": posterior,
            "recognised": None if memory is None else NAMES[int(memory.primitive.argmax())],
            "recognised_probability": None if memory is None else float(memory.primitive.max()),
            "play_body_minutes": self.child.play.minutes,
        }


@dataclass(frozen=True)
class Studied:
    """Every part of the study, of every play."""

    plays: Sequence[Child]
    parts: Sequence[Mapping[str, Any]]

    def all(self, key: str) -> list[Any]:
        """What the parts say under a key, play by play."""
        return [part[key] for part in self.parts if key in part]

    def by_name(self, key: str) -> dict[str, list[BoolArray]]:
        """Name -> what the parts say of it under a key, an array for each play."""
        return {name: [one[name] for one in self.all(key)] for name in self.all(key)[0]}

    @property
    def heads(self) -> dict[str, list[BoolArray]]:
        """Condition -> who touched with the forehead, an array for each play."""
        found: dict[str, list[BoolArray]] = {}
        for condition, touched in self.all("head"):
            found.setdefault(condition, []).append(touched)
        return found

    @property
    def metrics(self) -> dict[str, Any]:
        """For metrics.json."""
        table, alone, own = (self.all(key) for key in ("table", "kind_alone", "of_play"))
        gain = np.array([one[2] - other[2] for one, other in zip(table, alone, strict=True)])
        new = {toy: [one[toy] for one in self.all("new")] for toy in self.all("new")[0]}
        shares = {
            toy: {key: float(np.mean([one[key].mean() for one in ones])) for key in ("first", "own")}
            for toy, ones in new.items()
        }
        first, tried = (sum(one[key] for one in shares.values()) for key in ("first", "own"))
        return {
            **rates("primitive_success", self.by_name("success")),
            **rates("primitive_success_unaimed", self.by_name("unaimed")),
            "creep_mm_per_s": max(self.all("creep_mm_per_s")),
            **rates("apart_rate", {"below": self.all("below"), "above": self.all("above")}, flat=True),
            **calibrations("outcome", [one[:2] for one in table]),
            **calibrations("outcome_of_play", [one[:2] for one in own]),
            "outcome_gain_bits": float(gain.mean()),
            "outcome_gain_bits_interval": interval_over_learners(gain),
            **rates("recognition", self.by_name("recognised"), flat=True),
            "new_object": shares,
            "new_object_ratio": first / max(tried, 1e-9),
            **rates("head_touch", self.heads),
            "play_body_minutes": [child.play.minutes for child in self.plays],
            "agents": int(sum(map(len, self.heads["live"]))),
        }


def rates(name: str, found: Mapping[str, Sequence[BoolArray]], flat: bool = False) -> dict[str, Any]:
    """Shares, exact 95 % intervals over all, and 95 % intervals over plays: by name, or as names of their own."""
    share = {key: float(np.concatenate(list(ones)).mean()) for key, ones in found.items()}
    whole = {key: np.concatenate(list(ones)) for key, ones in found.items()}
    inside = {key: interval_95(int(one.sum()), len(one)) for key, one in whole.items()}
    plays = {
        key: share_over_learners(np.array([one.mean() for one in ones if len(one)])) for key, ones in found.items()
    }
    if not flat:
        return {name: share, f"{name}_interval": inside, f"{name}_interval_over_plays": plays}
    return {
        f"{name}_{key}{end}": values[key]
        for end, values in (("", share), ("_interval", inside), ("_interval_over_plays", plays))
        for key in found
    }
