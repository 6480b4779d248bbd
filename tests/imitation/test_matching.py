"""Matching to target: the first aim, and tries that converge on what is felt, on a mouth without physics."""

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from babbling.axes import BoolArray
from babbling.dark import FaceMind
from babbling.errors import BabblingError
from babbling.relations import RELATIONS
from imitation.acting.attempts import SHARE
from imitation.acting.matching import Tried, chosen, tries
from imitation.deferred import FaceMemory
from imitation.errors import ImitationError
from imitation.inference.inverse import BayesianInverse, InverseModel, LinearInverse
from tests.babbling.mouth import Mouth, grown

Array = NDArray[np.float64]
WAYS = {"gap": 0.5, "side": 0.2, "purse": 0.12, "brow": -0.08, "turn": 0.2, "nod": -0.1}
"""Changes that one motor alone makes."""


@pytest.fixture(scope="module")
def mind() -> FaceMind:
    return grown(1200)


def targets(mind: FaceMind) -> tuple[Array, BoolArray]:
    """(7, 8) relations to come to, each of one motor and the last of mouth and tongue; (7, 8) those moved."""
    wanted, moved = np.tile(mind.still, (7, 1)), np.zeros((7, 8), bool)
    for row, (name, change) in enumerate(WAYS.items()):
        wanted[row, RELATIONS.index(name)] += change
        moved[row, RELATIONS.index(name)] = True
    wanted[6, :2], moved[6, :2] = [0.5, 0.0], True
    return wanted, moved


def tried(
    mind: FaceMind, count: int = 6, weak: float = 0.0, noise: float = 0.0, inverses: Sequence[InverseModel] = ()
) -> tuple[Tried, Array]:
    """What came of so many tries, and (K, 7) how far off they were."""
    wanted, moved = targets(mind)
    done = tries(Mouth(len(wanted), noise=noise, weak=weak), [mind], wanted, moved, count, inverses)
    return done, np.abs(np.where(moved, done.felt - wanted, 0)).max(-1)


def test_the_first_try_lands_near_and_moves_nothing_else(mind: FaceMind) -> None:
    (done, off), (_, moved) = tried(mind, 1), targets(mind)
    assert (off[0] < 0.07).all() and off[0].mean() < 0.04
    np.testing.assert_allclose(np.where(moved, 0, done.felt[0] - mind.still), 0, atol=1e-3)
    for command, mine in zip(done.commands[0], moved, strict=True):
        own = np.isin(np.arange(8), mind.motors[mine])
        np.testing.assert_array_equal(command[~own], mind.rest[~own])
        assert (command[own] != mind.rest[own]).all()


def test_tries_converge_on_a_body_that_has_become_weak(mind: FaceMind) -> None:
    """What is missed shifts the next aim, nobody says how: a share of it each time, until it is matched."""
    done, off = tried(mind, 8, weak=0.25)
    size = np.abs(targets(mind)[0] - mind.still).max(1)
    assert (off[0] > 0.12 * size).all(), "a quarter is lacking at first"
    assert (off.min(0) < 0.3 * off[0]).all() and off[-1].mean() < 0.15 * off[0].mean()
    assert off[1].mean() == pytest.approx((1 - SHARE * 0.75) * off[0].mean(), rel=0.35)
    assert (np.diff(done.commands, axis=0) != 0).any((1, 2)).all()


def test_trying_does_not_spoil_what_was_right(mind: FaceMind) -> None:
    _, off = tried(mind, 8, noise=1.0)
    assert off[-3:].mean() < 1.1 * off[0].mean() and off.max() < 0.12


def test_between_tries_a_body_rests(mind: FaceMind) -> None:
    told: list[Array] = []

    class Watched(Mouth):
        def act(self, motors: Array) -> Array:
            told.append(motors.copy())
            return super().act(motors)

    heard: list[int] = []
    wanted, moved = targets(mind)
    done = tries(Watched(7), [mind], wanted, moved, 3, heed=lambda: heard.append(len(told)))
    assert len(told) == 6 and heard == [1, 3, 5], "heeded before rest"
    for k in range(3):
        np.testing.assert_array_equal(told[2 * k], done.commands[k])
        np.testing.assert_array_equal(told[2 * k + 1], np.tile(mind.rest, (7, 1)))
    np.testing.assert_array_equal(done.felt, mind.landmarks.relations(done.senses))


def test_a_line_can_stand_in(mind: FaceMind) -> None:
    line, table = (tried(mind, 6, inverses=[inverse])[0] for inverse in (
        LinearInverse(mind.forward_model), BayesianInverse(mind.forward_model, "map", trust=0.0)
    ))  # fmt: skip
    assert not np.allclose(line.commands[0], table.commands[0], atol=1e-3)
    np.testing.assert_array_equal(table.commands, tried(mind, 6)[0].commands)  # Eq. (1) is what none is
    straight = [2, 3, 5, 6, 7]
    _, off = tried(mind, 6, inverses=[LinearInverse(mind.forward_model)])
    rows = [row for row, moved in enumerate(targets(mind)[1]) if moved[straight].any()]
    assert (off.min(0)[rows] < 0.06).all(), "tries mend a line too"


def test_aims_out_of_reach_are_brought_within(mind: FaceMind) -> None:
    inverse = BayesianInverse(mind.forward_model, "map", trust=0.0)
    moved, far = np.zeros((2, 8), bool), np.tile(mind.still, (2, 1))
    moved[:, 6], far[0, 6], far[1, 6] = True, 50.0, mind.forward_model.outcome.high[6]
    lines = chosen(mind, far, moved, inverse)
    np.testing.assert_array_equal(lines[0], lines[1])
    assert np.isfinite(lines).all()


def test_minds_act_with_their_own_copies(mind: FaceMind) -> None:
    """Two minds of one body: the first for the first copies."""
    other = grown(300, seed=5, noise=1.0)
    wanted, moved = targets(mind)
    both = np.concatenate([wanted, wanted])
    done = tries(Mouth(14), [mind, other], both, np.concatenate([moved, moved]), 2)
    for n, one in enumerate((mind, other)):
        share = slice(7 * n, 7 * n + 7)
        alone = tries(Mouth(7), [one], wanted, moved, 2)
        np.testing.assert_array_equal(done.commands[:, share], alone.commands)
        np.testing.assert_array_equal(done.felt[:, share], alone.felt)
    assert not np.array_equal(done.commands[:, :7], done.commands[:, 7:])


@pytest.mark.parametrize("copies, minds, count", [(7, 1, 0), (6, 1, 1), (7, 2, 1)])
def test_what_does_not_go_round_is_refused(mind: FaceMind, copies: int, minds: int, count: int) -> None:
    wanted, moved = targets(mind)
    with pytest.raises(ImitationError, match=f"{count} tries at 7 targets by {minds} minds in {copies} copies"):
        tries(Mouth(copies), [mind] * minds, wanted, moved, count)


def test_another_body_s_mind_is_refused(mind: FaceMind) -> None:
    wanted, moved = targets(mind)
    with pytest.raises(BabblingError, match="learned by another body"):
        tries(Mouth(7, wiring=1), [mind], wanted, moved, 1)


def test_a_memory_belongs_to_one_body_and_its_relations() -> None:
    memory = FaceMemory("mine", np.zeros(8), np.ones(8, np.int64))
    memory.check("mine", 8)
    with pytest.raises(
        ImitationError, match=r"another body \(fingerprint mine, this body has yours\).*face that watched"
    ):
        memory.check("yours", 8)
    with pytest.raises(ImitationError, match="holds 8 relations; 9 are needed"):
        memory.check("mine", 9)
