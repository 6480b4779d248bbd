"""What a body looks like: its visible shapes, and where they are in each configuration. For pictures, not for minds."""

from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType
from typing import Literal, NamedTuple, get_args

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from models.arrays import BoolArray, FloatArray
from models.meshes import Mesh, meshes, texture, texture_of

Kind = Literal["box", "capsule", "sphere", "cylinder", "ellipsoid", "mesh"]

KINDS: dict[int, Kind] = {int(getattr(mujoco.mjtGeom, f"mjGEOM_{kind.upper()}")): kind for kind in get_args(Kind)}
"""Shapes that can be drawn; the ground (planes, height fields) is left out: bodies here hang, or bring their own."""
KINDS[int(mujoco.mjtGeom.mjGEOM_SDF)] = "mesh"
VISIBLE_GROUPS = 3
"""MuJoCo draws geom groups 0 to 2."""
PLAIN = (0.5, 0.5, 0.5, 1.0)
"""MuJoCo's colour of geoms that name none: their material's counts."""
MOST_TRIANGLES = 150_000
"""Of a whole body: 5 MB of a recording."""


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
    mesh: Mesh | None
    """In the part's frame; other shapes have none."""


class Part(NamedTuple):
    """One rigid part of a body with something to see on it."""

    name: str
    moves: bool
    positions: FloatArray
    """(T, 3) m, in the world."""
    turns: FloatArray
    """(T, 4) quaternions x, y, z, w."""
    shapes: tuple[Shape, ...]

    def during(self, ticks: slice) -> "Part":
        """The same part in some of its configurations alone."""
        return self._replace(positions=self.positions[ticks], turns=self.turns[ticks])


def parts(
    model: mujoco.MjModel,
    configurations: FloatArray,
    without: Collection[str] = (),
    hung: Mapping[str, FloatArray] = MappingProxyType({}),
    most: int = MOST_TRIANGLES,
) -> list[Part]:
    """The visible parts of a compiled model in each of (T, nq) configurations, `without` the geoms of these names.

    Left out is also what a configuration does not place: mocap bodies, but for those `hung` at (3,) or (T, 3) places.
    Meshes are thinned out until they have `most` triangles altogether.
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
    geoms = range(model.ngeom)
    rgba = colours(model)
    shown = seen(model, rgba[:, 3] > 0)
    for geom, body in enumerate(model.geom_bodyid):
        placed = model.body_mocapid[body] < 0 or model.body(body).name in hung
        shown[geom] &= placed and model.geom(geom).name not in without
    drawn = [geom for geom in geoms if shown[geom]]
    surfaces = meshes(model, [geom for geom in drawn if KINDS[int(model.geom_type[geom])] == "mesh"], most)
    paints = {
        number: texture(model, number).mean((0, 1)) / 255 for number in {texture_of(model, i) for i in drawn} - {-1}
    }
    shapes: dict[int, list[Shape]] = {}
    for geom in drawn:
        surface, paint = surfaces.get(geom), paints.get(texture_of(model, geom), np.ones(3))
        shape = _shape(model, geom, rgba[geom, :3], surface, paint)
        shapes.setdefault(int(model.geom_bodyid[geom]), []).append(shape)
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


def seen(model: mujoco.MjModel, opaque: BoolArray) -> BoolArray:
    """(ngeom,) which geoms are to be looked at, of those that are `opaque` at all.

    Those in MuJoCo's visible groups. Where one such group of a tree of bodies is all for touching (everything in it
    collides) and another all for looking (nothing does), the first is left out: viewers of such robots hide it. A tree
    that moves and has nothing to look at shows what it touches with.
    """
    able: BoolArray = np.isin(model.geom_type, list(KINDS))
    shown: BoolArray = able & opaque & (model.geom_group < VISIBLE_GROUPS)
    touches = (model.geom_contype | model.geom_conaffinity) != 0
    trees, moving = model.body_rootid[model.geom_bodyid], set(model.body_rootid[model.dof_bodyid])
    for tree in np.unique(trees):
        mine = trees == tree
        groups = [shown & mine & (model.geom_group == group) for group in range(VISIBLE_GROUPS)]
        if any(group.any() and not touches[group].any() for group in groups):
            for group in groups:
                if touches[group].all():
                    shown &= ~group
        elif tree in moving and not (shown & mine).any():
            shown |= able & mine
    return shown


def box(parts: Sequence[Part]) -> tuple[FloatArray, FloatArray]:
    """(3,) m least and (3,) m greatest place that anything of these parts reaches; zeros without parts.

    Exact, but for meshes: of those it is the box about them that turns.
    """
    ends = [(np.zeros(3), np.zeros(3))] if not parts else []
    for part in parts:
        once = slice(None) if part.moves else slice(1)
        turns, places = Rotation.from_quat(part.turns[once]), part.positions[once]
        for shape in part.shapes:
            if shape.mesh:
                low, high = shape.mesh.corners.min(0), shape.mesh.corners.max(0)
                middle, reach = (low + high) / 2, np.abs(turns.as_matrix()) @ ((high - low) / 2)
            else:
                middle, reach = shape.place, _reach(shape, (turns * Rotation.from_quat(shape.turn)).as_matrix())
            at = turns.apply(middle) + places
            ends.append(((at - reach).min(0), (at + reach).max(0)))
    return np.min([low for low, _ in ends], axis=0), np.max([high for _, high in ends], axis=0)


def _reach(shape: Shape, turns: FloatArray) -> FloatArray:
    """(T, 3) m how far a shape reaches from its middle along x, y and z, turned by (T, 3, 3) matrices."""
    size, along = shape.size, np.abs(turns[..., 2])
    if shape.kind == "box":
        return np.asarray(np.abs(turns) @ size)
    if shape.kind == "ellipsoid":
        return np.asarray(np.sqrt(turns**2 @ size**2))
    width = size[0] * np.sqrt(np.maximum(1 - along**2, 0)) if shape.kind == "cylinder" else size[0]
    return np.asarray(width + (0 if shape.kind == "sphere" else size[1]) * along)


def colours(model: mujoco.MjModel) -> FloatArray:
    """(ngeom, 4) every geom's own colour, or its material's."""
    found: FloatArray = model.geom_rgba.astype(float)
    plain = (model.geom_matid >= 0) & (found == PLAIN).all(1)
    found[plain] = model.mat_rgba[model.geom_matid[plain]]
    return found


def _shape(model: mujoco.MjModel, geom: int, colour: FloatArray, mesh: Mesh | None, paint: FloatArray) -> Shape:
    """With a (3,) mean colour of its texture, for what has no paint of its own."""
    turn, place = np.zeros(9), model.geom_pos[geom].copy()
    mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
    if mesh:
        mesh = mesh.placed(turn.reshape(3, 3), place)
        mesh = mesh._replace(paint=None if mesh.paint is None else mesh.paint * colour)
    return Shape(
        name=model.geom(geom).name or str(geom),
        kind=KINDS[int(model.geom_type[geom])],
        place=place,
        turn=model.geom_quat[geom][[1, 2, 3, 0]],
        axis=turn.reshape(3, 3)[:, 2].copy(),
        size=model.geom_size[geom].copy(),
        colour=colour * paint,
        mesh=mesh,
    )
