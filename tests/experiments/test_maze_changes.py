"""The maze's peers and changed mazes: laws in a maze without noise, where every walk can be followed by hand."""

import numpy as np
import pytest

from babbling.loop import babble
from experiments.maze.changes import changes
from experiments.maze.intents import rules_of_thumb
from experiments.maze.mind import Experience, outings, watched
from experiments.maze.peers import Q_SETTINGS, best_acts, copied, q_learners, replayed
from experiments.maze.planners import Explorers, wanderers
from experiments.maze.rerouting import Replanning, Rerouting, in_turn
from experiments.maze.worlds import moved_wall, new_goal
from imitation.acting.follow import Follower, follow
from imitation.episodes import Episode
from models.maze import MazeBody, default_maze, demonstrate, parse_maze

ROOMS = """\
+--+--+--+--+--+
|    2       3 |
+  +  +  +  +  +
|              |
+  +  +  +  +  +
|              |
+  +--+--+--+--+
|              |
+  +  +  +  +  +
|              |
+  +  +  +  +  +
| *          1 |
+--+--+--+--+--+
"""
COPIES = 6


@pytest.fixture(scope="module", params=[ROOMS, None], ids=["rooms", "chapter"])
def sure(request) -> Experience:
    """Imitators in a maze without noise, who know what acts do."""
    maze = default_maze() if request.param is None else parse_maze(request.param)
    body = MazeBody(maze, copies=COPIES, dynamics=np.eye(5))
    episodes = []
    for copy in range(COPIES):
        teachers = MazeBody(maze, copies=2, dynamics=np.eye(5))
        walks = [w for goal in (1, 2, 3) for w in demonstrate(teachers, goal, np.random.default_rng([copy, goal]))]
        episodes.append(tuple(watched(walk, maze) for walk in walks))
    explorers = Explorers(maze, COPIES, (0,))
    model = babble(body, explorers.walker, outings(400), 0)
    return Experience(body, model, tuple(episodes))


def explorers(sure: Experience) -> Explorers:
    """Who know what acts do, and have felt no wall yet."""
    we = Explorers(sure.maze, COPIES, (0,))
    we.model = sure.forward_model
    return we


def walked(maze, policy, limit=1000):
    """(R,) whether a policy arrives where every act does what it is meant to."""
    here = np.full(len(policy), maze.number(maze.start))
    arrived = here == maze.number(maze.goals[0])
    for _ in range(limit):
        here = maze.lead[here, policy[np.arange(len(policy)), here]]
        arrived |= here == maze.number(maze.goals[0])
    return arrived


def changed(sure, goal):
    return moved_wall(sure.maze, goal, np.random.default_rng(goal))


def test_a_copy_arrives_for_certain_where_nothing_is_uncertain_and_nothing_changes(sure):
    for goal in (1, 2, 3):
        policy = copied(sure, goal)
        one = type(sure.maze)(sure.maze.walls, sure.maze.start, (sure.maze.goals[goal - 1],))
        assert walked(one, policy).all()
        assert walked(one, copied(sure, goal, nearest=True)).all()


def test_a_copy_cannot_arrive_where_a_wall_was_moved_and_one_who_feels_it_does(sure):
    for goal in (2, 3):
        after = changed(sure, goal)
        end = after.number(after.goals[0])
        assert not walked(after, copied(sure, goal)).any()
        successor, prior = sure.remembered(goal)
        we, body = explorers(sure), MazeBody(after, copies=COPIES, dynamics=np.eye(5))
        chapter = Follower(we.model, we.places, successor, end, prior, copies=COPIES)
        assert not follow(body, chapter, rng=np.random.default_rng(0), limit=1000).reached.any()
        one = Rerouting(we, end, successor, prior)
        journey = follow(body, one, rng=np.random.default_rng(0), limit=1000)
        assert journey.reached.all() and one.alone.all()
        again = follow(body, one, rng=np.random.default_rng(0), limit=1000)
        assert again.reached.all()


def test_until_touch_contradicts_what_was_shown_it_is_the_chapters_imitator(sure):
    successor, prior = sure.remembered(3)
    end, we = sure.maze.number(sure.maze.goals[2]), explorers(sure)
    followers = (
        Follower(we.model, we.places, successor, end, prior, copies=COPIES),
        Rerouting(we, end, successor, prior),
    )
    one, other = (
        follow(MazeBody(sure.maze, copies=COPIES, seed=3), each, rng=np.random.default_rng(1), limit=2000)
        for each in followers
    )  # as noisy as ever: pushed off the way, neither finds a wall where it was shown none
    np.testing.assert_array_equal(one.states, other.states)
    assert not followers[1].alone.any()


def test_who_has_felt_everything_plans_the_shortest_way(sure):
    maze, we = sure.maze, explorers(sure)
    end = maze.number(maze.goals[1])
    planner, values = Rerouting(we, end), Replanning(we, end)
    for each in (planner, values):
        we.feel(everywhere(maze), each.fresh)
    assert (we.closed == maze.blocked[:, :4]).all() and (we.passed == ~maze.blocked[:, :4]).all()
    planner._plan(np.arange(COPIES))
    distance = maze.distances(maze.goals[1])
    inside = (distance > 0) & (np.arange(maze.cells) != end)
    assert (distance[planner.successor[:, inside]] == distance[inside] - 1).all()
    assert (planner.successor[:, end] == -1).all()
    values._sweep(1000)
    reached = distance >= 0
    np.testing.assert_allclose(values.value[:, reached], np.tile(distance[reached], (COPIES, 1)), atol=0.05)


def everywhere(maze) -> np.ndarray:
    """(S, COPIES, 6) what is felt in every cell."""
    places = np.array([maze.place(cell) for cell in range(maze.cells)])
    return np.repeat(np.hstack([places, maze.blocked[:, :4]])[:, None].astype(float), COPIES, 1)


def test_remembered_walls_are_doubted_so_that_nobody_is_walled_in_by_memory(sure):
    after, we = changed(sure, 3), explorers(sure)
    we.feel(everywhere(sure.maze))  # by memory there is no way to the goal
    one = Rerouting(we, after.number(after.goals[0]), *sure.remembered(3))
    body = MazeBody(after, copies=COPIES, dynamics=np.eye(5))
    assert follow(body, one, rng=np.random.default_rng(0), limit=3000).reached.all()


def test_sides_are_as_passable_as_counted():
    we = Explorers(parse_maze(ROOMS), 1, (0,))
    planner, cell = Rerouting(we, 3), we.places.number([3.0, 2.0])
    we.feel(np.array([[3.0, 2, 1, 0, 0, 0]]))
    # from both sides: 6 known open, 2 known closed
    remembered = planner.passable()[0]
    np.testing.assert_allclose(remembered[cell], [0.1, 0.9, 0.9, 0.9])
    assert remembered[0, 0] == pytest.approx(0.7) and remembered[0, 2] == 0, "unknown; the rim"
    we.feel(np.array([[3.0, 2, 1, 0, 0, 0]]), planner.fresh)
    np.testing.assert_array_equal(planner.passable()[0, cell], [0, 1, 1, 1])


def test_what_was_felt_last_counts_and_what_was_watched_is_open():
    maze = parse_maze(ROOMS)
    we, cell = Explorers(maze, 2, (0,)), maze.number((2, 2))
    north = np.array([[2.0, 2, 1, 0, 0, 0]] * 2)
    we.feel(north)
    assert we.closed[:, cell, 0].all() and we.closed[:, cell + maze.width, 2].all(), "known from both sides"
    we.feel(north * [1, 1, 0, 1, 1, 1])
    assert not we.closed.any() and we.passed[:, cell + maze.width, 2].all()
    we.watch([[Episode(0, np.array([0, 0, 1]), np.array([0, 1]))], []])
    assert we.passed[0, 0, 1] and we.passed[0, 1, 3] and not we.passed[1, :2, 1:].any()


@pytest.mark.parametrize("goal", [1, 2, 3])
def test_a_moved_wall_shuts_the_way_and_opens_another(goal):
    maze = default_maze()
    for seed in range(5):
        after = moved_wall(maze, goal, np.random.default_rng(seed))
        shut, opened = after.walls & ~maze.walls, maze.walls & ~after.walls
        assert shut.sum() == 2 and opened.sum() == 2, "both sides of one each"
        between = type(maze)(maze.walls | after.walls, maze.start, ())
        assert between.distances(after.goals[0])[maze.number(maze.start)] == -1
        assert after.distances(after.goals[0])[maze.number(maze.start)] > 0


def test_where_no_wall_can_be_moved_none_is():
    corridor = parse_maze("+--+--+--+\n| *     1|\n+--+--+--+\n")
    assert moved_wall(corridor, 1, np.random.default_rng(0)) is None
    ring = parse_maze("+--+--+--+\n| *     1|\n+  +  +  +\n|        |\n+--+--+--+\n")
    assert moved_wall(ring, 1, np.random.default_rng(0)).distances((3, 2))[ring.number((1, 2))] == 4, "only longer"


def test_a_new_goal_is_none_that_was_shown():
    maze = default_maze()
    drawn = {new_goal(maze, np.random.default_rng(seed)).goals[0] for seed in range(40)}
    assert len(drawn) > 30 and not drawn & set(maze.goals)


def test_replayed_demonstrations_are_what_q_learning_would_do_first():
    maze = parse_maze(ROOMS)
    (walk,) = demonstrate(MazeBody(maze, dynamics=np.eye(5)), 3, np.random.default_rng(0))
    episode = watched(walk, maze)
    first = replayed([[episode]], maze.cells, times=60)
    policy = best_acts(first)
    np.testing.assert_array_equal(policy[:, 0, episode.states[:-1]], np.tile(episode.actions, (len(Q_SETTINGS), 1)))
    for k, setting in enumerate(Q_SETTINGS):
        left = episode.steps - np.arange(episode.steps)
        worth = -left if setting.optimistic else setting.discount ** (left - 1.0)
        np.testing.assert_allclose(first[episode.actions, k, 0, episode.states[:-1]], worth, atol=1e-6)
    (begun,) = q_learners(maze, np.array([maze.number(maze.goals[2])]), 1, (0,), 0, first)
    np.testing.assert_array_equal(begun[:, 0], first)
    unseen = np.setdiff1d(np.arange(maze.cells), episode.states)
    assert (policy[:, 0, unseen] == -1).all()


def test_walks_in_turn_count_what_they_took():
    maze = parse_maze(ROOMS)
    (we,) = wanderers(maze, 5, (200,), 0)
    walks = in_turn(Replanning(we, maze.number(maze.goals[0])), maze, 3, 100, (4,))
    assert [steps for steps, _ in walks] == sorted(steps for steps, _ in walks) and walks[0][0] == 0
    assert walks[-1][1].all() and walks[1][0] >= maze.distances(maze.goals[0])[maze.number(maze.start)]


def test_rules_of_thumb_by_hand():
    maze = parse_maze(ROOMS)  # the goals: (5, 1), (2, 6), (5, 6); the upper room opens at x = 1 alone
    states = np.array([maze.number(place) for place in ((1, 1), (2, 1), (3, 1), (3, 2))])
    scores = rules_of_thumb(maze, states)
    np.testing.assert_allclose(scores["nearest goal, told the walls"][2], [-2, -8, -11])
    np.testing.assert_allclose(scores["straightest path, told the walls"][2], [2, -2, -2])
    np.testing.assert_allclose(scores["nearest goal, as the crow flies"][3], -np.sqrt([5, 17, 20]))
    began = np.sqrt([16, 26, 41])
    np.testing.assert_allclose(scores["straightest path, as the crow flies"][3], began - np.sqrt([5, 17, 20]))
    there = rules_of_thumb(maze, np.array([maze.number(maze.start), maze.number(maze.goals[1])]))
    assert all(score[-1].argmax() == 1 for score in there.values()), "right at the end is no feat: it stands there"


def test_the_same_seed_changes_the_maze_the_same_way(monkeypatch):
    for name, value in {"SEEDS": 1, "LEARNERS": 2, "WALKS": 1, "Q_STEPS": (0, 40)}.items():
        monkeypatch.setattr(f"experiments.maze.changes.{name}", value)
    maze = parse_maze(ROOMS.replace("2", " ").replace("3", " "))
    one, again, other = (repr(changes(maze, seed, 2, lambda done: None)) for seed in (3, 3, 4))
    assert one == again != other
