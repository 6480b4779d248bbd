"""Seeing faces: marks by colour, an innate template against ray casting, and poses and relations found together."""

import numpy as np
import pytest
from numpy.typing import NDArray

from experiments.face.showing import Shown, performed, still, truth
from imitation.errors import ImitationError
from imitation.seeing.face_fit import (
    BROW_PX,
    DOUBT,
    SIGMA_PX,
    STILL,
    TONGUE_PX,
    USUAL,
    Acquainted,
    acquaint,
    look_at,
    see,
)
from imitation.seeing.face_marks import NUMBERS, POINTS, coverage, numbers
from imitation.seeing.face_template import APART_M, FACING, MOVING, POSE, SHAPE, appear, parts
from imitation.seeing.features import COLOURS
from models.face import FACES, JOINTS
from models.face.looks import FOCAL_PX, Onlooker, View

Array = NDArray[np.float64]
FOCAL, AVERAGE = 450.0, np.array(list(SHAPE.values()))
TONGUE = slice(2 * len(POINTS) - 2, None)
BEYOND, UP = MOVING.index("beyond"), MOVING.index("up")
KNOWN = Acquainted(AVERAGE, np.array([0, 0, 0, 0.3, 0, 0.01]), FOCAL)


def moved(**relations: float) -> Array:
    """(12,) a look at rest but for these."""
    look = USUAL.copy()
    for name, amount in relations.items():
        look[POSE + MOVING.index(name)] = amount
    return look


def shown(look: Array, face: Acquainted = KNOWN, noise: float = 0.0, seed: int = 0) -> Array:
    """(2, NUMBERS) what both eyes see."""
    exact = appear(face.shape, face.pose, look[None], face.focal_px)[0]
    return np.asarray(exact + noise * np.random.default_rng(seed).standard_normal(exact.shape))


def hidden(numbers: Array) -> Array:
    """The same without a tongue."""
    numbers[:, TONGUE] = np.nan
    return numbers


# --------------------------------------------------------------------------------------------- template


def hits(rays: Array, middle: Array, axes: Array) -> Array:
    """(n,) how far along (n, 3) rays an ellipsoid is met, infinite where it is missed: the quadratic's lesser root."""
    flat = np.linalg.inv(axes)
    d, c = rays @ flat.T, flat @ middle
    a, b, rest = (d * d).sum(1), d @ c, c @ c - 1
    root = b * b - a * rest
    return np.where(root > 0, (b - np.sqrt(np.maximum(root, 0))) / a, np.inf)


@pytest.mark.parametrize("look", [
    moved(gap=0.5, beyond=0.4), moved(gap=0.3, beyond=0.1, side=0.25, up=0.1), moved(gap=0.4, beyond=-0.05, purse=0.2),
    moved(gap=0.7, beyond=0.3, side=-0.3) + np.r_[0.25, 0.15, -0.1, 0, 0, 0, np.zeros(6)],
])  # fmt: skip
def test_what_is_seen_of_a_tongue_is_what_rays_meet_first(look: Array) -> None:
    """Cast one by one, four to a pixel's side: its area and its middle, both eyes."""
    from_template = appear(AVERAGE, KNOWN.pose, look[None], FOCAL)[0]
    here = parts(AVERAGE, look[None, POSE:])
    yaw, nod, roll = look[:3]
    cy, sy, cn, sn, cr, sr = np.cos(yaw), np.sin(yaw), np.cos(nod), np.sin(nod), np.cos(roll), np.sin(roll)
    turn = (
        FACING
        @ np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
        @ np.array([[cn, 0, sn], [0, 1, 0], [-sn, 0, cn]])
        @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    )
    neck = AVERAGE[0] * np.array([-0.28, 0, -2.08])
    place = KNOWN.pose[3:] + FACING @ neck - turn @ neck
    for eye, side in enumerate((0.5, -0.5)):
        at = place - np.array([0, side * APART_M, 0])
        middle = turn @ here.tongue[0] + at
        centre = -middle[1:] / middle[0] * FOCAL
        grid = np.arange(-36, 36, 1 / 4) + 1 / 8
        u, v = np.meshgrid(centre[0] + grid, centre[1] + grid)
        rays = np.stack([np.ones(u.size), -u.ravel() / FOCAL, -v.ravel() / FOCAL], 1)
        tongue = hits(rays, middle, turn @ here.tongue_axes[0])
        lips = [hits(rays, turn @ here.lips[0, k] + at, turn @ here.lip_axes[0, k]) for k in range(4)]
        seen = np.isfinite(tongue) & (tongue < np.min(lips, axis=0))
        assert 100 < seen.sum() / 16 < 3000
        u_, v_, root = from_template[eye, TONGUE]
        assert root == pytest.approx(np.sqrt(seen.sum() / 16), rel=0.03)
        assert u_ == pytest.approx(u.ravel()[seen].mean(), abs=0.4)
        assert v_ == pytest.approx(v.ravel()[seen].mean(), abs=0.4)


def test_a_face_at_rest_stands_as_its_shape_says() -> None:
    """Straight before the eyes, by hand: an iris, the nose, a brow; a larger face further away looks the same."""
    mouth, apart, brows, eyes, ahead, nose = AVERAGE[:6]
    found = shown(USUAL)
    for name, place in {
        "left iris": (1.885, apart / 2, eyes), "nose": (ahead, 0, nose), "right brow": (1.715, -brows / 2, 0.65)
    }.items():  # fmt: skip
        x, y, z = mouth * np.array(place)
        depth, first = 0.3 - x, 2 * POINTS.index(name)
        for eye, side in enumerate((0.5, -0.5)):
            wanted = FOCAL * np.array([y + side * APART_M, -z - 0.01]) / depth
            np.testing.assert_allclose(found[eye, first : first + 2], wanted, atol=1e-9)
    left, right = found
    assert (left[0:18:2] > right[0:18:2]).all(), "everything is further right to the left eye"
    twice = Acquainted(AVERAGE * np.r_[2, np.ones(9)], KNOWN.pose * np.r_[1, 1, 1, 2, 2, 2], FOCAL)
    np.testing.assert_allclose(shown(USUAL, twice).mean(0), found.mean(0), rtol=0.01, atol=0.3)


@pytest.mark.parametrize("name, point, way", [
    ("gap", "lower left lip", (0, 1)), ("gap", "lower right lip", (0, 1)), ("brow", "left brow", (0, -1)),
    ("side", "tongue", (1, 0)), ("up", "tongue", (0, -1)), ("purse", "upper left lip", (-1, 0)),
    ("purse", "upper right lip", (1, 0)),
])  # fmt: skip
def test_each_relation_moves_its_own_points(name: str, point: str, way: tuple[int, int]) -> None:
    base = {"gap": 0.4, "beyond": 0.3}
    before, after = shown(moved(**base)), shown(moved(**(base | {name: base.get(name, 0.0) + 0.15})))
    place = 2 * POINTS.index(point)
    change = (after - before)[:, place : place + 2]
    assert (change @ way > 2.0).all()
    np.testing.assert_array_equal(after[:, :6], before[:, :6])  # irises and nose


# -------------------------------------------------------------------------------------------------- fits


def random_look(rng: np.random.Generator) -> Array:
    relations = rng.uniform([0.3, 0.1, -0.25, -0.15, 0.0, -0.12], [0.8, 0.6, 0.25, 0.15, 0.2, 0.12])
    pose = np.r_[rng.uniform(-0.2, 0.2, 2), rng.uniform(-0.02, 0.02), 0.002 * rng.standard_normal(3)]
    return np.r_[pose, relations]


@pytest.mark.parametrize("seed", range(5))
def test_a_look_is_recovered(seed: int) -> None:
    look = random_look(np.random.default_rng(seed))
    found = see(KNOWN, shown(look, noise=0.1, seed=seed))
    assert found.tongue and found.misses < 1
    wanted = np.r_[look[POSE:], look[:2] / (np.pi / 2)]
    np.testing.assert_allclose(found.relations, wanted, atol=0.04)
    np.testing.assert_allclose(found.relations[[0, 4, 5, 6, 7]], wanted[[0, 4, 5, 6, 7]], atol=0.008)
    np.testing.assert_allclose(found.look[POSE:], found.relations[:6])
    sure = np.sqrt(np.diag(np.linalg.inv(found.information)))
    assert (sure > 0.001).all() and (sure < 0.08).all()
    assert (np.linalg.eigvalsh(found.information) > 0).all() and np.allclose(found.information, found.information.T)


def test_information_is_what_the_marks_tell_with_roll_and_place_open() -> None:
    """By hand: slopes of all that is seen over their deviations; the covariance of the relations, turned round."""
    look, unit = random_look(np.random.default_rng(8)), np.r_[np.ones(6), np.pi / 2, np.pi / 2]
    deviation = np.full((2, NUMBERS), SIGMA_PX)
    deviation[:, TONGUE], deviation[:, [6, 8]] = TONGUE_PX, BROW_PX
    along = [POSE + np.arange(6), [0, 1], [2, 3, 4, 5]]
    steps = 1e-4 * np.eye(POSE + 6)[np.concatenate(along)]
    slopes = np.stack([((shown(look + s) - shown(look - s)) / 2e-4 / deviation).ravel() for s in steps])
    whole = slopes @ slopes.T
    whole[8:, 8:] += np.diag(1 / DOUBT[2:6] ** 2)
    covariance = np.linalg.inv(whole)[:8, :8] / np.outer(unit, unit)
    found = np.linalg.inv(see(KNOWN, shown(look)).information)
    np.testing.assert_allclose(np.sqrt(found.diagonal()), np.sqrt(covariance.diagonal()), rtol=0.15)
    scale = np.sqrt(np.outer(covariance.diagonal(), covariance.diagonal()))
    np.testing.assert_allclose(found / scale, covariance / scale, atol=0.2)


def test_a_hidden_tongue_is_not_told_of() -> None:
    found = see(KNOWN, hidden(shown(moved(gap=0.5), noise=0.1)))
    assert not found.tongue and found.relations[0] == pytest.approx(0.5, abs=0.01)
    tongue = [MOVING.index(name) for name in ("beyond", "side", "up")]
    assert (found.information[tongue] == 0).all() and (found.information[:, tongue] == 0).all()
    np.testing.assert_allclose(found.relations[tongue], STILL[tongue], atol=1e-6)
    rest = np.delete(np.arange(8), tongue)
    assert (np.linalg.eigvalsh(found.information[np.ix_(rest, rest)]) > 0).all()


def test_further_away_less_is_seen_and_what_is_seen_together_only_is_said_so() -> None:
    """Ahead and up look alike to eyes that stand close together."""
    deviations, together = [], []
    for distance in (0.3, 0.6):
        face = Acquainted(AVERAGE, np.array([0, 0, 0, distance, 0, 0.0]), FOCAL)
        found = see(face, shown(moved(gap=0.5, beyond=0.4, up=0.05), face))
        covariance = np.linalg.inv(found.information)
        deviations.append(np.sqrt(np.diag(covariance)))
        together.append(abs(covariance[BEYOND, UP]) / (deviations[-1][BEYOND] * deviations[-1][UP]))
    assert (deviations[1] > 1.5 * deviations[0]).all() and deviations[1][BEYOND] > 3 * deviations[0][BEYOND]
    assert min(together) > 0.35


@pytest.mark.parametrize("seed", range(3))
def test_proportions_and_pose_of_another_face_are_found(seed: int) -> None:
    """From eyes, nose, brows and lips of several looks; how wide a tongue is stays open while it is hidden."""
    rng = np.random.default_rng(seed)
    shape = AVERAGE * np.r_[rng.uniform(0.8, 1.3), rng.normal(1, 0.1, 9)]
    pose = np.r_[rng.normal(0, 0.15, 3), rng.uniform(0.25, 0.5), rng.normal(0, 0.02, 2)]
    face = Acquainted(shape, pose, FOCAL)
    looks = np.stack([hidden(shown(USUAL, face, 0.05, seed=9 * seed + n)) for n in range(3)])
    looks[0, 0, 3] = np.nan  # once a number was missed
    found = acquaint(looks, FOCAL)
    assert found.shape[0] == pytest.approx(shape[0], rel=0.01)
    np.testing.assert_allclose(found.shape[1:9], shape[1:9], atol=0.05)
    np.testing.assert_allclose(found.pose, pose, atol=0.006)
    np.testing.assert_allclose(hidden(shown(USUAL, found)), hidden(shown(USUAL, face)), atol=0.15)
    look = moved(brow=0.08)
    seen = see(found, hidden(shown(look, face, 0.05))).relations
    np.testing.assert_allclose(seen[[0, 4, 5]], [0, 0, 0.08], atol=0.02)


def test_where_there_is_no_face_none_is_found() -> None:
    with pytest.raises(ImitationError, match="no face is seen"):
        acquaint(np.full((3, 2, NUMBERS), np.nan), FOCAL)
    with pytest.raises(ImitationError, match="no face is seen"):
        wall = np.full((40, 40, 3), 150, np.uint8)
        acquaint(look_at((wall, wall))[None], FOCAL)
    half = np.stack([shown(USUAL)])
    half[:, 1] = np.nan
    with pytest.raises(ImitationError, match="in both eyes"):
        acquaint(half, FOCAL)


# ------------------------------------------------------------------------------------------------- marks

GREY, SKIN, FINE = (140.0, 140.0, 140.0), (165.0, 140.0, 120.0), 10
HUES = {"iris": "blue", "nose": "orange", "brow": "violet", "lip": "magenta", "tongue": "red"}


Thing = tuple[str, tuple[float, ...]]


def painted(
    things: list[Thing], light: float = 0.0, noise: float = 0.0, ground: tuple[float, ...] = GREY
) -> NDArray[np.uint8]:
    """(90, 120, 3) discs (x, y, radius) and boxes (x, y, half width, half height), the later in front; lit unevenly."""
    rows, columns = ((np.arange(n * FINE) + 0.5) / FINE - 0.5 for n in (90, 120))
    image = np.broadcast_to(np.array(ground), (90 * FINE, 120 * FINE, 3)).copy()
    for part, (x, y, *size) in things:
        off = columns - x, rows[:, None] - y
        inside = np.hypot(*off) < size[0] if len(size) == 1 else (abs(off[0]) < size[0]) & (abs(off[1]) < size[1])
        image[inside] = 220 * np.array(COLOURS[HUES[part]])
    image = image.reshape(90, FINE, 120, FINE, 3).mean((1, 3))
    shade = 1 - light * (np.arange(120) / 119)[:, None] - light / 2 * (np.arange(90) / 89)[:, None, None]
    rng = np.random.default_rng(0)
    return np.clip(image * shade + 255 * noise * rng.standard_normal(image.shape), 0, 255).round().astype(np.uint8)


MOUTH = (("lip", (60.3, 60.2, 12.0, 2.5)), ("lip", (60.3, 67.4, 12.0, 2.5)))
EYES = (("iris", (45.2, 30.3, 3.6)), ("iris", (75.7, 30.1, 3.6)), ("nose", (60.4, 44.6, 5.0)))
BROWS = (("brow", (44.7, 20.4, 6.0, 1.5)), ("brow", (76.1, 20.4, 6.0, 1.5)))


@pytest.mark.parametrize("light, ground, finer", [(0.0, GREY, 0.2), (0.4, GREY, 0.2), (0.4, SKIN, 0.35)])
def test_middles_are_finer_than_pixels_in_any_light(light: float, ground: tuple[float, ...], finer: float) -> None:
    """Discs to a tenth of a pixel; narrow bars lose part of their rims, most on ground that has a hue itself."""
    found = numbers(coverage(painted([*EYES, *BROWS, *MOUTH], light, ground=ground)))
    wanted = [(75.7, 30.1), (45.2, 30.3), (60.4, 44.6), (76.1, 20.4), (44.7, 20.4), (66.3, 60.2), (54.3, 60.2)]
    np.testing.assert_allclose(found[:14].reshape(-1, 2), wanted, atol=finer)
    np.testing.assert_allclose(found[:6].reshape(-1, 2), wanted[:3], atol=0.1)  # discs
    below = found[14:18].reshape(-1, 2)
    np.testing.assert_allclose(below[:, 1], 67.4, atol=finer)
    assert np.isnan(below[:, 0]).all(), "where along the lower lip is never told"
    assert np.isnan(found[TONGUE]).all()


def test_coverage_is_how_much_of_a_pixel_is_covered() -> None:
    covers = coverage(painted([("nose", (60.4, 44.6, 8.0))]))
    assert covers[1].sum() == pytest.approx(np.pi * 64, rel=0.03) and (covers[[0, 2, 3, 4]] == 0).all()
    assert (covers >= 0).all() and (covers <= 1).all()
    assert covers[1, 44, 60] == 1 and covers[1, 20, 20] == 0
    dim = coverage((0.6 * painted([("nose", (60.4, 44.6, 8.0))])).astype(np.uint8))
    assert dim[1].sum() == pytest.approx(covers[1].sum(), rel=0.02)


def test_a_tongue_covers_the_lower_lip_which_is_then_seen_at_its_ends() -> None:
    tongue = ("tongue", (60.8, 66.6, 5.5))
    found = numbers(coverage(painted([*EYES, *BROWS, *MOUTH, tongue])))
    np.testing.assert_allclose(found[18:20], tongue[1][:2], atol=0.1)
    assert found[20] == pytest.approx(np.sqrt(np.pi) * 5.5, rel=0.02)
    np.testing.assert_allclose(found[15:18:2], 67.4, atol=0.1)
    assert np.abs(found[11] - 60.2) < 0.4, "the upper lip too"
    aside = numbers(coverage(painted([*EYES, *BROWS, *MOUTH, ("tongue", (67.0, 66.6, 7.0))])))
    assert np.isnan(aside[15]) and aside[17] == pytest.approx(67.4, abs=0.1), "the covered end is not told"


def test_an_end_of_which_a_bit_is_left_is_not_told_at_the_border() -> None:
    bars = [("lip", (102.3, 60.2, 12.0, 2.5)), ("lip", (102.3, 67.4, 12.0, 2.5))]
    found = numbers(coverage(painted([*bars, ("tongue", (111.0, 64.5, 4.5))])))
    assert np.isnan(found[15]) and found[17] == pytest.approx(67.4, abs=0.1)


def test_an_end_of_which_a_bit_is_left_is_not_told_either() -> None:
    found = numbers(coverage(painted([*EYES, *BROWS, *MOUTH, ("tongue", (69.0, 64.5, 4.5))])))
    assert np.isnan(found[15]) and found[17] == pytest.approx(67.4, abs=0.1)


def test_places_are_told_from_the_middle_of_the_image() -> None:
    left, right = (painted([("nose", (59.5 + shift, 44.5, 5.0))]) for shift in (10, -10))
    np.testing.assert_allclose(look_at((left, right))[:, 4:6], [[10, 0], [-10, 0]], atol=0.05)


def test_noise_alone_is_no_face_and_hardly_moves_one() -> None:
    assert np.isnan(numbers(coverage(painted([], noise=0.02)))).all()
    clean, noisy = (numbers(coverage(painted([*EYES, *BROWS, *MOUTH], noise=n))) for n in (0.0, 0.02))
    np.testing.assert_allclose(noisy, clean, atol=0.25)


# -------------------------------------------------------------------------------------------- real images


def test_a_tongue_is_seen_within_a_millimetre() -> None:
    """Of a newborn's face: an adult puts out its tongue before two eyes with noise."""
    face, rng = FACES["adult"], np.random.default_rng(0)
    onlooker, passive = Onlooker(face, View(0.3)), still(face)
    first, second = (look_at(onlooker.look(passive, rng)) for _ in range(2))
    known = acquaint(np.stack([first, second]), FOCAL_PX)
    angles = np.zeros(len(JOINTS))
    angles[[0, 1, 2]] = np.deg2rad(12), 0.022 * face.proportions.size, np.deg2rad(10)
    posed = performed(face, [Shown(0, True, angles)])[-1, 0]
    change = truth(face).of(posed) - truth(face).of(passive)
    assert change[1] > 0.8
    rest, out = see(known, second), see(known, look_at(onlooker.look(posed, rng)))
    off = out.relations - rest.relations - change
    assert out.tongue and not rest.tongue
    assert np.abs(off[:6]).max() * 26 < 1.0 and np.abs(off[6:]).max() < 0.02
    assert known.shape[0] == pytest.approx(0.05, rel=0.02)
