"""What a body looks like: its visible shapes, and where they are in each configuration. For pictures, not for minds."""

from collections.abc import Collection, Mapping
from types import MappingProxyType
from typing import Literal, NamedTuple, get_args

import mujoco
import numpy as np

from models.arrays import FloatArray

Kind = Literal["box", "capsule", "sphere", "cylinder", "ellipsoid", "mesh"]

KINDS: dict[int, Kind] = {int(getattr(mujoco.mjtGeom, f"mjGEOM_{kind.upper()}")): kind for kind in get_args(Kind)}
"""Shapes that can be drawn; others (planes, height fields) are left out."""
VISIBLE_GROUPS = 3
"""MuJoCo draws geom groups 0 to 2."""


class Shape(NamedTuple):
    """One shape, fixed to its part."""

    name: str
    kind: Kind
    place: FloatArray
    """(3,) m, in the part's frame."""
    turn: FloatArray
    """(4,) quaternion x, y, z, w, in the part's frame."""
    axis: FloatArray
    """(3,) direction of the shape's own z axis in the part's frame."""
    size: FloatArray
    """(3,) m as MuJoCo has it: half extents of boxes and ellipsoids, radius (and half length) of the others."""
    colour: FloatArray
    """(3,) red, green, blue, 0 to 1."""
    triangles: FloatArray
    """(N, 3, 3) m, the corners of a mesh's triangles in the part's frame; no triangles of other shapes."""


class Part(NamedTuple):
    """One rigid part of a body with something to see on it."""

    name: str
    moves: bool
    positions: FloatArray
    """(T, 3) m, in the world."""
    turns: FloatArray
    """(T, 4) quaternions x, y, z, w."""
    shapes: tuple[Shape, ...]


def parts(
    model: mujoco.MjModel,
    configurations: FloatArray,
    without: Collection[str] = (),
    hung: Mapping[str, FloatArray] = MappingProxyType({}),
) -> list[Part]:
    """The visible parts of a compiled model in each of (T, nq) configurations, `without` the geoms of these names.

    Left out is also what a configuration does not place: mocap bodies, but for those `hung` at (3,) or (T, 3) places.
    """
    data = mujoco.MjData(model)
    count = len(configurations)
    positions, turns = np.empty((count, model.nbody, 3)), np.empty((count, model.nbody, 4))
    for t, configuration in enumerate(configurations):
        data.qpos[:] = configuration
        mujoco.mj_kinematics(model, data)
        positions[t], turns[t] = data.xpos, data.xquat[:, [1, 2, 3, 0]]
    for name, place in hung.items():
        positions[:, model.body(name).id] = place
    shapes: dict[int, list[Shape]] = {}
    for geom in range(model.ngeom):
        body, kind = int(model.geom_bodyid[geom]), int(model.geom_type[geom])
        visible = model.geom_group[geom] < VISIBLE_GROUPS and model.geom_rgba[geom, 3] > 0
        placed = model.body_mocapid[body] < 0 or model.body(body).name in hung
        if visible and placed and kind in KINDS and model.geom(geom).name not in without:
            shapes.setdefault(body, []).append(_shape(model, geom))
    return [
        Part(
            name=model.body(body).name or str(body),
            moves=bool(model.body_weldid[body] != 0),
            positions=positions[:, body],
            turns=turns[:, body],
            shapes=tuple(shapes[body]),
        )
        for body in sorted(shapes)
    ]


def _shape(model: mujoco.MjModel, geom: int) -> Shape:
    matrix, place, corners = np.zeros(9), model.geom_pos[geom].copy(), np.zeros((0, 3, 3))
    mujoco.mju_quat2Mat(matrix, model.geom_quat[geom])
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
        mesh = model.mesh(model.geom_dataid[geom])
        faces = model.mesh_face[mesh.faceadr[0] :][: mesh.facenum[0]]
        corners = model.mesh_vert[mesh.vertadr[0] :][faces] @ matrix.reshape(3, 3).T + place
    return Shape(
        name=model.geom(geom).name or str(geom),
        kind=KINDS[int(model.geom_type[geom])],
        place=place,
        turn=model.geom_quat[geom][[1, 2, 3, 0]],
        axis=matrix.reshape(3, 3)[:, 2].copy(),
        size=model.geom_size[geom].copy(),
        colour=model.geom_rgba[geom][:3].astype(float),
        triangles=corners,
    )
