"""One episode of gaze following, frame by frame: the teacher turns, beliefs move, the imitator looks there."""

from typing import NamedTuple

import numpy as np

from babbling.axes import FloatArray
from experiments.gaze.trials import TOYS, Watcher, table_body, tilt_of, toys_seen, view
from experiments.shared.caregiver import FACE, face_numbers
from imitation.gaze.fixation import Fixation
from imitation.gaze.reader import Preferences
from imitation.seeing.pose import LiveWatch
from models.biclops.gaze import lay_out, look_at
from models.biclops.movements import through
from models.biclops.room import wear_cloth
from models.heads import PARKED
from models.onlooker import Onlooked, onlook
from models.retina import Image

FRAME_S = 0.04
REST_S, STAY_S, LOOK_S = 0.6, 0.7, 1.4


class Following(NamedTuple):
    """T frames; angles in rad, pixels on the image."""

    names: tuple[str, ...]
    target: int
    images: list[tuple[Image, Image]]
    found: FloatArray
    """(T, K, 2 eyes, 2) every feature that was found; NaN unseen."""
    predicted: FloatArray
    """(T, G, 2 eyes, 2) where toys were expected once the eyes had moved; NaN before."""
    own: FloatArray
    """(T, 2) true pan and tilt."""
    teacher: FloatArray
    """(T, 2) true pan and tilt of the teacher."""
    estimated: FloatArray
    """(T, 2) the teacher's as estimated; NaN when nothing was."""
    probability: FloatArray
    """(T, G)"""
    events: list[tuple[float, str]]
    """Seconds and what happened."""
    seen: Onlooked
    """The stage as an onlooker sees it."""
    expected: FloatArray
    """(G, 2) the poses that Eq. (1) expects for each toy, "like me"."""


def episode(who: Watcher, layout: FloatArray | None, target: int, seed: int) -> Following:
    """One teacher, one look."""
    config, mind, appearance, head, gaze = who
    rng = np.random.default_rng([seed, 0xE91])
    body = table_body(config, 1, seed + 21, FRAME_S)
    wear_cloth(body.model, None)
    places = lay_out(rng, 4, config.distance, view(config), (15.0, 180.0)) if layout is None else layout
    count = len(places)
    names = TOYS[:count]
    goal = int(rng.integers(count)) if target == 0 else target - 1
    for number, name in enumerate(TOYS):
        body.place(name, places[number] if number < count else np.array(PARKED))
    aim = look_at(places[goal], config.distance) + np.deg2rad(config.aim_deg) * rng.standard_normal(2)
    path = through(np.array([[0.0, 0.0], np.rad2deg(aim)]), np.array([REST_S, STAY_S]))
    body.teacher_path = lambda t: path[min(round(t / 0.02), len(path) - 1)][None]
    centre = mind.pilot.retina.centre.reshape(2, 2)
    frames: list[tuple[FloatArray, ...]] = []
    images: list[tuple[Image, Image]] = []
    events: list[tuple[float, str]] = [(0.0, "watches the teacher")]
    watching = LiveWatch(appearance, FRAME_S)
    senses = body.reset()
    nothing = np.full((count, 2, 2), np.nan)

    def note(pose: FloatArray, belief: FloatArray, predicted: FloatArray) -> None:
        found = body.senses.read(senses, "place", (*FACE, *names))[0]
        frames.append((found, predicted, body.joint_angles[0].copy(), body.teacher_angles[0].copy(), pose, belief))
        images.append(body.images[0])

    rest = body.command_angles(body.rest[None])
    belief, leader = np.full(count, 1 / count), -1
    looks = round((len(path) * 0.02) / FRAME_S)
    for frame in range(looks):
        if frame:
            senses = body.act(rest)
        face, (things, area) = face_numbers(body, senses)[0], toys_seen(body, senses, mind, names)
        watching.ahead()
        pose = watching.see(face).mean[:2]
        where = gaze.geometry.locate(things[0], tilt_of(mind, senses)[0])
        if np.isfinite(where).all() and watching.belief is not None:
            prior = Preferences().prior(names, np.sqrt(np.maximum(area[0], 1.0)))
            posterior = gaze.read(pose, gaze.expected(where, head), prior)
            belief = posterior.probability if posterior.informed else prior
            best = int(belief.argmax())
            if best != leader and belief[best] > 0.5:
                events.append((frame * FRAME_S, f"thinks: {names[best]} ({belief[best]:.2f})"))
                leader = best
        note(pose.copy(), belief.copy(), nothing)
    chosen = int(belief.argmax())
    fixation = Fixation(mind)
    for number in range(2):
        things, posture = toys_seen(body, senses, mind, names)[0], mind.pilot.posture(senses)
        saccade = fixation.choose(np.nan_to_num(things[:, chosen]), posture, rng)
        events.append((len(images) * FRAME_S, f"looks at {names[chosen]}" if not number else "corrects"))
        after = mind.expect(things[0], np.repeat(posture, count, 0), np.repeat(saccade.change, count, 0))
        predicted = after.reshape(count, 2, 2) + centre
        command = mind.pilot.schema.motors(posture + saccade.change)
        for _ in range(round((LOOK_S if not number else 0.4) / FRAME_S)):
            senses = body.act(command)
            note(np.full(2, np.nan), belief.copy(), predicted)
    away = float(np.hypot(*toys_seen(body, senses, mind, names)[0][0, chosen, :2]))
    right = "the teacher's toy" if chosen == goal else f"not the teacher's, which is {names[goal]}"
    events.append((len(images) * FRAME_S, f"sees {names[chosen]} {away:.2f} px from the middle: {right}"))
    found, predicted, own, teacher, poses, beliefs = (np.stack(column) for column in zip(*frames, strict=True))
    seen = onlook(body.model, config.robot, own, teacher, dict(zip(names, places, strict=True)))
    expected = gaze.expected(where, head)
    return Following(names, goal, images, found, predicted, own, teacher, poses, beliefs, events, seen, expected)
