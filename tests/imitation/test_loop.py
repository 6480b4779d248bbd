"""The match-to-target loop end to end on a small robot."""

from dataclasses import replace

import numpy as np
import pytest

from babbling.errors import BabblingError
from babbling.mind import learn
from imitation.acting.loop import imitate
from imitation.acting.movement import Movement
from imitation.acting.rehearsal import EAGERNESS, OTHERWISE, REHEARSERS, made_up_movement, rehearse
from imitation.errors import ImitationError
from models.loading import load_body
from models.motion import read_motion


def seen(body, wave):
    """The movement as it reads on this body's lines, and its true angles."""
    angles = read_motion(wave).reordered(body.joints).resampled(body.tick_s).angles
    return Movement("wave", body.tick_s, body.sensations(angles)), angles


def performed(body, mind, wave, **how):
    movement, angles = seen(body, wave)
    how = {"rng": np.random.default_rng(0), "witness": lambda: body.joint_angles, **how}
    attempts = imitate(body, movement, mind, **how)
    return attempts, [np.rad2deg(np.sqrt(np.mean((a.truth[:, 0] - angles) ** 2))) for a in attempts]


def test_the_arm_does_what_it_saw(arm, arm_mind, wave):
    body = load_body(arm)
    attempts, errors = performed(body, arm_mind, wave, attempts=4)
    assert errors[0] < 0.2
    assert min(errors) < 0.5 * errors[0] or min(errors) < 0.01
    assert errors[-1] < 1.5 * min(errors)
    first = attempts[0]
    assert first.uninformed.size == 100 * 3 and not first.uninformed.any()
    np.testing.assert_allclose(first.posterior.sum(-1), 1, atol=1e-5)
    assert (first.entropy >= 0).all() and (first.evidence > 0).all()
    # what it believes of its posture is where it is
    assert np.rad2deg(np.abs(first.believed[:, 0, :, 0] - first.truth[:, 0]).max()) < 0.1


@pytest.mark.parametrize("selection", ["mean", "map", "matching"])
def test_the_same_seed_does_the_same_at_any_thread_count(arm, arm_mind, wave, selection):
    once, again = (
        performed(load_body(arm, threads=threads), arm_mind, wave, selection=selection)[0][0] for threads in (1, 2)
    )
    for name in ("senses", "believed", "commands", "truth", "posterior"):
        assert getattr(once, name).tobytes() == getattr(again, name).tobytes(), name


def test_map_is_nearly_as_good_as_the_mean(arm, arm_mind, wave):
    errors = {rule: performed(load_body(arm), arm_mind, wave, selection=rule)[1][0] for rule in ("mean", "map")}
    assert errors["map"] < 2 * errors["mean"]


@pytest.mark.parametrize("scramble", [1, 2])
def test_behind_an_unknown_wiring_it_works_as_well_as_before(arm, arm_mind, wave, scramble):
    body = load_body(arm, copies=16, scramble=scramble)
    mind = learn(body, minutes=1, seed=0)
    labels = [body.sense_labels[line] for line in mind.pilot.schema.posture]
    rates = [body.sense_labels[line] for line in mind.pilot.schema.rate]
    assert labels == list(body.motor_labels)
    assert rates == [f"{label} speed" for label in labels]
    straight = performed(load_body(arm), arm_mind, wave)[1][0]
    crossed = performed(load_body(arm, scramble=scramble), mind, wave)[1][0]
    assert crossed <= 1.2 * straight


def test_noise_is_weighed_by_what_it_was_at_rest(arm, wave):
    """What is believed lies nearer the truth than the senses do, and than what one believes who trusts them whole."""
    noise = np.deg2rad(0.2)
    mind = learn(load_body(arm, copies=16, noise=noise), minutes=1, seed=0)
    schema = mind.pilot.schema
    np.testing.assert_allclose(schema.noise, noise, rtol=0.1)
    np.testing.assert_allclose(schema.rate_noise, np.sqrt(2) * noise / 0.02, rtol=0.1)
    trusting = replace(schema, noise=schema.noise / 100, rate_noise=schema.rate_noise / 100)
    gullible = replace(mind, pilot=replace(mind.pilot, schema=trusting))
    missed = []
    for believer in (mind, gullible):
        attempt = performed(load_body(arm, noise=noise, seed=3), believer, wave)[0][0]
        missed.append(np.sqrt(np.mean((attempt.believed[:, 0, :, 0] - attempt.truth[:, 0]) ** 2)))
    assert missed[0] < 0.9 * noise and missed[0] < 0.9 * missed[1]


def test_rehearsal_chooses_among_its_candidates_by_what_was_felt(arm, arm_mind):
    mind = rehearse(load_body(arm, copies=REHEARSERS), arm_mind, seed=0, seconds=1.0)
    assert set(mind.temper.eagerness) <= set(EAGERNESS)
    ways = {(0.1, 0.0), *OTHERWISE}
    assert set(zip(mind.temper.trust.tolist(), mind.temper.simple.tolist(), strict=True)) <= ways
    assert mind.forward_model is arm_mind.forward_model


def test_what_is_made_up_stays_within_what_was_babbled(arm, arm_mind):
    body = load_body(arm)
    movement = made_up_movement(body, arm_mind, np.random.default_rng(0))
    postures = movement.postures(arm_mind.pilot.schema)
    low, high = body.sense_low[arm_mind.pilot.schema.posture], body.sense_high[arm_mind.pilot.schema.posture]
    assert (postures >= low).all() and (postures <= high).all()
    speed = np.abs(np.diff(postures, axis=0)).max(0) / body.tick_s
    assert (speed <= 0.5 * body.sense_high[arm_mind.pilot.schema.rate] * 1.001).all()


def test_what_cannot_be_imitated(arm, arm_mind, wave):
    body = load_body(arm)
    movement, _ = seen(body, wave)
    rng = np.random.default_rng(0)
    with pytest.raises(ImitationError, match="0 attempts: at least 1"):
        imitate(body, movement, arm_mind, attempts=0, rng=rng)
    with pytest.raises(ImitationError, match=r"wave has ticks of 0\.01 s, the body of 0\.02 s"):
        imitate(body, Movement("wave", 0.01, movement.senses), arm_mind, rng=rng)
    with pytest.raises(BabblingError, match="another body"):
        imitate(load_body(arm, scramble=1), movement, arm_mind, rng=rng)
