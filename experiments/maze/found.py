"""What one run in the maze came to."""

from dataclasses import dataclass

from babbling.axes import FloatArray
from experiments.maze.learning import Convergence
from experiments.maze.mind import Experience, Inferred
from experiments.maze.options import Config
from imitation.acting.follow import Journey, believed
from models.maze import Maze, Walk


@dataclass(frozen=True, eq=False)
class Found:
    """Everything one run found."""

    config: Config
    experience: Experience
    walks: list[Walk]
    """What was watched."""
    curve: Convergence | None
    """None for what is remembered."""
    journey: Journey
    unseen: Walk
    """The teacher's walk whose goal is inferred."""
    goal_prior: FloatArray
    beliefs: dict[str, Inferred]
    """Where it leads, by whether the teacher's actions are seen."""
    even: dict[str, Inferred]
    """The same with a uniform prior over goals."""

    @property
    def maze(self) -> Maze:
        """Where all of this happens."""
        return self.experience.maze

    @property
    def table(self) -> FloatArray:
        """(A, O) the learned forward model."""
        table: FloatArray = believed(self.experience.forward_model)[0]
        return table

    @property
    def inferred(self) -> Inferred:
        """Where it leads, seen as the options say."""
        return self.beliefs[self.config.actions]
