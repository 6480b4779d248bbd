"""Newborns' faces: they babble in the dark, see an adult's act, and do what they think was done."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from babbling.axes import IntArray
from experiments.battery.films import OFF, Camera, adults_face, newborns_face
from experiments.battery.life import Life
from experiments.battery.table import IMITATOR, WHOLE, Trial
from experiments.face.answering import answered
from experiments.face.infants import Group, Infant, raised
from experiments.face.theories import GESTURES, SAID
from experiments.face.watching import VIEWS, Look, Looking, watched
from models.face import FACES

EACH, VIEWED = 2, 2
"""Acts of every kind from each of so many views, which all infants draw their looks from."""
TRIES, WARD = 3, 20


@dataclass(frozen=True, eq=False)
class Ward:
    """WARD newborns whose bodies are stepped side by side, whoever of them is asked for, and what is to be seen."""

    first: int
    """Seed of the first; each has the next."""
    acts: int
    """That each babbles."""
    lives: tuple[tuple[Life, ...], ...]
    """Of every newborn that is asked for; those that differ in nothing that its face depends on."""
    bank: tuple[Look, ...]
    filmed: bool = False

    @property
    def label(self) -> str:
        """In words."""
        return f"faces of agents {self.lives[0][0].agent} to {self.lives[-1][-1].agent}"


def looks(seed: int) -> list[Looking]:
    """At an adult's face, from near and far."""
    return [
        Looking("usual", face, view, EACH, 100 * seed + n) for n, (face, view) in enumerate(VIEWS["usual"][:VIEWED])
    ]


def bank(looking: Looking) -> list[Look]:
    """Those in which something is done."""
    return [look for look in watched(looking) if look.shown.gesture < len(GESTURES)]


def faces(ward: Ward, camera: Camera = OFF) -> list[Trial]:
    """Every infant is shown every gesture, strong and weak, once."""
    infants = raised(group := Group(FACES["newborn"], 3000, WARD, ward.acts, ward.first))
    kinds = [(gesture, strong) for gesture in range(len(GESTURES)) for strong in (True, False)]
    of = [[look for look in ward.bank if (look.shown.gesture, look.shown.strong) == kind] for kind in kinds]
    rngs = [np.random.default_rng([ward.first + n, 0xBA77, 5]) for n in range(WARD)]
    mine = [[some[int(rng.integers(len(some)))] for some in of] for rng in rngs]
    answers, memories = answered(group, infants, mine, TRIES)
    places = [(alike[0].seed - ward.first, alike) for alike in ward.lives]
    who = places[0][0]
    camera.take("face-1", lambda: adults_face(mine[who][0]))
    camera.take("face-2", lambda: newborns_face(group, infants[who], memories[len(kinds) * who], TRIES))
    return [row for n, alike in places for life in alike for row in _rows(life, infants[n], mine[n], answers.labels[n])]


def _rows(life: Life, infant: Infant, seen: Sequence[Look], labels: IntArray) -> Iterator[Trial]:
    for look, tried in zip(seen, labels, strict=True):
        name, how = GESTURES[look.shown.gesture], "strong" if look.shown.strong else "weak"
        for number, label in enumerate(tried.tolist()):
            yield Trial(life.agent, life.seed, WHOLE, IMITATOR, 2, "face", f"{name}, {how}", number, SAID[label], name,
                        float(SAID[label] == name))  # fmt: skip
    for number, label in enumerate(infant.habit[: 2 * TRIES].tolist()):  # what it does where nothing was shown
        yield Trial(life.agent, life.seed, WHOLE, IMITATOR, 2, "face", "nothing shown", number, SAID[label],
                    "tongue out", float(SAID[label] == "tongue out"))  # fmt: skip
