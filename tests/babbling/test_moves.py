"""Wandering: relative moves, the overriding of walls, and the learning curve against its law."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from babbling.errors import BabblingError
from babbling.loop import babble, explore, flat
from babbling.moves import DIRECTIONS, MOVES, Places, overridden, relative_move
from babbling.states import Wanderer


class Plane:
    """A body without walls: it goes where it means to, except that `slips` of its moves stay."""

    def __init__(self, copies: int = 1, slips: float = 0.0, touch: bool = False) -> None:
        self.copies, self.slips, self.touch = copies, slips, touch
        self.rng = np.random.default_rng(0)

    motor_low, motor_high = np.zeros(1), np.full(1, 4.0)
    sense_low, sense_high = np.array([0, 0, 0, 0, 0, 0.0]), np.array([999, 999, 1, 1, 1, 1.0])
    tick_s, fingerprint = 1.0, "plane"

    def reset(self):
        self.place = np.full((self.copies, 2), 500)
        return self.feel()

    def act(self, motors):
        slip = self.rng.random((self.copies, 1)) < self.slips
        self.place = self.place + np.where(slip, 0, DIRECTIONS[motors[:, 0].astype(int)])
        return self.feel()

    def feel(self):
        return np.hstack([self.place, np.full((self.copies, 4), float(self.touch))])


@given(st.integers(0, 4), st.integers(-50, 50), st.integers(-50, 50))
def test_a_move_is_read_from_where_it_leads(move, x, y):
    assert relative_move([x, y], np.array([x, y]) + DIRECTIONS[move]) == move


@pytest.mark.parametrize("jump", [(1, 1), (2, 0), (0, -3), (-1, 1)])
def test_a_jump_is_no_move(jump):
    with pytest.raises(BabblingError, match="no single move"):
        relative_move([0, 0], jump)


@given(st.integers(1, 30), st.integers(1, 30))
def test_places_are_numbered_one_to_one(width, height):
    places = Places((1, 1), (width, height))
    numbers = np.arange(places.size)
    assert (places.number(places.place(numbers)) == numbers).all()
    with pytest.raises(BabblingError, match="lies outside"):
        places.number([width + 1, 1])


def test_walls_override_what_the_model_predicts():
    table = np.random.default_rng(0).dirichlet(np.ones(5), 5)
    assert (overridden(table, np.zeros(4, bool)) == table).all()
    closed = overridden(table, np.ones(4, bool))
    np.testing.assert_allclose(closed, np.eye(5)[[4] * 5], atol=1e-15)
    north = overridden(table, np.array([True, False, False, False]))
    assert (north[:, 0] == 0).all()
    np.testing.assert_allclose(north[:, 4], table[:, 4] + table[:, 0])


def test_a_sure_walker_learns_the_identity_and_touch_teaches_nothing():
    body = Plane()
    model = babble(body, wanderer(body), (400,), 0)
    assert (model.predictive[0] == np.eye(5)).all() and model.transitions == 400
    body = Plane(touch=True)
    assert babble(body, wanderer(body), (50,), 0).transitions == 0


def test_copies_alone_learn_what_they_would_learn_together():
    body = Plane(copies=7, slips=0.3)
    motors, senses = explore(body, wanderer(body).stream(body, np.random.default_rng(1)), 60)
    together, alone = wanderer(body), wanderer(body, alone=True)
    one, many = together.forward_model(), alone.forward_model()
    one.observe(*together.transitions(*flat(motors, senses)))
    many.observe(*alone.transitions(*flat(motors, senses)))
    assert (many.counts.sum(0) == one.counts[0]).all()
    first = explore_copy(motors, senses, 3)
    single = wanderer(Plane()).forward_model()
    single.observe(*together.transitions(*first))
    assert (many.counts[3] == single.counts[0]).all()


def wanderer(body, **how):
    return Wanderer(body, Places.of(body), MOVES, **how)


def explore_copy(motors, senses, copy):
    return flat(motors[:, copy : copy + 1], senses[:, copy : copy + 1])


def test_onward_goes_on_where_the_body_is():
    body = Plane()
    stream = wanderer(body).stream(body, np.random.default_rng(2))
    _, first = explore(body, stream, 5)
    _, second = explore(body, stream, 5, onward=first[-1])
    assert (second[0] == first[-1]).all()
    assert np.abs(np.diff(np.vstack([first, second[1:]])[:, 0, :2], axis=0)).sum(1).max() <= 1


def test_a_wanderer_needs_single_acts():
    body = Plane()
    with pytest.raises(BabblingError, match="one motor with 3 choices"):
        Wanderer(body, Places.of(body), ("a", "b", "c"))
    assert wanderer(body).forward_model().action.labels == MOVES
