"""Stages one and two: whose part moved, and doing the movement that was seen, by the mind that babbled."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from babbling.axes import FloatArray
from babbling.body_image import BodyImage
from babbling.mind import Mind
from experiments.battery.films import OFF, Camera
from experiments.battery.life import Grown, hardly_babbled
from experiments.battery.table import IMITATOR, WHOLE, Trial
from experiments.correspondence.acts import act
from experiments.shared.baselines import direct_replay
from experiments.shared.film import shot
from experiments.shared.judging import rmse_deg
from experiments.shared.minds import body_of
from experiments.shared.mirrors import Pupil, limbs_off_deg
from experiments.shared.oracle import at_ticks
from experiments.shared.peers import inverse_line
from experiments.shared.watching import Seen, watch
from imitation.acting.loop import imitate
from imitation.acting.rehearsal import REHEARSERS, best_eagerness
from imitation.correspondence.organ import identify
from models.body import SimulatedBody
from models.mirror import Mirror, blurred

SHOWN = ("icub-wave", "romeo-bow")
"""Movements of robots of other proportions."""
ACTS = 12
"""Single acts, each of a random part of a random robot."""
TASKS = ("movement, against its sub-goals", "movement, against the teacher")
ASTRAY = 1
"""Seed of the wiring of another's body."""


def movements(who: Grown, camera: Camera = OFF) -> Iterator[Trial]:
    """All rows of these stages, ablations among them."""
    life, body = who.life, body_of(who.life.body, 1, stream=3)
    for without, limbs in ((WHOLE, who.limbs), ("mirror", who.glimpsed)):
        rng = life.rng(1)
        for number in range(ACTS):
            part, shown = act(who.limbs.parts, life.seed + number, rng)
            shown = blurred(shown, float(np.deg2rad(life.how.seeing_noise_deg)), rng)
            found = -1 if limbs is None else identify(limbs.organs, shown, body.tick_s).part
            said, right = ("nothing", *who.limbs.parts)[found + 1], who.limbs.parts[part]
            yield Trial(life.agent, life.seed, without, IMITATOR, 1, "whose part", "single act", number, said, right,
                        float(said == right))  # fmt: skip
    hardly, line = hardly_babbled(life), inverse_line(who.mind.forward_model)
    rehearsers = body_of(life.body, REHEARSERS, stream=1)
    eager = best_eagerness(rehearsers, who.mind, line, life.seed, life.how.rehearsal_s)
    for name in SHOWN[: life.how.movements]:
        yield from _imitated(who, name, body, hardly, {"inverse": line, "eagerness": eager}, camera)


def _imitated(who: Grown, name: str, body: SimulatedBody, hardly: Mind, line: dict[str, object], camera: Camera
) -> Iterator[Trial]:  # fmt: skip
    life, mind = who.life, who.mind
    plain = watch(name, body)
    seen = _understood(who, who.limbs, plain, body)
    elsewhere = body_of(replace(life.body, scramble=ASTRAY), 1, stream=3)

    def done(robot: SimulatedBody, **how: object) -> FloatArray:
        how = {"mind": mind, "movement": seen.movement} | how
        attempt = imitate(robot, rng=life.rng(3), witness=lambda: robot.joint_angles, **how)[0]  # type: ignore[arg-type]
        return np.asarray(attempt.truth[:, 0])

    body.reset()
    rest = np.broadcast_to(body.joint_angles[0], seen.angles.shape)
    own = done(body)
    ghost = body.configurations(seen.angles)
    camera.take("movements-1", lambda: shot(name, body, body.configurations(own), ghost, plain.performance))
    ways = [
        (WHOLE, IMITATOR, own, seen),
        (WHOLE, "inverse line", done(body, **line), seen),
        (WHOLE, "direct replay", direct_replay(body, seen.angles), seen),
        (WHOLE, "stays at rest", rest, seen),
        ("babbling", IMITATOR, done(body, mind=hardly), seen),
        ("own body", IMITATOR, done(elsewhere, mind=replace(mind, fingerprint=elsewhere.fingerprint)), seen),
    ]
    if who.glimpsed is None:
        ways.append(("mirror", IMITATOR, rest, seen))  # it knows of no part what it shows
    else:
        poorly = _understood(who, who.glimpsed, plain, body)
        ways.append(("mirror", IMITATOR, done(body, movement=poorly.movement), poorly))
    for without, peer, angles, goal in ways:
        missed = rmse_deg(angles, goal.angles), _pointed(body, angles, goal)
        for task, error in zip(TASKS, missed, strict=True):
            if without == "mirror" and task == TASKS[0]:  # its sub-goals are not those of the others
                continue
            yield Trial(life.agent, life.seed, without, peer, 2, task, name, 0, "", "", np.nan, error, "deg")


def _understood(who: Grown, limbs: BodyImage, seen: Seen, body: SimulatedBody) -> Seen:
    pupil = Pupil(body, who.mind.pilot, limbs, who.life.how.seeing_noise_deg)
    assert seen.performance is not None
    return seen.learning(pupil.follow(seen.performance, who.life.rng(2)), body)


def _pointed(body: SimulatedBody, angles: FloatArray, seen: Seen) -> float:
    """Mean angle between where its parts pointed and the teacher's did, degrees."""
    assert seen.teacher is not None
    mirror, showed, frames = Mirror(body), at_ticks(seen.teacher, body.tick_s), len(angles)
    aims = {part: showed[part][:frames] for part in mirror.parts if part in showed}
    return float(limbs_off_deg(mirror, angles[: len(next(iter(aims.values())))], aims).mean())
