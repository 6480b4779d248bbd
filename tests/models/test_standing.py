"""A body on its own feet: weight, pushes, slopes and falls obey mechanics; copies are individuals."""

import numpy as np
import pytest

from models.errors import BodyError
from models.hoap2 import facts
from models.loading import load_body, load_standing
from models.standing import Individuals, StandingBody

LEFT, RIGHT = [0, 1, 2, 3], [4, 5, 6, 7]
ALIKE = Individuals(masses=0.0, friction=(0.9, 0.9))


def held(body: StandingBody, ticks: int = 50) -> np.ndarray:
    """(ticks, B, S) senses while the servos hold it at home."""
    home = body.command_angles(np.tile(np.array([np.deg2rad(facts.HOME_DEG.get(j, 0)) for j in body.joints]), (1, 1)))
    return np.stack([body.act(np.tile(home, (body.copies, 1))) for _ in range(ticks)])


def test_its_soles_carry_its_weight_and_its_balance_organ_feels_which_way_is_up() -> None:
    body = load_standing("hoap2", copies=3)
    senses = held(body)[-1]
    weight = body.batch.expand("body_mass").sum(1) * 9.81
    assert np.ptp(weight) > 0.5, "they are individuals"
    np.testing.assert_allclose(body.senses.read(senses, "touch").sum(1), weight, atol=3)
    np.testing.assert_allclose(np.linalg.norm(body.senses.read(senses, "accelerometer")[:, 0], axis=1), 9.81, atol=0.6)
    assert not body.fallen.any()


def test_joints_and_wiring_are_those_of_the_body_on_its_stand() -> None:
    hung, standing = load_body("hoap2", scramble=3), load_standing("hoap2", scramble=3)
    assert hung.joints == standing.joints and hung.motor_labels == standing.motor_labels
    assert len(standing.sense_labels) == 50 + len(facts.LOAD_CELLS) + 6
    assert set(hung.sense_labels) < set(standing.sense_labels)


def test_a_push_moves_the_pressure_its_way_and_a_strong_one_makes_it_fall() -> None:
    body = load_standing("hoap2", copies=5, individuals=ALIKE)
    held(body)
    body.push(np.array([[5, 0, 0], [-5, 0, 0], [0, 5, 0], [0, -5, 0], [0, 0, 0]], float))
    load = body.senses.read(held(body, 30)[-5:].mean(0), "touch")
    front = load[:, [0, 1, 4, 5]].sum(1) - load[:, [2, 3, 6, 7]].sum(1)
    left = load[:, :4].sum(1) - load[:, 4:].sum(1)
    assert front[0] > front[4] + 5 > front[1] + 10 and left[2] > left[4] + 5 > left[3] + 10
    body.push(np.array([[60.0, 0, 0]] * 4 + [[0, 0, 0]]))
    held(body, 10)
    body.push(np.zeros(3))
    held(body, 60)
    assert body.fallen.tolist() == [True] * 4 + [False]
    body.reset()
    assert not body.fallen.any() and not body.batch.xfrc_applied.any()


def test_who_has_fallen_stays_where_it_is_and_the_others_go_on_as_if_alone() -> None:
    both, alone = load_standing("hoap2", copies=2), load_standing("hoap2", individuals=Individuals(first=1))
    both.push(np.array([[60.0, 0, 0], [2.0, 1.0, 0]]))
    alone.push(np.array([2.0, 1.0, 0]))
    lying = np.zeros(0)
    for _ in range(100):
        held(both, 1)
        held(alone, 1)
        np.testing.assert_array_equal(both.configuration[1], alone.configuration[0])
        if both.fallen[0]:
            lying = both.configuration[0] if not lying.size else lying
            np.testing.assert_array_equal(both.configuration[0], lying)
    assert lying.size == both.model.nq and both.fallen.tolist() == [True, False]
    before = both.configuration[1]
    assert (held(both, 1) is not None) and (both.configuration[1] != before).any()
    both.reset()
    assert not both.fallen.any()
    held(both, 1)
    assert (both.configuration[0] != lying).any()


@pytest.mark.parametrize(("tilt", "sign"), [((4.0, 0.0), (1, 0)), ((-4.0, 0.0), (-1, 0)), ((0.0, 4.0), (0, 1))])
def test_downhill_is_where_the_pressure_goes(tilt: tuple[float, float], sign: tuple[int, int]) -> None:
    flat, slope = (load_standing("hoap2", individuals=ALIKE, tilt_deg=t) for t in ((0.0, 0.0), tilt))
    assert np.linalg.norm(slope.model.opt.gravity) == pytest.approx(9.81)
    loads = [body.senses.read(held(body, 60)[-10:].mean(0), "touch")[0] for body in (flat, slope)]
    more = loads[1] / loads[1].sum() - loads[0] / loads[0].sum()
    front, left = (
        more[plus].sum() - more[minus].sum() for plus, minus in (([0, 1, 4, 5], [2, 3, 6, 7]), (LEFT, RIGHT))
    )
    assert not slope.fallen.any()
    for moved, wanted in zip((front, left), sign, strict=True):
        assert moved * wanted > 0.05 or (wanted == 0 and abs(moved) < 0.05)


def test_an_individual_is_itself_wherever_it_stands() -> None:
    many, few = load_standing("hoap2", copies=4), load_standing("hoap2", copies=2, individuals=Individuals(first=2))
    for field in ("body_mass", "body_inertia", "geom_friction"):
        np.testing.assert_array_equal(many.batch.expand(field)[2:], few.batch.expand(field))
    share = many.batch.expand("body_mass")[:, 1:] / many.model.body_mass[1:]
    assert 0.9 <= share.min() < 0.93 and 1.07 < share.max() <= 1.1
    friction = many.batch.expand("geom_friction")[:, 0, 0]
    assert (friction >= 0.6).all() and (friction <= 1.0).all() and np.ptp(friction) > 0


def test_what_it_carries_comes_on_top_of_what_it_is() -> None:
    body = load_standing("hoap2", copies=2)
    own = np.array(body.batch.expand("body_mass"))
    body.carry(0.3, "left_hand", np.array([1]))
    more = body.batch.expand("body_mass") - own
    assert more[1].max() == pytest.approx(0.3) and more.sum() == pytest.approx(0.3)
    body.mend()
    np.testing.assert_array_equal(body.batch.expand("body_mass"), own)


def test_threads_make_no_difference() -> None:
    one, two = (held(load_standing("hoap2", copies=3, threads=threads), 20) for threads in (1, 2))
    np.testing.assert_array_equal(one, two)


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(BodyError, match=r"biclops: it has no soles .* these have: hoap2"):
        load_standing("biclops")
    with pytest.raises(BodyError, match=r"a floor tilted by .* degrees: 30 at most"):
        load_standing("hoap2", tilt_deg=(40.0, 0.0))
    for wrong in ({"friction": (0.0, 1.0)}, {"masses": 1.0}, {"friction": (1.0, 0.5)}, {"masses": np.nan}):
        with pytest.raises(BodyError, match="a share from 0 to 1, and friction above"):
            Individuals(**wrong)
    body = load_standing("hoap2")
    for force in (1e4, np.nan):
        with pytest.raises(BodyError, match="500 N at most"):
            body.push(np.array([force, 0, 0]))


def test_feet_are_as_high_as_they_are_lifted() -> None:
    body = load_standing("hoap2", copies=2, threads=1)
    np.testing.assert_array_equal(body.lifted, 0)
    up = body.joint_angles.copy()
    for joint, degrees in (("3", -25.0), ("4", 50.0), ("5", -25.0)):
        up[1, body.joints.index(f"right_leg_joint_{joint}")] += np.deg2rad(degrees)
    for _ in range(10):
        body.act(body.command_angles(up))
    assert np.abs(body.lifted[0]).max() < 0.003 and body.lifted[1, 1] > 0.01 > abs(body.lifted[1, 0])
