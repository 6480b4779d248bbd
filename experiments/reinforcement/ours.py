"""The imitator, watched by the same counters: the pilot, babbling, rehearsal, and a first attempt after each."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from babbling.axes import FloatArray
from babbling.loop import babble, bouts
from babbling.mind import Mind, Temper
from babbling.pilot import begin, pilot_minutes
from experiments.reinforcement.found import Point
from experiments.shared.judging import rmse
from experiments.shared.minds import body_of, copies_for
from experiments.shared.options import BodyOptions
from experiments.shared.peers import inverse_line
from imitation.acting.loop import imitate
from imitation.acting.movement import Movement
from imitation.acting.rehearsal import REHEARSERS, best_eagerness, rehearse
from models.risk import Risks, WatchedBody


class Life(NamedTuple):
    """What became of one mind."""

    points: list[Point]
    """After its pilot, after babbling, and after rehearsal too: the last is the imitator of `imitate gesture`."""
    line: float
    """What its inverse line is off by in the same loop; see `Point.error`."""


def live(task: tuple[BodyOptions, FloatArray, float]) -> Life:
    """A mind learns its body in so many minutes, its rehearsal not counted in, and tries (T, J) joint angles."""
    options, angles, minutes = task
    copies = copies_for(minutes)
    body = WatchedBody(body_of(options, copies))
    found, model = begin(body, options.seed)
    temper = Temper.cautious(len(model.factors))

    def mind() -> Mind:
        return Mind(body.fingerprint, options.seed, found, model, temper)

    points = [attempt(options, mind(), angles, body.risks)]
    more = minutes - pilot_minutes(copies)
    if more * 60 > body.tick_s * copies:
        reseeding: Callable[[int, object], None] = lambda done, _: body.body.reseed(1 + done)  # noqa: E731
        reseeding(0, None)
        babble(body, found, bouts(more, body), options.seed, onto=model, after_bout=reseeding)
        points.append(attempt(options, mind(), angles, body.risks))
    rehearsers = WatchedBody(body_of(options, REHEARSERS, stream=1))
    ready = rehearse(rehearsers, mind(), options.seed)
    points.append(attempt(options, ready, angles, body.risks.more(rehearsers.risks)))
    line = inverse_line(model)
    eagerness = best_eagerness(body_of(options, REHEARSERS, stream=1), ready, line, options.seed)
    return Life(points, attempt(options, ready, angles, body.risks, inverse=line, eagerness=eagerness).error)


def attempt(options: BodyOptions, mind: Mind, angles: FloatArray, before: Risks, **how: Any) -> Point:
    """One attempt, its own risks counted in; see `imitate`."""
    body = WatchedBody(body_of(options, 1, stream=3))
    movement = Movement("the movement", body.tick_s, body.body.sensations(angles))
    rng = np.random.default_rng([options.seed, 8])
    [done] = imitate(body, movement, mind, rng=rng, witness=lambda: body.body.joint_angles, **how)
    scale = body.body.shown_scale
    return Point(before.more(body.risks), rmse(done.truth[:, 0] * scale, angles * scale))
