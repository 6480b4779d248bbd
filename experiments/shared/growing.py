"""A child that has not played before an experiment plays for a while."""

from experiments.shared.children import Child, born
from experiments.shared.progress import progress
from experiments.shared.rounds import PLAYED, empty, play_on

ROUNDS = 4
"""Of play, where none was saved: 51 body-minutes over all children."""


def played_shortly(seed: int, workers: int) -> Child:
    """Babble on the seat and play for a while."""
    with progress("babbling on the seat") as report:
        mind, image = born(seed, report)
    play = play_on(mind, image, empty(mind), PLAYED, ROUNDS, seed, workers)
    return Child(mind, image, play)
