"""Babbling: bouts stand alone, so any cut, order or resumption gives the same counts; exploration keeps its laws."""

import numpy as np
import pytest

from babbling.errors import BabblingError
from babbling.exploration import MotorRange, smooth
from babbling.files import load, save
from babbling.loop import babble, bouts, experience, explore, flat
from babbling.mind import Mind, learn
from babbling.pilot import begin
from babbling.regression import regress
from models.loading import load_body

FORETOLD = ("evidence", "squares", "foretold")


@pytest.mark.parametrize("minutes", [0.0, -1.0, np.nan, np.inf, 1e-6])
def test_impossible_times(arm, minutes):
    with pytest.raises(BabblingError, match=r"minutes of babbling: it must be more than 0, at least one tick"):
        bouts(minutes, load_body(arm, copies=8))


def test_bouts_add_up(arm):
    body = load_body(arm, copies=8)
    plan = bouts(5.0, body)
    assert sum(plan) * 8 * body.tick_s / 60 == pytest.approx(5.0, abs=8 * body.tick_s / 60)
    assert max(plan) == 500 and all(n == 500 for n in plan[:-1])


def test_bouts_in_any_order_on_any_body_and_resumed_are_the_same(arm, arm_mind):
    body, other, plan = load_body(arm, copies=8), load_body(arm, copies=8, threads=1), (40, 50, 60)
    whole = babble(body, arm_mind.pilot, plan, 3)
    first = babble(body, arm_mind.pilot, plan[:1], 3)
    resumed = babble(other, arm_mind.pilot, plan, 3, onto=first, first=1)
    shards, parts = arm_mind.pilot.forward_model(), []
    for bout in (2, 0, 1):
        shard = arm_mind.pilot.forward_model()
        arm_mind.pilot.learn(shard, *experience(other, arm_mind.pilot, 3, bout, plan[bout]))
        shards.merge(shard)
        parts.append(shard)
    for model in (resumed, shards):  # what was counted
        assert (model.table.counts == whole.table.counts).all()
        assert (model.table.predictive == whole.table.predictive).all()
        assert (model.moments == whole.moments).all() and (model.lines == whole.lines).all()
    for name in FORETOLD:  # what was foretold depends on what was known by then, and adds
        assert (getattr(resumed, name) == getattr(whole, name)).all()
        np.testing.assert_allclose(getattr(shards, name), sum(getattr(part, name) for part in parts), rtol=1e-12)


def test_a_mind_is_the_same_at_one_and_two_threads(arm):
    minds = [learn(load_body(arm, copies=8, threads=threads), minutes=0.5, seed=4) for threads in (1, 2)]
    assert_same_mind(*minds)


def test_other_seeds_live_other_lives(arm, arm_mind):
    body = load_body(arm, copies=8)
    one, other = (experience(body, arm_mind.pilot, seed, 0, 20)[0] for seed in (0, 1))
    assert not np.array_equal(one, other)
    assert np.array_equal(one, experience(body, arm_mind.pilot, 0, 0, 20)[0])


def test_explore_begins_at_rest_and_holds_each_command_for_a_tick(arm, arm_mind):
    body = load_body(arm, copies=3)
    motors, senses = explore(body, arm_mind.pilot.stream(body, np.random.default_rng(0)), 12)
    assert (senses[0] == body.reset()).all()
    for t in range(12):
        assert (body.act(motors[t]) == senses[t + 1]).all()
    before, command, after = flat(motors, senses)
    assert (before[3:] == after[:-3]).all() and len(command) == 36


def test_what_is_learned_from_a_run_is_what_happened_beyond_coasting(arm, arm_mind):
    body, pilot = load_body(arm, copies=3), arm_mind.pilot
    motors, senses = explore(body, pilot.stream(body, np.random.default_rng(0)), 12)
    columns, outcome = pilot.experienced(motors, senses)
    believed, told = pilot.believed(motors, senses)
    np.testing.assert_array_equal(told, pilot.schema.efference(motors))
    q, v = believed[..., 0], believed[..., 1]
    whole = pilot.frame.features.of(q[:-1], v[:-1], pilot.schema.efference(motors))
    for t, copy in np.ndindex(12, 3):
        drift = pilot.dynamics.coasting * v[t, copy]
        np.testing.assert_allclose(outcome[3 * t + copy], q[t + 1, copy] - q[t, copy] - drift, atol=1e-15)
        np.testing.assert_array_equal(columns[3 * t + copy], whole[t, copy])


def test_a_pilot_has_counted_what_it_lived_through_and_foretold_nothing_of_it(arm):
    body = load_body(arm, copies=8)
    found, begun = begin(body, 0)
    assert begun.transitions * body.tick_s / 60 == pytest.approx(3 * found.counted_minutes)
    assert not begun.foretold.any() and not begun.evidence.any()
    share = found.frame.features.share
    np.testing.assert_allclose(share.sum(1), 1)
    assert (np.abs(share[:, 1:]).max(1) > 1e-6).all(), "found, not taken as it was begun with"


def test_smooth_babbling_keeps_to_its_range_its_speed_and_its_rest():
    low, high, speed = np.array([-1.0, 0.0]), np.array([0.5, 0.3]), np.array([4.0, 1.0])
    motors = MotorRange(low, high, np.array([0.2, 0.1]), speed, np.zeros(2))
    stream = smooth(motors, 50, 0.02, np.random.default_rng(0))
    path = np.stack([next(stream) for _ in range(1000)])
    assert (path >= low - 1e-12).all() and (path <= high + 1e-12).all()
    pace = np.diff(path, axis=0) / 0.02
    assert (np.abs(pace) <= speed * (1 + 1e-9)).all()
    assert np.abs(path[0] - motors.rest).max() < 0.01  # it starts from rest, at rest
    # minimum jerk: the acceleration never jumps more than the first tick of the shortest move explains
    assert np.ptp(path, axis=0).min() > 0
    slow = (np.abs(pace) < speed / 10).mean()
    assert 0.2 < slow < 0.95  # speeds over decades, not all at the limit


def test_a_mind_survives_its_file_to_the_last_bit(arm_mind, tmp_path):
    path = tmp_path / "arm.nc"
    save(arm_mind, path, robot="arm")
    mind = load(path, Mind)
    assert mind.fingerprint == arm_mind.fingerprint and mind.seed == arm_mind.seed
    assert_same_mind(mind, arm_mind)
    assert [p.name for p in tmp_path.iterdir()] == ["arm.nc"]


def assert_same_mind(one: Mind, other: Mind) -> None:
    mine, theirs = one.forward_model, other.forward_model
    assert (mine.table.predictive == theirs.table.predictive).all() and (mine.outside == theirs.outside).all()
    assert (mine.table.moments.sums == theirs.table.moments.sums).all()
    for name in ("moments", "lines", "weights", "spread", "slope", *FORETOLD):
        assert getattr(mine, name).tobytes() == getattr(theirs, name).tobytes(), name
    assert mine.frame.same(theirs.frame) and mine.frame.reach.tobytes() == theirs.frame.reach.tobytes()
    for name, value in vars(mine.features).items():
        assert value.tobytes() == getattr(theirs.features, name).tobytes(), name
    for name, value in one.pilot.dynamics._asdict().items():
        assert (value == getattr(other.pilot.dynamics, name)).all(), name
    for part in ("schema", "motors"):
        for name, value in vars(getattr(one.pilot, part)).items():
            assert (value == getattr(getattr(other.pilot, part), name)).all(), name
    assert (one.pilot.dynamics.coasting == other.pilot.dynamics.coasting).all()
    assert (one.temper.eagerness == other.temper.eagerness).all() and (one.temper.trust == other.temper.trust).all()


def test_another_body_is_refused(arm, arm_mind):
    arm_mind.check(load_body(arm, copies=2))
    with pytest.raises(BabblingError, match=r"learned by another body .* babble anew"):
        arm_mind.check(load_body(arm, scramble=3))


def test_noise_that_is_felt_does_not_pass_for_a_law(arm):
    """It stands in posture, command minus posture and displacement alike; believed postures are nearer to the true,
    and so is what a line through them says that a command does."""
    body = load_body(arm, copies=8, noise=0.01, seed=3)
    found, _ = begin(body, 0)
    true: list[np.ndarray] = []

    def noted(stream):
        for command in stream:
            true.append(body.joint_angles.copy())
            yield command

    motors, senses = explore(body, noted(found.stream(body, np.random.default_rng(1))), 400)
    believed, told = found.believed(motors, senses)
    np.testing.assert_array_equal(told, found.schema.efference(motors))
    true.append(body.joint_angles.copy())
    q, felt = np.array(true), senses[..., found.schema.posture]
    assert ((believed[..., 0] - q) ** 2).mean() < 0.5 * ((felt - q) ** 2).mean()

    def pull(posture):
        x = np.stack([np.ones_like(told), told - posture[:-1]], -1).reshape(-1, 3, 2)
        return regress(x, np.diff(posture, axis=0).reshape(-1, 3, 1)).coefficients[:, 0, 1]

    assert (np.abs(pull(believed[..., 0]) - pull(q)) < 0.7 * np.abs(pull(felt) - pull(q))).all()
