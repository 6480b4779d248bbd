"""An eye by ray casting: colour images without any graphics library.

Rays go through pixel centres (`mujoco.mj_multiRay`); what they hit is shaded by Lambert's law,

    level = 255 rgb (ambient + sum over lights of k_l max(0, n . l)),

n the surface normal, l the direction to the light, k_l the mean of the light's diffuse colour (lights are white and far
away here), the camera's own headlight included. There are no shadows, highlights, materials or transparency.

Most of an image is plain, so rays are spent where something happens. A block of 4 x 4 pixels is *plain* when the rays
through its four corners hit the same convex geom with nearly the same normal and no other geom can stand in front
of it there: either its bounding box projects outside the block, or one face of that box separates it from the camera
and from all four hit points (then from everything the block shows, the geom being convex). Plain blocks are
interpolated; what they show is certain, only their shading is bilinear instead of exact. All other blocks get a
ray per pixel, and pixels at a visible edge several.
"""

from copy import copy
from typing import NamedTuple

import mujoco
import numpy as np
import numpy.typing as npt

from models.arrays import BoolArray, FloatArray, IntArray
from models.retina import Eye, Levels, RetinaOptions

BLOCK = 4  # pixels along a side; of 2, 4, 5 and 8 the quickest or nearly so at 160 x 120
SAME_NORMAL = 0.97  # least cosine between the normals at a plain block's corners
EDGE_LEVELS = 20.0  # neighbouring pixels that differ by more (of 255, in any channel) have an edge between them
SUBPIXEL = np.array([(0.375, 0.125), (-0.125, 0.375), (-0.375, -0.125), (0.125, -0.375)])  # a rotated grid of four
VISIBLE_GROUPS = np.array([1, 1, 1, 0, 0, 0], np.uint8)  # MuJoCo's own custom: groups 3 to 5 are collision shapes
FAR = 1.0e3  # metres; where a ray that hits nothing is said to end

_KINDS = ("PLANE", "SPHERE", "CAPSULE", "ELLIPSOID", "CYLINDER", "BOX")
_CONVEX = [getattr(mujoco.mjtGeom, f"mjGEOM_{kind}") for kind in _KINDS]
_CORNERS = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


class Hits(NamedTuple):
    """What n rays met."""

    geom: npt.NDArray[np.int32]
    """(n,) geom ids, -1 where nothing was met."""
    depth: FloatArray
    """(n,) metres along the optical axis."""
    direction: FloatArray
    """(n, 3) world directions of depth 1."""
    normal: FloatArray
    """(n, 3) unit surface normals, 0 where nothing was met."""


class Lights(NamedTuple):
    """The light of one moment, and what it falls on."""

    ambient: float
    towards: FloatArray
    """(3, lights) unit vectors to the lights, the headlight among them."""
    strength: FloatArray
    """(lights,)"""
    colour: Levels
    """(geoms + 1, 3) levels in full light; the last row, geom -1, is the scene's haze."""


class RayEye(Eye):
    """A pinhole camera by ray casting; see the module's text and `models.retina.Eye`.

    The geoms of the camera's own body are not seen (a lens does not see its own case). Colours are read from the model
    at every look, so they may be changed in between; a geom with alpha 0 is not there.
    """

    def __init__(self, model: mujoco.MjModel, camera: str, options: RetinaOptions) -> None:
        super().__init__(model, camera, options)
        self._rayed = rayed(model)
        self._own_body = int(model.cam_bodyid[self._camera]) or -1  # a camera fixed to the world has no case
        self._convex = np.append(np.isin(model.geom_type, _CONVEX), True)  # the last is geom -1, nothing at all
        self._half = model.geom_aabb[:, 3:] + 1e-9
        self._half[model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE] = (np.inf, np.inf, 1e-9)  # a half-space

        height, width = options.height, options.width
        rows, columns = -(-height // BLOCK), -(-width // BLOCK)
        self._grid = (rows + 1, columns + 1)
        self._corner_rays = self._rays(*np.mgrid[0 : rows * BLOCK + 1 : BLOCK, 0 : columns * BLOCK + 1 : BLOCK])
        self._pixel_rays = self._rays(*np.mgrid[0:height, 0:width]).reshape(-1, 3)
        self._sub_rays = np.pad(SUBPIXEL, ((0, 0), (0, 1)))[:, None] / self.focal_px  # added to a pixel's own ray
        self._down = _hat(height, rows)
        self._across = np.ascontiguousarray(_hat(width, columns).T)

    def _colour(self, data: mujoco.MjData) -> Levels:
        height, width = self.options.height, self.options.width
        lights = self._lights(data)
        hits = self._cast(data, self._corner_rays.reshape(-1, 3))
        corners = _shade(hits, lights).reshape(*self._grid, 3)
        planes = self._down @ np.moveaxis(corners, 2, 0) @ self._across
        pixels: Levels = np.ascontiguousarray(np.moveaxis(planes, 0, 2), np.float32).reshape(-1, 3)

        busy = ~self._plain_blocks(data, hits)
        busy = np.repeat(np.repeat(busy, BLOCK, axis=0), BLOCK, axis=1)[:height, :width]
        busy[::BLOCK, ::BLOCK] = False  # the blocks' corners: known already
        todo = np.flatnonzero(busy)
        if todo.size:
            pixels[todo] = _shade(self._cast(data, self._pixel_rays[todo]), lights)
        if self.options.antialias:
            todo = np.flatnonzero(_edges(pixels.reshape(height, width, 3)))
            if todo.size:
                rays = (self._pixel_rays[todo] + self._sub_rays).reshape(-1, 3)
                samples = _shade(self._cast(data, rays), lights)
                pixels[todo] = samples.reshape(len(SUBPIXEL), -1, 3).mean(axis=0)
        return pixels.reshape(height, width, 3)

    def _rays(self, v: IntArray, u: IntArray) -> FloatArray:
        """Directions (x right, y up, z backwards, as MuJoCo's cameras have it) of depth 1, shape (..., 3)."""
        x = (u - 0.5 * (self.options.width - 1)) / self.focal_px
        y = -(v - 0.5 * (self.options.height - 1)) / self.focal_px
        return np.stack([x, y, np.full(x.shape, -1.0)], axis=-1)

    def _cast(self, data: mujoco.MjData, rays: FloatArray) -> Hits:
        """What rays (n, 3) in the camera's frame hit."""
        count = len(rays)
        direction = rays @ data.cam_xmat[self._camera].reshape(3, 3).T
        geom = np.empty(count, np.int32)
        depth = np.empty(count)
        normal = np.zeros(3 * count)
        self._rayed.geom_rgba[:] = self._model.geom_rgba  # what is transparent is not there
        mujoco.mj_multiRay(
            self._rayed, data, data.cam_xpos[self._camera], direction.ravel(), VISIBLE_GROUPS, 1, self._own_body,
            geom, depth, normal, count, mujoco.mjMAXVAL,
        )  # fmt: skip
        depth[geom < 0] = FAR
        return Hits(geom, depth, direction, normal.reshape(-1, 3))

    def _lights(self, data: mujoco.MjData) -> Lights:
        model, headlight = self._model, self._model.vis.headlight
        ambient, towards, strength = 0.0, [np.zeros(3)], [0.0]
        if headlight.active:
            ambient += float(headlight.ambient.mean())
            towards.append(data.cam_xmat[self._camera].reshape(3, 3)[:, 2])
            strength.append(float(headlight.diffuse.mean()))
        for i in np.flatnonzero(model.light_active):
            ambient += float(model.light_ambient[i].mean())
            towards.append(-data.light_xdir[i])
            strength.append(float(model.light_diffuse[i].mean()))
        colour = (255.0 * np.vstack([model.geom_rgba[:, :3], model.vis.rgba.haze[:3]])).astype(np.float32)
        return Lights(ambient, np.stack(towards, axis=1), np.array(strength), colour)

    def _plain_blocks(self, data: mujoco.MjData, hits: Hits) -> BoolArray:
        """Which blocks (rows, columns) certainly show one convex geom, or nothing, and no other geom."""
        ids = hits.geom.reshape(self._grid)
        shown, normal = ids[:-1, :-1], hits.normal.reshape(*self._grid, 3)
        unit = normal[:-1, :-1]
        same = self._convex[shown]
        for corner in np.s_[:-1, 1:], np.s_[1:, :-1], np.s_[1:, 1:]:
            cosine = np.einsum("ijk,ijk->ij", unit, normal[corner])
            same &= (shown == ids[corner]) & ((cosine >= SAME_NORMAL) | (shown < 0))

        model = self._model
        visible = (VISIBLE_GROUPS[np.clip(model.geom_group, 0, 5)] == 1) & (model.geom_bodyid != self._own_body)
        other = np.flatnonzero(visible & (model.geom_rgba[:, 3] > 0.0))
        rotation = data.geom_xmat[other].reshape(-1, 3, 3)
        centre = data.geom_xpos[other] + np.einsum("gij,gj->gi", rotation, model.geom_aabb[other, :3])
        half = self._half[other]
        overlap = self._overlap(data, rotation, centre, half)
        in_view = overlap.any(axis=(1, 2))
        other, overlap = other[in_view], overlap[in_view]
        rotation, centre, half = rotation[in_view], centre[in_view], half[in_view]

        origin = data.cam_xpos[self._camera]
        eye = np.einsum("gi,gij->gj", origin - centre, rotation)
        facing = np.sign(eye) * (np.abs(eye) > half)  # the box faces that see the eye: (geoms, 3) of -1, 0, 1
        inside = np.isin(shown, other[~facing.any(axis=1)])
        points = hits.depth[:, None] * hits.direction
        apart = np.zeros_like(overlap)
        for axis in range(3):  # one contiguous (geoms, corners) array after the other
            along = (rotation[:, :, axis] * facing[:, axis, None]) @ points.T
            limit = half[:, axis] - facing[:, axis] * eye[:, axis]
            limit[facing[:, axis] == 0.0] = np.inf
            outside: BoolArray = np.asarray(along > limit[:, None]).reshape(-1, *self._grid)
            pairs: BoolArray = np.logical_and(outside[:, 1:], outside[:, :-1])
            apart |= pairs[:, :, 1:] & pairs[:, :, :-1]
        hidden = overlap & ~apart & (other[:, None, None] != shown)
        return np.asarray(same & ~inside & ~hidden.any(axis=0))

    def _overlap(self, data: mujoco.MjData, rotation: FloatArray, centre: FloatArray, half: FloatArray) -> BoolArray:
        """Whether a geom's bounding box may project into a block: (geoms, rows, columns)."""
        unbounded = np.isinf(half).any(axis=1, keepdims=True)
        box = np.einsum("gij,gkj->gki", rotation, _CORNERS * np.where(np.isinf(half), 0.0, half)[:, None])
        seen = (box + (centre - data.cam_xpos[self._camera])[:, None]) @ data.cam_xmat[self._camera].reshape(3, 3)
        depth = -seen[:, :, 2]
        ahead = (depth > 0.0).any(axis=1, keepdims=True)
        columns = _touches(seen[:, :, 0], depth, self._corner_rays[0, :, 0])
        rows = _touches(-seen[:, :, 1], depth, -self._corner_rays[:, 0, 1])
        return np.asarray((unbounded | (ahead & rows))[:, :, None] & (unbounded | columns)[:, None, :])


def rayed(model: mujoco.MjModel) -> mujoco.MjModel:
    """A copy through which `mj_multiRay` meets what `mj_ray` meets; for rays alone, its bodies may not collide.

    MuJoCo 3.17 skips a body where a ray misses the sphere around the box of its colliding geoms, should it have any.
    What is only seen may lie outside, and the box's middle, in the body's inertial frame, is taken as if that were not
    turned. Here every sphere is about that frame's origin and around all geoms. There are at most as many as MuJoCo
    had boxes for bodies: the largest bodies have one each, all others share the last.
    """
    reach = np.linalg.norm(model.geom_pos - model.body_ipos[model.geom_bodyid], axis=1) + model.geom_rbound
    reach[model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE] = mujoco.mjMAXVAL
    radius = np.zeros(model.nbody)
    np.maximum.at(radius, model.geom_bodyid, reach)
    largest, count = np.argsort(-radius), min(model.nbody, int(model.body_bvhnum.sum()))
    rayed = copy(model)
    rayed.bvh_aabb[:count] = np.pad(radius[largest[:count], None], ((0, 0), (3, 2)))  # meshes' boxes stand behind
    rayed.body_bvhadr[largest] = np.minimum(np.arange(model.nbody), count - 1)  # -1: nothing is skipped
    return rayed


def _shade(hits: Hits, lights: Lights) -> Levels:
    """Levels (n, 3) of what was hit."""
    light = lights.ambient + np.maximum(hits.normal @ lights.towards, 0.0) @ lights.strength
    light[hits.geom < 0] = 1.0
    return np.asarray(lights.colour[hits.geom] * np.minimum(light, 1.0).astype(np.float32)[:, None])


def _touches(place: FloatArray, depth: FloatArray, borders: FloatArray) -> BoolArray:
    """Which blocks along one image axis boxes may reach: (geoms, blocks).

    `place`, `depth`: the boxes' corners (geoms, 8) across and along the view; block i spans slopes borders[i..i+1].
    A box lies wholly beyond a border's plane when all its corners do, wherever they are, behind the eye too.
    """
    beyond = place[:, None] - borders[:, None] * depth[:, None]  # (geoms, borders, 8)
    return np.asarray((beyond.max(axis=2)[:, :-1] >= 0.0) & (beyond.min(axis=2)[:, 1:] <= 0.0))


def _hat(pixels: int, blocks: int) -> Levels:
    """Weights (pixels, blocks + 1) of linear interpolation between block corners."""
    place = np.arange(pixels)[:, None] / BLOCK
    return np.maximum(1.0 - np.abs(place - np.arange(blocks + 1)), 0.0).astype(np.float32)


def _edges(image: Levels) -> BoolArray:
    """Pixels (height, width) that differ visibly from one of their four neighbours."""
    edge = np.zeros(image.shape[:2], bool)
    for level in np.ascontiguousarray(np.moveaxis(image, 2, 0)):
        for side, along in ((edge, level), (edge.T, level.T)):
            differs = np.abs(along[1:] - along[:-1]) > EDGE_LEVELS
            side[1:] |= differs
            side[:-1] |= differs
    return edge
