"""Things of the face's colours that cross the view: where they are seen, and how tracking is judged."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from experiments.head.distractor import BALLS, PARTS, Crossed, Kept, Strays, keep
from experiments.head.options import Config
from experiments.shared.caregiver import FACE, FIND_FACE, FRAME_S, NUMBERS
from experiments.shared.eyes import open_eyes
from imitation.seeing.finding import alone
from imitation.seeing.trackers import TRACKERS


@pytest.fixture(scope="module")
def strays() -> Strays:
    how = Config(noise=0.0)
    body = open_eyes(how, FIND_FACE, copies=1, tick_s=FRAME_S, seed=0, teacher=True, distance=0.7, balls=BALLS)
    return Strays(body, [6.0], np.random.default_rng(0))


def test_each_crosses_the_view_and_hides_its_look_alike_on_the_way(strays: Strays) -> None:
    body, nose = strays.body, PARTS.index("nose")
    for time in (-30.0, strays.when[0, nose] - 0.8, strays.when[0, nose], strays.when[0, nose] + 0.8, 60.0):
        strays.move(time)
        body.reset()
        strays.note()
    found = strays.sightings[:, 0, :, nose]  # (5, eyes, n, 3)
    assert (np.isfinite(found[..., 2]).sum(-1) == [[1, 1], [2, 2], [1, 1], [2, 2], [1, 1]]).all()  # one hides the other
    face = alone(found)[0]
    assert (
        np.linalg.norm(found[2, :, 0, :2] - face[:, :2], axis=-1).max() < 10.0
    )  # they meet near the middle of both eyes
    sides = np.sign(found[[1, 3], :, :2, 0] - face[:, None, 0])
    away = np.abs(found[[1, 3], :, :2, 0] - face[:, None, 0]).argmax(-1)
    assert (
        np.take_along_axis(sides, away[..., None], -1)[0] == -np.take_along_axis(sides, away[..., None], -1)[1]
    ).all()


class Flat:
    """An appearance that does not change with the pose."""

    def expect(self, posture: np.ndarray) -> np.ndarray:
        return np.zeros((*posture.shape[:-1], 2 * len(FACE) * NUMBERS))


def kept(pose_off: float, feature_off: float, told: float) -> Kept:
    numbers = np.full((8, 2 * len(FACE), NUMBERS), np.nan)
    numbers[::2, : round(told * 2 * len(FACE)), :2] = (feature_off, 0.0)
    watched: Any = SimpleNamespace(pose=np.full((8, 2), np.deg2rad(pose_off)))
    return Kept(np.zeros((4, 2, 5, 2)), np.zeros((4, 2, 5)), numbers.reshape(8, -1), watched)


def test_tracking_is_judged_as_by_hand() -> None:
    truth = np.zeros((8, 2))
    truth[1::2] = np.nan
    runs = {"kalman": [kept(0.1, 0.5, 1.0)] * 4, "largest": [kept(d, 6.0, 0.5) for d in (1.0, 1.0, 2.0, 4.0)]}
    runs["none"] = [kept(3.0, 0.0, 0.0)] * 4
    crossed = Crossed(None, runs, [truth] * 4, Flat(), 0)  # type: ignore[arg-type]
    found = crossed.metrics
    assert found["distractor_rmse_deg"]["kalman"] == pytest.approx(0.1)
    assert found["distractor_rmse_deg"]["largest"] == pytest.approx(np.sqrt((1 + 1 + 4 + 16) / 4))
    low, high = found["distractor_interval_95_deg"]["largest"]
    assert 1.0 <= low < found["distractor_rmse_deg"]["largest"] < high <= 4.0
    assert found["distractor_feature_rmse_px"] == {"kalman": 0.5, "largest": 6.0, "none": None}
    assert found["distractor_wrong_share"] == {"kalman": 0.0, "largest": 1.0, "none": None}
    assert found["distractor_told_share"] == {"kalman": 1.0, "largest": 0.5, "none": 0.0}
    assert "| largest | 2.345 (" in crossed.summary and "| none | 3.000" in crossed.summary
    few = Crossed(None, {"none": runs["none"][:2]}, [truth] * 2, Flat(), 0)  # type: ignore[arg-type]
    assert few.metrics["distractor_interval_95_deg"]["none"] is None


@pytest.mark.parametrize("name", TRACKERS)
def test_what_is_told_lies_where_the_pose_filter_looks_for_it(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("experiments.head.distractor.watch", lambda appearance, numbers, tick_s: numbers)
    sightings = np.full((6, 2, len(FACE), 4, 3), np.nan)
    for eye in range(2):
        for part in range(len(FACE)):
            sightings[:, eye, part, 0] = (10.0 * part + 50, 5.0 * eye + 40, part + 1)
    one = keep(name, sightings, 120, None, 12, 0)  # type: ignore[arg-type]
    told = one.numbers.reshape(12, len(FACE), 2, NUMBERS)
    assert np.isnan(told[1::2]).all()
    np.testing.assert_array_equal(told[::2], sightings[..., 0, :].swapaxes(1, 2))
