"""Pieces that recordings share: bodies as moving shapes, teachers as stick figures, series, heat maps.

Episodes are buffered and sent once, column by column: a recording is then small and quick to open.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import matplotlib
import mujoco
import numpy as np
import pyarrow as pa
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

DEMONSTRATED, IMITATED, REPLAYED = (120, 170, 255), (255, 140, 40), (150, 150, 150)


@contextmanager
def recording(path: Path, application: str, name: str, blueprint: rrb.Blueprint) -> Iterator[rr.RecordingStream]:
    """A recording stream into a file, blueprint inside; complete when the block ends."""
    rr.set_strict_mode(True)
    stream = rr.RecordingStream(application, recording_id=name)
    stream.save(path, default_blueprint=blueprint)
    stream.send_recording_name(name)
    yield stream
    stream.flush()
    stream.disconnect()


def ticks(count: int, tick_s: float) -> list[rr.TimeColumn]:
    """The timelines `sim_time` and `step` of an episode."""
    return [
        rr.TimeColumn("sim_time", duration=np.arange(count) * tick_s),
        rr.TimeColumn("step", sequence=np.arange(count)),
    ]


def log_series(
    stream: rr.RecordingStream,
    entity: str,
    values: FloatArray,
    tick_s: float,
    label: str,
    colour: tuple[int, int, int],
    width: float = 2.0,
) -> None:
    """One scalar per tick."""
    stream.log(entity, rr.SeriesLines(names=label, colors=[colour], widths=width), static=True)
    stream.send_columns(entity, ticks(len(values), tick_s), rr.Scalars.columns(scalars=np.asarray(values, float)))


def log_body(
    stream: rr.RecordingStream,
    entity: str,
    model: mujoco.MjModel,
    qpos: FloatArray,
    tick_s: float,
    *,
    offset: Sequence[float] = (0.0, 0.0, 0.0),
    tint: tuple[int, int, int] | None = None,
) -> None:
    """A body's visible shapes, moving through (T, nq) configurations."""
    data = mujoco.MjData(model)
    positions, turns = np.empty((len(qpos), model.nbody, 3)), np.empty((len(qpos), model.nbody, 4))
    for t, q in enumerate(qpos):
        data.qpos[:] = q
        mujoco.mj_kinematics(model, data)
        positions[t], turns[t] = data.xpos + np.asarray(offset), data.xquat[:, [1, 2, 3, 0]]
    visible = [g for g in range(model.ngeom) if model.geom_group[g] < 3 and model.geom_type[g] in _SHAPES]
    for body in sorted({int(model.geom_bodyid[g]) for g in visible}):
        name = f"{entity}/{model.body(body).name or body}"
        moving = model.body_weldid[body] != 0
        times = ticks(len(qpos), tick_s) if moving else []
        if moving:
            stream.send_columns(
                name, times, rr.Transform3D.columns(translation=positions[:, body], quaternion=turns[:, body])
            )
        else:
            stream.log(
                name,
                rr.Transform3D(translation=positions[0, body], quaternion=rr.Quaternion(xyzw=turns[0, body])),
                static=True,
            )
        for geom in (g for g in visible if model.geom_bodyid[g] == body):
            _log_geom(stream, f"{name}/{model.geom(geom).name or geom}", model, geom, tint)


_SHAPES = {
    int(mujoco.mjtGeom.mjGEOM_BOX), int(mujoco.mjtGeom.mjGEOM_CAPSULE), int(mujoco.mjtGeom.mjGEOM_SPHERE),
    int(mujoco.mjtGeom.mjGEOM_CYLINDER), int(mujoco.mjtGeom.mjGEOM_ELLIPSOID),
}  # fmt: skip


def _log_geom(
    stream: rr.RecordingStream, entity: str, model: mujoco.MjModel, geom: int, tint: tuple[int, int, int] | None
) -> None:
    size, place = model.geom_size[geom], model.geom_pos[geom]
    turn = rr.Quaternion(xyzw=model.geom_quat[geom][[1, 2, 3, 0]])
    rgb = model.geom_rgba[geom][:3] * 255
    colour = [tuple(int(c) for c in (rgb if tint is None else 0.35 * rgb + 0.65 * np.array(tint)))]
    kind = int(model.geom_type[geom])
    common = {"colors": colour, "fill_mode": "solid", "quaternions": [turn]}
    if kind == int(mujoco.mjtGeom.mjGEOM_CAPSULE):
        matrix = np.zeros(9)
        mujoco.mju_quat2Mat(matrix, model.geom_quat[geom])
        start = place - matrix.reshape(3, 3)[:, 2] * size[1]
        shape = rr.Capsules3D(lengths=[2 * size[1]], radii=[size[0]], translations=[start], **common)
    elif kind == int(mujoco.mjtGeom.mjGEOM_CYLINDER):
        shape = rr.Cylinders3D(lengths=[2 * size[1]], radii=[size[0]], centers=[place], **common)
    elif kind == int(mujoco.mjtGeom.mjGEOM_BOX):
        shape = rr.Boxes3D(half_sizes=[size], centers=[place], **common)
    else:
        radii = size if kind == int(mujoco.mjtGeom.mjGEOM_ELLIPSOID) else np.repeat(size[0], 3)
        shape = rr.Ellipsoids3D(half_sizes=[radii], centers=[place], **common)
    stream.log(entity, shape, static=True)


def log_stick_figure(
    stream: rr.RecordingStream,
    entity: str,
    points: FloatArray,
    bones: Sequence[tuple[int, int]],
    tick_s: float,
    colour: tuple[int, int, int],
    thickness: float = 0.012,
) -> None:
    """A teacher as lines between (T, K, 3) points."""
    times = ticks(len(points), tick_s)
    count = len(bones)
    segments = points[:, np.array(bones)].reshape(-1, 2, 3)
    stream.log(entity, rr.LineStrips3D.from_fields(colors=[colour], radii=[thickness]), static=True)
    stream.send_columns(entity, times, rr.LineStrips3D.columns(strips=list(segments)).partition([count] * len(points)))


class _Rows:
    """Several rows of a tensor component, which the column interface does not take as such."""

    def __init__(self, rows: FloatArray) -> None:
        self.rows = rows

    def as_arrow_array(self) -> pa.Array:
        parts = [
            rr.components.TensorDataBatch(np.ascontiguousarray(row, np.float32)).as_arrow_array() for row in self.rows
        ]
        return pa.concat_arrays(parts)


def log_bars(stream: rr.RecordingStream, entity: str, rows: FloatArray, tick_s: float) -> None:
    """(T, N) a bar chart that changes through time."""
    descriptor = rr.ComponentDescriptor(
        "BarChart:values", archetype="rerun.archetypes.BarChart", component_type="rerun.components.TensorData"
    )
    stream.send_columns(entity, ticks(len(rows), tick_s), [rr.ComponentColumn(descriptor, _Rows(rows))])


def heat_map(values: FloatArray, colours: str = "magma", tall: int = 1, wide: int = 1) -> NDArray[np.uint8]:
    """(H, W) numbers as an RGB picture, rows and columns repeated to be seen."""
    span = values.max() - values.min()
    scaled = (values - values.min()) / (span if span > 0 else 1.0)
    rgb = (matplotlib.colormaps[colours](scaled)[..., :3] * 255).astype(np.uint8)
    return np.repeat(np.repeat(rgb, tall, axis=0), wide, axis=1)
