"""Any body in a recording: meshes once, parts apart, files small, and all of it in the picture."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
import rerun.blueprint as rrb
from rerun.chunk import RrdReader

from experiments.shared import views
from experiments.shared.recording import log_body, recording
from experiments.shared.side_by_side import Stage
from models.body import resting
from models.loading import load_body
from models.shapes import box, parts
from tests.models.test_shapes import ball

BOXES = [
    ((0, -0.2, 0), (0.2, 0.7, 0.6)),
    ((-9, 3, -1), (9, 4, 1)),
    ((0, 0, 0), (0.01, 0.01, 5)),
    ((1, 1, 1), (1, 1, 1)),
]


@pytest.mark.parametrize(("low", "high"), BOXES)
def test_all_of_a_box_is_in_the_picture_and_fills_it(low: tuple[float, ...], high: tuple[float, ...]) -> None:
    ends = np.array([low, high], float)
    controls = views.framed("it", *ends).properties["EyeControls3D"]
    eye, target = (
        np.array(getattr(controls, name).as_arrow_array().to_pylist()[0]) for name in ("position", "look_target")
    )
    np.testing.assert_allclose(target, ends.mean(0), atol=1e-6)
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, (0, 0, 1))
    right /= np.linalg.norm(right)
    corners = np.array(np.meshgrid(*ends.T)).reshape(3, -1).T - eye
    depth = corners @ ahead
    assert (depth > 0).all()
    across, up = corners @ right / depth, corners @ np.cross(right, ahead) / depth
    edge = np.tan(views.FIELD / 2)
    filled = max(np.abs(across).max() / views.ASPECT, np.abs(up).max()) / edge
    assert filled <= 1 + 1e-4 and (filled > 0.99 or (ends[0] == ends[1]).all())


def test_two_bodies_stand_beside_each_other_without_touching() -> None:
    body = load_body("hoap2")
    angles = body.joint_range.mean(1) + 0.3 * np.ptp(body.joint_range, axis=1) * np.sin(np.arange(9))[:, None]
    mine = parts(body.model, body.configurations(angles))
    low, high = box(mine)
    stage = Stage.of(mine, [part.during(slice(3)) for part in mine])
    assert high[1] < low[1] + stage.aside < low[1] + 1.5 * (high - low)[1]
    np.testing.assert_allclose(stage.high - high, [0, stage.aside, 0])
    assert 0.4 < stage.height < 0.7


def test_a_heavy_body_is_drawn_in_a_small_file_its_mesh_once(tmp_path: Path) -> None:
    light, spec = ball(60), mujoco.MjSpec()
    spec.add_mesh(name="ball", uservert=light.mesh_vert.ravel(), userface=light.mesh_face.ravel())
    it = spec.worldbody.add_body(name="it")
    for _ in range(40):
        it.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="ball")
    heavy = spec.compile()
    shown = parts(heavy, np.tile(resting(heavy), (500, 1)))
    with recording(tmp_path / "it.rrd", "it", "it", rrb.Horizontal(), "") as stream:
        for name in ("imitator", "teacher"):
            log_body(stream, f"world/{name}", shown, 0.02)
    assert 40 * heavy.nmeshface > 560_000 and (tmp_path / "it.rrd").stat().st_size < 12e6
    reader = RrdReader(tmp_path / "it.rrd")
    chunks = [chunk for chunk in reader.stream(store=reader.recordings()[0]) if "/it/" in str(chunk.entity_path)]
    assert [(chunk.is_static, chunk.num_rows) for chunk in chunks] == [(True, 1)] * 80


def test_parts_with_slashes_in_their_names_do_not_carry_each_other(tmp_path: Path) -> None:
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body name='arm'><joint/><geom size='1'/><body name='arm/hand' pos='1 0 0'><joint/>"
        "<geom size='1' name='/a b'/></body></body></worldbody></mujoco>"
    )
    with recording(tmp_path / "it.rrd", "it", "it", rrb.Horizontal(), "") as stream:
        log_body(stream, "world/it", parts(model, np.zeros((2, 2))), 0.02)
    reader = RrdReader(tmp_path / "it.rrd")
    paths = {str(chunk.entity_path) for chunk in reader.stream(store=reader.recordings()[0])}
    assert {"/world/it/arm", "/world/it/arm\\/hand"} <= paths
    assert not any(path.startswith("/world/it/arm/hand") for path in paths)
