"""Babbling in the dark: what single acts show of a mouth that stops its tongue, each infant by itself."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from babbling.dark import FEWEST_ACTS, STILL_ACTS, Acts, FaceMind, babble, gaps, learn
from babbling.errors import BabblingError
from babbling.files import load, save
from babbling.relations import FORWARD, JAW, LIP, LIPS, MOUTH_M, RELATIONS, TIP, TONGUE, Landmarks
from tests.babbling.mouth import HIGH, LOW, MET, NOISE, ONE_WAY, PARTED, YIELDS, Mouth

COPIES, ACTS = 5, 1200
FloatArray = np.ndarray


def raised(body: Mouth, acts: int = ACTS, first: int = 0) -> list[Acts]:
    return babble(body, acts, body.rest, [np.random.default_rng([5, first + n]) for n in range(body.copies)])


@pytest.fixture(scope="module")
def clean() -> list[Acts]:
    return raised(Mouth(COPIES))


@pytest.fixture(scope="module")
def noisy() -> list[Acts]:
    return raised(Mouth(COPIES, noise=1.0))


@pytest.fixture(scope="module")
def minds(noisy: list[Acts]) -> list[FaceMind]:
    return [learn(acts, Mouth().fingerprint) for acts in noisy]


def by_senses(joints: FloatArray, parted: float = PARTED, met: float = MET) -> FloatArray:
    """(N, 8) relations of joints, by their law."""
    return Landmarks(parted, met).relations(np.hstack([joints, np.zeros((len(joints), 13))]))


# --------------------------------------------------------------------------------------------- relations


def test_relations_are_what_they_are_said_to_be() -> None:
    joints = np.random.default_rng(0).uniform(LOW, HIGH, (20, 8))
    jaw, slide, yaw, pitch, lips, brows, turn, nod = joints.T
    found = dict(zip(RELATIONS, by_senses(joints).T, strict=True))
    np.testing.assert_allclose(found["gap"], 2 * JAW * np.sin((jaw - PARTED) / 2))
    np.testing.assert_allclose(found["beyond"], (slide - MET) / MOUTH_M - LIP)
    np.testing.assert_allclose(found["side"], TONGUE * np.sin(yaw) * np.cos(pitch))
    np.testing.assert_allclose(found["up"], TONGUE * np.sin(pitch))
    np.testing.assert_allclose(found["purse"], FORWARD * lips / MOUTH_M)
    np.testing.assert_allclose(found["brow"], brows / MOUTH_M)
    np.testing.assert_allclose([found["turn"], found["nod"]], np.stack([turn, nod]) / (np.pi / 2))


def test_touch_tells_where_lips_part_and_where_the_tongue_meets_them(noisy: list[Acts]) -> None:
    for acts in noisy:
        felt = Landmarks.felt(np.concatenate([acts.nothing, acts.senses]))
        assert felt.parted == pytest.approx(PARTED, abs=1e-3) and felt.met == pytest.approx(MET, abs=1e-4)


def test_landmarks_are_medians_of_what_touched() -> None:
    """A tongue between the lips is no shut mouth; one that is bent or comes out is not met from inside."""
    senses = np.zeros((8, 21))
    senses[:, LIPS.start] = [0.2, 0.2, 0.2, 0, 0.2, 0.2, 0.2, 0.2]
    senses[:, TIP] = [0, 0, 0, 0, 0.2, 0.2, 0.2, 0.2]
    senses[:, 0] = [0.01, 0.03, 0.02, 9, 0.02, 0.03, 0.04, 0.5]
    senses[:, 1] = [0, 0, 0, 0, 0.005, 0.006, 0.008, 0.02]
    assert Landmarks.felt(senses) == Landmarks(0.02, 0.006)
    senses[4:7, 4] = 0.001  # pushed forward
    assert Landmarks.felt(senses).met == pytest.approx(0.006 - FORWARD * 0.001)
    bent = senses.copy()
    bent[4:7, 2] = 0.4
    assert Landmarks.felt(bent).met == pytest.approx(0.008 - FORWARD * 0.001), "as far as ever it came behind them"
    senses[:, LIPS] = 0
    with pytest.raises(BabblingError, match="the lips were never felt to touch: babble longer"):
        Landmarks.felt(senses)


def test_a_tongue_against_the_palate_has_not_met_the_lips() -> None:
    senses = np.zeros((12, 21))
    senses[:8, LIPS] = 0.2
    senses[3:, TIP] = 0.2
    senses[3:8, 1], senses[8:, 1] = 0.006, 0.0005  # against shut lips; drawn back and curled up
    senses[8:, 3] = 0.15
    assert Landmarks.felt(senses).met == pytest.approx(0.006)
    assert Landmarks.felt(np.vstack([senses, senses[8:]])).met == pytest.approx(0.006), "however often"


# ------------------------------------------------------------------------------------------------- acts


def test_a_third_moves_one_motor_a_third_one_and_the_mouth_s_a_third_all(clean: list[Acts]) -> None:
    body, third = Mouth(), ACTS // 3
    for acts in clean:
        moved = np.abs(acts.commands - body.rest) > 1e-12
        assert (moved[:third].sum(1) == 1).all()
        np.testing.assert_array_equal(moved[:third].sum(0), third / 8)  # each motor in its turn
        opener = body.motor[0]
        assert moved[third : 2 * third, opener].all() and (moved[third : 2 * third].sum(1) <= 2).all()
        np.testing.assert_array_equal(moved[third : 2 * third].sum(0)[np.arange(8) != opener], third / 8)
        assert moved[2 * third :].all()
        later = acts.commands[2 * third :]
        assert ((acts.reach[0] <= later) & (later <= acts.reach[1])).all(), "only what makes a difference"
        opening = acts.commands[third : 2 * third, opener]
        assert (acts.reach[0, opener] <= opening.min()) and (opening.max() <= acts.reach[1, opener])
        assert np.ptp(acts.commands[:third], axis=0).min() > 1.4, "of which nothing is known at first"
        assert len(acts.nothing) == STILL_ACTS and (acts.nothing[:, :8] == acts.nothing[0, :8]).all()


@pytest.mark.parametrize("noise", ["clean", "noisy"])
def test_reach_brackets_what_a_motor_can_do(noise: str, request: pytest.FixtureRequest) -> None:
    body = Mouth()
    for acts in request.getfixturevalue(noise):
        span = np.ptp(body.ends, axis=0)
        off = (acts.reach - body.ends) / span
        tongue = body.motor[1]  # which stops at shut lips
        others = np.delete(np.arange(8), tongue)
        assert np.abs(off[:, others]).max() < 0.2 and np.abs(off[:, others]).mean() < 0.07
        assert off[0, tongue] < 0.3 and off[1, tongue] > -0.3, "much of its way at least"
        assert np.abs(acts.reach).max() <= 1


def test_a_tongue_s_reach_is_not_that_behind_shut_lips(noisy: list[Acts]) -> None:
    body = Mouth()
    tongue = body.motor[1]
    for acts in noisy:
        free = acts.senses[acts.senses[:, 0] > 0.2, 1]
        assert free.max() > 0.95 * HIGH[1]
        assert (acts.reach[0, tongue] < 0.9 * body.ends[0, tongue]) and (acts.reach[1] > 0.9 * body.ends[1])[tongue]


def test_an_infant_s_acts_depend_on_its_own_randomness_alone(clean: list[Acts]) -> None:
    for copy in (0, COPIES - 1):
        [alone] = raised(Mouth(1), first=copy)
        for mine, among in zip(alone, clean[copy], strict=True):
            np.testing.assert_array_equal(mine, among)
    assert not np.array_equal(clean[0].commands, clean[1].commands)
    assert not np.array_equal(clean[0].reach, clean[1].reach)


def test_every_act_is_heeded_and_too_few_are_refused() -> None:
    told, body = list[int](), Mouth(2)
    rngs = [np.random.default_rng(n) for n in range(2)]
    babble(body, FEWEST_ACTS, body.rest, rngs, told.append)
    assert told == list(range(FEWEST_ACTS))
    with pytest.raises(BabblingError, match=f"{FEWEST_ACTS - 1} acts: at least {FEWEST_ACTS} are needed"):
        babble(body, FEWEST_ACTS - 1, body.rest, rngs)


def test_a_mouth_that_never_shuts_cannot_be_learned(clean: list[Acts]) -> None:
    numb = clean[0]._replace(senses=clean[0].senses.copy(), nothing=clean[0].nothing.copy())
    numb.senses[:, LIPS], numb.nothing[:, LIPS] = 0, 0
    with pytest.raises(BabblingError, match="never felt to touch"):
        learn(numb, "f")


# ----------------------------------------------------------------------------------------------- minds


@pytest.mark.parametrize("wiring", [None, 1, 2, 3])
def test_own_motors_are_found(wiring: int | None) -> None:
    body = Mouth(2, noise=1.0, wiring=wiring)
    for acts in raised(body):
        np.testing.assert_array_equal(learn(acts, "f").motors, body.motor)
        units = np.logspace(-2, 1, 8)  # what a motor's commands are counted in is nothing to its joint
        other = acts._replace(commands=units * acts.commands, reach=units * acts.reach, rest=units * acts.rest)
        np.testing.assert_array_equal(learn(other, "f").motors, body.motor)


def test_minds_know_their_own_rest(minds: list[FaceMind]) -> None:
    joints = np.where(np.arange(8) == 0, PARTED, 0.0)[None]
    for mind in minds:
        np.testing.assert_allclose(mind.still, by_senses(joints)[0], atol=0.02)
        np.testing.assert_array_equal(mind.rest, Mouth().rest)


def test_a_mind_foresees_what_its_joints_do(minds: list[FaceMind]) -> None:
    """With the mouth open every relation is what its own motor is told, along the bent line."""
    body, rng = Mouth(), np.random.default_rng(9)
    shares = rng.uniform(np.where(ONE_WAY, -0.9, -0.7), 0.7, (200, 8))
    shares[:, 0] = rng.uniform(0.0, 0.7, 200)
    lines = body.lines(shares)
    joints = (LOW + HIGH) / 2 + (HIGH - LOW) / 2 * (0.7 * shares + 0.3 * shares**3)
    wanted = by_senses(joints)
    reach = np.ptp(by_senses(np.stack([LOW, HIGH])), axis=0)
    for mind in minds:
        found = mind.forward_model.expected([gaps(wanted[:, 0], 8)], lines[:, mind.motors])
        off = np.abs(found - wanted) / reach
        assert off.mean() < 0.03 and np.quantile(off, 0.98) < 0.12


def test_a_mind_knows_that_shut_lips_stop_the_tongue(minds: list[FaceMind]) -> None:
    """Beyond where it meets them a tongue goes on as told or, mouth shut, little further than lips yield."""
    body, gap = Mouth(), np.ones((40, 8))
    for mind in minds:
        far = mind.forward_model.action.low[1] if body.gain[1] < 0 else mind.forward_model.action.high[1]
        lines = np.tile(body.rest, (40, 1))
        lines[:, body.motor[1]] = np.linspace(body.rest[body.motor[1]], far, 40)
        x = np.clip(body.gain * lines[:, body.motor] + body.offset, -1, 1)
        told = ((LOW + HIGH) / 2 + (HIGH - LOW) / 2 * (0.7 * x + 0.3 * x**3))[:, 1]
        commands, joints = lines[:, mind.motors], np.zeros((40, 8))
        stopped = np.minimum(told, MET + FORWARD * YIELDS * (told - MET))
        for width, slide, tolerance in ((0.0, stopped, 0.15), (0.5, told, 0.08)):
            joints[:, 1] = slide  # single acts behind shut lips are few, and a line stands in for the rest
            off = mind.forward_model.expected([gaps(width * gap[:, 0], 8)], commands)[:, 1] - by_senses(joints)[:, 1]
            assert np.abs(off).mean() < tolerance, width
        shut, opened = (mind.forward_model.expected([gaps(w * gap[:, 0], 8)], commands) for w in (0.0, 0.5))
        pushing = told > 2 * MET
        assert (opened - shut)[pushing, 1].mean() > 0.15
        np.testing.assert_allclose(shut[:, 2:], opened[:, 2:], atol=0.06)  # nothing else minds


def test_the_gap_is_its_own_context_never() -> None:
    context = gaps(np.array([[0.3, 0.4]]), 3)
    np.testing.assert_array_equal(context, [[[0.0, 0.3, 0.3], [0.0, 0.4, 0.4]]])


def test_nothing_that_was_felt_falls_off_the_axes(noisy: list[Acts], minds: list[FaceMind]) -> None:
    for acts, mind in zip(noisy, minds, strict=True):
        assert mind.forward_model.outside.sum() == 0
        assert mind.forward_model.transitions == 8 * len(acts.senses)


def test_a_mind_survives_its_file_and_belongs_to_one_body(minds: list[FaceMind], tmp_path: Path) -> None:
    mind, path = minds[0], tmp_path / "mind.nc"
    save(mind, path)
    found = load(path, FaceMind)
    for name in ("motors", "rest", "still"):
        np.testing.assert_array_equal(getattr(found, name), getattr(mind, name))
    assert (found.fingerprint, found.landmarks) == (mind.fingerprint, mind.landmarks)
    np.testing.assert_array_equal(found.forward_model.predictive, mind.forward_model.predictive)
    np.testing.assert_array_equal(found.forward_model.action.points, mind.forward_model.action.points)
    found.check(Mouth())
    with pytest.raises(BabblingError, match="learned by another body"):
        found.check(Mouth(wiring=1))


def test_a_mind_of_motors_that_it_has_not_is_refused(minds: list[FaceMind]) -> None:
    for motors in (np.arange(7), np.arange(1, 9)):
        with pytest.raises(BabblingError, match="of relations; 8 of 8"):
            replace(minds[0], motors=motors)


def test_more_acts_teach_more() -> None:
    body, rng = Mouth(1, noise=1.0), np.random.default_rng(3)
    shares = rng.uniform(0.0, 0.7, (100, 8))
    joints = (LOW + HIGH) / 2 + (HIGH - LOW) / 2 * (0.7 * shares + 0.3 * shares**3)
    wanted, errors = by_senses(joints), []
    for acts in (90, 1200):
        mind = learn(raised(body, acts)[0], "f")
        found = mind.forward_model.expected([gaps(wanted[:, 0], 8)], body.lines(shares)[:, mind.motors])
        errors.append(np.abs((found - wanted) / by_senses(HIGH[None])).mean())
    assert errors[1] < errors[0] / 2 and NOISE.min() > 0
