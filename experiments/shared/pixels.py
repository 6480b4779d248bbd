"""Seeing a table by two retinas: one's own eyes are learned by watching one's hands, others are watched from a room."""

from dataclasses import replace

import numpy as np

from babbling.axes import FloatArray
from babbling.body_image import BodyImage
from babbling.mind import Mind
from babbling.mirroring import mirror_babble
from babbling.own_eyes import OwnEyes, learn_own_eyes
from experiments.shared.playing import SEATED, Look, points
from imitation.acting.reaching import places
from imitation.seeing.marks import bridged, centred, located, marks
from models.body import SimulatedBody
from models.loading import load_body
from models.objects.playing import PlayBody
from models.objects.retinas import Retinas, Room
from models.objects.scene import PARTS
from models.robots import ROBOTS

WATCHING_COPIES, WATCHING_MINUTES = 16, 16.0
"""Of watching one's own hands."""
EVERY = 12
"""Ticks between two looks at one's hands: less apart they look alike."""
BEFORE_ONE = 0.5
"""Share of every motor's range, about rest, that keeps hands before one's eyes."""
LOOKED = 3
"""Looks at an act of which one is by pixels, besides close ones."""
ROW = 0.03
"""Greatest difference between rows, focal lengths, of a thing that is looked at: a little of it may be hidden from one
eye."""


def eyes_see(
    retinas: Retinas,
    configuration: FloatArray,
    rng: np.random.Generator,
    laid: FloatArray | tuple[()] = (),
    *,
    cut: bool = False,
) -> FloatArray:
    """(cameras, 5, 2) `centred` marks on what its cameras show; see `marks`."""
    shown = zip(retinas.eyes, retinas.see(configuration, rng, laid), strict=True)
    return np.array(
        [centred(marks(image, cut=cut), eye.options.width, eye.options.height, eye.focal_px) for eye, image in shown]
    )


class Watching:
    """Where one's hands are seen while one babbles: `babbling.mirroring.Mirror` by pixels, (B, 2 eyes, 2 hands, 2)."""

    parts = ("left hand", "right hand")

    def __init__(self, body: SimulatedBody, seed: int, every: int = EVERY) -> None:
        robot = ROBOTS[SEATED]
        assert robot.seat is not None
        self._body, self._retinas, self._every, self._looks = body, Retinas(robot, robot.seat), every, 0
        self._rng = np.random.default_rng([seed, 0xE7E5])

    def look(self) -> FloatArray:
        """What is seen now; NaN where one does not look."""
        seen = np.full((self._body.copies, 2, len(self.parts), 2), np.nan)
        if self._looks % self._every == 0:
            for copy, configuration in enumerate(np.asarray(self._body.batch.qpos)):
                seen[copy] = eyes_see(self._retinas, configuration, self._rng)[:, : len(self.parts)]
        self._looks += 1
        return seen


def watch_hands(mind: Mind, image: BodyImage, seed: int, minutes: float = WATCHING_MINUTES) -> OwnEyes:
    """Where things are that one's eyes see, learned by moving one's hands before them."""
    body, motors = load_body(SEATED, copies=WATCHING_COPIES, seed=seed), mind.pilot.motors
    low, high = (motors.rest + BEFORE_ONE * (end - motors.rest) for end in (motors.low, motors.high))
    near = replace(motors, low=low, high=high)
    seen = mirror_babble(body, Watching(body, seed), mind.pilot.schema, near, minutes, seed)
    looked = ~np.isnan(seen.directions).all((2, 3, 4))
    looks = seen.directions[looked].swapaxes(0, 1)
    postures = seen.postures[looked]
    hands = places(image, postures)[:, : len(Watching.parts)]
    return learn_own_eyes(looks, postures, hands, image.images[image.parts[-1]], image.fingerprint)


def pixels(eyes: OwnEyes, image: BodyImage, every: int = LOOKED) -> Look:
    """Hands and forehead are where the body image foretells them for the felt posture; a and b where one's eyes show,
    NaN where they do not, or where one does not look."""
    before: tuple[PlayBody, Retinas] | None = None
    looks = 0

    def look(body: PlayBody, felt: FloatArray, closely: bool, rng: np.random.Generator) -> FloatArray:
        nonlocal before, looks
        if before is None or before[0] is not body:
            before = body, Retinas.of(body)
        looks = 0 if body.time == 0 else looks + 1
        things = np.full((body.copies, 2, 3), np.nan)
        if closely or looks % every == 0:
            each = zip(body.configuration, body.laid, strict=True)
            seen = np.stack([eyes_see(before[1], q, rng, laid, cut=True)[:, PARTS:] for q, laid in each], 1)
            things = eyes.locate(seen, felt, ROW)
        return np.concatenate([places(image, felt), things], 1)

    return look


def sight(eyes: OwnEyes | None, image: BodyImage) -> Look:
    """By one's own eyes, of one who has learned to use them; otherwise as points."""
    return points() if eyes is None else pixels(eyes, image)


def film(
    body: PlayBody, configurations: FloatArray, laid: FloatArray, room: Room, rng: np.random.Generator
) -> FloatArray:
    """What somebody who watches an act sees of it.

    Args:
        body: whoever does it (the scene is taken from it).
        configurations: (T, nq) of one copy at T looks.
        laid: (pieces, 7) see `PlayBody.laid`, of that copy.
        room: from where; two cameras see depth, one does not.
        rng: of the retinas.

    Returns: (T, 5, 3) m ahead, left and up of the watcher, or (T, 5, 2) u, v on the one image in focal lengths: left
        and right hand, forehead, a and b, short gaps bridged, NaN where hidden for longer.
    """
    retinas = Retinas.of(body, room=room)
    seen = np.stack([eyes_see(retinas, one, rng, laid) for one in configurations], 1)
    return bridged(located(seen, room.apart) if room.apart else seen[0])
