"""The maze: what the chapter says of it, the drawing, the dynamics, the teacher, and what is refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.errors import BodyError
from models.maze import (
    ACTIONS,
    STEPS,
    TRUE_DYNAMICS,
    Maze,
    MazeBody,
    Walk,
    check_walk,
    default_maze,
    demonstrate,
    draw,
    parse_maze,
    read_maze,
)
from models.maze.walk_file import HEADER, read_walks, write_walks

SMALL = """\
+--+--+--+
|    2| 1|
+  +--+  +
| *      |
+--+--+--+
"""


def test_the_default_maze_is_the_chapters():
    maze = default_maze()
    assert (maze.width, maze.height, maze.start) == (20, 20, (1, 1))
    assert maze.goals[:2] == ((20, 20), (1, 8)) and len(maze.goals) == 3
    for y in (5, 8):  # corridors from (1, y) to (9, y): nothing in the way, walls on both sides nearly everywhere
        assert not maze.walls[y - 1, :8, 1].any()
        assert maze.walls[y - 1, :8, 0].sum() + maze.walls[y - 1, :8, 2].sum() >= 14
    assert (~maze.walls[8, 8]).sum() == 3, "(9, 9) is a junction"
    assert (maze.distances(maze.start) >= 0).all(), "every cell can be reached"
    assert 0.25 < (maze.walls.sum(-1) == 0).mean() < 0.5


@st.composite
def mazes(draw_from):
    width, height = draw_from(st.integers(1, 9)), draw_from(st.integers(1, 9))
    if width * height < 2:
        width = 2
    rng = np.random.default_rng(draw_from(st.integers(0, 2**32 - 1)))
    walls = np.zeros((height, width, 4), bool)
    north, east = rng.random((height, width)) < 0.2, rng.random((height, width)) < 0.2
    north[-1], east[:, -1] = True, True
    walls[..., 0], walls[..., 1] = north, east
    walls[..., 2] = np.vstack([np.ones((1, width), bool), north[:-1]])
    walls[..., 3] = np.hstack([np.ones((height, 1), bool), east[:, :-1]])
    bare = Maze(walls, (1, 1), ())
    near = np.flatnonzero(bare.distances((1, 1)) > 0)
    if not near.size:
        return bare
    chosen = rng.choice(near, min(3, near.size), replace=False)
    return Maze(walls, (1, 1), tuple(bare.place(c) for c in chosen))


@settings(max_examples=60, deadline=None)
@given(mazes())
def test_drawing_and_reading_are_inverse(maze):
    if not maze.goals:
        return
    again = parse_maze(draw(maze))
    assert (again.walls == maze.walls).all() and (again.start, again.goals) == (maze.start, maze.goals)
    assert again.fingerprint == maze.fingerprint


@settings(max_examples=40, deadline=None)
@given(mazes())
def test_geometry(maze):
    numbers = np.arange(maze.cells)
    assert [maze.number(maze.place(n)) for n in numbers] == numbers.tolist()
    for a in range(4):  # a wall has two sides, and what is led to leads back
        there = maze.lead[:, a]
        assert (maze.lead[there, (a + 2) % 4][there != numbers] == numbers[there != numbers]).all()
        assert ((there == numbers) == maze.blocked[:, a]).all()
    distance = maze.distances(maze.start)
    reached = distance >= 0
    best = np.where(distance[maze.lead] >= 0, distance[maze.lead], 10**6).min(1)
    away = reached & (numbers != maze.number(maze.start))
    assert (best[away] == distance[away] - 1).all()


def test_what_is_wrong_with_a_drawing_is_said_with_line_and_column():
    lines = SMALL.splitlines()

    def changed(line: int, text: str) -> str:
        return "\n".join([*lines[: line - 1], text, *lines[line:]])

    cases = {
        "line 4: 9 characters, line 1 has 10": changed(4, "| *     |"),
        "line 2, column 4: '?' where a wall '|' or an opening ' ' belongs": changed(2, "|  ?  | 1|"),
        "line 4, column 4: '\\t' where a wall '|'": changed(4, "|  \t     |"),
        "column 3: half a wall": changed(1, "+- +--+--+"),
        "line 1, column 5: the outer wall is open": changed(1, "+--+  +--+"),
        "line 4, column 1: the outer wall is open": changed(4, "  *      |"),
        "line 4, column 3: a second mark in one cell": changed(4, "|*3      |"),
        "line 4, column 6: a second '1'; the first is at": changed(4, "| *  1   |"),
        "no start; mark one cell": changed(4, "|        |"),
        r"goals 2; number them 1, 2, 3": changed(2, "|    2|  |"),
        "no path leads from the start (1, 1) to goal 1 at (3, 2)": changed(3, "+  +--+--+"),
        "4 lines; n rows of cells take 2 n + 1": "\n".join(lines[:4]),
        "line 3, column 4: '*' where a corner": changed(3, "+  *--+  +"),
        "line 4, column 4: '-' where a wall '|' or an opening ' ' belongs": changed(4, "| *-     |"),
        "11 characters; a row of n cells takes 3 n + 1": "\n".join(line + "+" for line in lines),
        "0 lines drawn": "",
    }
    for told, text in cases.items():
        with pytest.raises(BodyError) as caught:
            parse_maze(text, "plan")
        assert told in str(caught.value) and "\n" not in str(caught.value), (told, str(caught.value))


def test_sizes_up_to_200_and_no_further():
    def row(n: int) -> str:
        top, cells = "+" + "--+" * n, "| *" + "   " * (n - 2) + "  1|"
        return "\n".join([top, cells, top])

    assert parse_maze(row(200)).width == 200
    with pytest.raises(BodyError, match="201 x 1 cells; the largest maze is 200 x 200"):
        parse_maze(row(201))


def test_files_that_are_no_mazes(tmp_path):
    with pytest.raises(BodyError, match="no such file"):
        read_maze(tmp_path / "absent.txt")
    (tmp_path / "bytes").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BodyError, match="is not text"):
        read_maze(tmp_path / "bytes")
    (tmp_path / "large").write_bytes(b"+" * (1 << 21))
    with pytest.raises(BodyError, match="has 2 MB where at most 1 MB"):
        read_maze(tmp_path / "large")
    (tmp_path / "windows.txt").write_bytes(("# comment\n" + SMALL).replace("\n", "\r\n").encode())
    assert read_maze(tmp_path / "windows.txt").goals == ((3, 2), (2, 2))


def test_a_walker_moves_as_the_dynamics_say_and_never_through_walls():
    maze, copies = default_maze(), 4000
    body = MazeBody(maze, copies=copies, seed=5)
    rng = np.random.default_rng(0)
    counts, before = np.zeros((5, 5)), body.reset()
    for _ in range(60):
        action = rng.integers(0, 5, copies)
        after = body.act(action[:, None].astype(float))
        step = after[:, :2] - before[:, :2]
        outcome = (step[:, None] == STEPS).all(-1).argmax(1)
        assert not maze.blocked[maze_cells(maze, before), outcome].any()
        free = before[:, 2:].max(1) == 0
        np.add.at(counts, (action[free], outcome[free]), 1)
        assert (after[:, 2:] == maze.blocked[maze_cells(maze, after), :4]).all()
        before = after
    n = counts.sum(1, keepdims=True)
    assert (np.abs(counts / n - TRUE_DYNAMICS) < 5 * np.sqrt(TRUE_DYNAMICS * (1 - TRUE_DYNAMICS) / n)).all()


def maze_cells(maze, senses):
    return ((senses[:, 1] - 1) * maze.width + senses[:, 0] - 1).astype(int)


def test_a_body_answers_for_itself():
    body = MazeBody(parse_maze(SMALL), copies=3, seed=1)
    assert body.reset().tolist() == [[1, 1, 0, 0, 1, 1]] * 3
    runs = []
    for seed in (1, 1, 2):
        body = MazeBody(default_maze(), copies=50, seed=seed)
        body.reset()
        runs.append([body.act(np.ones((50, 1))) for _ in range(20)])
    assert np.array_equal(runs[0], runs[1]) and not np.array_equal(runs[0], runs[2])
    for bad in (5.0, -1.0, 0.5):
        with pytest.raises(BodyError, match=r"knows 0 to 4 \(N, E, S, W, X\)"):
            body.act(np.full((50, 1), bad))
    other = MazeBody(default_maze(), dynamics=np.eye(5))
    assert other.fingerprint != body.fingerprint


def test_a_teacher_without_noise_takes_a_shortest_path():
    maze = default_maze()
    body = MazeBody(maze, copies=8, dynamics=np.eye(5))
    for goal in (1, 2, 3):
        least = maze.distances(maze.goals[goal - 1])[maze.number(maze.start)]
        walks = demonstrate(body, goal, np.random.default_rng(goal))
        assert {walk.steps for walk in walks} == {least}
        for walk in walks:
            check_walk(maze, walk)
    assert len({tuple(walk.actions) for walk in demonstrate(body, 3, np.random.default_rng(0))}) > 1, "variants"


def test_a_noisy_teacher_always_arrives_and_nowhere_before():
    maze = default_maze()
    for walk in demonstrate(MazeBody(maze, copies=50, seed=3), 1, np.random.default_rng(1)):
        check_walk(maze, walk)
        assert (walk.places[:-1] != maze.goals[0]).any(1).all()
    still = MazeBody(maze, dynamics=np.eye(5)[[4] * 5])
    with pytest.raises(BodyError, match="did not reach goal 2 in"):
        demonstrate(still, 2, np.random.default_rng(0))
    with pytest.raises(BodyError, match="goal 4: this maze has goals 1 to 3"):
        demonstrate(still, 4, np.random.default_rng(0))


def test_a_walk_nobody_can_walk_is_refused_with_its_step():
    maze = parse_maze(SMALL)
    good = Walk(1, np.array([[1, 1], [2, 1], [3, 1], [3, 2]]), np.array([1, 1, 0]))
    check_walk(maze, good)
    cases = {
        r"step 1: from \(2, 1\) to \(2, 2\) leads through a wall": [[1, 1], [2, 1], [2, 2], [3, 2]],
        r"step 0: from \(1, 1\) to \(3, 1\) is no single step": [[1, 1], [3, 1], [3, 1], [3, 2]],
        r"step 1: \(0, 1\) lies outside": [[1, 1], [0, 1], [3, 1], [3, 2]],
        r"it ends at \(3, 1\), but goal 1 is at \(3, 2\)": [[1, 1], [2, 1], [3, 1], [3, 1]],
    }
    for told, places in cases.items():
        with pytest.raises(BodyError, match=told):
            check_walk(maze, good._replace(places=np.array(places)))
    with pytest.raises(BodyError, match="action 7"):
        check_walk(maze, good._replace(actions=np.array([1, 7, 0])))


def test_walks_survive_their_table_and_strangers_tables_are_checked(tmp_path):
    maze = default_maze()
    walks = [w for goal in (1, 2, 3) for w in demonstrate(MazeBody(maze, seed=goal), goal, np.random.default_rng(goal))]
    file = tmp_path / "walks.csv"
    write_walks(walks, file)
    for one, two in zip(walks, read_walks(file, maze), strict=True):
        assert one.goal == two.goal and (one.places == two.places).all() and (one.actions == two.actions).all()
    head = ",".join(HEADER) + "\n"
    cases = {
        "the first line must be": "a,b\n",
        "is empty": "",
        "no walks in it": head,
        "line 2 has 3 cells where most have 6": head + "1,2,3\n",
        "line 2: goal, step, x and y must be whole": head + "1,2,0,one,1,N\n",
        "line 3: step 5 where step 1": head + "1,2,0,1,1,N\n1,2,5,1,2,\n",
        "line 2: action 'Q'": head + "1,2,0,1,1,Q\n1,2,1,1,2,\n",
        "line 3: action 'N'": head + "1,2,0,1,1,N\n1,2,1,1,2,N\n",
        r"goals \[2, 3\]": head + "1,2,0,1,1,N\n1,3,1,1,2,\n",
        r"walk 1, step 1: from \(1, 2\) to \(2, 3\) is no single step": head + "1,2,0,1,1,N\n1,2,1,1,2,N\n1,2,2,2,3,\n",
        "line 2: goal, step, x and y must be whole numbers, 0 to": head + f"1,2,0,1,{10**9},N\n1,2,1,1,2,\n",
    }
    for told, text in cases.items():
        file.write_text(text)
        with pytest.raises(BodyError, match=told):
            read_walks(file, maze)
    assert len(ACTIONS) == 5


def test_blank_lines_about_a_drawing_do_no_harm_and_a_goal_is_not_the_start():
    plain, framed = parse_maze(SMALL), parse_maze(f"\n  \n{SMALL}\n \n\n")
    np.testing.assert_array_equal(plain.walls, framed.walls)
    assert (plain.start, plain.goals) == (framed.start, framed.goals)
    with pytest.raises(BodyError, match=r"goal 2 stands on the start \(2, 1\); put it elsewhere"):
        Maze(plain.walls, (2, 1), (plain.goals[0], (2, 1)))
