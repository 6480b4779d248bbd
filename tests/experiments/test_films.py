"""Films of walks: Eq. (2) beside brute force in a tiny room, signs and their absence, what peers make of them."""

from itertools import product

import numpy as np
import pytest

from experiments.errors import ExperimentError
from experiments.intentions import films as module
from experiments.intentions.films import DIFFERENCES, MINDS, Film, efficiency, figure, films, judge, like_me, preference
from experiments.maze.mind import walked
from imitation.episodes import Episode
from models.maze import TRUE_DYNAMICS, Maze, check_walk, parse_maze

ROOM = """\
+--+--+--+
| 1    2 |
+  +--+  +
| *      |
+--+--+--+
"""
NORTH, EAST, WEST, STAY = 0, 1, 3, 4
BELIEF = np.array([0.7, 0.3])
OURS, WAYS, STEPS = MINDS


@pytest.fixture(scope="module")
def room() -> Maze:
    return parse_maze(ROOM)


@pytest.fixture(scope="module")
def found():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "AGENTS", 8)
        return films([1, 2, 3])


def filmed(room: Maze, *acts: int) -> Film:
    """From the start, acts always succeeding."""
    states = [room.number(room.start)]
    for act in acts:
        states.append(int(room.lead[states[-1], act]))
    return Film(room, Episode(0, np.array(states), np.array(acts)))


def prior(room: Maze) -> np.ndarray:
    return like_me(room, TRUE_DYNAMICS)


def test_what_one_would_do_is_equation_1_with_fewer_steps_left_as_the_sub_goal(room):
    ours = like_me(room, TRUE_DYNAMICS)
    for g, goal in enumerate(room.goals):
        left = room.distances(goal)  # in this room the order of expected steps as well
        for cell in range(room.cells):
            nearer = [
                left[room.lead[cell, o]] < left[cell] if left[cell] else room.lead[cell, o] == cell for o in range(5)
            ]
            chance = np.array([sum(p for p, good in zip(row, nearer, strict=True) if good) for row in TRUE_DYNAMICS])
            np.testing.assert_allclose(ours[g, cell], chance / chance.sum())
    certain = like_me(room, np.eye(5))
    np.testing.assert_array_equal(certain[0, room.number(room.start)], np.eye(5)[NORTH])
    np.testing.assert_array_equal(certain[1, room.number(room.start)], [0.5, 0.5, 0, 0, 0])  # two ways, as long


@pytest.mark.parametrize("acts", [(EAST, EAST, NORTH), (NORTH,), (EAST, WEST, STAY, NORTH)])
def test_a_films_evidence_is_the_sum_over_all_goals_and_acts_and_the_product_of_what_was_foretold(room, acts):
    film, ours = filmed(room, *acts), prior(room)
    states = film.episode.states

    def leads(here: int, act: int, there: int) -> float:
        return sum(TRUE_DYNAMICS[act, o] for o in range(5) if room.lead[here, o] == there)

    joint = np.zeros(2)
    for g, did in product(range(2), product(range(5), repeat=len(acts))):
        steps = zip(states, did, states[1:], strict=False)
        joint[g] += BELIEF[g] * np.prod([ours[g, s, a] * leads(s, a, after) for s, a, after in steps])
    seen = judge(film, TRUE_DYNAMICS, prior, BELIEF)
    np.testing.assert_allclose(seen.evidence, joint.sum())
    np.testing.assert_allclose(seen.probability, joint / joint.sum())

    belief, nats = BELIEF, 0.0
    for t in range(len(acts)):
        step = Film(room, Episode(0, states[t : t + 2], film.episode.actions[t : t + 1]))
        one = judge(step, TRUE_DYNAMICS, prior, belief)
        belief, nats = one.probability, nats - np.log(one.evidence)
    assert -np.log(seen.evidence) == pytest.approx(nats)


def test_goals_are_alike_until_somebody_was_seen_to_go_to_one(room):
    other = Maze(room.walls, room.start, room.goals[::-1])
    film = filmed(room, EAST, EAST, NORTH)
    for belief in (BELIEF, np.full(2, 0.5)):
        one = judge(film, TRUE_DYNAMICS, prior, belief).evidence
        two = judge(Film(other, film.episode), TRUE_DYNAMICS, prior, belief[::-1]).evidence
        assert one == pytest.approx(two)
    assert judge(film, TRUE_DYNAMICS, prior, BELIEF[::-1]).evidence > judge(film, TRUE_DYNAMICS, prior, BELIEF).evidence


def test_films_can_be_walked_and_differ_only_in_what_they_test():
    for seed in range(20):
        rng = np.random.default_rng(seed)
        before, after = preference(rng)
        same, other = after.values()
        assert same.room is other.room and same.episode.steps == other.episode.steps
        assert {film.episode.goal for film in before} == {same.episode.goal} != {other.episode.goal}
        assert len({film.room.fingerprint for film in before}) == len(before)
        habits, tests = efficiency(rng)
        straight, gone, stands, mirrored = tests.values()
        assert gone.episode is stands.episode is habits[0].episode and habits[0].room is stands.room
        assert straight.episode.steps < gone.episode.steps == mirrored.episode.steps
        assert (mirrored.episode.states != stands.episode.states).any()
        for film in (*before, *after.values(), *habits, *tests.values()):
            check_walk(film.room, walked(film.episode, film.room))
            steps = film.room.lead[film.episode.states[:-1], film.episode.actions]
            np.testing.assert_array_equal(steps, film.episode.states[1:])


def test_who_learned_what_acts_do_is_surprised_as_infants_are(found):
    for name in ("preference", "efficiency", "efficiency, same steps"):
        for mean, half in found["difference"][name][OURS].values():
            assert mean > half > 0, name


def test_where_nothing_is_unexpected_the_sign_vanishes(found):
    for name in ("preference, nothing seen before", "efficiency, obstacle stands"):
        for mean, half in found["difference"][name][OURS].values():
            assert abs(mean) < half, name
    seen, unseen = (found["difference"][f"preference{late}"][OURS]["step"] for late in ("", ", nothing seen before"))
    assert sum(unseen) < seen[0] - seen[1]


def test_what_is_familiar_says_the_opposite_of_a_detour_and_next_to_nothing_of_a_preference(found):
    by = found["difference"]
    for peer in (WAYS, STEPS):
        assert sum(by["efficiency"][peer]["step"]) < 0
        assert by["efficiency, same steps"][peer]["film"] == [0, 0]
        mean, half = by["efficiency, obstacle stands"][peer]["film"]
        assert mean > half
        assert abs(by["preference"][peer]["film"][0]) < by["preference"][OURS]["film"][0] / 3


def test_who_never_babbled_is_surprised_at_nothing():
    found = module.watch(np.full((5, 5), 0.2), np.random.default_rng(0))
    ours = [step for (_, mind), (_, step) in found.items() if mind == OURS]
    np.testing.assert_allclose(ours, np.log(5))


def test_a_film_that_no_act_explains_is_refused(room):
    lame = np.eye(5)
    lame[NORTH] = lame[STAY]
    with pytest.raises(ExperimentError, match="a step that no act ever led to"):
        judge(filmed(room, NORTH), lame, lambda room: np.full((2, room.cells, 5), 0.2), BELIEF)


def test_bars_are_the_differences(found):
    bars = figure(found).axes[0].containers
    heights = [[bar.get_height() for bar in of] for of in bars if len(of) == len(DIFFERENCES)]
    for mind, drawn in zip(MINDS, heights, strict=True):
        assert drawn == [found["difference"][name][mind]["step"][0] for name in DIFFERENCES]
