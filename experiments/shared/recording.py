"""Pieces that recordings share: bodies as moving shapes, teachers as stick figures, series, heat maps.

Episodes are buffered and sent once, column by column: a recording is then small and quick to open.
"""

import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import rerun as rr
import rerun.blueprint as rrb
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from babbling.axes import FloatArray
from experiments.shared.experiment import RUN
from experiments.shared.palette import DEMONSTRATED
from experiments.shared.report import drawn
from experiments.shared.views import with_room
from models.shapes import Part, Shape

STEPS_S = 8.0
"""Steps a second where there is no other time."""
GHOSTLY = 90
"""Of 255: how much of a ghost's meshes is seen."""


class Timed(rr.RecordingStream):
    """A stream that knows when it ends."""

    end = 0
    """ns, or steps, of the timeline of this name that `recording` opens with."""
    timeline = "sim_time"

    def send_columns(self, entity_path: str, indexes: Iterable[rr.TimeColumn], *columns: Any, **more: Any) -> None:  # type: ignore[override]
        """As ever."""
        indexes = list(indexes)
        for index in indexes:
            if index.timeline == self.timeline and len(index.times):
                self.end = max(self.end, int(index.times.cast("int64").to_numpy().max()))
        super().send_columns(entity_path, indexes, *columns, **more)


@contextmanager
def recording(
    path: Path, application: str, name: str, layout: rrb.Container, summary: str, timeline: str = "sim_time"
) -> Iterator[rr.RecordingStream]:
    """A recording stream into a file, layout and summary inside; complete when the block ends.

    Raises:
        OSError: it cannot be written: it is held in memory until then, for on a full disk Rerun's own writer waits for
            ever, or leaves a piece without a word.
    """
    rr.set_strict_mode(True)
    run = RUN.get()
    stream = Timed(application, recording_id=run.identity if run else name)
    stream.timeline = timeline
    held = stream.memory_recording()
    stream.send_recording_name(name)
    for section, values in (run.properties if run else {}).items():
        if values:
            stream.send_property(section, rr.AnyValues(**values))
    stream.log("summary", rr.TextDocument(summary, media_type=rr.MediaType.MARKDOWN), static=True)
    yield stream
    with_room(layout, stream.end)
    blueprint = rrb.Blueprint(
        layout,
        rrb.TimePanel(state="collapsed", timeline=timeline, play_state="paused", loop_mode="all", fps=STEPS_S),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
    )
    stream.send_blueprint(blueprint)
    path.write_bytes(held.drain_as_bytes())
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


def log_states(
    stream: rr.RecordingStream,
    entity: str,
    colours: Mapping[str, tuple[int, int, int] | None],
    states: Sequence[str],
    tick_s: float,
    begin: int = 0,
) -> None:
    """Which of several states, by name, it is in at each tick from `begin` on."""
    changes = [t for t, state in enumerate(states) if t == 0 or state != states[t - 1]]
    lights = [light for light in colours.values() if light]
    stream.log(entity, rr.StateConfiguration(values=[*colours], labels=[*colours], colors=lights or None), static=True)
    at = np.array(changes) + begin
    index = [rr.TimeColumn("sim_time", duration=at * tick_s), rr.TimeColumn("step", sequence=at)]
    stream.send_columns(entity, index, rr.StateChange.columns(state=[states[t] for t in changes]))


def log_body(
    stream: rr.RecordingStream,
    entity: str,
    parts: Sequence[Part],
    tick_s: float,
    *,
    offset: Sequence[float] = (0.0, 0.0, 0.0),
    tint: tuple[int, int, int] | None = None,
    ghost: bool = False,
) -> None:
    """A body's visible parts, moving; a ghost's are edges, and meshes that one sees through."""
    for part in parts:
        name = f"{entity}/{rr.escape_entity_path_part(part.name)}"
        places = part.positions + np.asarray(offset)
        if part.moves:
            poses = rr.Transform3D.columns(translation=places, quaternion=part.turns)
            stream.send_columns(name, ticks(len(places), tick_s), poses)
        else:
            pose = rr.Transform3D(translation=places[0], quaternion=rr.Quaternion(xyzw=part.turns[0]))
            stream.log(name, pose, static=True)
        for shape in part.shapes:
            _log_shape(stream, f"{name}/{rr.escape_entity_path_part(shape.name)}", shape, tint, ghost)


def _log_shape(
    stream: rr.RecordingStream, entity: str, shape: Shape, tint: tuple[int, int, int] | None, ghost: bool
) -> None:
    def tinted(rgb: FloatArray) -> NDArray[np.uint8]:
        share = 1.0 if tint is None else 0.0 if ghost else 0.35
        return (255 * share * rgb + (1 - share) * np.array(tint or (0, 0, 0))).astype(np.uint8)

    size, place, mesh, colour = shape.size, shape.place, shape.mesh, tinted(shape.colour)
    mode = "majorwireframe" if ghost else "solid"
    common: dict[str, Any] = {"colors": [colour], "fill_mode": mode, "quaternions": [rr.Quaternion(xyzw=shape.turn)]}
    drawn: Any
    if shape.kind == "capsule":  # it begins at its origin
        start = place - shape.axis * size[1]
        drawn = rr.Capsules3D(lengths=[2 * size[1]], radii=[size[0]], translations=[start], **common)
    elif shape.kind == "cylinder":
        drawn = rr.Cylinders3D(lengths=[2 * size[1]], radii=[size[0]], centers=[place], **common)
    elif mesh:
        drawn = rr.Mesh3D(
            vertex_positions=mesh.corners,
            vertex_normals=mesh.normals,
            triangle_indices=mesh.triangles,
            vertex_colors=None if mesh.paint is None or ghost else tinted(mesh.paint),
            albedo_factor=[*colour, GHOSTLY] if ghost else colour if mesh.paint is None else None,
        )
    elif shape.kind == "box":
        drawn = rr.Boxes3D(half_sizes=[size], centers=[place], **common)
    else:
        radii = size if shape.kind == "ellipsoid" else np.repeat(size[0], 3)
        drawn = rr.Ellipsoids3D(half_sizes=[radii], centers=[place], **common)
    stream.log(entity, drawn, static=True)


def log_stick_figure(
    stream: rr.RecordingStream,
    entity: str,
    points: FloatArray,
    bones: Sequence[tuple[int, int]],
    tick_s: float,
    colour: tuple[int, int, int],
    thickness: float = 0.012,
) -> None:
    """Lines between (T, K, 3) points: a teacher, a gaze."""
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


BARS = rr.ComponentDescriptor(
    "BarChart:values", archetype="rerun.archetypes.BarChart", component_type="rerun.components.TensorData"
)


def log_bars(
    stream: rr.RecordingStream,
    entity: str,
    rows: FloatArray,
    tick_s: float,
    places: FloatArray | None = None,
    colour: tuple[int, int, int] = DEMONSTRATED,
    width: float = 1.0,
) -> None:
    """(T, N) a bar chart that changes through time, its bars at these places (0, 1, 2 ... where none are given)."""
    at = np.arange(rows.shape[1], dtype=float) if places is None else places
    wide = np.full(len(at), width * np.diff(at).mean() if len(at) > 1 else width)
    look = rr.BarChart(rows[0], color=colour, abscissa=at, widths=wide).as_component_batches()
    stream.log(entity, [part for part in look if part.component_descriptor() != BARS], static=True)
    stream.send_columns(entity, ticks(len(rows), tick_s), [rr.ComponentColumn(BARS, _Rows(rows))])


def log_figure(stream: rr.RecordingStream, entity: str, figure: Figure) -> None:
    """A figure as a still picture, the same as its file."""
    stream.log(entity, rr.EncodedImage(contents=drawn(figure), media_type="image/png"), static=True)


def png(rgb: NDArray[np.uint8]) -> bytes:
    """A picture (H, W, 3) as a file."""
    file = io.BytesIO()
    Image.fromarray(rgb).save(file, "PNG")
    return file.getvalue()
