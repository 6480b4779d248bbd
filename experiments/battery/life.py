"""One mind that grows: it babbles its body, watches itself, looks about, plays; what comes later builds on that.

What a later stage needs of an earlier one it takes from there: a stage left out is an ablation.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from babbling.body_image import BodyImage
from babbling.errors import BabblingError
from babbling.mind import Mind, Temper
from babbling.pilot import begin
from babbling.play import Play
from experiments.battery.films import OFF, Camera, Film, Shot, babble, handling
from experiments.battery.parameters import ALIKE, Parameters
from experiments.intentions.options import CONDITIONS
from experiments.intentions.showing import SHOWS
from experiments.intentions.study import OBJECTS
from experiments.intentions.trials import Trials, done, trials
from experiments.objects.showing import ROOM_TABLE_M, Act, demonstrated
from experiments.shared.children import Child
from experiments.shared.minds import body_of, learn_mind
from experiments.shared.mirrors import image_of, look_into_mirror
from experiments.shared.options import BodyOptions
from experiments.shared.playing import CANDIDATES, SEATED, Tried
from experiments.shared.rounds import PLAYED, empty, look_at_hands, play_on
from imitation.acting.primitives import NAMES
from models.objects.states import STATES, Watched

GLIMPSE_MINUTES = 0.3
"""Before a mirror, of those who are said to have had none."""
LONGER = 2
"""An adult has played so many times as long."""
EACH, MEANS, CARELESS = 1, 4, 12
"""Tries of every primitive with a thing, more of those that bring its target about, and, of adults, careless ones."""


UNPLAYED_CONDITIONS = ("target", "failed")
"""That those meet who never played."""


@dataclass(frozen=True)
class Life:
    """Of one agent, before it is lived."""

    agent: int
    seed: int
    how: Parameters
    things: tuple[str, ...]

    def childhood(self, part: str) -> tuple[object, ...]:
        """What a part of it depends on (see `ALIKE`)."""
        return (self.seed, self.things, *(getattr(self.how, name) for name in ALIKE[part]))

    @property
    def body(self) -> BodyOptions:
        """HOAP-2 on its seat: the body of all stages."""
        return BodyOptions(robot=SEATED, seed=self.seed, threads=1)

    def rng(self, *what: int) -> np.random.Generator:
        """Of one thing in this life."""
        return np.random.default_rng([self.seed, 0xBA77, *what])


@dataclass(frozen=True, eq=False)
class Grown:
    """What a life has left in one mind before it meets others."""

    life: Life
    mind: Mind
    limbs: BodyImage
    """Where its parts point, from the mirror."""
    glimpsed: BodyImage | None
    """The same from a glimpse into it; None where that showed nothing."""
    hands: BodyImage
    """Where its hands, forehead, elbows and shoulders are seen."""
    child: Child
    """Who has played."""
    own: dict[str, Trials]
    """By thing, tries from which it does not learn: what becomes of what it does."""


def grown(life: Life, camera: Camera = OFF) -> Grown:
    """Body babbling, watching oneself, play."""
    child = _child(life)
    mind, minutes = child.mind, life.how.mirror_minutes
    mirrored = look_into_mirror(life.body, mind.pilot, minutes, life.how.seeing_noise_deg)
    limbs, glimpsed = image_of(mirrored, life.body, mind.pilot), None
    camera.take("parts-1", lambda: babble(body_of(life.body, 1), mind.pilot, limbs, mirrored))
    with suppress(BabblingError):
        glimpsed = image_of(mirrored.first(GLIMPSE_MINUTES), life.body, mind.pilot)
    outline = look_at_hands(mind, life.seed, outline=True, minutes=minutes)
    return Grown(life, mind, limbs, glimpsed, outline, child, pool(child, life.seed, life.things))


def _child(life: Life) -> Child:
    """Who has babbled, looked at its hands, and played, if there is anything to play with."""
    quiet, how, things = (lambda share: None), life.how, played_with(life)
    minutes, seconds = how.babbling_minutes, how.rehearsal_s
    mind = learn_mind(life.body, minutes, quiet, candidates=CANDIDATES, rehearsal_s=seconds, judged=False).mind
    image = look_at_hands(mind, life.seed, minutes=how.mirror_minutes)
    nothing, rounds = empty(mind, things or PLAYED), how.play_rounds if things else 0
    return Child(mind, image, play_on(mind, image, nothing, things, rounds, life.seed, 1))


def played_with(life: Life) -> tuple[str, ...]:
    """Things; the panel with hands bound too."""
    return tuple(thing for one in life.things for thing in ((one, f"{one}:busy") if one == "panel" else (one,)))


def hardly_babbled(life: Life) -> Mind:
    """The ablation: a mind that knows what the first seconds of one body told it."""
    body = body_of(life.body, 1)
    found, model = begin(body, life.seed)
    return Mind(body.fingerprint, life.seed, found, model, Temper.cautious(len(model.factors)))


def unplayed(whole: Grown) -> Grown:
    """The ablation: it never played."""
    nothing: Play = whole.child.play.nothing()
    child = replace(whole.child, play=nothing)
    met = {toy for condition in UNPLAYED_CONDITIONS for toy in CONDITIONS[condition]}
    things = [thing for thing in whole.life.things if thing in met]
    return replace(whole, child=child, own=pool(child, whole.life.seed, things, means=0))


def pool(child: Child, number: int, things: Sequence[str], careless: int = 0, means: int = MEANS) -> dict[str, Trials]:
    """By thing, tries of this child in physics from which nobody learns: what becomes of what it does."""
    found = {}
    for thing in things:
        toy, _, hands = thing.partition(":")
        first = 1_000_000 + 10_000 * number + 1000 * OBJECTS.index(thing)
        how = {"each": EACH, "means": means, "careless": careless}
        found[thing] = trials(child, toy, SHOWS[toy].act, SHOWS[toy].target, first, busy=bool(hands), **how)
    return found


@dataclass(frozen=True, eq=False)
class Adult:
    """Whom agents watch: skilled, of the same kind of body."""

    tries: dict[str, Trials]
    touches: dict[str, Act]
    """With the forehead in the usual room, in another, and handling alone."""
    films: dict[str, Film] = field(default_factory=dict)


def adult(life: Life, *, filmed: Life | None = None) -> Adult:
    """Grown like all, played longer, and shows what there is to be seen; films of the one that is `filmed`."""
    longer = replace(life, how=replace(life.how, play_rounds=LONGER * life.how.play_rounds))
    child, camera = _child(longer), Camera(life == filmed)
    tries = pool(child, life.seed, played_with(life), CARELESS)
    shown = (("live", "press with the head", "lit by head", None), ("handled", "lift with both", None, None),
             ("room", "press with the head", "lit by head", ROOM_TABLE_M))  # fmt: skip
    touches = {
        name: demonstrated(child, "panel", act, state, 8, life.seed, table=table, keep=camera.on)
        for name, act, state, table in shown
    }
    live = touches["live"]
    camera.take("touch-1", lambda: handling("an adult", "panel", live.tried, int(live.rows[0])))
    camera.take("intentions-1", lambda: _in_vain(child, life.seed))
    return Adult(tries, {name: _light(act) for name, act in touches.items()}, camera.films)


def _in_vain(child: Child, number: int) -> Shot:
    """An act with the dumbbell that fails, if one of a few careless ones does."""
    show = SHOWS["dumbbell"]
    which, careless = np.full(CARELESS, NAMES.index(show.act)), np.ones(CARELESS, bool)
    tries, tried = done(child, "dumbbell", which, careless, number, keep=True)
    failed = tries.rows(never=STATES.index(show.target))
    return handling("an adult", "dumbbell", tried, int(failed[0]) if len(failed) else 0)


def _light(act: Act) -> Act:
    """Without the physics: what is seen of it is kept."""
    none = np.zeros(0)
    blank = Watched(none, none, none > 0)
    kept = ("tick_s", "which", "aims", "seen", "true")
    bare: dict[str, Any] = {one.name: none for one in fields(Tried) if one.name not in kept}
    return replace(act, tried=replace(act.tried, seen=blank, true=blank, **bare))
