"""Every experiment, by name. A newcomer adds one line here and gets the command line and the conformance tests."""

from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

from experiments.errors import ExperimentError
from models.errors import unknown

if TYPE_CHECKING:
    from experiments.shared.options import Options


@dataclass(frozen=True)
class Entry:
    """One experiment: its folder here and what it does, in a line."""

    name: str
    line: str

    def options(self) -> "type[Options]":
        """Its `Config`; help and refusals wait for nothing else."""
        config: type[Options] = import_module(f"experiments.{self.name}.options").Config
        return config

    def load(self) -> ModuleType:
        """The module that runs it, imported only when it is wanted: help must not wait for physics."""
        return import_module(f"experiments.{self.name}.run")


EXPERIMENTS: dict[str, Entry] = {
    "gesture": Entry("gesture", "HOAP-2 babbles, watches a movement and reproduces it by Bayesian action selection"),
    "babble": Entry("babble", "a robot babbles and leaves its forward model in a file; interrupted, it goes on"),
    "saccades": Entry("saccades", "a head looks about, learns what its movements do to what it sees, and fixates"),
    "head": Entry("head", "a head watches another nod, shake and look around, and does the same, at once or later"),
    "gaze": Entry("gaze", "a teacher turns to a toy; the imitator infers which, by its own forward model, and looks"),
    "maze": Entry("maze", "the chapter's maze: wander, watch, imitate, infer intent, with its figures and its claims"),
    "correspondence": Entry("correspondence", "a mirror, organ identification, anybody's movements in one's own limbs"),
    "play": Entry("play", "children play with things at a table and leave what they learned in a file"),
    "objects": Entry("objects", "an act on an object is seen once, remembered, and done by one's own means"),
    "intentions": Entry("intentions", "what somebody meant to do is inferred from failed attempts, and done"),
    "face": Entry("face", "a face is imitated that never saw itself; rival theories of newborns' imitation, scored"),
    "notice": Entry("notice", "a motor jams, a hand takes up a weight, wires are swapped: noticed, named and learned"),
    "robot": Entry("robot", "a robot's card: its motors, senses and what would be refused; a movement to begin with"),
    "compare": Entry("compare", "what earlier runs left, side by side: one table, one figure, one recording"),
    "reinforcement": Entry("reinforcement", "learning by reward beside imitation: how long it takes, what it risks"),
    "benchmark": Entry("benchmark", "peers, gains, learning curve and throughput in one table"),
}


def entry(name: str) -> Entry:
    """The experiment of this name.

    Raises:
        ExperimentError: there is none.
    """
    if name not in EXPERIMENTS:
        raise ExperimentError(unknown("experiment", name, EXPERIMENTS))
    return EXPERIMENTS[name]
