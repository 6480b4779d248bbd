"""The loop, one step at a time: what a step wants and believes, whom it depends on, and how attempts end."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

from babbling.axes import Axis
from babbling.belief import StateEstimate
from babbling.forward_model import ForwardModel
from imitation.acting.loop import Attempt, Imitator, imitate, lasting
from imitation.acting.movement import APPROACH_S, RUN_UP_S, Movement
from imitation.errors import ImitationError
from imitation.inference.inverse import Term
from imitation.inference.moving import AveragedInverse, Decided, Here
from models.loading import load_body
from models.motion import read_motion

LEAD = round(APPROACH_S / 0.02) + round(RUN_UP_S / 0.02)
FEW = ("posterior", "candidates", "familiarity")
ARRAYS = ("senses", "truth", "believed", "wanted", "commands", "evidence", "entropy", *FEW)


class Asked(NamedTuple):
    here: Here
    wanted: np.ndarray
    action: np.ndarray


class Obeyed:
    """An inverse model whose every wish comes true: it expects what it is asked for; its actions are arbitrary."""

    def __init__(self) -> None:
        self.asked: list[Asked] = []

    def choose(self, here, wanted, terms, rng):
        self.asked.append(Asked(here, wanted, rng.uniform(-0.1, 0.1, wanted.shape)))
        return Decided.bare(self.asked[-1].action)

    def expect(self, here, command):
        return self.asked[-1].wanted


@pytest.fixture(scope="module")
def movement(arm, wave):
    body = load_body(arm)
    return Movement("wave", 0.02, body.sensations(read_motion(wave).reordered(body.joints).resampled(0.02).angles))


def feeling(schema, copies, seed):
    """Endless random senses that are in no way what was wanted."""
    rng = np.random.default_rng(seed)
    while True:
        senses = np.zeros((copies, 6))
        senses[:, schema.posture], senses[:, schema.rate] = rng.normal(0, 0.3, (2, copies, 3))
        yield senses


def driven(mind, movement, eagerness, copies=2, aim=0.0):
    """One attempt on random senses: inverse model, states (one more than infos) and infos."""
    inverse, rng = Obeyed(), np.random.default_rng(0)
    imitator = Imitator(mind, movement, inverse=inverse, eagerness=eagerness)
    senses = feeling(mind.pilot.schema, copies, 1)
    felt = [next(senses)]
    states, infos = [imitator.start(felt[0], aim)], []
    while states[-1].left:
        state, _, info = imitator.step(states[-1], felt[-1], rng)
        states.append(state)
        infos.append(info)
        felt.append(next(senses))
    return inverse, states, infos, felt


def test_no_command_beyond_the_motors_is_sent_and_the_belief_is_told_what_was_sent(arm, arm_mind, movement):
    """Wishes far beyond every stop: what the motors get is what the belief goes on with. A command may ask for more
    than a posture within the senses' range (what pushes back takes some of it), the way into a movement may not."""
    pilot, eager = arm_mind.pilot, Obeyed()
    eager.choose = lambda here, wanted, terms, rng: Decided.bare(np.array([[9.0, -9.0, 0.0]]))
    eager.expect = lambda here, command: command - here.posture
    imitator = Imitator(arm_mind, movement, inverse=eager)
    body = load_body(arm)
    low, high = body.sense_low[pilot.schema.posture], body.sense_high[pilot.schema.posture]
    state, motors, info = imitator.step(imitator.start(felt := body.reset()), felt, np.random.default_rng(0))
    np.testing.assert_allclose(pilot.schema.efference(motors), info.commands, atol=1e-12)
    np.testing.assert_array_equal(info.commands[0, :2], [pilot.ends[0].max(), pilot.ends[1].min()])
    sent = np.sort(pilot.schema.motors(pilot.ends.T), axis=0)
    np.testing.assert_allclose(sent, [body.motor_low, body.motor_high])
    before = imitator.start(felt).belief
    told = imitator.estimate.predict(before, info.commands, info.commands - before.mean[..., 0])
    np.testing.assert_array_equal(state.belief.mean, told.mean)
    near = Imitator(arm_mind, movement, inverse=eager, farthest=np.array([0.1, 0.2, np.inf]))
    state, _, info = near.step(near.start(felt), felt, np.random.default_rng(0))
    np.testing.assert_allclose((info.commands - info.believed[..., 0])[0, :2], [0.1, -0.2])
    told = near.estimate.predict(before, info.commands, info.commands - before.mean[..., 0])
    np.testing.assert_array_equal(state.belief.mean, told.mean)
    fast = Movement("fast", 0.02, body.sensations(body.joint_range[:, 1] - 4 * 0.02 * np.arange(5.0)[:, None]))
    way = Imitator(arm_mind, fast).start(felt).targets[:LEAD]
    assert (way >= low).all() and (way <= high).all()
    np.testing.assert_array_equal(way[-1, 0], high)


@pytest.mark.parametrize("copies", [1, 3])
def test_steps_by_hand_are_what_the_loop_does(arm, arm_mind, movement, copies):
    body, rng = load_body(arm, copies=copies, noise=0.002), np.random.default_rng(0)
    imitator = Imitator(arm_mind, movement, selection="matching")
    senses = body.reset()
    state, seen = imitator.start(senses), []
    while state.left:
        state, motors, info = imitator.step(state, senses, rng)
        seen.append((senses, body.joint_angles.copy(), info))
        senses = body.act(motors)
    body = load_body(arm, copies=copies, noise=0.002)
    once = imitate(
        body, movement, arm_mind, selection="matching", rng=np.random.default_rng(0), witness=lambda: body.joint_angles
    )[0]
    assert once.ended is None and once.ended_tick == len(once.senses) == 100
    for t, (senses, angles, info) in enumerate(seen[LEAD:]):
        by_hand = vars(lasting(info)) | {"senses": senses, "truth": angles}
        for name in (*ARRAYS, "uninformed"):
            assert getattr(once, name)[t].tobytes() == by_hand[name].tobytes(), (name, t)


def test_a_step_can_be_taken_again_and_does_not_change_the_state(arm_mind, movement):
    imitator = Imitator(arm_mind, movement)
    senses = feeling(arm_mind.pilot.schema, 2, 0)
    first, second = next(senses), next(senses)
    state = imitator.step(imitator.start(first), first, np.random.default_rng(0))[0]
    before = [part.copy() for part in (*state.belief, *state.echo, state.targets)]
    once, again = (imitator.step(state, second, np.random.default_rng(1)) for _ in range(2))
    assert once[1].tobytes() == again[1].tobytes() and once[2].believed.tobytes() == again[2].believed.tobytes()
    assert all((a == b).all() for a, b in zip(before, (*state.belief, *state.echo, state.targets), strict=True))
    with pytest.raises(ValueError, match="read-only"):
        state.targets[0] = 0


def test_whose_wishes_come_true_is_at_the_next_sub_goal_one_tick_later(arm_mind, movement):
    """From wherever it believes to be, however fast, whatever its bias; beyond the last sub-goal at its own pace."""
    _, states, infos, _ = driven(arm_mind, movement, eagerness=1.0)
    goals = movement.postures(arm_mind.pilot.schema)
    onward = np.concatenate([goals, 2 * goals[-1:] - goals[-2:-1]])
    for t, (goal, state) in enumerate(zip(onward, states[LEAD:], strict=True)):
        np.testing.assert_allclose(state.belief.mean[..., 0], np.tile(goal, (2, 1)), atol=1e-12, err_msg=f"tick {t}")
    bias = np.abs([info.believed[..., 2] for info in infos])
    assert np.median(bias) > 1e-3, "there was something to get wrong"


@pytest.mark.parametrize("eagerness", [0.0, 0.4, 1.0])
def test_it_asks_from_between_where_it_is_and_where_it_should_be(arm_mind, movement, eagerness):
    inverse, states, infos, _ = driven(arm_mind, movement, eagerness)
    signs = set()
    for asked, state, info in zip(inverse.asked, states, infos, strict=False):
        target, (posture, rate, _) = state.targets[state.tick], info.believed.T
        pace, onward = np.gradient(state.targets, 0.02, axis=0)[state.tick : state.tick + 2]
        where = (1 - eagerness) * target + eagerness * posture.T
        np.testing.assert_allclose(asked.here.posture, where, atol=1e-12)
        np.testing.assert_allclose(asked.here.rate, (1 - eagerness) * pace + eagerness * rate.T, atol=1e-12)
        np.testing.assert_allclose(asked.here.pace, onward, atol=1e-12)
        np.testing.assert_array_equal(asked.here.ahead, state.targets[state.tick + 1 :])
        told = (where + asked.action).clip(*arm_mind.pilot.ends.T)
        np.testing.assert_allclose(info.commands, told, atol=1e-12)
        signs |= set(np.sign(asked.here.rate).ravel())
    assert {-1.0, 1.0} <= signs


def test_the_mirror_image_is_asked_for_the_mirror_image(arm_mind, movement):
    """Negate what is felt and what was seen: every question is negated (nothing in the loop is blind to a sign)."""
    turned = Movement("turned", movement.tick_s, -movement.senses)
    pilot = replace(arm_mind.pilot, low=np.full(3, -9.0), high=np.full(3, 9.0))  # its own stops have no mirror image
    mind = replace(arm_mind, pilot=pilot)
    imitators = [Imitator(mind, m) for m in (movement, turned)]
    senses = feeling(arm_mind.pilot.schema, 1, 3)
    first, second = next(senses), next(senses)
    wanted = []
    for imitator, sign in zip(imitators, (1, -1), strict=True):
        rng = np.random.default_rng(0)
        state = imitator.start(sign * first)
        belief = state.belief._replace(mean=sign * np.random.default_rng(5).normal(0, 0.1, (1, 3, 3)))
        _, _, info = imitator.step(state._replace(belief=belief, tick=1), sign * second, rng)
        wanted.append(np.concatenate([info.wanted[..., None], info.believed], -1))
    np.testing.assert_allclose(wanted[0], -wanted[1], atol=1e-12)


def test_what_is_believed_is_the_filter_over_everything_felt_so_far(arm_mind, movement):
    inverse, _, infos, felt = driven(arm_mind, movement, eagerness=0.5)
    schema = arm_mind.pilot.schema
    estimate = StateEstimate(schema, arm_mind.pilot.dynamics)
    belief = estimate.start(felt[0][:, schema.posture], felt[0][:, schema.rate])
    for t, info in enumerate(infos):
        if t:
            belief = estimate.correct(belief, felt[t][:, schema.posture], felt[t][:, schema.rate])
        np.testing.assert_allclose(info.believed, belief.mean, atol=1e-12)
        belief = estimate.predict(belief, info.commands, inverse.asked[t].wanted)


def test_what_earlier_commands_left_is_the_plays_of_all_commands_so_far(arm_mind, movement):
    inverse, _, infos, felt = driven(arm_mind, movement, eagerness=0.5)
    features = arm_mind.pilot.frame.features
    echo = features.start(felt[0][:, arm_mind.pilot.schema.posture])
    for asked, info in zip(inverse.asked, infos, strict=True):
        for mine, told in zip(asked.here.echo, echo, strict=True):
            np.testing.assert_array_equal(mine, told)
        echo = features.after(echo, info.commands)


def test_further_terms_are_handed_on_and_told_what_is_felt_and_believed(arm_mind, movement):
    """Pull with this much, says a second term, twice as loud."""
    axes = [Axis(name, "rad", np.full(3, -1.0), np.ones(3), 21) for name in ("action", "pull")]
    model, told = ForwardModel((), *axes, factors=("0", "1", "2"), prior_strength=1.0), []
    pull = np.random.default_rng(2).uniform(-1, 1, (200, 3))
    model.observe((), pull, pull)

    def hold(senses, believed):
        told.append((senses, believed))
        return [Term(model, (), believed[..., 1], 2.0)]

    inverse = AveragedInverse(arm_mind.forward_model)
    asked = []
    choose = inverse.choose
    inverse.choose = lambda *what: asked.append(what) or choose(*what)
    imitator = Imitator(arm_mind, movement, inverse=inverse, terms=hold)
    alone = Imitator(arm_mind, movement, inverse=AveragedInverse(arm_mind.forward_model))
    senses, rng = next(feeling(arm_mind.pilot.schema, 2, 0)), np.random.default_rng(0)
    start = imitator.start(senses)
    also, without = imitator.step(start, senses, rng)[2], alone.step(start, senses, rng)[2]
    (felt, believed), [(_, wanted, [term], _)] = told[0], asked
    assert felt is senses and believed is also.believed and wanted is also.wanted
    assert term.outcome.tobytes() == start.belief.mean[..., 1].tobytes() and term.weight == 2.0
    assert also.wanted.tobytes() == without.wanted.tobytes()
    assert np.abs(also.commands - without.commands).max() > 0.01


def test_copies_do_not_know_of_each_other(arm_mind, movement):
    """Three that feel differently, from the first moment on, do together what each does alone."""
    senses = feeling(arm_mind.pilot.schema, 3, 7)
    felt = [next(senses) for _ in range(LEAD + 100)]
    imitator = Imitator(arm_mind, movement)

    def commands(copies):
        state, done = imitator.start(felt[0][copies]), []
        for now in felt:
            state, _, info = imitator.step(state, now[copies], np.random.default_rng(0))
            done.append(info.commands)
        return np.array(done)

    together = commands([0, 1, 2])
    for copy in range(3):
        np.testing.assert_allclose(commands([copy])[:, 0], together[:, copy], atol=1e-12)


def test_an_aim_shifts_every_sub_goal_and_is_taken_up_on_the_way(arm_mind, movement):
    aim = np.random.default_rng(0).normal(0, 0.1, (100, 2, 3))
    plain, shifted = (driven(arm_mind, movement, 1.0, aim=a)[1] for a in (0.0, aim))
    moved = shifted[0].targets - plain[0].targets
    np.testing.assert_allclose(moved[LEAD:-1], aim, atol=1e-12)
    np.testing.assert_allclose(moved[:LEAD], np.linspace(0, 1, LEAD)[:, None, None] * aim[0], atol=1e-12)


def test_the_next_attempt_aims_against_what_the_last_one_missed(arm, arm_mind, movement):
    """Judged by what is believed, in every factor."""
    body = load_body(arm)
    goals = movement.postures(arm_mind.pilot.schema)
    first, second = imitate(body, movement, arm_mind, attempts=2, eagerness=0.2, rng=np.random.default_rng(0))
    missed = [np.sqrt(np.mean((a.believed[:, 0, :, 0] - goals) ** 2, axis=0)) for a in (first, second)]
    assert (missed[1] < 0.7 * missed[0]).all()


def stopping(at):
    """Ends attempt n at step at[n], counted from the start of its approach."""
    asked, attempt = [0], [0]

    def ended(senses):
        asked[0] += 1
        if attempt[0] < len(at) and asked[0] > at[attempt[0]]:
            asked[0], attempt[0] = 0, attempt[0] + 1
            return f"fell, attempt {attempt[0]}"
        return None

    return ended


def test_an_early_end_is_a_result_and_later_attempts_go_on(arm, arm_mind, movement):
    def attempts(**how) -> list[Attempt]:
        body = load_body(arm)
        return imitate(
            body, movement, arm_mind, attempts=3, rng=np.random.default_rng(0), witness=lambda: body.joint_angles, **how
        )

    whole, (fell, early, last) = attempts(), attempts(ended=stopping([LEAD + 40, 10]))
    assert fell.ended == "fell, attempt 1" and fell.ended_tick == 40 and fell.uninformed.size == 120
    assert early.ended == "fell, attempt 2" and early.ended_tick == 10 - LEAD
    assert last.ended is None and last.ended_tick == 100
    for attempt, lasted in ((fell, 40), (early, 0), (last, 100)):
        for name in (*ARRAYS, "uninformed", "select_s"):
            assert getattr(attempt, name).shape == (lasted, *getattr(whole[0], name).shape[1:]), name
    for name in ARRAYS:
        assert getattr(fell, name).tobytes() == getattr(whole[0], name)[:40].tobytes(), name
    goals = movement.postures(arm_mind.pilot.schema)
    first, again = (np.abs(a.believed[:40, 0, :, 0] - goals[:40]).mean() for a in (fell, last))
    assert again < 0.8 * first, "what happened was learned from"
    np.testing.assert_allclose(last.commands[60:], whole[0].commands[60:], atol=0.02)  # what did not happen was not


def test_beyond_the_end_there_is_no_step(arm_mind, movement):
    imitator = Imitator(arm_mind, movement)
    senses = next(feeling(arm_mind.pilot.schema, 1, 0))
    state = imitator.start(senses)
    assert state.left == LEAD + 100
    over = state._replace(tick=LEAD + 100)
    with pytest.raises(ImitationError, match=f"step {LEAD + 101} of a movement that ends with step {LEAD + 100}"):
        imitator.step(over, senses, np.random.default_rng(0))
