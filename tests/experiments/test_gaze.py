"""Gaze following as an experiment: cloths, stages and toys, how it is judged, refusals."""

import numpy as np
import pytest
from scipy.stats import binom

from babbling.errors import BabblingError
from experiments.errors import ExperimentError
from experiments.gaze.covered import own_experience
from experiments.gaze.run import Config, run
from experiments.gaze.trials import view
from experiments.shared.judging import calibration_error, interval_95
from imitation.gaze.reader import EyeLore
from models.biclops.cloth import through_cloth
from models.biclops.gaze import lay_out, look_at, possible, separation
from models.errors import BodyError
from models.heads import stage
from models.onlooker import onlook


def test_whether_a_cloth_lets_one_see_is_seen() -> None:
    rng = np.random.default_rng(0)
    image = np.full((60, 80, 3), 150, np.uint8)
    for column, rgb in ((20, (255, 115, 0)), (60, (0, 230, 230))):
        image[25:35, column - 5 : column + 5] = rgb
    belief = {}
    for kind in ("opaque", "see_through"):
        lore = EyeLore()
        own_experience(lore, None, [image], 0.02, rng)
        own_experience(lore, kind, [image], 0.02, rng)
        belief[kind] = lore.sees(True)[0]
    assert belief["opaque"] < 0.15 and belief["see_through"] > 0.85
    with pytest.raises(BodyError, match="unknown cloth 'silk'"):
        through_cloth(image, "silk", 0.0, rng)


def test_calibration_error_of_known_tables() -> None:
    rng = np.random.default_rng(3)
    sure = rng.uniform(0.3, 1.0, 20_000)
    assert calibration_error(sure, rng.random(20_000) < sure)[0] < 0.02
    error, bins = calibration_error(np.full(100, 0.95), np.arange(100) < 50)
    assert error == pytest.approx(0.45)
    assert bins[:, 2].sum() == 100


@pytest.mark.parametrize(("hits", "count"), [(0, 7), (3, 20), (20, 20)])
def test_an_exact_interval_leaves_a_fortieth_on_either_side(hits: int, count: int) -> None:
    low, high = interval_95(hits, count)
    assert low == 0.0 if hits == 0 else binom.sf(hits - 1, count, low) == pytest.approx(0.025)
    assert high == 1.0 if hits == count else binom.cdf(hits, count, high) == pytest.approx(0.025)


def test_a_teacher_that_looks_at_a_toy_has_it_in_the_middle_of_its_view() -> None:
    model = stage("biclops", teacher=True, distance=0.95).compile()
    targets = np.array([[0.4, 0.2, 0.022], [0.6, -0.15, 0.022]])
    seen = onlook(model, "biclops", np.zeros((2, 2)), look_at(targets, 0.95), {})
    assert seen.teacher_gaze is not None
    start, way = seen.teacher_gaze
    off = np.linalg.norm(np.cross(targets - start, way), axis=-1)
    np.testing.assert_allclose(off, 0.0, atol=1e-6)


def test_toys_lie_as_far_apart_as_asked_and_in_view() -> None:
    seen = view(Config())
    rng = np.random.default_rng(0)
    four = lay_out(rng, 4, 0.95, seen, (15.0, 180.0))
    first, second = np.triu_indices(4, 1)
    assert np.rad2deg(separation(four[first], four[second], 0.95)).min() >= 15.0
    pair = lay_out(rng, 2, 0.95, seen, (5.7, 6.3))
    assert np.rad2deg(separation(pair[0], pair[1], 0.95)) == pytest.approx(6.0, abs=0.3)
    assert not possible(np.array([[0.2, 0.6, 0.022]]), 0.95, seen, (0.0, 180.0))


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"objects": "0.5,0.1;0.5,0.9"}, "object 2 at 0.5,0.9 m is outside every direction"),
        ({"objects": "here"}, "give x,y;x,y in metres"),
        ({"objects": "0.5,0.1"}, "2 to 4 are possible"),
        ({"objects": "0.5,0.1;0.5,-0.1", "target": 3}, "there are 2 objects"),
        ({"aim_deg": 0.0}, "at most 20 degrees"),
        ({"distance": 3.0}, "between 0.7 and 1.2 m"),
        ({"width": 0}, "a retina width of 0 pixels"),
        ({"robot": "maze"}, "unknown robot with eyes 'maze'"),
    ],
)
def test_options_that_cannot_be_meant_are_refused_in_one_line(options: dict[str, object], text: str) -> None:
    with pytest.raises((ExperimentError, BabblingError, BodyError), match=text) as caught:
        run(Config(**options))  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)
