"""Noticing a changed body, and counting on: the laws of both."""

from types import SimpleNamespace

import numpy as np
import pytest

from babbling.errors import BabblingError
from babbling.explanations import Explanations
from imitation.acting.counting_on import CountingOn
from imitation.acting.loop import State, imitate
from imitation.acting.movement import together
from imitation.acting.noticing import BROADER, FADING, LAGS, Alarm, Normal, Noticer, Run, grow
from imitation.acting.rehearsal import made_up_movement
from models.loading import load_body

TICK_S = 0.02
JOINTS = 5


def healthy(rng: np.random.Generator, ticks: int = 3000, copies: int = 8) -> Run:
    """Misses that follow each other and grow with speed; some are far out."""
    rate = np.cumsum(rng.normal(0, 0.02, (ticks, copies, JOINTS)), axis=0)
    rate -= rate.mean(0)
    missed = np.zeros((ticks, copies, JOINTS, 2))
    noise = rng.standard_t(5, missed.shape) * (0.01 + 0.01 * np.abs(rate[..., None]))
    for t in range(1, ticks):
        missed[t] = 0.6 * missed[t - 1] + noise[t]
    return Run(missed, rate, 0.1 * np.cumsum(rate, 0) * TICK_S)


@pytest.fixture(scope="module")
def normal() -> Normal:
    return Normal.found(healthy(np.random.default_rng(0)), TICK_S)


def test_evidence_is_a_cusum_that_fades() -> None:
    """By brute force: the best of all moments at which the change may have been, each with its own faded sum."""
    rng = np.random.default_rng(1)
    ratios, grown = rng.normal(-0.1, 1, 60), np.zeros(1)
    for t, ratio in enumerate(ratios):
        grown = grow(grown, np.array([ratio]))
        sums = [sum(ratios[k : t + 1] * FADING ** np.arange(t - k, -1, -1)) for k in range(t + 1)]
        assert grown[0] == pytest.approx(max(0, *sums))


def test_what_foretells_a_miss_is_found_and_taken_out(normal: Normal) -> None:
    rest = normal.standard(healthy(np.random.default_rng(2)))
    assert abs((rest[1:] * rest[:-1]).mean() / (rest**2).mean()) < 0.02  # of .6
    rate = healthy(np.random.default_rng(2)).rate[LAGS - 1 : -1]
    fast = np.abs(rate) > np.quantile(np.abs(rate), 0.9)
    assert (rest[fast] ** 2).mean() / (rest[~fast] ** 2).mean() < 1.5  # of what was about 7
    assert (np.abs(normal.freedom / 5 - 1) < 0.5).all()


def test_log_ratios_are_those_of_two_densities(normal: Normal) -> None:
    """Under what is usual the ratio's mean is 1: importance sampling of the broad density."""
    rng = np.random.default_rng(3)
    nu = 4.0
    plain = normal._replace(
        whitening=np.tile(np.eye(2), (1, 1, 1)), freedom=np.array([nu]), spread=np.zeros((1, 2, 7)),
        weights=np.zeros((1, 2, 2 * LAGS + 6)),
    )  # fmt: skip
    plain.spread[..., 0] = 1.0
    draws = rng.standard_normal((200_000, 2)) / np.sqrt(rng.chisquare(nu, (200_000, 1)) / nu)
    missed = np.concatenate([np.zeros((LAGS, 2)), draws])[:, None, None]
    ratios = plain.ratios(Run(missed, np.zeros(missed.shape[:3]), np.zeros(missed.shape[:3])))
    assert np.exp(ratios[:, 0]).mean() == pytest.approx(1, abs=0.4)  # heavy tails: a rough mean
    assert (ratios[draws[:, 0] ** 2 + draws[:, 1] ** 2 < 1] < 0).all()
    assert ratios.max() < nu * np.log(BROADER[-1])  # one tick says no more


def test_false_alarms_are_as_rare_as_promised_and_a_shifted_joint_is_named(normal: Normal) -> None:
    run = healthy(np.random.default_rng(4), copies=16)  # 16 minutes
    surprise = normal.alarm.surprise(normal.sizes(run))
    whole = normal.alarm.whole(surprise)
    seconds = whole[: len(whole) // 50 * 50].reshape(-1, 50, 16).max(1)
    for level in (3.0, 4.0):  # once in 20 and in 55 seconds
        assert np.exp(-level) / 3 < (seconds > level).mean() < np.exp(-level) * 3
    assert (seconds > np.log(3600)).sum() <= 2
    run.missed[1000:, 3, 2] += 0.5
    surprise = normal.alarm.surprise(normal.sizes(run))
    soon = slice(1000 - LAGS, 1000 - LAGS + 25)
    assert normal.alarm.whole(surprise)[soon, 3].max() > np.log(3600)
    assert surprise[soon, 3].max(0).argmax() == 2


def test_an_alarm_of_sizes_without_chance_is_finite() -> None:
    """A size that never grew while nothing changed: still no certainty, and no division by nothing."""
    alarm = Alarm.found(np.zeros((200, 2, 4, 3)), TICK_S)
    surprise = alarm.surprise(np.full((2, 4, 3), 5.0))
    assert np.isfinite(surprise).all() and (alarm.whole(surprise) > 0).all()
    assert (alarm.surprise(np.zeros((2, 4, 3))) == 0).all()


def test_a_jam_is_noticed_while_imitating_and_named(arm, arm_mind) -> None:
    """Step by step it is what all of it says afterwards."""

    def moves(seed: int, copies: int, seconds: float):
        body = load_body(arm, copies=copies)
        rngs = [np.random.default_rng([seed, copy]) for copy in range(copies)]
        return body, together([made_up_movement(body, arm_mind, rng, seconds) for rng in rngs])

    body, movement = moves(5, 4, 12)
    infos = []
    imitate(body, movement, arm_mind, rng=np.random.default_rng(0), heed=lambda state, senses, info: infos.append(info))
    normal = Normal.found(Run.of(infos), body.tick_s)
    body, movement = moves(6, 4, 3)
    noticer, infos = Noticer(normal), []
    goals = movement.senses[..., arm_mind.pilot.schema.posture]
    joint = int(np.ptp(goals[50:75, 0], axis=0).argmax())
    named = body.sense_labels[arm_mind.pilot.schema.posture[joint]]
    noticed = []

    def heed(state: State, senses, info) -> None:
        noticer(state, senses, info)
        infos.append(info)
        noticed.append(noticer.noticed)
        if state.left == len(goals) - 50:
            body.jam(named, np.array([0]))

    imitate(body, movement, arm_mind, rng=np.random.default_rng(0), heed=heed)
    changed = len(infos) - len(goals) + 50
    assert not np.stack(noticed)[: changed + 1, 0].any() and np.stack(noticed)[changed + 1 : changed + 26, 0].any()
    assert noticer.surprises[changed + 25][0].argmax() == joint
    at_once = normal.alarm.surprise(normal.sizes(Run.of(infos)))
    np.testing.assert_allclose(np.stack(noticer.surprises)[LAGS:], at_once, rtol=1e-9, atol=1e-9)


def test_counting_on_counts_what_babbling_would_have(arm, arm_mind) -> None:
    """The transitions of a run, told step by step, are those of the pilot's own account of it; and nobody else's mind
    changes."""
    body = load_body(arm)
    before, counting = arm_mind.forward_model.moments.copy(), CountingOn(arm_mind)
    pilot, senses, commands = arm_mind.pilot, [], []

    def heed(state: State, felt, info) -> None:
        counting(state, felt, info)
        senses.append(felt)
        commands.append(info.commands)

    movement = made_up_movement(body, arm_mind, np.random.default_rng(7), 2)
    imitate(body, movement, arm_mind, rng=np.random.default_rng(0), heed=heed)
    columns, outcome = counting.count()
    motors = pilot.schema.motors(np.stack(commands))[:-1]
    expected = pilot.experienced(motors, np.stack(senses))
    np.testing.assert_allclose(columns, expected[0], atol=1e-6)  # who acts also expects what no line does
    np.testing.assert_allclose(outcome, expected[1], atol=1e-6)
    model = counting.mind.forward_model
    assert model.transitions == arm_mind.forward_model.transitions + outcome.size
    np.testing.assert_array_equal(arm_mind.forward_model.moments, before)


def test_what_fades_weighs_less_and_says_the_same(arm_mind) -> None:
    """Fading alone moves no line; merged with new experience the old weighs its share; nothing is left of nothing."""
    counting = CountingOn(arm_mind)
    model: Explanations = counting.mind.forward_model
    lines, weights = model.lines.copy(), model.weights.copy()
    model.fade(0.25)
    np.testing.assert_allclose(model.lines, lines, atol=1e-6)
    assert model.transitions == pytest.approx(arm_mind.forward_model.transitions / 4, abs=3)
    np.testing.assert_allclose(model.evidence, arm_mind.forward_model.evidence / 4)
    assert (model.weights.max(1) <= weights.max(1) + 1e-9).all()  # less evidence, less sure
    model.fade(0.0)
    with pytest.raises(BabblingError, match="no experience"):
        model.fit("line")


def test_noticing_starts_afresh_with_each_attempt(normal: Normal) -> None:
    noticer = Noticer(normal)
    rng = np.random.default_rng(8)

    def info(size: float):
        missed, rest = rng.normal(0, size, (1, JOINTS, 2)), np.zeros((1, JOINTS))
        return SimpleNamespace(missed=missed, believed=np.zeros((1, JOINTS, 3)), commands=rest)

    for tick in range(10):
        noticer(SimpleNamespace(tick=tick), np.zeros(0), info(5.0))
    assert noticer.noticed.all()
    noticer(SimpleNamespace(tick=0), np.zeros(0), info(0.0))
    assert not noticer.noticed.any()
