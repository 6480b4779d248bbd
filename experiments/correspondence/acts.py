"""Single acts of all teachers: which part was that, how often must one try until it looks right, and what hides it?"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.mirroring import angles_between
from babbling.organs import EDGES_DEG, Organs, turned
from experiments.shared.judging import Sweep
from experiments.shared.kept import once
from experiments.shared.mirrors import Pupil
from imitation.correspondence.organ import edge_ticks, identify, owners
from imitation.correspondence.tries import try_again
from models.mirror import Mirror, blurred
from models.teachers.acts import movable, single_act
from models.teachers.robots import ROBOTS

POSTURES = 3000
"""Looked at to know how near a part can come; three joints are then 4 deg apart, or less."""


@dataclass(frozen=True)
class Acts:
    """truth, said: (A,) part numbers, -1 for nothing; errors_deg (A', tries + 1): how far off the right part points,
    before any try and after each, in acts whose part was identified; least_deg (A', 2): how near it comes at all, with
    that part's own joints and with all, by looking at many postures; parts: names by number."""

    parts: tuple[str, ...]
    truth: IntArray
    said: IntArray
    errors_deg: FloatArray
    least_deg: FloatArray

    @property
    def rate(self) -> float:
        """Share of acts put to the right part."""
        return float(np.mean(self.truth == self.said))


def act_study(pupil: Pupil, count: int, tries: int, seed: int) -> Acts:
    """Random robots, random parts, random postures; the imitator starts its tries at rest."""
    rng = np.random.default_rng([seed, 17])
    image, mirror = pupil.image, Mirror(pupil.body)
    calm = replace(pupil, noise_deg=pupil.noise_deg / 3)
    truth, said, errors, least = [], [], [], []
    reach = _Reach(pupil, mirror, np.random.default_rng([seed, 20]))
    for number in range(count):
        part, shown = act(image.parts, number, rng)
        organ = identify(image.organs, pupil.look(shown, rng), pupil.body.tick_s)
        truth.append(part)
        said.append(organ.part)
        if organ.part == truth[-1]:
            wanted = shown[-1, organ.part]

            def look(posture: FloatArray, which: int = organ.part) -> FloatArray:
                return pupil.look(mirror.shown(pupil.angles(posture[None]))[0, which], rng)

            eye = calm.look(wanted, rng)  # it holds still at the end: ten frames make one good look
            tried = try_again(image, organ.part, eye, image.rest, look, tries, rng)
            shows = mirror.shown(pupil.angles(tried))[:, organ.part]
            errors.append(angles_between(shows, wanted))
            least.append(reach.least(organ.part, wanted))
    table = np.rad2deg(errors).reshape(-1, tries + 1)
    nearest = np.rad2deg(least).reshape(-1, 2)
    return Acts(image.parts, np.array(truth), np.array(said), table, nearest)


class _Reach:
    """Where parts can point at all: in POSTURES postures drawn evenly from all there are, for those who judge."""

    def __init__(self, pupil: Pupil, mirror: Mirror, rng: np.random.Generator) -> None:
        self._pupil, self._mirror, self._image = pupil, mirror, pupil.image
        self._drawn = rng.uniform(pupil.image.low, pupil.image.high, (POSTURES, len(pupil.image.low)))
        self._own = dict[int, FloatArray]()
        self._all = mirror.shown(pupil.angles(self._drawn))

    def least(self, part: int, wanted: FloatArray) -> tuple[float, float]:
        """rad, with the joints that are that part's own and the others at rest, and with all."""
        if part not in self._own:
            own = owners(self._image.moves) == part
            postures = np.where(own, self._drawn, self._image.rest)
            self._own[part] = self._mirror.shown(self._pupil.angles(postures))[:, part]
        return float(angles_between(self._own[part], wanted).min()), float(
            angles_between(self._all[:, part], wanted).min()
        )


def act(
    parts: Sequence[str], number: int, rng: np.random.Generator, share: float = 1.0, others: int = 0
) -> tuple[int, FloatArray]:
    """Robots take turns: the number of a random part and the (T, P, 3) directions of its act, NaN where a robot lacks a
    part. See `single_act`; so many `others` move along."""
    robot = list(ROBOTS)[number % len(ROBOTS)]
    part, *along = rng.permutation([part for part in movable(robot) if part in parts])[: 1 + others].tolist()
    seen = single_act(robot, part, rng, share, tuple(along)).directions
    return parts.index(part), np.stack([seen.get(name, np.full_like(seen[part], np.nan)) for name in parts], 1)


class Hard(NamedTuple):
    """What makes an act hard to put to a part."""

    noise_deg: float = 3.0
    """Of seeing the teacher; the mirror was looked at with 3 degrees."""
    share: float = 1.0
    """Of the way of an act."""
    others: float = 0
    """Parts that move along, half as far."""
    exchanged: float = 0.0
    """Share of frames in which left and right parts, look-alikes, are taken for one another."""


HARDER: dict[str, tuple[str, str, tuple[float, ...]]] = {
    "noise_deg": ("seeing noise", "noise [deg]; the mirror was seen with 3", (3, 6, 12, 18, 24, 36)),
    "share": ("small movements", "way, as a share of a whole act's", (1, 0.5, 0.25, 0.12, 0.06, 0.03)),
    "others": ("several parts at once", "other parts that move, half as far", (0, 1, 2, 3, 4)),
    "exchanged": ("look-alikes", "share of frames with left for right", (0, 0.1, 0.2, 0.3, 0.4, 0.5)),
}
"""Field of `Hard`: what it is called, its unit, its grades."""
MIDDLES = np.deg2rad([0.5, *(np.array(EDGES_DEG[:-1]) + EDGES_DEG[1:]) / 2, 60.0])
"""rad, of the categories of amounts."""
RULES = ("Eq. (1)", "correlation with own acts", "largest turn")


def harder_acts(
    learners: list[Organs], count: int, tick_s: float, seed: int, report: Callable[[float], None]
) -> dict[str, Sweep]:
    """Every learner sees `count` acts at every grade of every difficulty; all rules are told that something moved."""
    found = {}
    for n, (name, (_, label, grades)) in enumerate(HARDER.items()):
        right = [once(_answers, organs, name, count, tick_s, seed + s) for s, organs in enumerate(learners)]
        found[name] = Sweep(label, grades, RULES, np.array(right) / count)
        report((n + 1) / len(HARDER))
    return found


def _answers(organs: Organs, name: str, count: int, tick_s: float, seed: int) -> FloatArray:
    """(R, K) how often each rule was right at each grade of one difficulty."""
    grades, rng = HARDER[name][2], np.random.default_rng([seed, 19, [*HARDER].index(name)])
    right = np.zeros((len(RULES), len(grades)))
    for g, grade in enumerate(grades):
        hard = Hard()._replace(**{name: grade})
        for number in range(count):
            part, shown = act(organs.parts, number, rng, hard.share, int(hard.others))
            right[:, g] += part == put_to_parts(organs, seen_hard(shown, organs.parts, hard, rng), tick_s)
    return right


def seen_hard(shown: FloatArray, parts: Sequence[str], hard: Hard, rng: np.random.Generator) -> FloatArray:
    """(T, P, 3) directions as they are seen: some frames with left and right exchanged, all with noise."""
    other = {"left": "right", "right": "left"}
    twin = ["_".join(other.get(word, word) for word in part.split("_")) for part in parts]
    exchanged = shown[:, [parts.index(name) for name in twin]]
    away = rng.random(len(shown)) < hard.exchanged
    return blurred(np.where(away[:, None, None], exchanged, shown), float(np.deg2rad(hard.noise_deg)), rng)


def put_to_parts(organs: Organs, seen: FloatArray, tick_s: float) -> IntArray:
    """(3,) which part moved, by `RULES`: Eq. (1); the own motor whose mean amounts correlate most with those seen, no
    model of noise or size; the part that turned most."""
    edge = edge_ticks(tick_s)
    amounts = turned(seen[:edge], seen[-edge:])
    there = np.isfinite(amounts)
    counts, owner = organs.amounts.counts[:, :-1].astype(float), owners(organs.moves)
    own = (counts @ MIDDLES / np.maximum(counts.sum(-1), 1.0))[there]
    away, own = amounts[there] - amounts[there].mean(), own - own.mean(0)
    likeness = np.where(owner >= 0, away @ own / np.maximum(np.linalg.norm(own, axis=0), 1e-9), -np.inf)
    said = identify(organs, seen, tick_s).probability[:-1].argmax()
    return np.array([said, owner[likeness.argmax()], np.nanargmax(amounts)])
