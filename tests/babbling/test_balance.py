"""Balance is found in a world that is known: pressure, pairs, synergies, lean with its product, the settled table."""

from dataclasses import replace

import numpy as np
import pytest

from babbling.balance import SATURATED, Balance, Stood, features, find_pressure, settled, wiggled
from babbling.errors import BabblingError
from babbling.synergies import find_pairs, least
from tests.babbling import soles
from tests.babbling.soles import COUNT, EFFECTS, HOME, PAIRS, PATTERNS, PRESSURE, REACH, REST, TICK, TURNS, learned

BOTH = np.stack([soles.FRONT, soles.LEFT])
FIRST, SECOND = np.triu_indices(COUNT)
PRODUCT = 1 + COUNT + int(np.flatnonzero((FIRST == soles.PRODUCT[0]) & (SECOND == soles.PRODUCT[1]))[0])


@pytest.fixture(scope="module")
def known() -> Balance:
    """After wiggling."""
    return soles.learned(np.random.default_rng(1))


@pytest.fixture(scope="module")
def found(known: Balance) -> Balance:
    """After moving about."""
    rng = np.random.default_rng(2)
    weights, table = settled(known, [soles.stand(rng, known.synergy, gain=0.8) for _ in range(2)], TICK)
    return replace(known, weights=weights, forward_model=table)


def rocked(order: list[int], seed: int, way: np.ndarray | float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """(T, B, 8) loads and (T, B, 3) senses of a balance organ; forward and left are felt by senses `order`."""
    rng = np.random.default_rng(seed)
    pressure = soles.moves(0.1, 6, 6.0, rng, 2) * (1.0, 0.5) * way
    own = 1 / 8 + 0.05 * rng.uniform(-1, 1, (6, 8))
    organ = rng.uniform(-1, 1, (6, 3)) + 0.01 * rng.standard_normal((*pressure.shape[:2], 3))
    organ[..., order] += pressure * (-3.0, 2.0)
    return soles.felt(own + pressure @ PATTERNS.T, rng), organ


@pytest.mark.parametrize("order", [[0, 1], [1, 0], [2, 0], [1, 2]])
@pytest.mark.parametrize("seed", range(3))
def test_pressure_is_found_however_everybody_stands(order: list[int], seed: int) -> None:
    """Up to sign and scale: how everyone's loads and organ read at rest is an individual's own."""
    loads, organ = rocked(order, seed)
    weights, senses = find_pressure(loads, organ)
    assert sorted(senses) == sorted(order)
    gains = weights @ PATTERNS
    for row, sense in enumerate(senses):
        own, other = order.index(sense), 1 - order.index(sense)
        assert abs(gains[row, other]) < 0.05 * abs(gains[row, own])
        assert gains[row, own] * (-3.0, 2.0)[own] > 0, "its sign is that of the sense"
    np.testing.assert_allclose(np.abs(weights).max(1), 1)


@pytest.mark.parametrize("what", ["air", "one way"])
def test_loads_that_do_not_change_in_two_ways_are_no_soles(what: str) -> None:
    loads, organ = rocked([0, 1], 0)
    loads = 0 * loads if what == "air" else 70 * (1 / 8 + 0.1 * organ[..., :1] * PATTERNS.T[0])
    with pytest.raises(BabblingError, match=r"feels nothing of it in its soles") as caught:
        find_pressure(loads, organ)
    assert "\n" not in str(caught.value)


def test_what_a_command_does_is_felt_four_ticks_later_by_those_who_stand_on_both_feet() -> None:
    ticks, copies = 90, 3
    loads = np.full((ticks, copies, 8), 10.0)
    loads[60:70, 1] = 4.0  # hardly any weight
    upright = np.ones((ticks, copies), bool)
    upright[80:, 2] = False
    clock = np.arange(ticks)[:, None, None]
    run = Stood(clock, clock, clock, loads, np.zeros((ticks, copies, 3)), upright)
    before, after, kept = run.settled(TICK, 80.0)
    assert (clock[after] - clock[before] == 4).all() and kept.shape == (ticks - 4, copies)
    felt = [clock[after][kept[:, copy], 0, 0].tolist() for copy in range(copies)]
    assert felt[0] == list(range(50, 90)), "the first second is getting up"
    assert felt[1] == [t for t in felt[0] if not 60 <= t < 70] and felt[2] == list(range(50, 80))


@pytest.mark.parametrize("seed", range(3))
def test_wiggling_finds_what_carries_and_what_each_joint_does(seed: int) -> None:
    known = soles.learned(np.random.default_rng(seed))
    np.testing.assert_allclose(known.effects, EFFECTS, atol=0.03)
    assert known.carries.tolist() == [1.0] * 8 + [0.0] * 2
    np.testing.assert_allclose(known.rest, REST, atol=0.05)
    assert known.weight == pytest.approx(soles.WEIGHT, rel=0.05)
    np.testing.assert_allclose(known.leaning(HOME + 0.05), known.rest + 0.05 * PRESSURE.sum(1), atol=0.01)
    strain = known.effects - PATTERNS @ (BOTH @ known.effects)
    assert set(find_pairs(strain, known.carries > 0)) == PAIRS


def test_what_the_wiggle_itself_feels_like_is_no_effect() -> None:
    """Pressure goes the wrong way while a joint moves: the line of the settled posture is found without it."""
    rng = np.random.default_rng(5)
    run = soles.wiggle(rng)
    slow = wiggled(run, HOME, REACH, BOTH, np.arange(8), TICK, "soles")
    own = run.loads[4:] / run.loads[4:].sum(-1, keepdims=True)
    x, y = (v - v.mean(0) for v in (run.told[:-4], own))
    naive = np.linalg.lstsq(x.reshape(-1, COUNT), y.reshape(-1, 8), rcond=None)[0].T
    assert np.abs(slow.effects - EFFECTS).max() < 0.3 * np.abs(naive - EFFECTS).max()


def test_pairs_have_signs_and_nobody_is_in_two() -> None:
    strain = np.array([[1.0, 1.0, -1.1, 0.0, 0.0], [0.0, 0.0, 0.0, 2.0, 2.0]])
    carries = np.array([True, False, True, True, True])
    assert set(find_pairs(strain, carries)) == {(0, 2, 1), (3, 4, -1)}
    assert find_pairs(np.eye(4), np.ones(4, bool)) == []


def test_a_synergy_changes_pressure_its_own_way_and_nothing_else(known: Balance) -> None:
    done = EFFECTS @ known.synergy.T
    for way in (0, 1):
        gain = BOTH[way] @ done[:, way]
        assert gain > 3, "one rad of it moves the pressure well"
        np.testing.assert_allclose(done[:, way], gain * PATTERNS[:, way], atol=0.02 * gain * np.abs(PATTERNS).max())
    for i, j, sign in PAIRS:
        np.testing.assert_allclose(known.synergy[:, i], sign * known.synergy[:, j])
    assert np.abs(known.synergy).max() == 1 and not known.synergy[:, 8:].any()


def test_of_all_that_does_it_the_least_is_taken() -> None:
    """The stronger of two that push the same way does most of it, and what does harm is made up for."""
    pressure = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    one = np.array([1.0, 0.0])
    alone = least(np.array([[6.0, 4.0], [0.0, 0.0], [0.0, 0.0]]), pressure, one)
    np.testing.assert_allclose(alone, [1.0, 0.0], atol=1e-9)
    mended = least(np.array([[6.0, 4.0], [0.0, 6.0], [0.0, 0.0]]), pressure, np.array([4.0, 6.0]))
    np.testing.assert_allclose(mended, [0.0, 1.0], atol=1e-9)
    for wanted in np.eye(2):
        found = least(np.array([[6.0, 4.0, 1.0], [0.5, 6.0, 0.0], [0.0, 0.0, 0.0]]), pressure, wanted)
        changed = np.array([[6.0, 4.0, 1.0], [0.5, 6.0, 0.0]]) @ found
        np.testing.assert_allclose(changed / changed.max(), wanted, atol=1e-9)
    strained = np.array([[6.0, 5.9], [0.0, 0.0], [60.0, 0.0]])
    np.testing.assert_allclose(least(strained, pressure, one), [0.0, 1.0], atol=1e-9)


def test_following_keeps_what_pairs_can_do_and_leaves_what_strains(known: Balance) -> None:
    crouch, sway = np.zeros(COUNT), np.zeros(COUNT)
    crouch[[0, 1]], crouch[[4, 5]] = 0.2, 0.4  # pressure 6 x 0.2 - 3 x 0.4
    sway[[2, 6]], sway[[3, 7]] = (0.3, -0.4), (-0.3, 0.4)
    for safe in (crouch, sway, np.eye(COUNT)[8], np.eye(COUNT)[9]):
        np.testing.assert_allclose(known.safe(HOME + safe), HOME + safe, atol=0.02)
    for i, j, sign in PAIRS:
        against = np.zeros(COUNT)
        against[[i, j]] = 0.2, -0.2 * sign
        np.testing.assert_allclose(known.safe(HOME + against), HOME, atol=1e-9)
    for ankles in (0.2 * (np.arange(COUNT) < 2), 0.2 * (np.arange(COUNT) == 4)):
        beside = known.safe(HOME + ankles) - HOME
        assert np.abs(PRESSURE @ beside).max() < 0.05 < 0.2 * np.abs(PRESSURE @ ankles).max()
    np.testing.assert_array_equal(known.safe(HOME), HOME)
    assert known.safe(HOME + 9 * np.eye(COUNT)[8])[8] == REACH[1, 8], "no further than the joint goes"
    assert known.safe(HOME - 9 * np.eye(COUNT)[8])[8] == REACH[0, 8]


def test_a_body_without_pairs_is_told_so() -> None:
    run = soles.wiggle(np.random.default_rng(0))
    odd = np.zeros((COUNT, 8))
    odd[:4] = soles.STRAINS  # four joints that each strain in a way of their own
    beside = np.concatenate([run.told[:1].repeat(4, 0), run.told[:-4]]) - HOME
    run = run._replace(loads=70 * (1 / 8 + beside @ odd))
    with pytest.raises(BabblingError, match="no joints carry it in pairs") as caught:
        wiggled(run, HOME, REACH, BOTH, np.arange(8), TICK, "soles")
    assert "\n" not in str(caught.value)


def test_pressure_is_of_shares_and_lean_of_products(found: Balance) -> None:
    loads = np.random.default_rng(0).uniform(1, 20, (5, 3, 8))
    np.testing.assert_allclose(found.pressed(loads), found.pressed(2 * loads))
    np.testing.assert_allclose(found.pressed(loads), (loads / loads.sum(-1, keepdims=True)) @ BOTH.T)
    assert not found.pressed(0 * loads).any()
    posture = HOME + np.random.default_rng(1).uniform(-1, 1, COUNT)
    beside = posture - HOME
    by_hand = found.weights[:, 0] + found.weights[:, 1 : 1 + COUNT] @ beside
    for n, (i, j) in enumerate(zip(FIRST, SECOND, strict=True)):
        by_hand = by_hand + found.weights[:, 1 + COUNT + n] * beside[i] * beside[j]
    np.testing.assert_allclose(found.leaning(posture), by_hand)
    assert features(np.zeros((4, 2))).tolist() == [[1.0] + [0.0] * 5] * 4


def test_lean_is_recovered_with_the_product_that_is_there(found: Balance) -> None:
    np.testing.assert_allclose(found.weights[:, 0], REST, atol=0.05)
    np.testing.assert_allclose(found.weights[:, 1 : 1 + COUNT], PRESSURE, atol=0.15)
    assert found.weights[0, PRODUCT] == pytest.approx(soles.MUCH, rel=0.15)
    postures = HOME + np.random.default_rng(3).uniform(-0.1, 0.1, (200, COUNT))
    assert np.abs(found.leaning(postures) - soles.lean(postures)).max() < 0.1


@pytest.mark.parametrize("seed", range(2))
def test_a_product_that_is_not_there_is_not_found(known: Balance, seed: int) -> None:
    rng = np.random.default_rng(seed)
    weights, _ = settled(known, [soles.stand(rng, known.synergy, product=0.0) for _ in range(2)], TICK)
    assert np.abs(weights[:, 1 + COUNT :]).max() < 0.05 * soles.MUCH


def test_what_did_not_move_is_as_wiggling_found_it(known: Balance) -> None:
    rng = np.random.default_rng(7)
    weights, _ = settled(known, [soles.stand(rng, known.synergy, legs=1e-9)], TICK)
    np.testing.assert_allclose(weights[:, 1:9], (known.pressing @ known.effects)[:, :8], atol=1e-4)


def test_the_table_foretells_where_pressure_settles(found: Balance) -> None:
    """The gain is that of moving about, four fifths of what wiggling said, and without the wrong way first."""
    gain = 0.8 * np.diag(PRESSURE @ found.synergy.T)
    lean, offset = np.meshgrid(np.linspace(-0.4, 0.4, 9), np.linspace(-0.1, 0.1, 9))
    lean, offset = (np.repeat(v.reshape(-1, 1), 2, 1) for v in (lean, offset))
    wanted = lean + gain * offset
    there = np.abs(wanted) < 0.7
    told = found.forward_model.expected((lean,), offset)
    spread = np.sqrt(found.forward_model.linear().covariance[:, 0, 0])
    assert (spread < 0.04).all(), "little more than the world's own 0.02: what moving adds is not in the table"
    assert np.abs(told - wanted)[there].max() < 0.07 and np.abs(told - wanted)[there].mean() < 0.02


def test_what_is_felt_at_the_edge_of_the_soles_is_not_counted(known: Balance) -> None:
    rng = np.random.default_rng(4)
    run = soles.stand(rng, known.synergy, offsets=0.3)
    felt = known.pressed(run.loads[50:])  # but for the first second
    inside = np.abs(felt) < SATURATED
    assert 0.1 < 1 - inside.mean() < 0.6
    weights, table = settled(known, [run], TICK)
    off = table.outside + table.moments.samples
    assert (off <= inside.sum((0, 1))).all() and (off > 0.97 * inside.sum((0, 1))).all()
    np.testing.assert_allclose(weights[:, 1 : 1 + COUNT], PRESSURE, atol=0.3)


def test_balance_is_of_one_body(known: Balance) -> None:
    known.check(replace(known))  # type: ignore[arg-type]
    with pytest.raises(BabblingError, match="another body"):
        known.check(replace(known, fingerprint="other"))  # type: ignore[arg-type]


def test_what_turns_the_organ_as_no_pressure_does_stays_at_home() -> None:
    turns = TURNS.copy()
    turns[0, 8], turns[2, 9] = (
        0.9,
        0.5,
    )  # one arm leans the organ, as a waist does; the other turns it about the upright
    known = learned(np.random.default_rng(3), turns)
    assert known.carries.tolist() == [1.0] * 8 + [0.0, 1.0]
    moved = known.safe(known.home + np.eye(10)) - known.home
    np.testing.assert_allclose(moved[9], 0, atol=1e-12)
    assert moved[8, 8] == pytest.approx(1)
