"""Meshes as pictures need them: corners shared, smooth but for sharp edges, coloured, no finer than is seen."""

from collections.abc import Collection
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arrays import FloatArray, IntArray

SHARP = 0.8
"""A face whose normal has less than this cosine with its corner's mean normal keeps its own: an edge."""
ACROSS = 3
"""Least number of cells across a mesh, each way: thin things stay, and the smallest are hardly more than boxes."""
COARSER = 1.05
"""Least factor on the grid's cell while there are too many triangles, which are as many as its square is small."""


class Mesh(NamedTuple):
    """A surface of triangles."""

    corners: FloatArray
    """(V, 3) m."""
    normals: FloatArray
    """(V, 3) unit vectors, area-weighted means of the faces that meet there without an edge between them."""
    triangles: IntArray
    """(N, 3) corners of each."""
    paint: FloatArray | None
    """(V, 3) red, green, blue, 0 to 1, of the texture at each corner, where the mesh has places for one."""

    def placed(self, turn: FloatArray, place: FloatArray) -> "Mesh":
        """The mesh turned by a (3, 3) matrix, then shifted by (3,) m."""
        return self._replace(corners=self.corners @ turn.T + place, normals=self.normals @ turn.T)

    def across(self) -> FloatArray:
        """(N, 3) normals of the triangles, as long as twice their area."""
        one, two, three = np.moveaxis(self.corners[self.triangles], 1, 0)
        return np.cross(two - one, three - one)

    def thinned(self, cell: float) -> "Mesh":
        """With all corners in one cell of a grid, m, at their mean, and without what thereby falls together.

        Cells are narrower where the whole is thin. Normals are the means of those that look one of 27 ways.
        """
        extent = np.ptp(self.corners, axis=0)
        cells = np.clip(np.minimum(cell, extent / ACROSS), max(extent) * 1e-6 + 1e-12, None)
        at = np.floor((self.corners - self.corners.min(0)) / cells).astype(np.int64)
        sides = at.max(0) + 1
        _, place = np.unique((at[:, 0] * sides[1] + at[:, 1]) * sides[2] + at[:, 2], return_inverse=True)
        _, row = np.unique(27 * place + _ways(self.normals), return_inverse=True)
        parts = place[self.triangles]
        used, triangles = np.unique(row[self.triangles[(parts != np.roll(parts, 1, 1)).all(1)]], return_inverse=True)
        return Mesh(
            _means(row, _means(place, self.corners)[place])[used],
            _unit(_sums(row, self.normals))[used],
            triangles.reshape(-1, 3),
            None if self.paint is None else _means(row, self.paint)[used],
        )


def meshes(model: mujoco.MjModel, geoms: Collection[int], most: int) -> dict[int, Mesh]:
    """The mesh of each of these geoms of a compiled model in the geom's frame, at most `most` triangles altogether.

    Where there are more, all are thinned out on one grid, as fine as may be (but for `ACROSS`: a thousand meshes may
    be more than `most`). Geoms that share a mesh and a texture share the result.
    """
    kinds = {geom: (int(model.geom_dataid[geom]), texture_of(model, geom)) for geom in geoms}
    whole = {kind: _made(model, *kind) for kind in set(kinds.values())}
    areas = (float(np.linalg.norm(whole[kind].across(), axis=1).sum() / 2) for kind in kinds.values())
    largest = max((float(np.ptp(mesh.corners, axis=0).max()) for mesh in whole.values()), default=0.0)
    cell, made = 0.0, whole
    while cell < largest and (count := sum(len(made[kind].triangles) for kind in kinds.values())) > most:
        cell = cell * max(COARSER, np.sqrt(count / most)) or 0.5 * np.sqrt(sum(areas) / most) or largest
        made = {kind: mesh.thinned(cell) for kind, mesh in whole.items()}
    return {geom: made[kind] for geom, kind in kinds.items()}


def texture_of(model: mujoco.MjModel, geom: int) -> int:
    """Number of the texture that colours a geom, or -1."""
    material = int(model.geom_matid[geom])
    return -1 if material < 0 else int(model.mat_texid[material, int(mujoco.mjtTextureRole.mjTEXROLE_RGB)])


def texture(model: mujoco.MjModel, number: int) -> NDArray[np.uint8]:
    """(H, W, 3) a texture's picture; the six faces of a cube stand below each other."""
    high, wide, layers = (int(getattr(model, f"tex_{one}")[number]) for one in ("height", "width", "nchannel"))
    start = int(model.tex_adr[number])
    picture = model.tex_data[start : start + high * wide * layers].reshape(high, wide, layers)
    return np.asarray(picture[..., :3] if layers >= 3 else np.repeat(picture[..., :1], 3, axis=2))


def _made(model: mujoco.MjModel, number: int, painted: int) -> Mesh:
    """A whole mesh: its corners are shared by the faces that meet there without an edge between them."""
    faces = model.mesh_face[model.mesh_faceadr[number] :][: model.mesh_facenum[number]].astype(np.int64)
    corners = model.mesh_vert[model.mesh_vertadr[number] :][: model.mesh_vertnum[number]].astype(float)
    across = np.repeat(Mesh(corners, corners, faces, None).across(), 3, axis=0)
    corner, facing = faces.ravel(), _unit(across)
    own = 1 + _ways(facing)
    own[(facing * _unit(_sums(corner, across))[corner]).sum(1) > SHARP] = 0
    kept, row = np.unique(28 * corner + own, return_inverse=True)
    colours = _painted(model, number, painted)
    paint = None if colours is None else _means(row, colours.reshape(-1, 3))
    return Mesh(corners[kept // 28], _unit(_sums(row, across)), row.reshape(-1, 3), paint)


def _painted(model: mujoco.MjModel, number: int, painted: int) -> FloatArray | None:
    """(N, 3, 3) the texture's colour at the corners of each face."""
    flat = painted >= 0 and model.tex_type[painted] == mujoco.mjtTexture.mjTEXTURE_2D
    if not flat or model.mesh_texcoordadr[number] < 0:
        return None
    picture = texture(model, painted)
    places = model.mesh_facetexcoord[model.mesh_faceadr[number] :][: model.mesh_facenum[number]]
    u, v = np.moveaxis(model.mesh_texcoord[model.mesh_texcoordadr[number] :][places] % 1.0, -1, 0)
    high, wide = picture.shape[:2]
    return np.asarray(picture[(v * high).astype(int) % high, (u * wide).astype(int) % wide] / 255)


def _ways(normals: FloatArray) -> IntArray:
    """(N,) 0 to 26: which way unit vectors look."""
    return np.asarray(np.rint(normals).astype(np.int64) @ (9, 3, 1) + 13)


def _sums(row: IntArray, values: FloatArray) -> FloatArray:
    return np.stack([np.bincount(row, column) for column in values.T], 1)


def _means(row: IntArray, values: FloatArray) -> FloatArray:
    return np.asarray(_sums(row, values) / np.maximum(np.bincount(row), 1)[:, None])


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300))
