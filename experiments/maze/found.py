"""What a run in the maze found: as data, as metrics and as a table."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from babbling.axes import FloatArray
from experiments.maze.learning import Convergence
from experiments.maze.mind import Experience, Inferred
from experiments.maze.options import Config
from experiments.shared.tables import table
from imitation.acting.follow import Journey, believed
from imitation.inference.intent import in_blocks
from models.maze import TRUE_DYNAMICS, Maze, Walk

BLOCK = 8
"""Steps that one point of Figure 7 (b) averages."""


@dataclass(frozen=True, eq=False)
class Found:
    """One who wandered, watched, imitated, and inferred the intent of an unseen walk."""

    config: Config
    experience: Experience
    walks: list[Walk]
    """What was watched."""
    curve: Convergence | None
    """How the forward model was learned; None where it was remembered."""
    journey: Journey
    """The imitation."""
    unseen: Walk
    goal_prior: FloatArray
    beliefs: dict[str, Inferred]
    """Of the unseen walk's goal, by whether its actions were seen."""
    even: dict[str, Inferred]
    """The same under a uniform goal prior."""

    @property
    def maze(self) -> Maze:
        """Where all of this happens."""
        return self.experience.maze

    @property
    def table(self) -> FloatArray:
        """(A, O) the learned forward model."""
        return np.asarray(believed(self.experience.forward_model)[0])

    @property
    def inferred(self) -> Inferred:
        """What is shown of `beliefs`."""
        return self.beliefs[self.config.actions]

    def metrics(self) -> dict[str, Any]:
        """Numbers, by part of the experiment."""
        model, decisions, curve = self.experience.forward_model, self.journey.decisions, self.curve
        maze, goal = self.maze, self.config.goal
        teacher, steps = self.experience.teacher_steps(goal), int(self.journey.steps[0])
        inferred = self.inferred
        by_actions = {
            name: {
                "right_steps": float((one.by_step.probability.argmax(1) == self.unseen.goal - 1).mean()),
                "filter_end": one.filtered.probability[-1],
            }
            for name, one in self.beliefs.items()
        }
        return {
            "maze": {"goals": maze.goals, "fingerprint": maze.fingerprint},
            "forward_model": {
                "counted_transitions": model.transitions,
                "uniform": model.transitions == 0,
                "untried_actions": int((model.visits == 0).sum()),
                "table": self.table,
                "truth": TRUE_DYNAMICS,
                "total_variation": float(np.abs(self.table - TRUE_DYNAMICS).sum(-1).mean() / 2),
            },
            "learning_curve": None
            if curve is None
            else {
                "steps": curve.steps,
                "forward_model_tv": curve.tv,
                "forward_model_tv_bound": curve.bound,
                "forward_model_tv_band_95": curve.band.T,
            },
            "imitation": {
                "goal": goal,
                "selection": self.config.selection,
                "reached": bool(self.journey.reached[0]),
                "steps": steps,
                "teacher_steps": teacher,
                "step_ratio": steps / teacher,
                "forward_model_alone_steps": int(decisions.forward_alone.sum()),
                "chance_steps": int(decisions.chance.sum()),
                "backtracking_steps": int(decisions.backtracking.sum()),
                "states": self.journey.states[:, 0],
            },
            "intent": {
                "goal": self.unseen.goal,
                "steps": self.unseen.steps,
                "block": BLOCK,
                "blocks": in_blocks(inferred.by_step.probability, BLOCK),
                **by_actions[self.config.actions],
                "uninformed_steps": inferred.by_step.uninformed_steps,
                "actions": self.config.actions,
                "by_actions": by_actions,
            },
        }


def summary(config: Config, metrics: dict[str, Any]) -> str:
    """The metrics of `Found` for people: a markdown table."""
    learned, imitation, intent = metrics["forward_model"], metrics["imitation"], metrics["intent"]
    source = f"{config.wander_steps} random steps" if config.memory is None else f"recalled from {config.memory.name}"
    verdict = (
        f"{learned['counted_transitions']} transitions counted away from walls, {learned['untried_actions']} actions "
        f"never tried there; total variation from the truth {learned['total_variation']:.4f}"
    )
    if learned["uniform"]:
        verdict = "**nothing was counted: the forward model is uniform, it knows no action from another**"
    arrived = "reached" if imitation["reached"] else "**not reached**"
    rows = [
        ("forward model", f"{source}: {verdict}"),
        (
            f"imitation of goal {imitation['goal']}, {imitation['selection']}",
            f"{arrived} in {imitation['steps']} steps; the teacher took {imitation['teacher_steps']:.1f} "
            f"(ratio {imitation['step_ratio']:.2f})",
        ),
        (
            "events on the way",
            f"Eq. (1) was 0/0 and the forward model decided alone: {imitation['forward_model_alone_steps']}; "
            f"chance: {imitation['chance_steps']}; backtracking: {imitation['backtracking_steps']}",
        ),
    ]
    for actions, one in intent["by_actions"].items():
        end = ", ".join(f"{p:.3f}" for p in one["filter_end"])
        walk = f"intent, unseen walk of {intent['steps']} steps to goal {intent['goal']}, actions {actions}"
        rows.append((walk, f"right in {one['right_steps']:.0%} of steps one by one; the filter ends at {end}"))
    return f"# Maze: wander, watch, imitate, infer\n\n{table(rows, ('', ''))}\n"
