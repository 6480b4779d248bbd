import mujoco
import numpy as np
import pytest

from imitation.errors import ImitationError
from imitation.seeing.features import COLOURS, Feature, find_features
from imitation.seeing.stereo import Geometry
from models.biclops import facts
from models.biclops.room import FACE_PREFIX, FEATURES, TEACHER, Ball, wear_cloth
from models.heads import stage
from models.renderers import open_eye
from models.retina import RetinaOptions

WIDTH, HEIGHT = 160, 120
COLOUR_OF = {"left_eye": "blue", "right_eye": "green", "nose": "red", "left_ear": "yellow", "right_ear": "magenta"}


def _errors(radius: float, noise: float, looks: int) -> tuple[np.ndarray, np.ndarray]:
    """Centroid errors (looks, 2) and areas of a red ball at 0.6 m; every look must find it and nothing else."""
    model = stage("biclops", balls=[Ball("ball", (0.6, 0, 0.2), (0.95, 0.08, 0.08), radius)]).compile()
    data, rng = mujoco.MjData(model), np.random.default_rng(5)
    eye = open_eye(model, "left_eye", RetinaOptions(noise=noise))
    mujoco.mj_forward(model, data)
    camera = data.cam("left_eye")
    errors, areas = [], []
    for _ in range(looks):
        u, v = rng.uniform(20, 140), rng.uniform(15, 80)
        ray = np.array([(u - 79.5) / eye.focal_px, -(v - 59.5) / eye.focal_px, -1.0])
        data.mocap_pos[0] = camera.xpos + camera.xmat.reshape(3, 3) @ (0.6 * ray)
        mujoco.mj_forward(model, data)
        (found,) = find_features(eye.see(data, rng))
        assert found.label == "red" and found.whole
        errors.append((found.u - u, found.v - v))
        areas.append(found.area)
    return np.array(errors), np.array(areas)


@pytest.mark.parametrize("radius", [0.005, 0.01])
def test_centroids_are_finer_than_a_pixel(radius: float) -> None:
    errors, areas = _errors(radius, 0.0, 60)
    assert np.hypot(*errors.T).mean() <= 0.15  # 0.10 and 0.06 are usual
    assert np.abs(errors.mean(axis=0)).max() < 0.06  # shading does not pull
    focal = 60 / np.tan(np.deg2rad(46.826 / 2))
    assert areas.mean() == pytest.approx(np.pi * (focal * radius / 0.6) ** 2, rel=0.12)


def test_two_percent_noise_adds_little_and_invents_nothing() -> None:
    errors, _ = _errors(0.01, 0.02, 60)
    assert np.hypot(*errors.T).mean() <= 0.15


def _located(left: Feature, right: Feature, focal: float) -> np.ndarray:
    """(3,) m ahead, left and up of the middle between the eyes."""
    middle = np.array([WIDTH - 1, HEIGHT - 1]) / 2
    things = np.array([left[1:3] - middle, right[1:3] - middle]).ravel()
    return np.asarray(Geometry(focal).locate(things, 0.0) * facts.BASELINE)


def _face(noise: float) -> tuple[list[tuple[Feature, ...]], mujoco.MjModel, mujoco.MjData]:
    model = stage("biclops", teacher=True, distance=0.8).compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    rng = np.random.default_rng(0)
    options = RetinaOptions(WIDTH, HEIGHT, noise=noise)
    return [find_features(open_eye(model, f"{s}_eye", options).see(data, rng)) for s in ("left", "right")], model, data


@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_a_face_is_found_in_both_eyes_and_in_depth(noise: float) -> None:
    (left, right), model, data = _face(noise)
    assert sorted(f.label for f in left) == sorted(f.label for f in right) == sorted(COLOUR_OF.values())
    pairs = {f.label: (f, next(g for g in right if g.label == f.label)) for f in left}
    middle = (data.cam("left_eye").xpos + data.cam("right_eye").xpos) / 2
    focal = open_eye(model, "left_eye", RetinaOptions(WIDTH, HEIGHT)).focal_px
    for name in FEATURES:
        geom = f"{TEACHER}{FACE_PREFIX}{name}"
        place = _located(*pairs[COLOUR_OF[name]], focal)
        # what shows of a geom is its near side, at most its size nearer than its centre
        np.testing.assert_allclose(place, data.geom(geom).xpos - middle, atol=0.01 + model.geom(geom).size.max())


@pytest.mark.parametrize(("cloth", "eyes"), [("blindfold", set()), ("headband", {"blue", "green"})])
def test_a_blindfold_hides_the_eyes_and_a_headband_does_not(cloth: str, eyes: set[str]) -> None:
    model = stage("biclops", teacher=True, distance=0.8).compile()
    data = mujoco.MjData(model)
    wear_cloth(model, cloth)
    for pan, tilt in ((0.0, 0.0), (0.3, 0.2), (-0.3, 0.2), (0.25, -0.2), (0.0, 0.3)):
        data.qpos[2:] = pan, tilt
        mujoco.mj_forward(model, data)
        labels = {feature.label for feature in find_features(open_eye(model, "left_eye").see(data))}
        assert labels & {"blue", "green"} == eyes
        assert "red" in labels


def test_stereo_error_follows_the_disparity_law() -> None:
    model = stage("biclops", balls=[Ball("ball", (0.6, 0, 0.2), (0.0, 0.8, 0.8), 0.01)]).compile()
    data = mujoco.MjData(model)
    focal = open_eye(model, "left_eye").focal_px
    for x in (0.4, 0.8, 1.2):
        errors = []
        for y in np.linspace(-0.06, 0.05, 7):
            data.mocap_pos[0] = x, y, 0.24
            mujoco.mj_forward(model, data)
            seen = [find_features(open_eye(model, f"{side}_eye").see(data)) for side in ("left", "right")]
            (left,), (right,) = seen
            place = _located(left, right, focal)
            errors.append(place - data.mocap_pos[0] + [0, 0, facts.PAN_HEIGHT + facts.CAMERA_HEIGHT])
        depth_error = np.sqrt(np.mean(np.square(errors), axis=0))[0]
        assert depth_error < 0.25 * x**2 / (focal * facts.BASELINE)  # a quarter of a pixel of disparity


def test_what_is_absent_is_not_listed_and_what_is_cut_off_says_so() -> None:
    image = np.full((40, 60, 3), 120, np.uint8)
    assert find_features(image) == ()
    image[10:20, 50:60] = (250, 20, 20)
    image[25:31, 10:16] = (20, 60, 250)
    image[33:35, 30:32] = (20, 60, 250)
    red, big, small = find_features(image)
    assert (red.label, red.whole) == ("red", False)
    assert (big.label, big.whole) == ("blue", True)
    assert big[1:4] == pytest.approx((12.5, 27.5, 36.0))
    assert small.area == pytest.approx(4.0) and small.u == pytest.approx(30.5)


@pytest.mark.parametrize("light", [0.35, 1.0])
@pytest.mark.parametrize("label", COLOURS)
def test_every_colour_is_known_by_its_name_in_light_and_shade(label: str, light: float) -> None:
    rng = np.random.default_rng(0)
    image = np.full((30, 30, 3), 110.0)
    image[10:18, 10:18] = 255 * light * np.array(COLOURS[label])
    noisy = np.clip(image + 5.1 * rng.standard_normal(image.shape), 0, 255).astype(np.uint8)
    assert [f.label for f in find_features(noisy)] == [label]


def test_grey_ground_is_nothing_and_shade_does_not_move_a_thing() -> None:
    image = np.full((30, 30, 3), 90, np.uint8)
    image[8:16, 8:12], image[8:16, 12:16] = (200, 40, 40), (100, 20, 20)  # half of it in shade
    (found,) = find_features(image)
    assert (found.u, found.v) == pytest.approx((11.5, 11.5), abs=0.02) and found.area == pytest.approx(64, rel=0.02)
    assert find_features(np.random.default_rng(0).integers(60, 200, (30, 30, 1)).repeat(3, 2).astype(np.uint8)) == ()


def test_wrong_images_are_refused_in_words() -> None:
    with pytest.raises(ImitationError, match=r"shape \(4, 4\) of float64"):
        find_features(np.zeros((4, 4)))
    with pytest.raises(ImitationError, match="shows nothing"):
        find_features(np.zeros((0, 5, 3), np.uint8))
