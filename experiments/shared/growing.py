"""A child that has not played before an experiment plays for a while."""

from experiments.shared.children import Child, born
from experiments.shared.progress import progress
from experiments.shared.rounds import PLAYED, empty, play_on, rounds_of


def played_for(minutes: float, seed: int, workers: int) -> Child:
    """Babble on the seat and play for so many body-minutes, over all children."""
    with progress("babbling on the seat") as report:
        mind, image = born(seed, report)
    play = play_on(mind, image, empty(mind), PLAYED, rounds_of(minutes, PLAYED), seed, workers)
    return Child(mind, image, play)
