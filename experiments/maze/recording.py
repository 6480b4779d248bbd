"""The maze run as a Rerun recording: both walks through time, what was believed of actions and of goals, the figures.

Everything stands on one timeline, `step`: on the left the imitator on its way, on the right the teacher's unseen walk
and the observer's belief about where it leads.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from matplotlib.figure import Figure

from babbling.axes import FloatArray, IntArray
from experiments.maze.drawing import GOAL_COLOURS, offsets, wall_segments
from experiments.maze.found import Found
from experiments.maze.mind import places_of
from experiments.shared import views
from experiments.shared.figures import spaced
from experiments.shared.palette import CYCLE, PLAIN, light
from experiments.shared.recording import log_figure, log_series, log_states, recording, ticks
from models.maze import ACTIONS, STEPS, Maze

WALL_HEIGHT, WALL_WIDTH = 0.55, 0.07
ACTION_COLOURS = (*CYCLE[1:5], PLAIN)
FLOOR, WALL, PALE, DARK = (222, 222, 216), (70, 84, 104), np.array([190, 190, 190]), np.array([12, 14, 20])
LONGEST_TRAIL = 150
EVENTS = {"sub-goal": light(CYCLE[2]), "backtracking": light(CYCLE[5]), "forward model alone": light(CYCLE[4])}


def record(path: Path, done: Found, summary: str, figures: Mapping[str, Figure]) -> None:
    """Write the recording, blueprint inside."""
    name = f"maze, goal {done.config.goal}"
    with recording(path, "imitate-maze", name, _layout(done, figures), summary, "step") as stream:
        for name, figure in figures.items():
            log_figure(stream, f"figures/{name}", figure)
        for world in ("imitating", "watching"):
            _log_maze(stream, world, done.maze)
        _log_imitation(stream, done)
        _log_watching(stream, done)


def _log_maze(stream: rr.RecordingStream, world: str, maze: Maze) -> None:
    stream.log(world, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    middle = [(maze.width + 1) / 2, (maze.height + 1) / 2, -0.06]
    floor = rr.Boxes3D(centers=[middle], half_sizes=[[maze.width / 2, maze.height / 2, 0.04]], colors=[FLOOR],
                       fill_mode="solid")  # fmt: skip
    stream.log(f"{world}/floor", floor, static=True)
    ends = np.array(wall_segments(maze))
    centres = np.column_stack([ends.mean(1), np.full(len(ends), WALL_HEIGHT / 2 - 0.02)])
    halves = np.column_stack([np.abs(ends[:, 1] - ends[:, 0]) / 2 + WALL_WIDTH, np.full(len(ends), WALL_HEIGHT / 2)])
    walls = rr.Boxes3D(centers=centres, half_sizes=halves, colors=[WALL], fill_mode="solid")
    stream.log(f"{world}/walls", walls, static=True)
    _log_label(stream, f"{world}/start", maze.start, "start")


def _log_label(stream: rr.RecordingStream, entity: str, place: tuple[int, int], text: str) -> None:
    """White letters beside a place."""
    label = rr.Points3D([[*place, 0.02]], radii=[0.12], colors=[(255, 255, 255)], labels=[text], show_labels=True)
    stream.log(entity, label, static=True)


def _log_imitation(stream: rr.RecordingStream, done: Found) -> None:
    maze, journey, decisions, goal = done.maze, done.journey, done.journey.decisions, done.config.goal
    shown = [walk.places for walk in done.walks if walk.goal == goal]
    lines = [_raised(walk + offset, 0.05) for walk, offset in zip(shown, offsets(len(shown), 0.18), strict=True)]
    stream.log("imitating/demonstrations", rr.LineStrips3D(lines, colors=[(150, 170, 190)], radii=[0.04]), static=True)
    steps, there = int(journey.steps[0]), maze.goals[goal - 1]
    during, places = ticks(steps, 1.0), places_of(maze).place(journey.states[: steps + 1, 0])
    ball = rr.Points3D([[*there, 0.3]], radii=[0.36], colors=[light(GOAL_COLOURS[goal - 1])])
    stream.log("imitating/goal", ball, static=True)
    _log_label(stream, "imitating/goal/label", there, f"goal {goal}")
    _log_walk(stream, "imitating", places)
    subgoal = _raised(places_of(maze).place(decisions.subgoal[:steps, 0]), 0.1)
    stream.log("imitating/subgoal", rr.Points3D.from_fields(colors=[EVENTS["sub-goal"]], radii=[0.2]), static=True)
    stream.send_columns("imitating/subgoal", during, rr.Points3D.columns(positions=subgoal))
    posterior = decisions.posterior[:steps, 0]
    reach = np.pad(STEPS[:4], ((0, 0), (0, 1))) * posterior[:, :4, None] * 1.5
    origins = np.repeat(_raised(places[:steps], 0.45), 4, axis=0)
    colours = np.array([light(c) for c in ACTION_COLOURS[:4]], np.uint8)
    stream.log("imitating/posterior", rr.Arrows3D.from_fields(colors=colours, radii=[0.07]), static=True)
    columns = rr.Arrows3D.columns(vectors=reach.reshape(-1, 3), origins=origins).partition([4] * steps)
    stream.send_columns("imitating/posterior", during, columns)
    for action, colour, series in zip(ACTIONS, ACTION_COLOURS, posterior.T, strict=True):
        log_series(stream, f"actions/posterior/{action}", series, 1.0, action, light(colour))
    events = np.select([decisions.forward_alone[:steps, 0], decisions.backtracking[:steps, 0]], [2, 1], 0)
    log_states(stream, "actions/mode", EVENTS, [list(EVENTS)[k] for k in events], 1.0)


def _log_watching(stream: rr.RecordingStream, done: Found) -> None:
    """The unseen walk and what is believed of it; before the first step that is the prior."""
    _log_walk(stream, "watching", done.unseen.places)
    told = done.inferred.filtered, done.inferred.by_step
    belief, by_step = (np.vstack([done.goal_prior, one.probability]) for one in told)
    goals, index = len(done.maze.goals), ticks(len(belief), 1.0)
    colours = [light(ink) for ink in GOAL_COLOURS[:goals]]
    labels = [f"goal {g + 1}: {p:.2f}" for row in belief for g, p in enumerate(row)]
    spots = np.tile(_raised(np.array(done.maze.goals), 0.3), (len(belief), 1))
    columns = rr.Points3D.columns(
        positions=spots,
        radii=(0.18 + 0.6 * np.sqrt(belief)).ravel(),
        colors=np.tile(np.array(colours, np.uint8), (len(belief), 1)),
    ).partition([goals] * len(belief))
    stream.send_columns("watching/goals", index, columns)
    below = rr.Points3D.columns(positions=spots - [0, 0.6, 0], labels=labels).partition([goals] * len(belief))
    stream.send_columns("watching/goals/labels", index, below)
    white = rr.Points3D.from_fields(colors=[(255, 255, 255)], radii=[0.02], show_labels=True)
    stream.log("watching/goals/labels", white, static=True)
    for entity, beliefs in (("goals/filter", belief), ("goals/by_step", by_step)):
        for g, series in enumerate(beliefs.T, 1):
            log_series(stream, f"{entity}/goal_{g}", series, 1.0, f"goal {g}", colours[g - 1])


def _log_walk(stream: rr.RecordingStream, world: str, places: IntArray) -> None:
    """A walker and the trail behind it, light where it is old and dark where it is new."""
    index = ticks(len(places), 1.0)
    stream.log(f"{world}/walker", rr.Points3D.from_fields(colors=[DARK.astype(np.uint8)], radii=[0.3]), static=True)
    stream.send_columns(f"{world}/walker", index, rr.Points3D.columns(positions=_raised(places, 0.3)))
    low = _raised(places, 0.08)
    pieces = np.stack([low[:-1], low[1:]], axis=1)
    trails = [pieces[max(0, t - LONGEST_TRAIL) : t] for t in range(len(places))]
    shades = [PALE + (DARK - PALE) * np.linspace(0, 1, len(trail))[:, None] for trail in trails]
    strips = rr.LineStrips3D.columns(strips=np.concatenate(trails), colors=np.vstack(shades).astype(np.uint8))
    stream.log(f"{world}/trail", rr.LineStrips3D.from_fields(radii=[0.07]), static=True)
    stream.send_columns(f"{world}/trail", index, strips.partition([len(trail) for trail in trails]))


def _layout(done: Found, figures: Mapping[str, Figure]) -> rrb.Horizontal:
    def world(name: str, title: str) -> rrb.Spatial3DView:
        width, height = done.maze.width, done.maze.height
        x, y, across = (width + 1) / 2, (height + 1) / 2, max(width, height)
        return views.world(title, (x, y - 0.38 * across, 1.1 * across), (x, y, 0.0), f"/{name}")

    return views.beside(
        rrb.Horizontal(
            world("imitating", f"imitating goal {done.config.goal}: arrows are P(action)"),
            world("watching", f"watching an unseen walk to goal {done.unseen.goal}: spheres are P(goal)"),
        ),
        views.series("Eq. (1): P(action), X is to stay", origin="/actions/posterior", within=views.CHANCE),
        rrb.StateTimelineView(origin="/actions/mode", name="what decided"),
        views.series("Bayes filter: P(goal), all steps so far", origin="/goals/filter", within=views.CHANCE),
        views.series("Eq. (2): P(goal), each step by itself", origin="/goals/by_step", within=views.CHANCE),
        row_shares=[1, 0.5, 1, 1],
        stage_share=1.4,
        right_share=1.0,
        more=[views.picture(spaced(name), f"/figures/{name}") for name in figures],
    )


def _raised(where: FloatArray | IntArray, height: float) -> FloatArray:
    return np.column_stack([where, np.full(len(where), height)])
