"""Who has played: from a file, or for a while before the experiment."""

from pathlib import Path

from experiments.errors import ExperimentError
from experiments.shared.children import Child, born, meet
from experiments.shared.progress import progress
from experiments.shared.rounds import PLAYED, empty, play_on
from models.objects import TOYS

ROUNDS = 3
"""Of play, where none was saved: 38 body-minutes over all children."""


def who(play: Path | None, seed: int, workers: int) -> Child:
    """Who has played: from a file, or now.

    Raises:
        BabblingError: see `meet`.
    """
    return meet(play) if play is not None else played_shortly(seed, workers)


def kind_of(child: Child, toy: str) -> int:
    """Number of the kind of thing that an object is, to one who has played with it.

    Raises:
        ExperimentError: it never did.
    """
    kind, known = TOYS[toy].kind, child.play.kinds
    if kind not in known:
        raise ExperimentError(
            f"--object {toy}: {kind} was never played with, only {', '.join(known)}; play with it first"
        )
    return known.index(kind)


def played_shortly(seed: int, workers: int) -> Child:
    """Babble on the seat and play for a while."""
    with progress("babbling on the seat") as report:
        mind, image = born(seed, report)
    play = play_on(mind, image, empty(mind), PLAYED, ROUNDS, seed, workers)
    return Child(mind, image, play)
