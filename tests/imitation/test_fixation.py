"""Looking at something by Eq. (1): enumerated on a known eye, within reach, and where it is 0/0."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from babbling.axes import Axis
from babbling.looking import Reach
from imitation.gaze.fixation import Fixation

FOCAL = 100.0
SIZES = {"u": 3, "v": 3, "other": 3, "change": 5, "moved": 7}
SPAN = {"u": 80.0, "v": 60.0, "other": 0.5, "change": 0.5, "moved": 8.0}
REACH = Reach(np.array([-0.6, -0.4]), np.array([0.6, 0.4]), np.array([0.5, 0.5]))


def known_eye(seed: int = 0, flat: bool = False) -> Any:
    """Two motors, two eyes (8 factors); things move by FOCAL per rad, but for what a random table says."""
    rng, factors = np.random.default_rng(seed), 8
    axes = tuple(Axis(n, "", np.full(factors, -SPAN[n]), np.full(factors, SPAN[n]), SIZES[n]) for n in SIZES)
    shape = (factors, *SIZES.values())
    table = np.full(shape, 1 / shape[-1]) if flat else rng.dirichlet(np.ones(shape[-1]), shape[:-1])

    def straight(context: tuple[np.ndarray, ...], action: np.ndarray, factors: slice) -> np.ndarray:
        return FOCAL * action

    def expect(things: np.ndarray, posture: np.ndarray, change: np.ndarray) -> np.ndarray:
        return things + FOCAL * np.tile(change, 2)

    pilot = SimpleNamespace(retina=SimpleNamespace(coordinates=4), reach=REACH, straight=straight, movers=np.arange(2))
    return SimpleNamespace(pilot=pilot, forward_model=SimpleNamespace(axes=axes, predictive=table), expect=expect)


@pytest.mark.parametrize("motor", [0, 1])
@pytest.mark.parametrize("eye", [0, 1])
def test_equation_one_over_changes_is_enumeration(motor: int, eye: int) -> None:
    mind = known_eye()
    fixation = Fixation(mind, eye=eye)
    things, posture = np.array([[20.0, 10.0, 12.0, 9.0], [-31.0, -20.0, -40.0, -21.0]]), np.array([[0.1, 0.2], [0, 0]])
    found, _ = fixation.posterior(motor, things, posture, goal=3.03)
    factor = motor * 4 + 2 * eye + motor
    grid = [axis.points[factor] for axis in mind.forward_model.axes]
    table = RegularGridInterpolator(grid, mind.forward_model.predictive[factor])
    for n, (thing, at) in enumerate(zip(things, posture, strict=True)):
        weight = []
        for change in fixation.candidates[motor].points[0]:
            left_over = 3.03 - thing[2 * eye + motor] - FOCAL * change
            fits = abs(left_over) <= SPAN["moved"] and REACH.low[motor] <= at[motor] + change <= REACH.high[motor]
            seen = (thing[2 * eye], thing[2 * eye + 1], at[1 - motor], change, left_over)
            weight.append(table(seen).item() if fits else 0.0)
        np.testing.assert_allclose(
            found.probability[n], np.array(weight) / np.sum(weight), rtol=2e-3
        )  # soft cells are 1/4096 fine


def test_nothing_out_of_reach_is_asked_for() -> None:
    fixation = Fixation(known_eye(flat=True))
    posture = np.array([[0.55, 0.0]])
    found, _ = fixation.posterior(0, np.array([[-10.0, 0.0, -10.0, 0.0]]), posture, 0.0)
    changes = fixation.candidates[0].points[0]
    assert found.informed.all() and not found.probability[0, changes > 0.05 + 1e-9].any()
    far = fixation.choose(np.array([[-60.0, 0.0, -60.0, 0.0]]), posture, np.random.default_rng(0))
    assert far.uninformed.all()  # no change within reach brings it near: the efference copy goes as far as can be
    assert far.change[0, 0] == pytest.approx(0.05, abs=1e-3) and far.change[0, 1] == pytest.approx(0.0, abs=1e-3)


def test_a_flat_table_leaves_it_to_the_efference_copy_and_the_second_motor_starts_where_the_first_ended() -> None:
    mind = known_eye(flat=True)
    asked: list[tuple[int, np.ndarray, np.ndarray]] = []

    class Watched(Fixation):
        def posterior(self, motor: int, things: np.ndarray, posture: np.ndarray, goal: float) -> Any:
            asked.append((motor, things.copy(), posture.copy()))
            return super().posterior(motor, things, posture, goal)

    things, posture = np.array([[-20.0, 15.0, -28.0, 15.0]]), np.array([[0.1, 0.1]])
    saccade = Watched(mind).choose(things, posture, np.random.default_rng(0), goal=(2.0, -1.0))
    np.testing.assert_allclose(saccade.change, [[0.22, -0.16]], atol=2e-3)
    after = mind.expect(things, posture, saccade.change)
    np.testing.assert_allclose(after, [[2.0, -1.0, -6.0, -1.0]], atol=0.2)
    (_, first, before), (_, then, after) = asked
    np.testing.assert_array_equal(first, things)
    np.testing.assert_array_equal(before, posture)
    np.testing.assert_allclose(then, things + FOCAL * np.tile([saccade.change[0, 0], 0.0], 2))
    np.testing.assert_allclose(after, posture + np.array([saccade.change[0, 0], 0.0]))
    np.testing.assert_array_equal(things, [[-20.0, 15.0, -28.0, 15.0]])  # what was given is left as it was
