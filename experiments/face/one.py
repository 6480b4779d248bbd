"""One infant and one adult: babble, watch, try; or try what is remembered."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.dark import FaceMind, babble, learn
from babbling.files import load, save
from babbling.relations import MOUTH_M, RELATIONS
from experiments.face.answering import acted, comparable, understood
from experiments.face.infants import Group, joint_of_motor, rest_lines
from experiments.face.judging import MAIN, RANGE, WHOSE, labels, organs
from experiments.face.later import PASSIVE_ACTS
from experiments.face.mirroring import before_mirror
from experiments.face.once import NEUTRAL_TICKS, TICK_S, Done, Watched, named
from experiments.face.options import Config
from experiments.face.recording import record
from experiments.face.showing import Watcher, drawn, performed, still, truth
from experiments.face.shows import demo_figure
from experiments.face.theories import GESTURES
from experiments.shared.experiment import Result
from experiments.shared.progress import progress
from experiments.shared.tables import table
from imitation.correspondence.own_acts import OwnActs
from imitation.deferred import FaceMemory
from imitation.seeing.face_fit import Seen
from imitation.seeing.mirrored import Mirrored
from models.body import SimulatedBody
from models.face import face_of
from models.face.looks import View
from models.retina import Image


def one(config: Config) -> Result:
    """See the module."""
    face = face_of(config.face)
    group = Group(face, 0, 1, config.acts, config.seed, config.scramble)
    body = group.body(1)
    mind = born(config, body) if config.mind is None else load(config.mind, FaceMind)
    mind.check(body)
    acts, joints = OwnActs(mind), joint_of_motor(body)
    watched = None
    if config.memory is None:
        mirror = None
        if config.correspondence == "learned":
            mirror = before_mirror(body, face, mind, config.seed)
        watched = watch(config, acts, joints, mirror)
        memory, _ = understood(acts, watched.seen[-1], watched.neutral)
    else:
        memory = load(config.memory, FaceMemory)
        memory.check(mind.fingerprint, len(RELATIONS))
    stopped = None
    if config.pacifier:
        _, hindered = acted(group.body(1, pacifier=True), [mind], [memory], 1)
        stopped = named(labels(hindered[0, 0]))
        body.reset()
        rng = np.random.default_rng([config.seed, 0x9AC])
        for _ in range(PASSIVE_ACTS):
            command = mind.rest.copy()
            motor = int(rng.choice(mind.motors))
            command[motor] = rng.uniform(body.motor_low[motor], body.motor_high[motor])
            body.act(command[None])
    tried, true = acted(body, [mind], [memory], config.tries, reset=not config.pacifier)
    done = Done(config, group, mind, watched, memory, tried, true[:, 0], stopped)
    metrics = told(done)
    summary = f"# A face\n\n{table(rows(done, metrics))}"
    files = {"mind.nc": partial(save, mind), "memory.nc": partial(save, memory)}
    return Result(
        metrics, summary, {"imitated": demo_figure(done, metrics)}, lambda path: record(path, done, summary), files
    )


def born(config: Config, body: SimulatedBody) -> FaceMind:
    """Body babbling in the dark."""
    with progress("babbling in the dark") as report:
        rng = np.random.default_rng([config.seed, 0xFACE, 0, 0])
        [acts] = babble(body, config.acts, rest_lines(body), [rng], lambda act: report((act + 1) / config.acts))
    return learn(acts, body.fingerprint)


def watch(config: Config, acts: OwnActs, joints: IntArray, mirror: Mirrored | None) -> Watched:
    """A gesture, seen frame by frame with both eyes; nothing is known of the face but how it looks at rest. Faces are
    understood by birthright, or by what a mirror showed."""
    adult, rng = face_of(config.adult), np.random.default_rng([config.seed, 0x5EE])
    shown = drawn(adult, GESTURES.index(config.gesture), config.strength == "strong", rng)
    moving = performed(adult, [shown], TICK_S)[:, 0]
    whole = np.concatenate([np.repeat(still(adult)[None], NEUTRAL_TICKS, 0), moving])
    watcher = Watcher.of(adult, View(config.distance, config.yaw_deg, config.pitch_deg), rng)
    seen, images, found = list[Seen](), list[tuple[Image, Image]](), list[FloatArray]()
    with progress("watching") as report:
        for frame in whole:
            what, numbers, looked = watcher.watch(frame, rng)
            if mirror is not None:
                what = mirror.see(numbers, watcher.passive)
            seen.append(what)
            images.append(looked)
            found.append(numbers)
            report(len(seen) / len(whole))
    neutral = watcher.neutral if mirror is None else mirror.see(watcher.passive, watcher.passive).relations
    beliefs = [organs(acts, understood(acts, what, neutral)[1], joints) for what in seen]
    relations = np.stack([comparable(acts.mind, what, neutral) for what in seen])
    true = truth(adult).of(whole[-1])
    return Watched(shown, watcher, whole, images, np.stack(found), seen, neutral, relations, np.stack(beliefs), true)


def told(done: Done) -> dict[str, Any]:
    """metrics.json."""
    found: dict[str, Any] = {
        "gesture": None if done.watched is None else done.config.gesture,
        "done": [named(label) for label in labels(done.true)],
        "target": dict(zip(RELATIONS, done.memory.relations, strict=True)),
        "moved": [name for name, moved in zip(RELATIONS, done.memory.moved, strict=True) if moved],
        "relations_by_try": done.true,
        "felt_by_try": done.tried.felt[:, 0],
        "with_pacifier": done.stopped,
    }
    if done.watched is not None:
        relation = int(MAIN[done.watched.shown.gesture])
        missed = np.abs(done.true - done.watched.true)[:, relation]
        found |= {
            "organ": dict(zip(WHOSE, done.watched.organs[-1], strict=True)),
            "shown": dict(zip(RELATIONS, done.watched.true, strict=True)),
            "match_error_share": missed / RANGE[relation],
            "tongue_error_mm": 1e3 * MOUTH_M * np.abs(done.true - done.watched.true)[:, 1],
        }
    return found


def rows(done: Done, m: dict[str, Any]) -> Sequence[tuple[str, str]]:
    """For people."""
    say = [("does", ", then ".join(dict.fromkeys(m["done"])))]
    if done.watched is not None:
        organ = max(m["organ"], key=lambda name: m["organ"][name])
        share = ", ".join(f"{value:.3f}" for value in m["match_error_share"])
        seen = f"{done.config.gesture}, {done.config.strength}, by {done.config.adult} at {done.config.distance:g} m"
        say = [
            ("was shown", seen),
            ("organ that moves, it seems", f"{organ} (P = {m['organ'][organ]:.2f})"),
            *([("with a pacifier in its mouth", str(done.stopped))] if done.stopped else []),
            *say,
            ("missed by try, share of the range", share),
        ]
    return say
