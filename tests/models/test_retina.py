from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from models.biclops.room import Ball
from models.errors import BodyError
from models.heads import stage
from models.objects import TOYS
from models.objects.retinas import Room
from models.objects.scene import seated
from models.renderers import RENDERERS, open_eye
from models.retina import RetinaOptions
from models.retina_rays import VISIBLE_GROUPS, RayEye, _shade
from models.robots import ROBOTS

BALL = Ball("ball", (0.6, 0.05, 0.2), (0.9, 0.1, 0.1), radius=0.03)


@pytest.fixture(scope="module")
def scene() -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = stage("biclops", teacher=True, balls=[BALL]).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def _every_ray(eye: RayEye, data: mujoco.MjData) -> np.ndarray:
    """The image with one ray through each pixel and no shortcut: the oracle."""
    colour = _shade(eye._cast(data, eye._pixel_rays), eye._lights(data))
    return colour.reshape(eye.options.height, eye.options.width, 3)


def _met(model: mujoco.MjModel, data: mujoco.MjData, start: np.ndarray, ways: np.ndarray, own: int = -1) -> np.ndarray:
    """Geoms that single rays meet, and their depths, (n, 2): the oracle."""
    geom = np.empty(1, np.int32)
    depths = [(mujoco.mj_ray(model, data, start, way, VISIBLE_GROUPS, 1, own, geom), geom[0]) for way in ways]
    return np.array(depths)[:, ::-1]


STAGES = [name for name, robot in ROBOTS.items() if robot.head]
SEATED = [name for name, robot in ROBOTS.items() if robot.seat]


def _at_table(name: str, toy: str | None) -> mujoco.MjSpec:
    robot = ROBOTS[name]
    assert robot.seat is not None
    spec = seated(robot, robot.seat, TOYS[toy] if toy else None)
    Room().furnish(spec)
    return spec


@pytest.mark.parametrize(
    "scene_of",
    [pytest.param(lambda n=n: stage(n, teacher=True, balls=[BALL]), id=n) for n in STAGES]
    + [pytest.param(lambda n=n, t=t: _at_table(n, t), id=f"{n} {t}") for n in SEATED for t in (None, *TOYS)],
)
def test_rays_together_meet_what_single_rays_meet(scene_of: Callable[[], mujoco.MjSpec]) -> None:
    """In every scene that eyes look at, in any posture: rays at whatever is there, and just past it."""
    model = scene_of().compile()
    data, rng = mujoco.MjData(model), np.random.default_rng(4)
    eyes = [RayEye(model, model.camera(c).name, RetinaOptions()) for c in range(model.ncam)]
    turning = np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE)
    for _ in range(3):
        data.qpos[model.jnt_qposadr[turning]] = rng.uniform(*model.jnt_range[turning].T)
        mujoco.mj_forward(model, data)
        for eye in eyes:
            aims = data.geom_xpos[rng.integers(model.ngeom, size=150)] + rng.normal(0, 0.03, (150, 3))
            camera = data.cam(eye._camera)
            hits = eye._cast(data, (aims - camera.xpos) @ camera.xmat.reshape(3, 3))
            geoms, depths = _met(model, data, camera.xpos, hits.direction, eye._own_body).T
            np.testing.assert_array_equal(hits.geom, geoms)
            np.testing.assert_allclose(hits.depth[geoms >= 0], depths[geoms >= 0])


@pytest.mark.parametrize(
    "geoms",
    [
        '<geom size=".3" group="2" contype="0" conaffinity="0"/><geom size=".02" pos="0 0 -.6" group="3"/>',
        '<geom size=".3"/>',
    ],
    ids=["what is only seen", "a body turned"],
)
def test_bodies_that_rays_together_miss_are_seen(geoms: str) -> None:
    """Were the model cast at as it is, nothing would be there (MuJoCo 3.17)."""
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><worldbody><camera name="eye" xyaxes="0 -1 0 0 0 1"/>
        <body pos="2 1 0" euler="0 0 180"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
        <frame pos="0 1 0">{geoms}</frame></body></worldbody></mujoco>"""
    )
    data, before = mujoco.MjData(model), model.bvh_aabb.copy()
    mujoco.mj_forward(model, data)
    ahead, geom, depth = np.array([1.0, 0, 0]), np.empty(1, np.int32), np.empty(1)
    mujoco.mj_multiRay(model, data, np.zeros(3), ahead, VISIBLE_GROUPS, 1, -1, geom, depth, None, 1, 10.0)
    hits = RayEye(model, "eye", RetinaOptions())._cast(data, np.array([[0, 0, -1.0]]))
    assert geom[0] == -1
    assert (hits.geom[0], hits.depth[0]) == (0, pytest.approx(1.7))
    np.testing.assert_array_equal(model.bvh_aabb, before)  # it is the model that bodies touch by


@pytest.mark.parametrize("size", [(160, 120), (101, 67)])
def test_plain_blocks_hide_nothing(scene, size) -> None:
    model, _ = scene
    data, rng = mujoco.MjData(model), np.random.default_rng(3)
    saved = 0.0
    for camera in ("left_eye", "onlooker"):
        eye = RayEye(model, camera, RetinaOptions(*size, antialias=False))
        for _ in range(12):
            data.qpos[:] = rng.uniform([-3, -1, -3, -1], [3, 1, 3, 1])
            data.mocap_pos[0] = rng.uniform([0.15, -0.4, 0.0], [1.0, 0.4, 0.4])
            mujoco.mj_forward(model, data)
            np.testing.assert_allclose(eye._colour(data), _every_ray(eye, data), atol=1.0)  # levels of 255
            saved += eye._plain_blocks(data, eye._cast(data, eye._corner_rays.reshape(-1, 3))).mean() / 24
    assert saved > 0.5  # or the shortcut would be none


def test_a_camera_inside_a_box_and_a_mesh_still_see_everything() -> None:
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><asset><mesh name="m" vertex="0 0 0  .3 0 0  0 .3 0  0 0 .3"/></asset><worldbody>
        <camera name="eye" pos="0 0 0" euler="10 0 20"/>
        <geom type="box" size="2 2 1" rgba=".5 .6 .7 1"/>
        <body><geom type="mesh" mesh="m" pos="-.2 .1 -.6" rgba="1 0 0 1" contype="0" conaffinity="0"/></body>
        <body><geom type="capsule" size=".01 .4" pos=".1 0 -.5" euler="70 20 0" rgba="0 1 0 1" contype="0"
        conaffinity="0"/></body></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    eye = RayEye(model, "eye", RetinaOptions(antialias=False))
    exact = _every_ray(eye, data)
    np.testing.assert_allclose(eye._colour(data), exact, atol=1.0)
    hits = eye._cast(data, eye._pixel_rays[::7])
    np.testing.assert_array_equal(hits.geom, _met(model, data, data.cam_xpos[0], hits.direction)[:, 0])
    assert {tuple(c) for c in (exact > 60).reshape(-1, 3)} >= {(True, False, False), (False, True, False)}


def test_pinhole_projection() -> None:
    model = stage("biclops", balls=[BALL]).compile()
    data = mujoco.MjData(model)
    data.qpos[:] = 0.15, -0.1
    mujoco.mj_forward(model, data)
    eye = open_eye(model, "left_eye")
    camera = data.cam("left_eye")
    seen = (data.geom("ball").xpos - camera.xpos) @ camera.xmat.reshape(3, 3)
    u, v = 79.5 - eye.focal_px * seen[0] / seen[2], 59.5 + eye.focal_px * seen[1] / seen[2]
    image = eye.see(data).astype(int)
    rows, columns = np.nonzero((image[..., 0] > 2 * image[..., 1]) & (image[..., 0] > 60) & (image[..., 2] < 40))
    np.testing.assert_allclose([columns.mean(), rows.mean()], [u, v], atol=0.3)
    wider = open_eye(model, "left_eye", RetinaOptions(fovy_deg=90.0))
    assert wider.focal_px == pytest.approx(60.0)


def test_lambert_shading_of_a_directly_lit_wall() -> None:
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><visual><headlight active="0"/></visual><worldbody>
        <light directional="true" dir="0 0.6 -0.8" ambient=".1 .1 .1" diffuse=".5 .5 .5"/>
        <camera name="eye" pos="0 0 1"/><geom type="plane" size="5 5 .1" rgba=".8 .4 .2 1"/></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    image = open_eye(model, "eye").see(data)
    expected = np.rint(255 * np.array([0.8, 0.4, 0.2]) * (0.1 + 0.5 * 0.8))
    assert np.abs(image - expected).max() <= 1


def test_edges_are_smooth_only_with_antialiasing(scene) -> None:
    model, data = scene
    hard, soft = (open_eye(model, "left_eye", RetinaOptions(antialias=a)).see(data) for a in (False, True))
    changed = (hard != soft).any(axis=2)
    assert 0.01 < changed.mean() < 0.15


def test_noise_and_blur_are_what_they_say(scene) -> None:
    model, data = scene
    clean = open_eye(model, "left_eye").see(data).astype(float)
    noisy_eye = open_eye(model, "left_eye", RetinaOptions(noise=0.02))
    noisy = noisy_eye.see(data, np.random.default_rng(1))
    assert np.array_equal(noisy, noisy_eye.see(data, np.random.default_rng(1)))
    calm = (clean > 30) & (clean < 225)
    spread = (noisy - clean)[calm]
    assert abs(spread.mean()) < 0.1
    assert spread.std() == pytest.approx(np.sqrt(5.1**2 + 1 / 6), rel=0.02)  # both images are rounded to whole levels
    blurred = open_eye(model, "left_eye", RetinaOptions(blur=1.5)).see(data).astype(float)
    assert blurred.mean() == pytest.approx(clean.mean(), abs=0.3)
    assert np.abs(np.diff(blurred, axis=1)).max() < 0.6 * np.abs(np.diff(clean, axis=1)).max()
    with pytest.raises(BodyError, match="needs a random generator"):
        noisy_eye.see(data)


def test_colours_are_read_at_every_look(scene) -> None:
    model, data = scene
    eye = open_eye(model, "left_eye")
    before = eye.see(data)
    geom = model.geom("ball")
    was = geom.rgba.copy()
    geom.rgba[3] = 0.0
    gone = eye.see(data)
    geom.rgba[:] = was
    assert (before != gone).any(axis=2).sum() > 50
    assert np.array_equal(before, eye.see(data))


@pytest.mark.parametrize("renderer", RENDERERS)
def test_every_renderer_shows_the_same_scene(scene, renderer: str) -> None:
    model, data = scene
    try:
        eye = open_eye(model, "left_eye", renderer=renderer)
    except BodyError as error:
        pytest.skip(str(error))
    image = eye.see(data).astype(float)
    assert image.shape == (120, 160, 3)
    reference = open_eye(model, "left_eye").see(data).astype(float)
    assert np.median(np.abs(image - reference)) < 15


def test_wrong_eyes_are_refused_in_words(scene) -> None:
    model, _ = scene
    with pytest.raises(BodyError, match=r"unknown camera 'left_eyes'.*did you mean 'left_eye'"):
        open_eye(model, "left_eyes")
    with pytest.raises(BodyError, match="no cameras at all"):
        open_eye(mujoco.MjModel.from_xml_string("<mujoco/>"), "left_eye")
    with pytest.raises(BodyError, match=r"unknown renderer 'ray'.*did you mean 'rays'"):
        open_eye(model, "left_eye", renderer="ray")
