"""HOAP-2 learns to stand on its feet, in a hurry, and does short movements there: what is felt, and what is sent."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import experiments.shared.journal as journal
import experiments.shared.one_leg as one_leg
import experiments.shared.standing as standing
from babbling.axes import FloatArray
from babbling.balance import Balance
from babbling.belief import USUAL, StateEstimate
from babbling.files import load, save
from babbling.kalman import Belief
from babbling.mind import Mind, learn
from experiments.__main__ import main
from experiments.errors import ExperimentError
from experiments.gesture import standing_study
from experiments.gesture.options import Config
from experiments.shared.journal import Journal
from experiments.shared.one_leg import Learner, learn_balance
from experiments.shared.options import BodyOptions
from experiments.shared.standing import (
    Joints,
    Performance,
    perform,
    standing_of,
    wander,
)
from imitation.acting.balancing import Balancer, Plan
from imitation.acting.movement import Movement
from models.body import SimulatedBody
from models.hoap2.facts import HOME_DEG, JOINTS, LOAD_CELLS
from models.loading import load_body, load_standing
from models.standing import StandingBody

OPTIONS = BodyOptions(robot="hoap2", threads=1, seed=100)
HOME = np.array([np.deg2rad(HOME_DEG.get(joint, 0)) for joint in JOINTS])


@pytest.fixture(scope="module")
def hurried(hasty: None) -> Iterator[list[float]]:
    """Fewer and shorter bouts on one's feet; and what was reported meanwhile."""
    short = {"ROCKING_S": 4.0, "WIGGLING": 12, "WIGGLING_S": 6.0, "STAGE": 4, "STAGE_S": 3.0, "STAGES": (0.2,)}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(standing, "REST_S", 0.2)
        for name, value in short.items():
            patch.setattr(one_leg, name, value)
        yield []


@pytest.fixture(scope="module")
def hung() -> SimulatedBody:
    return load_body("hoap2", threads=1)


@pytest.fixture(scope="module")
def mind(hasty: None) -> Mind:
    return learn(load_body("hoap2", copies=8, threads=1), minutes=0.3, seed=0)


@pytest.fixture(scope="module")
def balance(hurried: list[float], hung: SimulatedBody, mind: Mind) -> Balance:
    return learn_balance(Learner(OPTIONS, mind, hung, hurried.append, Journal()))


def arms(hung: SimulatedBody, seconds: float = 0.6) -> FloatArray:
    """(T, J) from home, both arms forward and the hips bent a little."""
    share = np.linspace(0, 1, round(seconds / hung.tick_s))[:, None]
    wanted = np.zeros(len(JOINTS))
    for joint, much in {"left_arm_joint_1": -0.5, "right_arm_joint_1": 0.5, "left_leg_joint_3": -0.1}.items():
        wanted[JOINTS.index(joint)] = much
    return HOME + share * wanted


def raise_arms(hung: SimulatedBody, seconds: float = 0.6) -> Movement:
    """The same, to be imitated."""
    return Movement("arms", hung.tick_s, hung.sensations(arms(hung, seconds)))


class Listened(StandingBody):
    """A body whose commands, and pushes as they act, are written down."""

    sent: list[np.ndarray]
    pushed: list[np.ndarray]

    def act(self, motors: np.ndarray) -> np.ndarray:
        self.sent.append(motors.copy())
        self.pushed.append(self.batch.xfrc_applied[:, self._pushed, :3].copy())
        return super().act(motors)


def listened(copies: int = 2) -> Listened:
    body = standing_of(OPTIONS, copies, 7)
    body.__class__ = Listened
    assert isinstance(body, Listened)
    body.sent, body.pushed = [], []
    return body


@pytest.mark.parametrize("scramble", [None, 3])
def test_a_mind_feels_its_joints_on_the_floor_as_on_its_stand(scramble: int | None) -> None:
    known, body = (load("hoap2", copies=2, threads=1, scramble=scramble) for load in (load_body, load_standing))
    assert isinstance(body, StandingBody)
    moves = body.command_angles(np.tile(HOME, (2, 1))) + 0.02
    for _ in range(5):
        senses = body.act(moves)
    felt = Joints(known, body).felt(senses)
    assert felt.shape == (2, len(known.sense_low)) and not np.isnan(felt).any()
    there = known.sensations(body.joint_angles)
    seen = ~np.isnan(there)
    assert seen.sum() == 2 * len(JOINTS)
    np.testing.assert_allclose(felt[seen], there[seen], atol=6e-5)  # encoders count
    speed = known.senses.vector({"speed": body.senses.read(senses, "speed")})
    np.testing.assert_array_equal(felt[~seen], speed[~seen])


def test_interrupted_it_remembers_what_it_lived_through(
    balance: Balance, hung: SimulatedBody, mind: Mind, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(journal, "EVERY_S", 0.0)
    path, episodes = tmp_path / "arm.balance.nc.partial", [0, 0]

    def interrupt(done: float) -> None:
        episodes[0] += 1
        if episodes[0] == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        learn_balance(Learner(OPTIONS, mind, hung, interrupt, Journal(path, {"seed": 1})))
    with pytest.raises(ExperimentError, match="another interrupted learning to stand is here"):
        Journal(path, {"seed": 2})
    ticks, act = [0], StandingBody.act

    def counting(body: StandingBody, motors: FloatArray) -> FloatArray:
        ticks[0] += 1
        return act(body, motors)

    monkeypatch.setattr(StandingBody, "act", counting)
    again = learn_balance(Learner(OPTIONS, mind, hung, lambda done: None, Journal(path, {"seed": 1})))
    assert ticks[0] == round(one_leg.STAGE_S / 0.02)  # only the last of three
    for number, found in enumerate((balance, again)):
        save(found, tmp_path / f"{number}.nc")
    assert (tmp_path / "0.nc").read_bytes() == (tmp_path / "1.nc").read_bytes()


def test_wandering_stays_within_reach_and_begins_and_moves_about_zero() -> None:
    body, rng = load_standing("hoap2", copies=5, threads=1), np.random.default_rng(0)
    reach = np.array([0.1, 0.6, 0.0001])
    beside = wander(reach, body, 6.0, rng)
    assert beside.shape == (300, 5, 3) and (np.abs(beside) <= reach).all()
    assert (np.abs(beside).max((0, 1)) > 0.8 * reach).all() and np.abs(beside[0, :, 1]).max() < 0.1
    assert (np.abs(np.diff(beside, axis=0)) / body.tick_s).max() <= 1.001 * standing.PACE
    ends = np.stack([np.array([-0.5, 0.2]), np.array([1.0, 0.4])])  # rest lies outside of the second
    moved = wander(ends, body, 6.0, rng, 0.3)
    assert (moved >= [-0.5, 0.0]).all() and (moved <= [1.0, 0.4]).all()
    assert (np.abs(np.diff(moved, axis=0)) / body.tick_s).max() <= 1.001 * 0.3


def test_balance_is_learned_and_counted(balance: Balance, hurried: list[float], mind: Mind) -> None:
    assert balance.pressing.shape == (2, len(LOAD_CELLS)) and balance.lines.shape == (len(LOAD_CELLS),)
    found = {JOINTS[joint] for joint in np.flatnonzero(balance.carries)}  # its lines are those of the joints here
    assert {f"{side}_leg_joint_{n}" for side in ("left", "right") for n in (2, 5, 6)} <= found
    assert len(found - {joint for joint in JOINTS if "_leg_" in joint}) < 3, "next to nothing but legs"
    front = balance.pressing[0] * np.sign(balance.pressing[0, 0])
    assert (np.sign(front) == [1, 1, -1, -1, 1, 1, -1, -1]).all(), "toes and heels"
    np.testing.assert_allclose(balance.minutes, [8 * 4 / 60, 12 * 6 / 60, 4 * 3 / 60])
    assert balance.falls.shape == (3,) and (balance.falls <= [8, 12, 4]).all() and not balance.falls[:2].any()
    assert balance.forward_model.transitions > 200
    assert balance.fingerprint == load_standing("hoap2").fingerprint != mind.fingerprint
    assert hurried == [1 / 3, 2 / 3, 1.0]


def test_one_leg_is_learned_after_both_and_takes_nothing_of_them_away(
    balance: Balance, mind: Mind, hung: SimulatedBody, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in {"TRIES": 4, "ALONE": 6, "ALONE_S": 1.2}.items():
        monkeypatch.setattr(one_leg, name, value)
    told: list[float] = []
    found = one_leg.learn_to_stand(OPTIONS, mind, hung, told.append)
    for name in ("effects", "synergy", "weights", "following"):
        np.testing.assert_array_equal(getattr(found, name), getattr(balance, name))
    np.testing.assert_allclose(found.minutes, [*balance.minutes, 4 * 3.3 / 60, 6 * 3.5 / 60])
    assert len(found.falls) == 5 and (found.falls[-2:] <= [4, 6]).all()
    assert (found.free <= found.carries).all() and not (found.free.all(0)).any(), "no joint is of both legs"
    assert not balance.free.any() and not balance.there.any()
    assert told == sorted(told) and told[-1] == 1.0


def test_learners_are_others_every_time_and_none_of_those_who_are_judged(mind: Mind, hung: SimulatedBody) -> None:
    learner, masses = Learner(OPTIONS, mind, hung, lambda share: None, Journal(), [], []), []
    for _ in range(2):
        body = learner.bodies(3)
        masses.append(np.array(body.batch.expand("body_mass")).sum(1))
        learner.note(body, 10, 1)
    masses.append(np.array(standing_of(OPTIONS, 3, 0).batch.expand("body_mass")).sum(1))
    assert len(set(np.concatenate(masses).round(6))) == 9
    assert learner.falls == [1, 1] and learner.minutes == pytest.approx([10 * 3 * 0.02 / 60] * 2)


def test_what_comes_just_before_a_fall_is_part_of_it(balance: Balance, mind: Mind, hung: SimulatedBody) -> None:
    tip = np.zeros((70, 2, 2))
    tip[:, 1, 0] = np.minimum(np.arange(70) / 20, 1) * 0.6
    postures = balance.home + tip @ balance.synergy
    nothing = 0 * tip
    learner = Learner(OPTIONS, mind, hung, lambda share: None, Journal(), [], [])
    run = learner.stand(standing_of(OPTIONS, 2, 7), Plan(postures, postures, nothing, tip, nothing, nothing))
    twin, down = standing_of(OPTIONS, 2, 7), []
    for command in postures:
        twin.act(mind.pilot.schema.motors(command))
        down.append(twin.fallen)
    assert np.array(down)[-1].tolist() == [False, True] and learner.falls == [1]
    first = int(np.argmax(np.array(down)[:, 1]))
    assert run.upright[:, 0].all() and int(run.upright[:, 1].sum()) == first - 15
    assert run.upright[: first - 15, 1].all() and run.told is postures and run.offset is tip


def test_what_carries_does_what_was_planned_and_the_rest_follows_eq_1(
    balance: Balance, mind: Mind, hung: SimulatedBody
) -> None:
    body, movement = listened(), raise_arms(hung)
    done = perform(body, hung, mind, movement, Balancer(balance), feels=False)
    ticks, carries = len(done.angles), balance.carries > 0
    assert done.angles.shape == (ticks, 2, 25) and done.loads.shape == (ticks, 2, 8)
    assert done.configurations.shape == (ticks, 2, body.model.nq) and done.pushes.shape == (ticks, 2, 3)
    assert done.upright.shape == (ticks, 2) and not done.fell.any() and not done.pushes.any()
    resting = round(standing.REST_S / body.tick_s)
    assert ticks - 1 == len(body.sent) == done.first + len(movement.senses) + resting
    wanted = mind.pilot.schema.motors(np.clip(done.plan.postures[1 : len(body.sent) + 1], *mind.pilot.ends.T))
    sent = np.array(body.sent)
    np.testing.assert_allclose(sent[..., carries], wanted.repeat(2, 1)[..., carries])
    assert np.abs(sent - wanted)[..., ~carries].max() > 1e-3, "ahead of where they are to be"
    moved = done.angles[-1, :, JOINTS.index("left_arm_joint_1")] - HOME[JOINTS.index("left_arm_joint_1")]
    np.testing.assert_allclose(moved, -0.5, atol=0.05)


def test_replay_sends_the_sub_goals_themselves(balance: Balance, mind: Mind, hung: SimulatedBody) -> None:
    body, movement = listened(), raise_arms(hung)
    done = perform(body, hung, mind, movement, Balancer(balance), replay=True)
    goals = movement.senses[:, mind.pilot.schema.posture]
    sent = np.array(body.sent)[done.first - 1 :]
    np.testing.assert_allclose(sent[: len(goals), 0], mind.pilot.schema.motors(np.clip(goals, *mind.pilot.ends.T)))
    assert not done.plan.offset.any() and np.array_equal(done.plan.planned, done.plan.postures)


def test_a_push_acts_when_it_should_and_a_reflex_is_told_what_is_felt(
    balance: Balance, mind: Mind, hung: SimulatedBody
) -> None:
    told: list[tuple[int, np.ndarray, np.ndarray]] = []

    def reflex(tick: int, loads: np.ndarray, gyro: np.ndarray) -> np.ndarray:
        told.append((tick, loads, gyro))
        return np.tile([0.02, -0.01], (2, 1))

    def push(time: float) -> np.ndarray:
        return np.where(0.1 - 1e-9 <= time < 0.2 - 1e-9, 1.0, 0.0) * np.array([[5.0, 0, 0], [0, -5.0, 0]])

    body, still = listened(), listened()
    balancer, movement = Balancer(balance), raise_arms(hung)
    done: Performance = perform(body, hung, mind, movement, balancer, feels=False, reflex=reflex, push=push)
    perform(still, hung, mind, movement, balancer, feels=False)
    at = np.flatnonzero(done.pushes[:, 0, 0])
    assert at.tolist() == list(range(done.first + 5, done.first + 10))
    np.testing.assert_array_equal(done.pushes[at], np.tile([[5.0, 0, 0], [0, -5.0, 0]], (5, 1, 1)))
    np.testing.assert_array_equal(np.array(body.pushed), done.pushes[:-1])
    assert [tick for tick, _, _ in told] == list(range(len(body.sent)))
    np.testing.assert_array_equal(np.array([loads for _, loads, _ in told]), done.loads[:-1])
    assert all(gyro.shape == (2, 3) for _, _, gyro in told) and np.ptp([gyro for _, _, gyro in told]) > 0.1
    carries, schema = balance.carries > 0, mind.pilot.schema
    more = (np.array(body.sent) - np.array(still.sent))[..., carries]
    np.testing.assert_allclose(
        more, np.tile([0.02, -0.01] @ balance.synergy / schema.slope, (*more.shape[:2], 1))[..., carries], atol=1e-9
    )


def test_what_stays_of_what_is_felt_is_answered_and_foretold(balance: Balance, mind: Mind, hung: SimulatedBody) -> None:
    slope = standing_of(OPTIONS, 2, 7, tilt_deg=(2.0, 0.0))
    done = perform(slope, hung, mind, raise_arms(hung, 3.0), Balancer(balance))
    blind = perform(slope, hung, mind, raise_arms(hung, 3.0), Balancer(balance), feels=False)
    off = [np.abs(balance.pressed(one.loads[-20:])[..., 0].mean(0)) for one in (done, blind)]
    assert (off[0] < 0.8 * off[1]).all() and not blind.stays.any() and np.ptp(done.stays[-1, :, 0]) < 0.05
    downhill = np.sign(blind.stays[-1, :, 0] + balance.pressed(blind.loads[-1])[:, 0] - blind.foretold[-1, :, 0])
    assert (np.sign(done.stays[-1, :, 0]) == downhill).all()
    assert done.foretold.shape == done.stays.shape == (len(done.loads), 2, 2)
    np.testing.assert_array_equal(blind.foretold[0], np.repeat(blind.plan.expected[0], 2, 0))


def test_a_bias_beyond_what_babbling_showed_is_something_in_the_way(mind: Mind) -> None:
    usual = np.sqrt(mind.pilot.dynamics.bias_variance)
    mean = np.zeros((2, len(usual), 3))
    mean[0, :, 2], mean[1, 3, 2] = 0.9 * USUAL * usual, -1.1 * USUAL * usual[3]
    belief, resisted = StateEstimate(mind.pilot.schema, mind.pilot.dynamics).usual(
        Belief(mean, np.zeros((len(usual), 3, 3)))
    )
    np.testing.assert_array_equal(belief.mean[0], mean[0])
    np.testing.assert_allclose(belief.mean[1, 3], [0, 0, -USUAL * usual[3]])
    assert np.argwhere(resisted).tolist() == [[1, 3]]


def test_who_holds_an_arm_is_noticed_and_lets_go(balance: Balance, mind: Mind, hung: SimulatedBody) -> None:
    """A gear that locks and is mended: felt as resistance while it lasts; afterwards it catches up without swinging."""
    body, joint = standing_of(OPTIONS, 1, 7), "left_arm_joint_1"
    held = standing_of(OPTIONS, 1, 7)
    line = [body.sense_labels[i] for i in mind.pilot.schema.posture].index(joint)
    original, tick = held.act, 0

    def act(motors: np.ndarray) -> np.ndarray:
        nonlocal tick
        tick += 1
        if tick == 40:
            held.jam(joint)
        elif tick == 80:
            held.mend()
        return original(motors)

    held.act = act  # type: ignore[method-assign]
    movement, balancer = raise_arms(hung, 2.5), Balancer(balance)
    done = [perform(one, hung, mind, movement, balancer) for one in (body, held)]
    assert not done[0].resisted[..., line].any() and done[1].resisted[66:79, 0, line].all()
    after = np.rad2deg(np.abs(done[1].angles - done[0].angles)[:, 0, body.joints.index(joint)])
    assert after[78] > 3 and after[95:].max() < 0.3


def test_the_study_counts_who_falls_and_what_half_survive(
    balance: Balance, hung: SimulatedBody, mind: Mind, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Shoved hardly at all nobody falls, shoved by a car everybody; in between lies what half survive."""
    few = {"SPEEDS": (1.0,), "SEEDS": 2, "WAYS": ("ours", "replay", "pd"), "FACING": ("ours",), "PUSHED": ("ours",),
           "SHOWN": {}, "IMPULSES": np.array([0.1, 40.0]), "PUSHED_AT_S": 0.1, "BUILT_IN": ("arms",)}  # fmt: skip
    for name, value in (few | {"HARDSHIPS": {"on ice": {"kg": 0.1}}}).items():
        monkeypatch.setattr(standing_study, name, value)
    shows = dict.fromkeys(("arms", "begin", "moving"), arms(hung)) | {"at rest": np.repeat(arms(hung)[:1], 40, 0)}
    whole = standing_study.Study(Config(robot="hoap2", threads=1), mind, balance, shows, standing_study.GAINS[:1])
    found = standing_study.study(whole, 1)
    assert found["falls"] == {who: {"1": 0} for who in few["WAYS"]} and found["runs"]["ours"] == {"1": 2}
    assert found["hardships"] == {"on ice": {"ours": 0}}
    for when in ("moving", "at rest"):
        assert found["push_impulse_ns"][when] == {"ours": pytest.approx([0.1] * 8)}
    assert len(found["joint_rmse_free_deg"]["arms"]) == 2 and max(found["joint_rmse_free_deg"]["arms"]) < 1


def test_half_survive_what_lies_between_the_sizes_of_pushes() -> None:
    stood = np.arange(8) % (len(standing_study.IMPULSES) + 1)  # in each direction, so many of the sizes from below
    fell = (np.arange(len(standing_study.IMPULSES)) >= stood[:, None]).ravel().tolist()
    ends = np.concatenate([[0.4], standing_study.IMPULSES])
    assert standing_study.survived(fell) == pytest.approx(ends[stood])


def test_a_mind_and_its_balance_are_left_by_one_command_and_taken_by_the_next(
    hurried: list[float], tmp_path: Path
) -> None:
    mind, balance, out = tmp_path / "mind.nc", tmp_path / "mind.balance.nc", tmp_path / "out"
    assert main(["babble", "--robot", "hoap2", "--stand", "--babbling-minutes", "0.3", "--out", str(mind)]) == 0
    found = load(balance, Balance)
    found.check(standing_of(OPTIONS, 1, 0))
    movement = tmp_path / "arms.csv"
    angles = np.tile(HOME, (8, 1))
    angles[:, JOINTS.index("left_arm_joint_1")] += np.linspace(0, -0.4, 8)
    rows = [",".join(map(str, [n / 10, *row])) for n, row in enumerate(angles)]
    movement.write_text("\n".join([",".join(["time", *JOINTS]), *rows]))
    taken = ["--forward-model", str(mind), "--balance", str(balance), "--demonstration", str(movement)]
    assert main(["gesture", "--stand", *taken, "--push", "0.2,3,0,0", "--out", str(out)]) == 0
    metrics = json.loads((out / "metrics.json").read_text())
    assert metrics["balance_body_minutes"] == pytest.approx(found.minutes.sum())
    assert set(metrics["fell"]) == {"ours", "linear", "replay"} and not metrics["fell"]["ours"]
    assert metrics["joint_rmse_deg"] < 1 and metrics["contact_frames_share"] == 0 < metrics["choice_p50_ms"]
    assert {"recording.rrd", "standing.png"} <= {file.name for file in out.iterdir()}
    assert main(["gesture", "--stand", *taken, "--robot", "hoap2-worn", "--out", str(out / "other")]) == 2
