"""Correspondence: somebody else's limb directions become postures of one's own (chapter, sections 2.2, 3.2 and 3.5).

What is seen of a teacher is where its parts point, whatever its size, heading or joints: the supramodal state of the
chapter's Figure 9. What one's own parts look like in a posture was learned in front of a mirror (`BodyImage`). So a
movement that was seen is steadied (`steadying`), every own limb in turn is turned round by Eq. (1) (`inversion`), and
what comes out is smoothed into sub-goals that keep the limits (`smooth_path`).
No joint name, no limb length and no kinematics is used.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from babbling.axes import BoolArray, FloatArray
from babbling.body_image import Image
from babbling.mirroring import angles_between
from imitation.correspondence.inversion import LimbView, choose
from imitation.correspondence.limbs import own_limbs
from imitation.correspondence.smooth_path import smooth_path
from imitation.correspondence.steadying import steady
from imitation.errors import ImitationError

MARGIN = np.deg2rad(1.0)
"""Distance kept from the ends of the posture senses, rad."""
REACHABLE = np.deg2rad(5.0)
"""A direction that can be met this nearly is held while smoothing."""
LEAST_TRUST = 0.02


@dataclass(frozen=True)
class Corresponded:
    """A movement that was seen, as postures of one's own.

    postures: (T, F), one for every frame that was seen. slowed: how many times as long the body needs for them, 1 if it
    keeps up. parts: the P' parts that correspond. wanted: (T, P', 3) steadied directions. reachable: (T, P') whether a
    posture comes within REACHABLE of what is wanted, time left aside. moved: (T, P') by how much smoothing turned what
    is shown, as the body image has it, rad. noise: (P',) seeing noise per axis, rad. chosen: (T, F), before smoothing.
    seconds: processor time it took, all threads together.
    """

    postures: FloatArray
    slowed: float
    parts: tuple[str, ...]
    wanted: FloatArray
    reachable: BoolArray
    moved: FloatArray
    noise: FloatArray
    chosen: FloatArray
    seconds: float


def correspond(
    image: Image,
    name: str,
    seen: Mapping[str, FloatArray],
    tick_s: float,
    speed: FloatArray,
    visible: Mapping[str, BoolArray] | None = None,
) -> Corresponded:
    """Postures of one's own for a movement.

    Args:
        image: the learned body image.
        name: what people call the movement.
        seen: part -> (T, 3) directions in the teacher's torso's frame, one per tick.
        tick_s: duration of a tick.
        speed: (F,) limits, posture units per second.
        visible: part -> (T,) whether it was seen; parts not named were seen throughout.

    Raises:
        ImitationError: none of the parts is one of one's own, or lengths differ.
    """
    started = time.process_time()
    parts = tuple(part for part in image.parts if part in seen)
    if not parts:
        raise ImitationError(
            f"{name}: none of the parts seen ({', '.join(seen) or 'nothing'}) is one of one's own "
            f"({', '.join(image.parts)}): there is nothing to imitate"
        )
    lengths = {len(seen[part]) for part in parts}
    if len(lengths) != 1:
        raise ImitationError(f"{name}: parts were seen for {sorted(lengths)} frames; all must have as many")
    count = lengths.pop()
    steadied = {
        part: steady(f"{name}: {part}", seen[part], (visible or {}).get(part, np.ones(count, bool))) for part in parts
    }
    postures = np.tile(image.rest, (count, 1))
    reachable, moved, slowed = np.zeros((count, len(parts)), bool), np.zeros((count, len(parts))), 1.0
    chosen = postures.copy()
    for limb in own_limbs(image.moves):
        here = {p: miss for p, miss in zip(limb.parts, limb.tolerances, strict=True) if image.parts[p] in steadied}
        if not here:
            continue
        names = tuple(image.parts[part] for part in here)
        view = LimbView(image, limb, [*here], postures, MARGIN)
        wanted = np.stack([steadied[part].directions for part in names], 1)
        trust = np.stack([np.maximum(steadied[part].trust, LEAST_TRUST) for part in names], 1)
        doubt = np.array([steadied[part].doubt for part in names])
        precision = 1 / (doubt**2 + np.array([*here.values()]) ** 2)
        weights = trust * precision / precision.max()
        chosen[:, limb.factors] = angles = choose(view, wanted, weights, doubt)
        shown, _ = view.directions(angles, rows := np.arange(count))
        near = angles_between(shown, wanted) < REACHABLE
        places = [parts.index(part) for part in names]
        smooth, longer = smooth_path(view, angles, weights, near & (trust == 1), doubt, speed[limb.factors], tick_s)
        reachable[:, places], moved[:, places] = near, angles_between(view.directions(smooth, rows)[0], shown)
        postures[:, limb.factors], slowed = smooth, max(slowed, longer)
    return Corresponded(
        postures,
        slowed,
        parts,
        np.stack([steadied[part].directions for part in parts], 1),
        reachable,
        moved,
        np.array([steadied[part].noise for part in parts]),
        chosen,
        time.process_time() - started,
    )
