"""What a body risks: stops, servos and parts are counted as mechanics has them, and counting changes nothing."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from models.loading import load_body, load_standing
from models.risk import IMPACT, STOP, WatchedBody

ELBOW = "left_arm_joint_4"


@pytest.fixture
def watched() -> WatchedBody:
    return WatchedBody(load_body("hoap2", copies=2))


def test_it_feels_and_does_what_the_body_alone_would() -> None:
    alone, watched = (load_body("hoap2", copies=2, noise=0.01, scramble=3, seed=4) for _ in range(2))
    seen, rng = WatchedBody(watched), np.random.default_rng(0)
    alone.reseed(1), watched.reseed(1)
    np.testing.assert_array_equal(seen.reset(), alone.reset())
    for _ in range(20):
        lines = rng.uniform(-1, 1, (2, 25))
        np.testing.assert_array_equal(seen.act(lines), alone.act(lines))
    assert (seen.fingerprint, seen.copies, seen.tick_s) == (alone.fingerprint, 2, alone.tick_s)
    assert seen.risks.minutes == pytest.approx(20 * 2 * 0.02 / 60)
    before = seen.risks
    seen.reset()
    assert seen.risks == before, "what was risked stays risked"
    assert before.more(before) == tuple(2 * one for one in before)


def driven(body: WatchedBody, joint: str, away_deg: float, from_deg: float, per_s: float) -> tuple[int, float]:
    """Stops hit, and servo seconds saturated, while a joint of copy 0 goes from so far before its upper end to
    `away_deg` from it at so many degrees a second, all else at home."""
    number = body.body.joints.index(joint)
    end = np.rad2deg(body.body.joint_range[number, 1])
    body.reset()
    posture = body.body.joint_angles.copy()
    posture[0, number] = np.deg2rad(end - from_deg)
    for _ in range(100):
        body.act(body.body.command_angles(posture))
    before = body.risks
    for t in range(100):
        posture[0, number] = np.deg2rad(min(end - from_deg + t * 0.02 * per_s, end - away_deg))
        body.act(body.body.command_angles(posture))
    return body.risks.stops_hit - before.stops_hit, body.risks.saturated_s - before.saturated_s


def test_a_joint_that_runs_into_its_stop_hits_it_once(watched: WatchedBody) -> None:
    assert driven(watched, ELBOW, -5, 40, 150)[0] == 1, "its command goes beyond the end"
    assert driven(watched, ELBOW, -5, 20, IMPACT / 2)[0] == 0, "it leans against its stop, but came slowly"
    assert driven(watched, ELBOW, 3, 40, 150)[0] == 0, "as fast, but it stops before"


def test_a_hit_is_near_the_end_fast_and_towards_it(watched: WatchedBody) -> None:
    low, high = watched.body.joint_range.T
    near, fast = np.deg2rad(STOP), np.deg2rad(IMPACT) * 0.02
    for end, way in ((low, -1), (high, 1)):
        at = end - way * near * 0.99
        assert watched.hits((at - way * fast * 1.01)[None], at[None]).all()
        assert not watched.hits((at - way * fast * 0.99)[None], at[None]).any(), "too slow"
        assert not watched.hits((at + way * fast * 1.01)[None], at[None]).any(), "away from it"
        there = end - way * near * 1.01
        assert not watched.hits((there - way * fast * 2)[None], there[None]).any(), "it is not there"


def test_a_servo_is_saturated_where_mujoco_has_its_force_at_the_limit(watched: WatchedBody) -> None:
    model, body, rng = watched.body.model, watched.body, np.random.default_rng(1)
    data, limit, counted = mujoco.MjData(model), body.model.actuator_forcerange[:, 1], 0
    for scale in (0.02, 0.1, 0.4):
        watched.reset()
        for _ in range(15):
            before, qpos, qvel = watched.risks.saturated_s, body.batch.qpos.copy(), body.batch.qvel.copy()
            watched.act(body.command_angles(body.joint_angles + scale * rng.normal(size=(2, 25))))
            expected = 0
            for copy in range(2):
                data.qpos[:], data.qvel[:], data.ctrl[:] = qpos[copy], qvel[copy], body.batch.ctrl[copy]
                mujoco.mj_forward(model, data)
                expected += int((np.abs(data.actuator_force) >= limit).sum())
            assert watched.risks.saturated_s - before == pytest.approx(expected * 0.02)
            counted += expected
    assert counted > 20
    assert driven(watched, ELBOW, 20, 40, 20)[1] == 0


def test_parts_touch_where_they_do_on_the_floor(watched: WatchedBody) -> None:
    standing = load_standing("hoap2")
    postures = np.random.default_rng(0).uniform(*watched.body.joint_range.T, (60, 25))
    free = standing.configurations(postures)
    free[:, 2] += 1  # off the floor
    touching = watched.touching(watched.body.configurations(postures))
    np.testing.assert_array_equal(touching, standing.touching(free))
    assert 0.2 < touching.mean() < 0.95


def test_hands_that_meet_are_counted_and_home_is_not(watched: WatchedBody) -> None:
    home = watched.body.joint_angles[:1].copy()
    assert not watched.touching(watched.body.configurations(home)).any()
    meeting = home.copy()
    for side, inward in (("left", 90), ("right", -90)):
        for number, angle in enumerate((0, 0, inward, -90), 1):
            meeting[0, watched.body.joints.index(f"{side}_arm_joint_{number}")] = np.deg2rad(angle)
    together = np.concatenate([home, meeting])
    for _ in range(100):
        watched.act(watched.body.command_angles(together))
    before = watched.risks.touching_s
    apart, met = watched.touching(watched.body.batch.qpos)
    for _ in range(10):
        watched.act(watched.body.command_angles(together))
    assert met and not apart
    assert watched.risks.touching_s - before == pytest.approx(10 * 0.02)


def test_a_servo_without_a_limit_is_never_saturated(tmp_path: Path) -> None:
    path = tmp_path / "one.xml"
    path.write_text(
        '<mujoco><worldbody><body><joint name="j" axis="0 1 0" range="-60 60" armature=".01"/><geom size=".05"/></body>'
        '</worldbody><actuator><position joint="j" kp="20" kv="1" inheritrange="1"/></actuator></mujoco>'
    )
    body = WatchedBody(load_body(path))
    for sign in (-1.0, 1.0) * 5:
        body.act(np.array([[sign]]))
    assert body.risks.saturated_s == 0 and body.risks.minutes > 0
