"""A body as it moves, in pictures without any graphics library: rays against its shapes, and a ghost over it.

A ray goes through every pixel that a shape's bounding box may cover, several through pixels at an edge; what is met is
shaded by Lambert's law. A ghost is the same body in another configuration, seen through: it shows beside the body and,
by more than `THIN`, before it; a body that is where its ghost is looks like itself.
"""

from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from models.arrays import BoolArray, FloatArray, IntArray
from models.retina import Image
from models.retina_rays import SUBPIXEL, VISIBLE_GROUPS, rayed
from models.shapes import KINDS, colours

THIN = 0.004
"""Share of the distance by which a ghost must be nearer than the body to be seen before it."""
FOVY = np.deg2rad(35.0)
FROM = (1.0, -0.3, 0.25)
"""Whence one looks: from the front (x), a little from its right (-y) and from above (z)."""
SUN = np.array([-0.45, 0.75, 0.6]) / np.linalg.norm([-0.45, 0.75, 0.6])
"""To the light, in the onlooker's right, up and back."""
AMBIENT, SEEN = 0.35, 0.45
"""Light without the sun; how much is seen of a ghost."""
NEAREST = 0.01
"""m that a camera is away from what is seen."""
NEARLY_ALL = 1.08
"""Of the size that is seen, so that nothing touches the picture's frame."""

_CORNERS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


class View(NamedTuple):
    """A pinhole camera that stands still."""

    place: FloatArray
    """(3,) m."""
    axes: FloatArray
    """(3, 3) columns: right, up, backwards."""
    width: int
    height: int

    @property
    def focal_px(self) -> float:
        """Focal length, pixels."""
        return float(0.5 * self.height / np.tan(FOVY / 2))

    def pixels(self, points: FloatArray) -> FloatArray:
        """(..., 2) where (..., 3) points before the camera are seen: pixels to the right and down."""
        x, y, z = np.moveaxis((points - self.place) @ self.axes, -1, 0)
        middle = np.array([self.width - 1, self.height - 1]) / 2
        return np.asarray(middle + self.focal_px * np.stack([x, -y], -1) / -z[..., None])


def view_of(points: FloatArray, width: int, height: int) -> View:
    """From where all of (N, 3) points are seen, as near as `FROM` allows; where there is none, the origin."""
    points = points if len(points) else np.zeros((1, 3))
    towards = np.array(FROM) / np.linalg.norm(FROM)
    right = np.cross((0.0, 0.0, 1.0), towards)
    right /= np.linalg.norm(right)
    axes = np.column_stack([right, np.cross(towards, right), towards])
    seen, slope = points @ axes, np.tan(FOVY / 2) * np.array([width / height, 1.0]) / NEARLY_ALL
    across, back = seen[:, :2], slope * seen[:, 2:]
    one, other = (across + back).max(0), (back - across).max(0)  # planes at the picture's sides that touch them
    distance = max(((one + other) / 2 / slope).max(), seen[:, 2].max() + NEAREST)
    return View(axes @ [*(one - other) / 2, distance], axes, width, height)


class Filmed:
    """A compiled model before a camera.

    Args:
        model: what moves; planes and what MuJoCo does not draw are left out.
        ground: red, green, blue of the background, 0 to 255.
        ghost: of the ghost.
    """

    def __init__(self, model: mujoco.MjModel, ground: tuple[int, int, int], ghost: tuple[int, int, int]) -> None:
        self._data, self._rayed = mujoco.MjData(model), rayed(model)
        own = colours(model)
        shown = np.isin(model.geom_type, list(KINDS)) & (VISIBLE_GROUPS[np.clip(model.geom_group, 0, 5)] == 1)
        shown &= own[:, 3] > 0
        self._rayed.geom_rgba[:] = np.where(shown[:, None], own, 0.0)
        self._rayed.geom_matid[:] = -1
        self._geoms = np.flatnonzero(shown)
        self._colours = 255 * np.vstack([own[:, :3], np.zeros(3)])
        self._ground, self._ghost = np.array(ground, float), np.array(ghost, float)

    def corners(self, configuration: FloatArray) -> FloatArray:
        """(G, 8, 3) m of the boxes around its shapes in a (nq,) configuration."""
        self._move(configuration)
        model, data = self._rayed, self._data
        turn, box = data.geom_xmat[self._geoms].reshape(-1, 3, 3), model.geom_aabb[self._geoms]
        inside = box[:, None, :3] + _CORNERS * box[:, None, 3:]
        return np.asarray(data.geom_xpos[self._geoms][:, None] + np.einsum("gij,gkj->gki", turn, inside))

    def picture(self, view: View, configuration: FloatArray, ghost: FloatArray | None = None) -> Image:
        """How it looks in a (nq,) configuration, its ghost in another."""
        postures = [configuration] if ghost is None else [configuration, ghost]
        whole = np.tile(self._ground, (view.height, view.width, 1))
        shown = np.full(whole.shape[:2], -1)
        todo = np.argwhere(np.any([self._covered(view, self.corners(posture)) for posture in postures], 0))
        whole[tuple(todo.T)], shown[tuple(todo.T)] = self._look(view, todo.astype(float), postures)
        edge = np.zeros(shown.shape, bool)
        for one, other in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
            edge[one] |= shown[one] != shown[other]
            edge[other] |= shown[one] != shown[other]
        todo = np.argwhere(edge)
        colours, _ = self._look(view, (todo + SUBPIXEL[:, None]).reshape(-1, 2), postures)
        whole[edge] = colours.reshape(len(SUBPIXEL), -1, 3).mean(0)
        return (whole + 0.5).astype(np.uint8)

    def _look(self, view: View, places: FloatArray, postures: Sequence[FloatArray]) -> tuple[FloatArray, IntArray]:
        """(n, 3) colours at (n, 2) rows and columns, and (n,) numbers that tell apart what is seen there."""
        flat = (places[:, ::-1] - [(view.width - 1) / 2, (view.height - 1) / 2]) * (1, -1) / view.focal_px
        rays = np.column_stack([flat, -np.ones(len(flat))]) @ view.axes.T
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        (depth, light, geom), *ghosts = (self._cast(view, rays, posture) for posture in postures)
        colour = np.where((geom >= 0)[:, None], self._colours[geom] * light[:, None], self._ground)
        for before, light, met in ghosts:
            through = (before < (1 - THIN) * depth)[:, None]
            colour = np.where(through, (1 - SEEN) * colour + SEEN * light[:, None] * self._ghost, colour)
            geom = np.where(through[:, 0], len(self._colours) * (met + 1) + geom, geom)
        return colour, geom

    def _cast(self, view: View, rays: FloatArray, configuration: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
        """(n,) m along (n, 3) rays, infinite where nothing is met; light 0 to 1; geom, -1 where nothing is met."""
        self._move(configuration)
        count = len(rays)
        geom, depth, normal = np.empty(count, np.int32), np.empty(count), np.zeros(3 * count)
        mujoco.mj_multiRay(
            self._rayed, self._data, view.place, rays.ravel(), VISIBLE_GROUPS, 1, -1, geom, depth, normal, count,
            mujoco.mjMAXVAL,
        )  # fmt: skip
        out = normal.reshape(-1, 3)
        out = out * -np.sign(np.einsum("ij,ij->i", out, rays))[:, None]  # to the onlooker, however a mesh is wound
        light = AMBIENT + (1 - AMBIENT) * np.maximum(out @ (view.axes @ SUN), 0.0)
        return np.where(geom >= 0, depth, np.inf), light, geom.astype(np.intp)

    def _move(self, configuration: FloatArray) -> None:
        self._data.qpos[:] = configuration
        mujoco.mj_kinematics(self._rayed, self._data)

    def _covered(self, view: View, corners: FloatArray) -> BoolArray:
        """(H, W) pixels that a box may cover."""
        todo = np.zeros((view.height, view.width), bool)
        places = view.pixels(corners)
        low, high = np.floor(places.min(1)).clip(0).astype(int), np.ceil(places.max(1)).clip(-1).astype(int) + 1
        for (left, top), (right, bottom) in zip(low, high, strict=True):
            todo[top:bottom, left:right] = True
        return todo
