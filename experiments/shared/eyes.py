"""Eyes, toys and minds: what the experiments with a seeing head share."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from babbling.axes import FloatArray
from babbling.forward_model import ForwardModel
from babbling.looking import PILOT_TICKS, LookingMind, LookingPilot, Reach, pilot_looking
from babbling.loop import Transitions, babble, bouts
from babbling.pilot import REST_S, SETTLE_S, WIRING_S
from experiments.shared.options import EyeOptions
from experiments.shared.progress import Report, ticking
from imitation.seeing.features import COLOURS
from imitation.seeing.finding import Finder
from models.biclops.room import Ball
from models.heads import clear_away, stage
from models.retina import RetinaOptions
from models.robots import EYE_HEIGHT, head_of
from models.seeing_body import Perceive, SeeingBody

TOYS = tuple(COLOURS)
"""Toys hang about the head, one of each colour."""
TOY_RADIUS = 0.03
LEAST_TOY = 10.0
"""Square pixels at 160 x 120, a fifth of what a toy covers; less of it is no toy."""
TOY_DISTANCE = (0.9, 1.1)
"""m: about an arm's length of an adult; a much nearer toy would move otherwise (parallax)."""
TOY_BEARING, TOY_ELEVATION = 0.85, (-0.80, 0.50)
"""rad, largest bearing to either side and range of elevations."""
APART = np.deg2rad(13.0)
SACCADE_S = 1.4
"""s between saccades: the slowest of them (tilt, 30 degrees at 80 degrees/s^2) takes 1.23 s."""
COPIES = 16
"""Heads that babble side by side, each before toys hung up its own way."""
BOUT = 6
"""Saccades between two rests."""
REACH_PAN, LARGEST = 0.70, (0.56, 0.44)
"""rad: pan to either side, and saccades, that are babbled."""


def retina_of(eyes: EyeOptions) -> RetinaOptions:
    """Checked options of both retinas."""
    return RetinaOptions(eyes.width, eyes.height, eyes.fovy_deg, eyes.noise, eyes.blur)


def open_eyes(
    eyes: EyeOptions,
    perceive: Perceive,
    *,
    copies: int,
    tick_s: float,
    seed: int,
    rest: tuple[float, float] | None = None,
    teacher: bool = False,
    distance: float = 0.8,
    balls: Sequence[Ball] = (),
) -> SeeingBody:
    """Heads with these eyes on a stage; see `models.heads.stage` and `SeeingBody`."""
    model = stage(eyes.robot, teacher=teacher, distance=distance, balls=balls).compile()
    return SeeingBody(
        model, eyes.robot, perceive, retina=retina_of(eyes), renderer=eyes.renderer, copies=copies, tick_s=tick_s,
        seed=seed, rest=rest, scramble=eyes.scramble, squinting=eyes.squint,
    )  # fmt: skip


def reach_of(robot: str) -> Reach:
    """Postures that are babbled."""
    low, high = head_of(robot).tilt
    return Reach(np.array([-REACH_PAN, low]), np.array([REACH_PAN, high]), np.array(LARGEST))


def toy_places(copies: int, seed: int) -> FloatArray:
    """(K, copies, 3) where toys hang: random directions at least `APART`, in the table's frame."""
    rng = np.random.default_rng([seed, 0x701])
    places = np.empty((len(TOYS), copies, 3))
    for copy in range(copies):
        found: list[FloatArray] = []
        while len(found) < len(TOYS):
            bearing, elevation = rng.uniform(-TOY_BEARING, TOY_BEARING), rng.uniform(*TOY_ELEVATION)
            way = np.array(
                [np.cos(elevation) * np.cos(bearing), np.cos(elevation) * np.sin(bearing), np.sin(elevation)]
            )
            if all(way @ other < np.cos(APART) for other in found):
                found.append(way)
        distance = rng.uniform(*TOY_DISTANCE, (len(TOYS), 1))
        places[:, copy] = np.array(found) * distance + (0.0, 0.0, EYE_HEIGHT)
    return places


def nursery(options: EyeOptions, seed: int, copies: int = COPIES) -> SeeingBody:
    """Heads among toys."""
    balls = [Ball(name, (1.0, 0.0, 0.2), COLOURS[name], TOY_RADIUS) for name in TOYS]
    find = Finder(TOYS, LEAST_TOY * (options.height / 120) ** 2)
    body = open_eyes(options, find, copies=copies, tick_s=SACCADE_S, seed=seed, balls=balls)
    clear_away(body.model, "table")  # toys hang below its top too
    for name, places in zip(TOYS, toy_places(copies, seed), strict=True):
        body.place(name, places)
    return body


@dataclass(frozen=True)
class _Noting(LookingPilot):
    """Notes transitions beside reading them: for peers that learn from the very same experience."""

    notes: list[Transitions]

    def transitions(self, before: FloatArray, motors: FloatArray, after: FloatArray) -> Transitions:
        """As any pilot of looking reads them."""
        self.notes.append(super().transitions(before, motors, after))
        return self.notes[-1]


def learn_to_look(
    body: SeeingBody,
    minutes: float,
    seed: int,
    after_bout: Callable[[float, LookingMind], None] | None = None,
    notes: list[Transitions] | None = None,
    report: Report = lambda done: None,
) -> LookingMind:
    """Pilot and so many body-minutes of saccades; with `notes`, their transitions are kept there too.

    Raises:
        BabblingError: no time at all.
    """
    plan = bouts(minutes, body, BOUT)
    reach, line = reach_of(body.robot), body.wiring.sense  # of pan and of tilt; told by sense line, as ranges are
    first = round((SETTLE_S + REST_S + WIRING_S) / body.tick_s) + PILOT_TICKS
    with ticking(body, report, first + sum(plan)):
        found = pilot_looking(body, Reach(reach.low[line], reach.high[line], reach.largest[line]), seed)
    done = np.cumsum(plan) * body.tick_s * body.copies / 60

    def told(bout: int, model: ForwardModel) -> None:
        if after_bout is not None:
            after_bout(bout / len(plan), LookingMind(found, model, float(done[bout - 1])))

    babbler = found if notes is None else _Noting(**vars(found), notes=notes)
    with ticking(body, report, first + sum(plan), first):
        model = babble(body, babbler, plan, seed, after_bout=told)
    return LookingMind(found, model, float(done[-1]))
