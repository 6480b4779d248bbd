"""`imitate maze` as a user runs it: what it leaves behind, determinism, deferral, and every refusal in one line."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from babbling.files import load
from experiments.__main__ import main
from experiments.benchmark.maze import rows
from experiments.maze.learning import expected_distance, scatter, walkers
from experiments.maze.mind import (
    CHECKPOINTS,
    UNSEEN,
    infer,
    junctions,
    outings,
    population,
    step_likelihood,
    teach,
    watched,
)
from experiments.maze.peers import Q_SETTINGS, best_acts, q_learners
from experiments.maze.planners import arrivals, least_steps, steps_to_go, wanderers
from experiments.maze.rerouting import Replanning, in_turn
from experiments.maze.run import Config, run
from experiments.maze.study import study
from experiments.maze.trials import reliable_from
from experiments.shared.experiment import as_json
from imitation.acting.follow import believed
from imitation.deferred import StepMemory
from imitation.episodes import Episode
from imitation.inference.priors import ActionPriors
from models.maze import TRUE_DYNAMICS, MazeBody, default_maze, parse_maze

TINY = """\
+--+--+--+--+--+
|    2       3 |
+  +  +  +  +  +
|              |
+  +  +  +  +  +
|              |
+  +--+--+--+  +
| *          1 |
+--+--+--+--+--+
"""


@pytest.fixture(scope="module")
def tiny(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("maze") / "tiny.txt"
    path.write_text(TINY)
    return path


@pytest.fixture(scope="module")
def base(tiny):
    """One run that several tests look at."""
    return run(Config(maze=tiny, wander_steps=600, seed=5))


def command(*words: object) -> int:
    return main(["maze", *map(str, words)])


def test_a_run_leaves_what_it_promises(tiny, tmp_path, monkeypatch):
    monkeypatch.setattr("experiments.shared.provenance.version", lambda name: "0")  # works uninstalled as well
    out = tmp_path / "out"
    assert command("--maze", tiny, "--goal", 3, "--wander-steps", 3000, "--selection", "matching", "--out", out) == 0
    left = {path.name for path in out.iterdir()}
    figures = {"figure_5.png", "figure_6.png", "figure_7.png", "learning_curve.png"}
    assert left >= figures | {"config.json", "metrics.json", "recording.rrd", "memory.nc", "demonstrations.csv"}
    metrics = json.loads((out / "metrics.json").read_text())
    assert metrics["imitation"]["goal"] == 3 and metrics["imitation"]["reached"]
    assert metrics["imitation"]["states"][0] == 0 and metrics["imitation"]["states"][-1] == 19
    np.testing.assert_allclose(np.sum(metrics["forward_model"]["table"], 1), 1)
    assert np.allclose(np.sum(metrics["intent"]["blocks"], 1), 1)


def test_the_recording_holds_both_walks_and_both_posteriors(base, tmp_path):
    from rerun.chunk import RrdReader

    base.record(tmp_path / "r.rrd")
    reader = RrdReader(tmp_path / "r.rrd")
    (entry,) = reader.recordings()
    paths = set(map(str, reader.store(store=entry).schema().entity_paths()))
    wanted = {"/imitating/walker", "/imitating/trail", "/imitating/posterior", "/watching/walker", "/watching/goals"}
    wanted |= {f"/actions/posterior/{a}" for a in "NESWX"} | {f"/goals/filter/goal_{g}" for g in (1, 2, 3)}
    assert paths >= wanted | {"/summary", "/figures/figure_7", "/actions/mode"}
    assert reader.blueprints()


def test_the_same_seed_gives_the_same_metrics(tiny, base):
    again, other = (run(Config(maze=tiny, wander_steps=600, seed=seed)).metrics for seed in (5, 6))
    assert repr(again) == repr(base.metrics)
    assert repr(other) != repr(base.metrics)


def test_a_new_process_imitates_from_the_file_as_the_old_one_would(tiny, base, tmp_path):
    later = run(Config(maze=tiny, wander_steps=600, seed=5, deferred=True))
    assert repr(later.metrics) == repr(base.metrics)
    base.files["memory.nc"](tmp_path / "memory.nc")
    recalled = run(Config(maze=tiny, seed=5, memory=tmp_path / "memory.nc"))
    for part in ("imitation", "intent", "forward_model"):
        assert repr(recalled.metrics[part]) == repr(base.metrics[part])
    counts = load(tmp_path / "memory.nc", StepMemory).forward_model.counts[0]
    np.testing.assert_array_equal(counts / counts.sum(1, keepdims=True), base.metrics["forward_model"]["table"])
    with pytest.raises(ValueError, match="this memory belongs to body"):
        run(Config(memory=tmp_path / "memory.nc"))


def test_watched_walks_of_a_table_are_what_is_imitated(tiny, base, tmp_path):
    base.files["demonstrations.csv"](tmp_path / "walks.csv")
    again = run(Config(maze=tiny, wander_steps=600, seed=5, watch=tmp_path / "walks.csv"))
    assert repr(again.metrics) == repr(base.metrics)


def test_intent_from_places_alone_looks_at_no_action(tiny, base):
    unseen = run(Config(maze=tiny, wander_steps=600, seed=5, actions="unseen")).metrics["intent"]
    both = base.metrics["intent"]["by_actions"]
    assert repr(unseen["by_actions"]) == repr(both)  # both are told, whichever is shown
    assert unseen["filter_end"].tolist() == both["unseen"]["filter_end"].tolist()
    assert unseen["filter_end"].tolist() != both["seen"]["filter_end"].tolist()
    maze = parse_maze(TINY)
    episodes = [watched(walk, maze) for walk in teach(maze, 2, 5)]
    priors = ActionPriors.learned(episodes, 3, maze.cells, 5)
    liar = replace(episodes[0], actions=(episodes[0].actions + 1) % 5)
    likelihood = step_likelihood(maze, TRUE_DYNAMICS, episodes[0])
    one, other = (infer(priors, e, np.full(3, 1 / 3), 0.1, likelihood).filtered for e in (episodes[0], liar))
    np.testing.assert_array_equal(one.probability, other.probability)
    start = maze.number(maze.start)  # below the start is a wall: whoever goes south stays
    stays = step_likelihood(maze, TRUE_DYNAMICS, Episode(0, np.array([start, start]), np.array([0])))[0]
    blocked = maze.blocked[start, :4]
    np.testing.assert_allclose(stays, TRUE_DYNAMICS[:, 4] + TRUE_DYNAMICS[:, :4] @ blocked)


def test_no_wandering_is_a_uniform_model_and_said_so(tiny):
    result = run(Config(maze=tiny, wander_steps=0))
    assert result.metrics["forward_model"]["uniform"]
    assert (np.array(result.metrics["forward_model"]["table"]) == 0.2).all()
    assert "the forward model is uniform" in result.summary


REFUSALS = {
    "no path": (["--maze", "closed.txt"], "no path leads from the start (1, 1) to goal 1"),
    "unequal rows": (["--maze", "unequal.txt"], "line 2: 15 characters, line 1 has 16"),
    "unknown character": (["--maze", "strange.txt"], "line 8, column 7: '%' where a wall '|' or an opening"),
    "too large": (["--maze", "large.txt"], "201 x 1 cells; the largest maze is 200 x 200"),
    "no maze": (["--maze", "absent.txt"], "there is no such file"),
    "prior sum": (["--goal-prior", "0.5,0.5,0.5"], "sums to 1.5, not to 1"),
    "prior length": (["--goal-prior", "0.5,0.5"], "goal prior of 2 numbers; there are 3 goals"),
    "prior words": (["--goal-prior", "half,half"], "give numbers with commas"),
    "wall": (
        ["--maze", "tiny.txt", "--watch", "wall.csv"],
        "walk 1, step 1: from (2, 1) to (2, 2) leads through a wall",
    ),
    "nobody shown": (["--maze", "tiny.txt", "--watch", "one.csv"], "nobody was watched going to goal 2"),
    "goal": (["--goal", "4"], "this maze has goals 1 to 3"),
    "selection": (
        ["--selection", "mop"],
        "unknown selection 'mop'; there are map, matching, mean; did you mean 'map'?",
    ),
    "mean": (["--selection", "mean"], "are categories and have no mean; use map or matching"),
    "steps": (["--wander-steps", "-1"], "it must lie between 0 and 10000000 steps"),
    "demonstrations": (["--demonstrations", "0"], "it must lie between 1 and 1000"),
    "smoothing": (["--smoothing", "-0.1"], "--smoothing"),
    "smoothing nan": (["--smoothing", "nan"], "--smoothing"),
    "study": (["--maze", "wide.txt", "--study"], "a maze of 2600 cells; hundreds of learners fit into at most 2500"),
    "seed": (["--seed", "-1"], "it must lie between 0 and 4000000000"),
    "memory": (["--memory", "tiny.txt"], "not a readable NetCDF-4 file"),
    "both": (["--memory", "a", "--watch", "b"], "give one of them"),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_what_cannot_be_meant_is_refused_in_one_line(case, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    head = "walk,goal,step,x,y,action\n"
    Path("tiny.txt").write_text(TINY)
    Path("closed.txt").write_text(TINY.replace("| *          1 |", "| *|         1 |").replace("+  +--+", "+--+--+"))
    Path("unequal.txt").write_text(TINY.replace("|    2       3 |", "|    2      3 |"))
    Path("strange.txt").write_text(TINY.replace("| *          1 |", "| *   %      1 |"))
    Path("large.txt").write_text("+" + "--+" * 201 + "\n| *" + "   " * 199 + "  1|\n+" + "--+" * 201)
    rows = "|" + "   " * 199 + "  |\n+" + "  +" * 200 + "\n"
    Path("wide.txt").write_text("+" + "--+" * 200 + "\n" + rows * 12 + "| *" + "   " * 198 + "  1|\n+" + "--+" * 200)
    Path("wall.csv").write_text(head + "1,2,0,1,1,E\n1,2,1,2,1,N\n1,2,2,2,2,\n")
    Path("one.csv").write_text(head + "1,1,0,1,1,E\n1,1,1,2,1,E\n1,1,2,3,1,E\n1,1,3,4,1,E\n1,1,4,5,1,\n")
    words, told = REFUSALS[case]
    assert command(*words, "--out", tmp_path / "out") == 2
    error = capsys.readouterr().err.strip()
    assert told in error and "\n" not in error and "Traceback" not in error
    assert not (tmp_path / "out").exists()


def test_outings_add_up_and_stop_at_the_checkpoints():
    for steps in (0, 1, 99, 100, 5000, 61_234):
        plan = outings(steps)
        assert sum(plan) == steps and all(n > 0 for n in plan)
        assert {c for c in CHECKPOINTS if c <= steps} <= set(np.cumsum(plan).tolist())


def test_learning_follows_the_multinomial_bound():
    _, curve = walkers(default_maze(), 3000, 7, 60, lambda done: None)
    ratio = np.array(curve.tv) / np.array(curve.bound)
    assert (np.abs(ratio[np.array(curve.steps) >= 300] - 1) < 0.1).all()
    assert curve.slope == pytest.approx(-0.5, abs=0.04)
    assert expected_distance(np.full((1, 2), 0.5), np.array([100.0])) == pytest.approx(0.5 * np.sqrt(2 / (np.pi * 100)))


def test_a_run_that_counts_lies_in_the_band_nineteen_times_in_twenty():
    """Of few draws as of many; the expectation lies within."""
    rng, truth = np.random.default_rng(3), TRUE_DYNAMICS
    for visits in (np.array([3, 9, 4, 20, 7]), np.full(5, 400)):
        band = scatter(truth, visits, np.random.default_rng(0), 2000)
        runs = rng.multinomial(visits, truth, (2000, 5)) / visits[:, None]
        off = (np.abs(runs - truth).sum(-1) / 2).mean(-1)
        assert np.mean((band[0] <= off) & (off <= band[1])) == pytest.approx(0.95, abs=0.02)
        assert band[0] < off.mean() < band[1]
    _, curve = walkers(default_maze(), 3000, 7, 1, lambda done: None)
    assert curve.band.shape == (2, len(curve.steps)) and (np.diff(np.diff(curve.band, axis=0)) < 0).all()
    assert (curve.band[0] <= curve.tv).mean() > 0.5 and (curve.tv <= curve.band[1]).mean() > 0.5


def test_counting_beside_walls_would_never_converge():
    """What the touch sense is for: with wall cells counted the floor is a tenth off, however long one wanders."""
    body = MazeBody(default_maze(), copies=200, seed=1)
    rng, before, counts = np.random.default_rng(0), body.reset(), np.zeros((5, 5))
    from babbling.moves import relative_move

    for _ in range(400):
        action = rng.integers(0, 5, 200)
        after = body.act(action[:, None].astype(float))
        np.add.at(counts, (action, relative_move(before[:, :2], after[:, :2])), 1)
        before = after
    learned = counts / counts.sum(1, keepdims=True)
    assert np.abs(learned - TRUE_DYNAMICS).sum(1).mean() / 2 > 0.08


@pytest.mark.parametrize("selection", ["map", "matching"])
def test_imitation_succeeds_for_every_goal(selection):
    imitators = population(default_maze(), 25, 2, 2000, 9)
    for goal in (1, 2, 3):
        journey = imitators.imitate(goal, selection, np.random.default_rng([9, 23, goal]), 2000)
        assert journey.reached.all() and not journey.decisions.chance.any()
        assert journey.steps.mean() / imitators.teacher_steps(goal) < (1.3 if selection == "map" else 1.4)


def test_the_filter_knows_the_goal_at_the_end():
    maze = default_maze()
    right = []
    for seed in range(12):
        episodes = [watched(walk, maze) for walk in teach(maze, 2, seed)]
        priors = ActionPriors.learned(episodes, 3, maze.cells, 5)
        for walk in teach(maze, 1, seed, UNSEEN):
            belief = infer(priors, watched(walk, maze), np.full(3, 1 / 3), 0.1).filtered.probability
            right.append(belief[-1].argmax() == walk.goal - 1)
            np.testing.assert_allclose(belief.sum(1), 1, atol=1e-12)
    assert np.mean(right) >= 0.97


def test_junctions_are_where_shortest_ways_part():
    maze = default_maze()
    assert [maze.place(cell) for cell in junctions(maze)] == [(9, 8), (9, 9)]


def test_value_iteration_is_exact_where_it_can_be_checked():
    maze = parse_maze(TINY)
    sure = steps_to_go(maze.lead, np.eye(5)[None], maze.number(maze.goals[1]))
    distance = maze.distances(maze.goals[1])
    away = np.arange(maze.cells) != maze.number(maze.goals[1])
    assert (sure[0].min(-1)[away] == distance[away]).all()
    goal = maze.number(maze.goals[2])
    expected = least_steps(maze, TRUE_DYNAMICS, goal)
    policy = steps_to_go(maze.lead, TRUE_DYNAMICS[None], goal).argmin(-1)
    body = MazeBody(maze, copies=4000, seed=2)
    body.reset()
    steps, here = np.zeros(4000), body.cell
    while (here != goal).any():
        steps += here != goal
        here = np.where(here == goal, goal, body.move(policy[0, here]))
        body._cell = here
    assert steps.mean() == pytest.approx(expected, rel=0.03)


def test_baselines_become_reliable_in_a_small_maze():
    maze = parse_maze(TINY)
    goal = maze.number(maze.goals[2])
    (we,) = wanderers(maze, 6, (500,), 0)
    policy = steps_to_go(maze.lead, believed(we.model), goal).argmin(-1)
    assert arrivals(maze, goal, policy, 60, (1,), 20).mean() > 0.95
    assert np.mean([hits for _, hits in in_turn(Replanning(we, goal), maze, 6, 60, (1,))][2:]) > 0.9
    (learned,) = q_learners(maze, np.array([goal]), 4, (8000,), 0)
    assert best_acts(learned).shape == (1, len(Q_SETTINGS), 4, maze.cells)
    best = max(arrivals(maze, goal, policy, 60, (2,), 20).mean() for policy in best_acts(learned)[0])
    assert best > 0.95


def test_reliable_from_is_the_first_budget_that_is_enough():
    assert reliable_from({1: 0.5, 2: 0.95, 3: 0.9}) == 2
    assert reliable_from({1: 0.5, 2: 0.94}) is None


def test_benchmark_rows_agree_with_bare_numpy(monkeypatch):
    monkeypatch.setattr("experiments.benchmark.maze.TRANSITIONS", 2000)
    monkeypatch.setattr("experiments.benchmark.maze.POSTERIORS", 100)
    found = rows()
    assert {row.question for row in found} == {"learn", "action posterior"}
    assert all(row.largest_difference < 1e-12 for row in found)


@pytest.mark.parametrize("text", [TINY, "+--+--+--+\n| *     1|\n+--+--+--+\n"], ids=["room", "corridor"])
def test_a_small_study_measures_every_claim(text, monkeypatch):
    small = {"CURVE_STEPS": 600, "CURVE_WALKERS": 5, "SEEDS": 4, "WALKS": 3}
    budgets = {
        "LEARNERS": 4,
        "IMITATION_BUDGETS": (0, 100, 1000),
        "Q_BUDGETS": (0, 300, 600),
        "REPLANNED_WALKS": 2,
    }
    changing = {"SEEDS": 2, "LEARNERS": 3, "WALKS": 2, "Q_STEPS": (0, 100)}
    for module, values in (("study", small), ("trials", budgets), ("changes", changing)):
        for name, value in values.items():
            monkeypatch.setattr(f"experiments.maze.{module}.{name}", value)
    maze, told = parse_maze(text), []
    found = study(maze, 0, 2, 100, 0.1, told.append)
    per_goal = {str(goal + 1) for goal in range(len(maze.goals))}
    for name in ("imitation_success", "step_ratio", "uninformed_steps"):
        assert {selection: set(goals) for selection, goals in found.metrics[name].items()} == {
            "map": per_goal,
            "matching": per_goal,
        }
    for name in ("trials_imitation", "trials_value_iteration", "trials_q_learning"):
        assert set(found.metrics[name]) == per_goal
    assert set(found.metrics["forward_model_tv"]) == set(found.metrics["forward_model_tv_bound"])
    for rule in ("filter", "step", "unseen_filter", "unseen_step"):
        assert 0 <= found.metrics[f"intent_{rule}_accuracy"] <= 1 and found.metrics[f"intent_{rule}_log_loss"] >= 0
    for world, methods in found.metrics["changes"].items():
        assert ("imitation" in methods) == (world != "wall moved" or text == TINY)
        for one in methods.values():
            low, high = np.transpose(one["interval"])
            assert (low <= one["share"]).all() and (one["share"] <= high).all() and len(one["by_seed"][0]) == len(low)
    for one in found.metrics["intent_by_share"].values():
        assert len(one["accuracy"]) == 10 and 0 <= min(one["accuracy"]) <= max(one["accuracy"]) <= 1
    assert "NaN" not in as_json(found.metrics) and "trials" in found.figures
    assert sorted(told) == told and told[-1] == pytest.approx(1.0)
