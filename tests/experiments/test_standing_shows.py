"""What a teacher shows of standing, and who judges it."""

from dataclasses import fields

import numpy as np
import pytest

import experiments.gesture.standing_shows as shown
from experiments.gesture.standing_shows import LIFTED_M, STEPS, knees_deg, shows, steps_on_the_spot, stood_on_one_leg
from experiments.shared.standing import Performance
from imitation.acting.balancing import Plan
from models.body import SimulatedBody
from models.hoap2.facts import JOINTS, RANGES_DEG
from models.loading import load_body


@pytest.fixture(scope="module")
def hung() -> SimulatedBody:
    return load_body("hoap2", threads=1)


def performance(angles: np.ndarray, lifted: np.ndarray, falls: int = -1) -> Performance:
    """(T, B, J) and (T, B, 2); copy `falls` does so at the end."""
    upright = np.ones(lifted.shape[:2], bool)
    upright[-1, falls] = falls < 0
    plan = Plan(*(np.zeros((1, 1, 1)) for _ in Plan._fields))
    untold = dict.fromkeys(field.name for field in fields(Performance)) | {"first": 0}
    return Performance(**untold | {"plan": plan, "angles": angles, "upright": upright, "lifted": lifted})  # type: ignore[arg-type]


def test_what_is_shown_begins_and_ends_at_home_within_the_joints_ranges(hung: SimulatedBody) -> None:
    home = shown.resting(hung)
    ends = np.deg2rad([RANGES_DEG[joint] for joint in JOINTS]).T
    for name, angles in shows(hung).items():
        np.testing.assert_allclose(angles[[0, -1]], np.tile(home, (2, 1)), atol=2e-3, err_msg=name)
        assert (angles >= ends[0]).all() and (angles <= ends[1]).all(), name
        assert np.abs(np.diff(angles, axis=0)).max() / hung.tick_s < 2.5, name


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_weight_is_on_a_leg_before_the_other_is_lifted(hung: SimulatedBody, side: str) -> None:
    [other] = {"left", "right"} - {side}
    angles = shows(hung)[f"{side} leg"] - shown.resting(hung)
    knees = {each: angles[:, JOINTS.index(f"{each}_leg_joint_4")] for each in ("left", "right")}
    assert not knees[side].any() and np.rad2deg(knees[other].max()) == pytest.approx(2 * shown.LIFT_DEG)
    sway = np.abs(angles[:, JOINTS.index(f"{side}_leg_joint_2")])
    assert (sway[knees[other] > 1e-9] > 0.999 * np.deg2rad(shown.SWAY_DEG)).all()


def test_judges_count_what_stands(hung: SimulatedBody) -> None:
    lifted = np.zeros((100, 3, 2))
    lifted[20:60, :, 1] = 2 * LIFTED_M
    lifted[70:80, :, 1] = 2 * LIFTED_M
    lifted[50:60, 1, 0] = 2 * LIFTED_M  # both: a jump
    angles = np.zeros((100, 3, len(JOINTS)))
    angles[50, :, JOINTS.index("left_leg_joint_4")] = 2.0
    angles[50:, :, JOINTS.index("right_leg_joint_4")] = 1.0
    done = performance(angles, lifted, falls=2)
    np.testing.assert_allclose(stood_on_one_leg(done, 0.02, "left"), [0.8, 0.6, 0])
    assert not stood_on_one_leg(done, 0.02, "right").any()
    assert steps_on_the_spot(done).tolist() == [2, 2, 0] and STEPS == 4
    np.testing.assert_allclose(knees_deg(done, hung), np.rad2deg([1.0, 1.0, 0]))
