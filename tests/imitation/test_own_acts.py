"""Own acts as hypotheses: Bayes by brute force on a mind of few numbers, what is hidden, what at rest would tell."""

from functools import cache
from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from babbling.axes import Axis
from babbling.dark import FaceMind, gaps
from babbling.forward_model import ForwardModel
from babbling.relations import RELATIONS, Landmarks
from imitation.correspondence import own_acts
from imitation.correspondence.own_acts import (
    ALIKE,
    CLOUD,
    FEWER,
    LAPSE,
    LEVELS,
    NOTHING,
    OTHERS,
    SHOWS,
    OwnActs,
    given_still,
    likeliest,
    owned,
)

Array = NDArray[np.float64]
MOTORS = np.array([3, 1, 0, 2, 4, 4, 5, 6])
"""Whose each relation is; motor 4 purses lips and lifts brows."""
OPENER, TONGUE = 3, 1
STILL = np.array([0.0, -0.44, 0, 0, 0, 0, 0, 0])
REST = np.array([0.0, -1, 0, -1, 0, 0, 0])
GAP, BEYOND, SIDE, UP = range(4)
STUCK = -0.2
"""Where a tongue stays whose mouth is open less than 0.1; from 0.2 on it is free."""


def ends(relation: int, command: Array, gap: Array) -> Array:
    """Where a relation comes to: the mouth and the tongue go one way from rest, all else both ways."""
    if relation == GAP:
        return (command + 1) / 2
    if relation != BEYOND:
        return 0.5 * command
    free, freely = (command + 1) / 2 - 0.44, np.clip((gap - 0.1) / 0.1, 0, 1)
    return freely * free + (1 - freely) * np.minimum(free, STUCK)


@cache
def acts() -> OwnActs:
    """Of a mind that felt every command at every gap once."""
    one = np.ones(len(RELATIONS))
    gap, action, outcome = (
        Axis("gap", "W", 0 * one, one, 11),
        Axis("c", "1", -one, one, 13),
        Axis("o", "W", -one, one, 41),
    )
    model = ForwardModel([gap], action, outcome, factors=RELATIONS, fingerprint="few")
    where, command = (x.ravel() for x in np.meshgrid(gap.points[0], action.points[0]))
    found = np.stack([ends(r, command, where) for r in range(len(RELATIONS))], 1)
    model.observe([gaps(np.repeat(where[:, None], 8, 1)[:, 0], 8)], np.repeat(command[:, None], 8, 1), found)
    return OwnActs(FaceMind("few", model, MOTORS, REST, STILL, Landmarks(0.01, 0.006)))


def sets() -> list[tuple[int, ...]]:
    others = [motor for motor in range(7) if motor != OPENER]
    some = [(), *((motor,) for motor in others), *combinations(others, 2)]
    return [tuple(sorted((*mouth, *s))) for mouth in ((), (OPENER,)) for s in some]


def imagined(motors: tuple[int, ...]) -> tuple[Array, Array]:
    """(A, 8) ends of all acts of these motors, and (8,) how far neighbours lie apart."""
    found = []
    for levels in product(np.linspace(-1, 1, LEVELS), repeat=len(motors)):
        command = dict(zip(motors, levels, strict=True))
        gap = ends(GAP, np.array(command.get(OPENER, -1.0)), np.array(0.0))
        found.append([
            float(ends(r, np.array(command[m]), gap)) if m in command else STILL[r] for r, m in enumerate(MOTORS)
        ])  # fmt: skip
    relations = np.array(found)
    return relations, np.ptp(relations, axis=0) / (LEVELS - 1)


def normal(x: Array, sigma: float) -> Array:
    return np.asarray(np.exp(-((x / sigma) ** 2) / 2) / (sigma * np.sqrt(2 * np.pi)))


@cache
def by_integration(information: tuple[float, ...], off: tuple[float, ...], wide: tuple[float, ...]) -> float:
    """Integral of N(y; end, T^2) exp(-(seen - y)' L (seen - y) / 2) dy, on a grid, of one block of L."""
    grid = np.stack(np.meshgrid(*(np.linspace(-6, 6, 45) * s for s in wide), indexing="ij"), -1)
    weight = np.prod([normal(grid[..., k], s) for k, s in enumerate(wide)], axis=0)
    from_seen, matrix = grid + off, np.array(information).reshape(len(off), -1)
    likely = np.exp(-0.5 * np.einsum("...i,ij,...j->...", from_seen, matrix, from_seen))
    return float((weight * likely).sum() * np.prod([12 * s / 44 for s in wide]))


def evidence(motors: tuple[int, ...], seen: Array, information: Array, tongue: bool) -> float:
    relations, step = imagined(motors)
    wide = np.sqrt((step / 2) ** 2 + ALIKE**2).round(9)
    each = []
    for one in relations:
        shows = one[GAP] > SHOWS[0] and one[BEYOND] > SHOWS[1]
        likely = 1 - LAPSE if shows == tongue else LAPSE
        for block in ([GAP], [BEYOND, UP], [SIDE], [4], [6]):  # of the rest nothing is known
            off = (one - seen).round(9)[block]
            likely *= by_integration(tuple(information[np.ix_(block, block)].ravel()), tuple(off), tuple(wide[block]))
        each.append(likely)
    return float(np.mean(each))


def surely(**relations: float) -> tuple[Array, Array]:
    """Relations at rest but for these, and information about all of them."""
    seen = STILL.copy()
    for name, amount in relations.items():
        seen[RELATIONS.index(name)] = amount
    return seen, 4e3 * np.eye(len(RELATIONS))


def dark(information: Array) -> Array:
    """Nothing is told of the tongue."""
    blind = information.copy()
    blind[1:4], blind[:, 1:4] = 0, 0
    return blind


# -------------------------------------------------------------------------------------------- hypotheses


def test_every_act_of_up_to_two_motors_and_the_mouth_s_is_imagined() -> None:
    found = {tuple(sorted(one.motors)): one for one in acts().acts}
    assert set(found) == set(sets()) and len(found) == len(acts().acts) == 2 * (1 + 6 + 15)
    assert acts().acts[0].motors == () and acts().opener == OPENER
    for motors in sets():
        relations, step = imagined(motors)
        order = [np.lexsort(r.round(6).T) for r in (relations, found[motors].relations)]
        np.testing.assert_allclose(found[motors].relations[order[1]], relations[order[0]], atol=1e-3)
        np.testing.assert_allclose(found[motors].step, step, atol=1e-3)


def test_a_tongue_alone_stays_behind_its_lips() -> None:
    [alone] = [one for one in acts().acts if one.motors == (TONGUE,)]
    [opened] = [one for one in acts().acts if set(one.motors) == {OPENER, TONGUE}]
    assert alone.relations[:, BEYOND].max() == pytest.approx(STUCK, abs=1e-3) and not alone.shows().any()
    assert opened.relations[:, BEYOND].max() == pytest.approx(0.56, abs=1e-3) and opened.shows().any()
    np.testing.assert_array_equal(owned(acts().mind, (4,)), MOTORS == 4)


def test_more_motors_are_less_likely_beforehand() -> None:
    prior, sizes = acts().prior, np.array([len(one.motors) for one in acts().acts])
    assert prior.sum() == pytest.approx(1) and prior[0] == NOTHING
    one, two, three = (prior[sizes == n].sum() for n in (1, 2, 3))
    assert two / one == pytest.approx(FEWER) and three / two == pytest.approx(FEWER)
    assert all(np.ptp(prior[sizes == n]) < 1e-15 for n in (1, 2, 3))


@pytest.mark.parametrize("seed", range(2))
def test_the_posterior_is_bayes_by_brute_force(seed: int) -> None:
    """What is hidden is integrated over on a grid, act by act, set by set."""
    rng = np.random.default_rng(seed)
    seen = STILL + np.array([0.4, 0.7, 0.1, -0.05, 0.02, 0, 0.01, 0]) * rng.uniform(0.5, 1, 8)
    information = np.diag([3e3, 900.0, 300, 700, 2e3, 0, 1e3, 0])
    information[BEYOND, UP] = information[UP, BEYOND] = -0.8 * np.sqrt(900 * 700)
    tongue = bool(seed % 2 == 0)
    likely = np.array([evidence(one.motors, seen, information, tongue) for one in acts().acts])
    wanted = (likely / likely.max() + CLOUD) * acts().prior
    found = acts().posterior(seen, information, tongue).probability
    assert found.sum() == pytest.approx(1)
    np.testing.assert_allclose(found, wanted / wanted.sum(), rtol=2e-3)


@given(st.integers(0, 2**31), st.booleans())
@settings(max_examples=15, deadline=None)
def test_it_sums_to_one_and_no_act_is_ever_ruled_out(seed: int, tongue: bool) -> None:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(8, 8)) * 10 ** rng.uniform(-1, 3)
    found = acts().posterior(rng.uniform(-1, 1, 8), root @ root.T, tongue)
    assert found.probability.sum() == pytest.approx(1) and found.informed.all()
    assert (found.probability > 0.5 * CLOUD * acts().prior).all()


def test_what_is_hidden_leaves_the_prior_s_proportions() -> None:
    """Behind shut lips tongues may do anything: as likely as before, beside doing nothing."""
    seen, information = surely()
    found, prior = acts().posterior(seen, dark(information), False).probability, acts().prior
    alike = [h for h, one in enumerate(acts().acts) if set(one.motors) <= {0, 1, 2}]  # tongue's motors and nothing
    assert len(alike) == 1 + 3 + 3
    np.testing.assert_allclose(found[alike] / found[0], prior[alike] / prior[0])
    others = [h for h in range(len(prior)) if h not in alike]
    assert (found[others] / found[0] < prior[others] / prior[0]).all()


def test_without_any_information_only_whether_a_tongue_shows_counts() -> None:
    found = acts().posterior(STILL, np.zeros((8, 8)), True).probability
    shows = np.array([one.shows().mean() for one in acts().acts])
    wanted = acts().prior * (
        ((1 - LAPSE) * shows + LAPSE * (1 - shows)) / (shows.max() * (1 - 2 * LAPSE) + LAPSE) + CLOUD
    )
    np.testing.assert_allclose(found, wanted / wanted.sum())


@pytest.mark.parametrize("changes, tongue, motors", [
    ({}, False, ()),
    ({"gap": 0.5}, False, {OPENER}),
    ({"purse": 0.33, "brow": 0.33}, False, {4}),
    ({"turn": -0.33}, False, {5}),
    ({"nod": 0.17}, False, {6}),
    ({"gap": 0.5, "beyond": 0.23}, True, {OPENER, TONGUE}),
    ({"gap": 0.5, "beyond": 0.23, "side": -0.33}, True, {OPENER, TONGUE, 0}),
])  # fmt: skip
def test_a_clear_change_is_whose_it_is(changes: dict[str, float], tongue: bool, motors: set[int]) -> None:
    seen, information = surely(**changes)
    found = acts().posterior(seen, information if tongue else dark(information), tongue)
    assert set(likeliest(acts(), found)) == set(motors)
    assert found.probability.max() > 0.4


def test_whether_a_tongue_is_seen_counts_by_itself() -> None:
    """The same relations, of which those of the tongue are unsure: with an open mouth only who shows it has it out."""
    seen, information = surely(gap=0.5, beyond=0.2)
    unsure = dark(information) + np.diag([0, 3.0, 0, 0, 0, 0, 0, 0])
    by_tongue = [acts().posterior(seen, unsure, tongue).probability for tongue in (True, False)]
    with_tongue = [TONGUE in one.motors for one in acts().acts]
    with_, without = (found[with_tongue].sum() for found in by_tongue)
    assert with_ > 0.2 and without < 0.02


# ------------------------------------------------------------------------------------------- given still

seeds = st.integers(0, 2**31)


def look(seed: int) -> tuple[Array, Array, NDArray[np.bool_], Array]:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(8, 8)) * 30
    moved = rng.random(8) < 0.4
    return rng.uniform(-1, 1, 8), root @ root.T + 50 * np.eye(8), moved, rng.uniform(-1, 1, 8)


@given(seeds)
@settings(max_examples=40, deadline=None)
def test_it_is_where_likelihood_and_prior_together_are_largest(seed: int) -> None:
    seen, information, moved, still = look(seed)
    found = given_still(seen, information, moved, still)
    np.testing.assert_array_equal(found[~moved], still[~moved])
    if moved.any():  # by hand: the still ones, each as likely as it is far, taken out of the normal equations
        m, o = np.flatnonzero(moved), np.flatnonzero(~moved)
        tight = information[np.ix_(o, o)] + np.eye(len(o)) / OTHERS**2
        shift = information[o] @ (seen - still)  # where still ones would go, were moved ones at rest
        cross = information[np.ix_(m, o)]
        left = information[np.ix_(m, m)] - cross @ np.linalg.solve(tight, cross.T)
        right = (information[m] @ (seen - still)) - cross @ np.linalg.solve(tight, shift)
        np.testing.assert_allclose(found[m], still[m] + np.linalg.solve(left, right), atol=1e-6)


@given(seeds)
@settings(max_examples=40, deadline=None)
def test_faces_that_do_not_differ_make_it_a_conditional_gaussian(seed: int) -> None:
    seen, information, moved, still = look(seed)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(own_acts, "OTHERS", 1e-7)
        found = given_still(seen, information, moved, still)
        patch.setattr(own_acts, "OTHERS", 1e7)
        unbound = given_still(seen, information, moved, still)
    covariance, o = np.linalg.inv(information), ~moved
    if moved.any() and o.any():
        gain = np.linalg.solve(covariance[np.ix_(o, o)], covariance[np.ix_(o, moved)]).T
        np.testing.assert_allclose(found[moved], seen[moved] + gain @ (still - seen)[o], atol=1e-4)
    np.testing.assert_allclose(unbound[moved], seen[moved], atol=1e-6)


def test_what_was_not_seen_is_taken_to_be_at_rest() -> None:
    seen, information = surely(beyond=0.4, up=0.3)
    everything = np.ones(8, bool)
    np.testing.assert_allclose(given_still(seen, dark(information), everything, STILL)[1:4], STILL[1:4])
    np.testing.assert_allclose(given_still(seen, information, everything, STILL), seen, atol=1e-6)
    np.testing.assert_array_equal(given_still(seen, information, ~everything, STILL), STILL)


def test_a_tongue_that_seems_raised_comes_out_further_if_only_that_is_its_own() -> None:
    """Ahead and up were seen as a sum only: who knows that it is not raised knows how far it is out."""
    seen, information = surely(gap=0.4, beyond=0.3, up=0.1)
    information[BEYOND, UP] = information[UP, BEYOND] = 0.95 * 4e3
    moved = owned(acts().mind, (OPENER, TONGUE))
    found = given_still(seen, information, moved, STILL)
    assert found[BEYOND] == pytest.approx(0.3 + 0.95 * 0.1, abs=0.03) and found[UP] == 0
