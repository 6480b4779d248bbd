"""The maze of the chapter's section 3.3: a world drawn as text, a body that walks in it, a teacher that knows it."""

from models.maze.body import TRUE_DYNAMICS, MazeBody
from models.maze.drawing import default_maze, draw, parse_maze, read_maze
from models.maze.maze import ACTIONS, STEPS, Maze, Place
from models.maze.teacher import Walk, check_walk, demonstrate

__all__ = [
    "ACTIONS",
    "STEPS",
    "TRUE_DYNAMICS",
    "Maze",
    "MazeBody",
    "Place",
    "Walk",
    "check_walk",
    "default_maze",
    "demonstrate",
    "draw",
    "parse_maze",
    "read_maze",
]
