"""What is shown: by a person or a device, with success, in vain, by accident, with bound hands: tries in physics."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.body_image import BodyImage
from babbling.play import HANDS, Play
from experiments.intentions.trials import Trials
from experiments.objects.deciding import remembered
from experiments.objects.showing import Seen
from experiments.shared.playing import SEEING_M
from imitation.acting.primitives import NAMES
from imitation.inference.meaning import Presentation
from imitation.seeing.somebody import like_me, residuals
from models.objects import TOYS
from models.objects.states import STATES

ACROSS: Final = np.diag([-1.0, -1.0, 1.0])
"""Somebody across the table is seen turned round."""


class Show(NamedTuple):
    """What adults show with an object, and what it is for."""

    act: str
    target: str
    other: str | None = None
    """The kind of thing that it is for an adult, where that is another than for a child."""


SHOWS: Final = {
    "dumbbell": Show("pull", "apart"),
    "box": Show("carry and push", "buzz"),
    "loop": Show("carry", "joined"),
    "square": Show("carry", "joined"),
    "cup": Show("carry", "joined"),
    "outsized": Show("pull", "apart", "dumbbell"),
    "panel": Show("press with the head", "lit by head"),
}
HANDLING: Final = ("lift with both", "squeeze", "hold", "lift", "sweep")
"""What an adult does who handles a thing without the act."""
TWO_EFFECTS: Final = {"dumbbell": ("lift with both", "up"), "cup": ("lift", "up")}
"""Objects with a second effect, for what is done by accident (Carpenter et al. 1998)."""
HANDS_SEEN: Final = slice(0, 2)
"""Of the five places of a track."""
IN_VAIN: Final = ("failed", "failed_unlooked", "device_failed", "outsized")
"""Conditions in which what is shown does not come off."""
NOTHING: Final = ("baseline", "none")
"""What conditions end in where nothing is shown."""
CONTACT: Final = (0.7, 0.05)
"""P(it looks at who watches | somebody), and for a thing."""
POLES_M: Final = (0.05, 0.15, 0.6)
"""m forward, to each side and up from the middle of the table: where the poles of the device hang from."""


@dataclass(frozen=True)
class Looks:
    """N tries of an adult as a child sees them across the table."""

    trials: Trials
    states: IntArray
    """(N,) what became of the object, by what was seen."""
    movement: FloatArray
    """(N, A) P(primitive | movement), by what oneself does with such a thing."""
    as_other: FloatArray
    """(N, A) the same, with the kind of thing that it is for the other."""

    def presentation(self, row: int, again: bool, itself: bool) -> Presentation:
        """One of these tries; whether it was taken up again at once is told."""
        movement = self.movement if itself else self.as_other
        return Presentation(movement[row], int(self.states[row]), again)


def looked_at(play: Play, trials: Trials, rng: np.random.Generator) -> Looks:
    """How tries look, 3 mm of noise, from across the table; hands under a blanket do not show."""
    tracks = trials.tracks @ ACROSS
    if trials.busy:
        tracks[:, :, HANDS_SEEN] = np.nan
    seen = Seen(tracks + SEEING_M * rng.standard_normal(tracks.shape), trials.signal, SEEING_M)
    own = remembered(play, trials.toy, seen)
    other = SHOWS[trials.toy].other
    theirs = own if other is None else remembered(play, trials.toy, seen, TOYS[other].kind)
    states, movement = np.array([one.states[-1] for one in own]), np.array([one.primitive for one in own])
    return Looks(trials, states, movement, np.array([one.primitive for one in theirs]))


def stretched(outline: FloatArray, by: float) -> FloatArray:
    """Arms so many times as long."""
    found = outline.copy()
    for part, shoulder in ((0, 5), (3, 5), (1, 6), (4, 6)):
        found[..., part, :] = outline[..., shoulder, :] + by * (outline[..., part, :] - outline[..., shoulder, :])
    return found


def without(outline: FloatArray, parts: Sequence[int]) -> FloatArray:
    """Some parts are missing."""
    found = outline.copy()
    found[..., list(parts), :] = np.nan
    return found


def device(outline: FloatArray) -> FloatArray:
    """Pincers where hands are, on poles that hang from above; no head."""
    found = without(outline, [2])
    for pincer, half_way, end, side in ((0, 3, 5, 1.0), (1, 4, 6, -1.0)):
        found[..., end, :] = np.multiply(POLES_M, (1.0, side, 1.0))
        found[..., half_way, :] = (found[..., end, :] + outline[..., pincer, :]) / 2
    return found


BODIES: Final[dict[str, Callable[[FloatArray], FloatArray]]] = {
    "person": lambda outline: outline,
    "a smaller one": lambda outline: 0.8 * outline,
    "arms 1.25 x": lambda outline: stretched(outline, 1.25),
    "without a head": lambda outline: without(outline, [2]),
    "arms 1.5 x": lambda outline: stretched(outline, 1.5),
    "one arm": lambda outline: without(outline, [0, 3, 5]),
    "arms 2 x": lambda outline: stretched(outline, 2.0),
    "arms 2.5 x": lambda outline: stretched(outline, 2.5),
    "a head on poles": lambda outline: np.where(np.isnan(device(outline)), outline, device(outline)),
    "poles and pincers": device,
    "a hand alone": lambda outline: without(outline, [0, 2, 3, 4, 5, 6]),
}
"""What may do the same movement: less and less like oneself."""


def likeness(image: BodyImage, outlines: FloatArray, body: str, rng: np.random.Generator) -> FloatArray:
    """(N,) log odds of a body like mine, from (N, L, 7, 3) outlines that another kind of body shows."""
    shown = BODIES[body](outlines) @ ACROSS
    shown = shown + SEEING_M * rng.standard_normal(shown.shape)
    return np.array([like_me(residuals(image, one)) for one in shown])


def somebody(log_odds: FloatArray, contact: bool | None = None) -> float:
    """P(somebody) by how it looks, and by whether it looks at who watches (None: that is not known); even odds
    before."""
    met, meets = {None: (1.0, 1.0), True: CONTACT, False: (1 - CONTACT[0], 1 - CONTACT[1])}[contact]
    return float(1 / (1 + np.exp(-(np.mean(log_odds) + np.log(met / meets)))))


class Shown(NamedTuple):
    """One condition, as one imitator sees it."""

    rows: list[int]
    """Which tries were shown."""
    seen: list[Presentation]
    target: int
    """The state that is asked for."""
    body: str = "person"
    contact: bool = True
    hands: int = HANDS.index("free")


def presented(
    condition: str, toy: str, looks: dict[str, Looks], count: int, rng: np.random.Generator, itself: bool = False
) -> Shown | None:
    """What an imitator is shown in a condition; None where no try of the adult's is such a one.

    Args:
        condition: see `experiments.intentions.options`.
        toy: with what.
        looks: by object; the panel with hands bound is `panel:busy`.
        count: how often.
        rng: which tries.
        itself: see `How.as_itself`.
    """
    show = SHOWS[toy]
    target, act = STATES.index(show.target), NAMES.index(show.act)
    if condition.endswith(NOTHING):
        return Shown([], [], target)
    busy = condition == "head_bound"
    look = looks[f"{toy}:busy" if busy else toy]
    left, kept_on = [False] * count, [True] * (count - 1) + [False]
    hands = HANDS.index("busy" if busy else "free")
    device_ = condition.startswith("device")
    if condition in ("intended", "accidental"):
        return _two(toy, look, rng, itself, wanted=condition == "intended")
    if condition == "manipulation":
        handling = np.isin(look.trials.which, [NAMES.index(name) for name in HANDLING])
        rows, again = np.flatnonzero(handling & (look.trials.states != target)), left
    elif condition in IN_VAIN:
        rows, again = look.trials.rows(act, never=target), kept_on
    else:  # target, device_success, head
        rows, again = look.trials.rows(act, target), left
    if not len(rows):
        return None
    picked = rng.choice(rows, count, replace=len(rows) < count).tolist()
    seen = [look.presentation(row, more, itself) for row, more in zip(picked, again, strict=True)]
    contact = not (device_ or condition == "failed_unlooked")
    return Shown(picked, seen, target, "poles and pincers" if device_ else "person", contact, hands)


def _two(toy: str, look: Looks, rng: np.random.Generator, itself: bool, wanted: bool) -> Shown | None:
    """Two effects, one of them by accident: it is taken up again at once. What is asked is whether the one that was
    wanted comes about, or the accident."""
    one, other = SHOWS[toy], TWO_EFFECTS[toy]
    pairs = [(NAMES.index(one.act), STATES.index(one.target)), (NAMES.index(other[0]), STATES.index(other[1]))]
    meant, accident = pairs if rng.random() < 0.5 else pairs[::-1]
    rows = [look.trials.rows(*pair) for pair in (meant, accident)]
    if not all(map(len, rows)):
        return None
    pair = [(int(rng.choice(rows[0])), False), (int(rng.choice(rows[1])), True)]
    order = pair if rng.random() < 0.5 else pair[::-1]
    seen = [look.presentation(row, again, itself) for row, again in order]
    return Shown([row for row, _ in order], seen, meant[1] if wanted else accident[1])
