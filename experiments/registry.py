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
    """One experiment."""

    name: str
    """Its folder here."""
    line: str
    """What it does."""
    example: str = ""
    """Options of a command worth trying."""
    takes: str = ""
    """How long that takes."""
    stage: str = "Others"
    """Whose heading it stands under."""

    def options(self) -> "type[Options]":
        """Its `Config`; help and refusals wait for nothing else."""
        config: type[Options] = import_module(f"experiments.{self.name}.options").Config
        return config

    def load(self) -> ModuleType:
        """The module that runs it, imported only when it is wanted: help must not wait for physics."""
        return import_module(f"experiments.{self.name}.run")


BABBLING = "Stage 1, body babbling: how one moves, how one looks"
MOVEMENTS = "Stage 2, imitating movements: of the body, of head and gaze, of the face"
MAZE = "The chapter's example (section 3.3)"
OBJECTS = "Stage 3, imitating acts on objects"
INTENTIONS = "Stage 4, inferring what others mean to do"
POPULATIONS = "All stages"
TOOLS = "Tools"
EXPERIMENTS: dict[str, Entry] = {
    one.name: one
    for one in (
        Entry(
            "babble", "a robot babbles and leaves its forward model in a file; interrupted, it goes on",
            "--robot hoap2 --out hoap2.nc", "about 40 s on two cores", BABBLING,
        ),
        Entry(
            "correspondence", "a mirror, organ identification, anybody's movements in one's own limbs",
            "--scramble 3", "about 100 s on two cores", BABBLING,
        ),
        Entry(
            "gesture", "HOAP-2 babbles, watches a movement and reproduces it by Bayesian action selection",
            "--demonstration human-raise --attempts 5", "about a minute on two cores", MOVEMENTS,
        ),
        Entry(
            "saccades", "a head looks about, learns what its movements do to what it sees, and fixates",
            "--squint 1", "about 30 s on two cores", MOVEMENTS,
        ),
        Entry(
            "head", "a head watches another nod, shake and look around, and does the same, at once or later",
            "--movement nod --deferred", "about 30 s on two cores", MOVEMENTS,
        ),
        Entry(
            "gaze", "a teacher turns to a toy; the imitator infers which, by its own forward model, and looks",
            "--seed 1", "about a minute on two cores", MOVEMENTS,
        ),
        Entry(
            "face", "a face is imitated that never saw itself; rival theories of newborns' imitation, scored",
            '--gesture "mouth open"', "about 20 s on two cores", MOVEMENTS,
        ),
        Entry(
            "maze", "the chapter's maze: wander, watch, imitate, infer intent, with its figures and its claims",
            "--goal 3 --deferred", "about 10 s", MAZE,
        ),
        Entry(
            "play", "children play with things at a table and leave what they learned in a file",
            "--minutes 40 --out play.nc", "about a minute on two cores", OBJECTS,
        ),
        Entry(
            "objects", "an act on an object is seen once, remembered, and done by one's own means",
            "--condition week", "about a minute on two cores", OBJECTS,
        ),
        Entry(
            "intentions", "what somebody meant to do is inferred from failed attempts, and done",
            "--condition failed --object dumbbell", "about a minute on two cores", INTENTIONS,
        ),
        Entry(
            "battery", "all stages, one growing mind each: populations of agents beside infants",
            "--quick --vary exponent=0.5,1,2", "about ten minutes on two cores", POPULATIONS,
        ),
        Entry(
            "fit", "how individuals and groups choose: Eq. (1) and (2) fitted to a table of choices",
            "runs/battery/trials.parquet --recover", "about 15 s", POPULATIONS,
        ),
        Entry(
            "notice", "a motor jams, a hand takes up a weight, wires are swapped: noticed, named and learned",
            "--cases 10", "about two minutes on two cores", TOOLS,
        ),
        Entry(
            "robot", "a robot's card: its motors, senses and what would be refused; a movement to begin with",
            "hoap2 --template wave.csv", "a few seconds", TOOLS,
        ),
        Entry(
            "compare", "what earlier runs left, side by side: one table, one figure, one recording",
            "runs/gesture runs/filmed", "a few seconds", TOOLS,
        ),
        Entry(
            "reinforcement", "learning by reward beside imitation: how long it takes, what it risks",
            "--peers search", "about 10 minutes on two cores", TOOLS,
        ),
        Entry(
            "benchmark", "peers, gains, learning curve and throughput in one table",
            "--bodies ideal --clips icub-wave --seeds 1", "minutes", TOOLS,
        ),
    )
}  # fmt: skip


def entry(name: str) -> Entry:
    """The experiment of this name.

    Raises:
        ExperimentError: there is none.
    """
    if name not in EXPERIMENTS:
        raise ExperimentError(unknown("experiment", name, EXPERIMENTS))
    return EXPERIMENTS[name]
