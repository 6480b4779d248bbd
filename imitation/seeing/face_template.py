"""An innate face: where its parts stand in space, how they move, and what two eyes would then see of them.

The correspondence between faces that one is born with (Meltzoff & Moore 1997) is this template: eyes, nose, brows and
lips about a head, a jaw that opens, a tongue that slides in the jaw. Lengths are in widths of the mouth, so that one
template serves a newborn and an adult; it has no motors. Fitting it to both eyes' images finds the head's pose and the
relations between organs together: a tongue that comes nearer and a head that nods look alike to one who asks for
either alone. Frames: x forward, y left, z up; positions on images in units of the focal length, u right, v down.
"""

from typing import Final, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from babbling.axes import FloatArray
from babbling.relations import RELATIONS, TONGUE
from imitation.seeing.face_marks import NUMBERS

APART_M: Final = 0.036
"""Between one's own eyes."""
MOVING: Final = RELATIONS[:6]
"""Relations that the template moves by, besides its pose; turn and nod are how the pose differs from the usual one."""
POSE: Final = 6
"""Numbers of a pose. At rest: a rotation vector, none for a face that looks at one, and a place before the eyes, m; of
a look: how far the head is turned to its left, nods and rolls upon its neck, rad, and is elsewhere besides, m."""
SHAPE: Final = {
    "mouth": 0.045,
    "eyes apart": 1.40,
    "brows apart": 1.40,
    "eyes up": 0.08,
    "nose ahead": 2.00,
    "nose up": -0.46,
    "brows up": 0.65,
    "lips up": -1.17,
    "lips thick": 0.19,
    "tongue wide": 0.46,
}
"""What differs between faces, and the average: m, then widths of the mouth, from the middle of the head."""
SPREAD: Final = 0.12
"""Of faces about the average, as a share."""
EYES_AHEAD, BROWS_AHEAD, LIPS_AHEAD = 1.885, 1.715, 1.845
"""Widths of the mouth, of all faces."""
NECK: Final = np.array([-0.28, 0.0, -2.08])
"""Where the head turns and nods."""
HINGE: Final = np.array([0.18, 0.0, -0.69])
"""Of the jaw."""
TONGUE_AHEAD, TONGUE_UP = 1.25, 0.135
"""Middle of the tongue at rest, mouth shut: ahead, and above where the lips meet."""
TONGUE_LONG, TONGUE_HIGH, TONGUE_ARM, REST = 0.66, 0.23, 0.23, -0.44
"""Length and height of what is seen of it; from its own hinge to that middle; at rest, its tip from the lower lip's
front."""
LIP_DEEP, INWARDS, QUARTER, CLOSING, RECEDES = 0.11, 0.75, 0.22, 0.36, 0.035
"""Half depth of a lip; how far corners come in for each length that lips go forward; middle of what is seen of half a
lip from the middle of the mouth, how far that comes in, and how far behind the lips' middle it lies."""
FACING: Final = np.diag([-1.0, -1.0, 1.0])
"""How a face stands that looks at one."""
SAMPLES: Final = (32, 24)
"""Across and down, of the patch in which the tongue is looked for."""
REACH: Final = 0.75
"""Half width of that patch, widths of the mouth."""
SOFT: Final = 0.02
"""Widths of the mouth within which it is open which of two surfaces lies in front."""


class Parts(NamedTuple):
    """Where things are in the head's frame, for V poses of the organs: (V, 3) each."""

    points: FloatArray
    """(V, 9, 3) all points but the tongue."""
    tongue: FloatArray
    """(V, 3) its middle."""
    tongue_axes: FloatArray
    """(V, 3, 3) its half axes, columns."""
    lips: FloatArray
    """(V, 4, 3) middles of half lips."""
    lip_axes: FloatArray
    """(V, 4, 3, 3)."""


def parts(shape: FloatArray, moved: FloatArray) -> Parts:
    """Of (10,) `SHAPE` and (V, 6) `MOVING`: m, in the head's frame."""
    mouth, apart, brows_apart, eyes, ahead, nose, brows, lips, thick, wide = shape
    gap, beyond, side, up, purse, brow = moved.T
    count, one = len(moved), np.ones(len(moved))
    lip = np.array([LIPS_AHEAD, 0.0, lips])
    lever = lip - (0, 0, thick / 2) - HINGE
    open_ = 2 * np.arcsin(np.clip(gap / 2 / np.linalg.norm(lever[[0, 2]]), 0, 0.5))
    jaw = Rotation.from_euler("y", open_[:, None]).as_matrix()

    def hinged(place: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("vij,vj->vi", jaw, place - HINGE) + HINGE)

    fixed = [(EYES_AHEAD, s * apart / 2, eyes) for s in (1, -1)] + [(ahead, 0.0, nose)]
    points = [np.broadcast_to(place, (count, 3)) for place in fixed]
    points += [np.stack([BROWS_AHEAD * one, s * brows_apart / 2 * one, brows + brow], -1) for s in (1, -1)]
    middles, axes = list[FloatArray](), list[FloatArray]()
    turned = Rotation.from_euler("z", [[15], [-15]], degrees=True).as_matrix()
    for down in (1, -1):
        for number, s in enumerate((1, -1)):
            frame = jaw if down < 0 else np.broadcast_to(np.eye(3), (count, 3, 3))
            ellipsoid = np.diag([LIP_DEEP, 0.33, thick / 2])
            for y, behind, into in (
                (QUARTER - CLOSING * purse, RECEDES, points), (0.17 - INWARDS * purse, 0.0, middles)
            ):  # fmt: skip
                place = np.stack([lip[0] - behind + purse, s * y, (lips + down * thick / 2) * one], -1)
                into.append(hinged(place) if down < 0 else place)
            axes.append(frame @ turned[number] @ ellipsoid)
    tilt = np.arcsin(np.clip(up / TONGUE, -0.9, 0.9))
    yaw = np.arcsin(np.clip(side / TONGUE, -0.9, 0.9))
    bend = Rotation.from_euler("zy", np.stack([yaw, -tilt], -1)).as_matrix()
    slide = beyond - REST
    arm = TONGUE_ARM * bend[:, :, 0]
    tongue = np.stack([TONGUE_AHEAD - TONGUE_ARM + slide, 0 * one, (lips + TONGUE_UP) * one], -1) + arm
    long_axes = bend @ np.diag([TONGUE_LONG / 2, wide / 2, TONGUE_HIGH / 2])
    return Parts(
        mouth * np.stack(points, 1),
        mouth * hinged(tongue),
        mouth * (jaw @ long_axes),
        mouth * np.stack(middles, 1),
        mouth * np.stack(axes, 1),
    )


def appear(shape: FloatArray, pose: FloatArray, looks: FloatArray, focal_px: float, tongue: bool = True) -> FloatArray:
    """(V, 2, NUMBERS) what the left and the right eye show, pixels from the middle of the image.

    Args:
        shape: (10,) of `SHAPE`.
        pose: (6,) at rest.
        looks: (V, 12) pose and `MOVING`.
        focal_px: focal length.
        tongue: whether to work out the tongue; its numbers are NaN otherwise.
    """
    here = parts(shape, looks[:, POSE:])
    upright = FACING @ Rotation.from_rotvec(pose[:3]).as_matrix()
    moved = Rotation.from_euler("ZYX", looks[:, :3]).as_matrix()
    turn, neck = upright @ moved, shape[0] * NECK
    place = pose[3:] + (neck - moved @ neck) @ upright.T + looks[:, 3:POSE]
    points = np.einsum("vij,vkj->vki", turn, here.points) + place[:, None]
    found = np.full((len(looks), 2, NUMBERS), np.nan)
    for eye, side in enumerate((0.5, -0.5)):
        seen = points - (0, side * APART_M, 0)
        flat = -seen[..., 1:] / seen[..., :1] * focal_px
        found[:, eye, :18] = flat.reshape(len(looks), -1)
        if tongue:
            at = np.array([0, side * APART_M, 0])
            middle = np.einsum("vij,vj->vi", turn, here.tongue) + place - at
            lips = np.einsum("vij,vkj->vki", turn, here.lips) + (place - at)[:, None]
            found[:, eye, 18:] = _patch(
                middle, turn @ here.tongue_axes, lips, turn[:, None] @ here.lip_axes, shape[0], focal_px
            )
    return found


def _patch(
    tongue: FloatArray, axes: FloatArray, lips: FloatArray, lip_axes: FloatArray, mouth: float, focal_px: float
) -> FloatArray:
    """(V, 3) u, v and the square root of the area of what the lips leave to be seen of the tongue, pixels."""
    centre = -tongue[:, 1:] / tongue[:, :1]
    step = 2 * REACH * mouth / tongue[:, 0] / SAMPLES[0]
    u = centre[:, :1] + step[:, None] * (np.arange(SAMPLES[0]) - (SAMPLES[0] - 1) / 2)
    v = centre[:, 1:] + step[:, None] * (np.arange(SAMPLES[1]) - (SAMPLES[1] - 1) / 2)
    rays = np.ones((len(tongue), SAMPLES[1], SAMPLES[0], 3))
    rays[..., 1], rays[..., 2] = -u[:, None, :], -v[:, :, None]
    cover, depth = _ellipsoid(rays, tongue, axes)
    for lip in range(lips.shape[1]):
        hides, there = _ellipsoid(rays, lips[:, lip], lip_axes[:, lip])
        cover = cover * (1 - hides * np.clip(0.5 + (depth - there) / (SOFT * mouth), 0, 1))
    total = np.maximum(cover.sum((1, 2)), 1e-3)
    across, down = (cover.sum(1) * u).sum(1) / total, (cover.sum(2) * v).sum(1) / total
    return np.stack([across, down, step * np.sqrt(total)], -1) * focal_px


def _ellipsoid(rays: FloatArray, middle: FloatArray, axes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """How much of each sample's cell an ellipsoid covers, and at what depth: (V, rows, columns) each."""
    flat = np.linalg.inv(axes)
    d = np.einsum("vij,vrcj->vrci", flat, rays)
    c = np.einsum("vij,vj->vi", flat, middle)
    dd, dc = np.einsum("vrci,vrci->vrc", d, d), np.einsum("vrci,vi->vrc", d, c)
    inside = dc**2 / dd - (np.einsum("vi,vi->v", c, c) - 1)[:, None, None]
    slope = np.hypot(np.gradient(inside, axis=1), np.gradient(inside, axis=2))
    cover = np.clip(0.5 + inside / np.maximum(slope, 1e-9), 0, 1)
    depth = (dc - np.sqrt(np.maximum(inside, 0) * dd)) / dd
    return cover, depth
