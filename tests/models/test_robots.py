"""What a robot's entry says is true of its MJCF; a robot that does not fit is told which do."""

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.errors import BodyError
from models.heads import ASKEW_DEG, TOE_IN_DEG, camera_facts, squint, stage
from models.loading import load_body
from models.robots import ROBOTS, head_of, limbs_of

SEEING = [name for name, one in ROBOTS.items() if one.head]


@pytest.mark.parametrize("name", ROBOTS)
def test_an_entry_is_true_of_its_body(name: str) -> None:
    one = ROBOTS[name]
    body = load_body(name, threads=1)
    assert {segment.joint for segment in one.limbs.values()} <= set(body.joints)
    assert one.babbles == "joints" or one.head is not None
    assert {channel.kind for channel in body.senses.channels.values()} >= {"angle", "speed"}


@pytest.mark.parametrize("name", SEEING)
def test_a_head_can_do_what_its_entry_says(name: str) -> None:
    head, body = head_of(name), load_body(name, threads=1)
    low, high = body.joint_range[[body.joints.index(motor) for motor in head.motors]].T
    assert (low < head.rest).all() and (high > head.rest).all()
    assert low[1] < head.tilt[0] < head.rest[1] < head.tilt[1] < high[1]
    model = stage(name, teacher=True, distance=0.9).compile()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    ours, theirs = (np.mean([data.camera(t + eye).xpos for eye in head.eyes], 0) for t in ("", "teacher_"))
    np.testing.assert_allclose((ours - head.table)[1:], (theirs - head.table)[1:], atol=0.003)  # eye to eye
    assert theirs[0] - head.table[0] == pytest.approx(0.9, abs=0.05)
    fovy_deg, half_baseline = camera_facts(name)
    assert 20 < fovy_deg < 120 and 0.01 < half_baseline < 0.1


@pytest.mark.parametrize("name", SEEING)
def test_eyes_that_squint_are_toed_in_about_their_own_middles(name: str) -> None:
    def look(seed: int | None) -> tuple[np.ndarray, np.ndarray]:
        model = stage(name).compile()
        if seed is not None:
            squint(model, name, seed)
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        eyes = [data.camera(eye) for eye in head_of(name).eyes]
        return np.array([eye.xpos for eye in eyes]), np.array([eye.xmat.reshape(3, 3) for eye in eyes])

    (middles, true), seen = look(None), [look(seed) for seed in range(10)]
    for places, now in seen:
        np.testing.assert_allclose(places, middles, atol=1e-12)
        nod, inwards, roll = np.rad2deg(Rotation.from_matrix(true.swapaxes(1, 2) @ now).as_rotvec()).T
        assert np.abs([nod, roll]).max() <= ASKEW_DEG
        assert TOE_IN_DEG[0] <= -inwards[0] <= TOE_IN_DEG[1] and TOE_IN_DEG[0] <= inwards[1] <= TOE_IN_DEG[1]
        back = now[:, :, 2] @ (middles[0] - middles[1])
        assert back[0] > 0 > back[1]  # cameras look along -z: their lines meet
    assert len({now.tobytes() for _, now in seen}) == 10
    np.testing.assert_array_equal(look(3)[1], seen[3][1])


def test_who_does_not_fit_is_told_who_does() -> None:
    with pytest.raises(BodyError, match="unknown robot with eyes 'hoap2-worn'; there are biclops, hoap2; did you mean"):
        head_of("hoap2-worn")
    with pytest.raises(BodyError, match=r"^biclops: limb directions can be shown to hoap2, hoap2-worn, .* only$"):
        limbs_of("biclops", load_body("biclops").joints)
    assert limbs_of("mine.xml", load_body("hoap2").joints) is ROBOTS["hoap2"].limbs
