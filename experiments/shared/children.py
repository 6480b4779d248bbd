"""A child that has played: its mind, the image of its hands and head, and what it learned of things; as files."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from babbling.body_image import BodyImage
from babbling.files import load, save
from babbling.mind import Mind
from babbling.own_eyes import OwnEyes
from babbling.play import Play
from experiments.errors import ExperimentError
from experiments.shared.kept import once
from experiments.shared.minds import learn_mind
from experiments.shared.options import BABBLING_MINUTES, BodyOptions
from experiments.shared.pixels import sight
from experiments.shared.playing import SEATED, Player
from experiments.shared.rounds import look_at_hands

NAMED = {"mind": ".mind.nc", "image": ".image.nc", "eyes": ".eyes.nc"}
"""What stands beside a play; eyes only of one who sees by pixels."""


@dataclass(frozen=True)
class Child:
    """Who has babbled, looked at its hands, and played."""

    mind: Mind
    image: BodyImage
    play: Play
    eyes: OwnEyes | None = None
    """What its own eyes show; None for one who sees points."""
    robot: str = SEATED

    @property
    def player(self) -> Player:
        """At a table."""
        return Player(self.mind, self.image, sight(self.eyes, self.image), self.robot)


def beside(path: Path, what: str) -> Path:
    """Where mind or image is kept, beside a play."""
    return path.with_suffix(NAMED[what])


def born(
    seed: int,
    report: Callable[[float], None],
    mind: Mind | None = None,
    robot: str = SEATED,
    minutes: float = BABBLING_MINUTES,
) -> tuple[Mind, BodyImage]:
    """Babble on the seat, unless there is a mind, and look at one's own hands and head."""
    if mind is None:
        mind = once(learn_mind, BodyOptions(robot=robot, seed=seed), minutes, report=report).mind
    return mind, once(look_at_hands, mind, seed, robot)


def keep(child: Child, path: Path) -> None:
    """Write all that a child knows; the play last, so that what it needs is there."""
    for what in NAMED:
        if getattr(child, what) is not None:
            save(getattr(child, what), beside(path, what))
    save(child.play, path)


def meet(path: Path) -> Child:
    """A child from its files.

    Raises:
        BabblingError: a file is missing, of another kind or body, or damaged.
    """
    play = load(path, Play)
    mind, image = load(beside(path, "mind"), Mind), load(beside(path, "image"), BodyImage)
    eyes = load(beside(path, "eyes"), OwnEyes) if beside(path, "eyes").exists() else None
    for what, one in (("mind", mind), ("image", image), ("eyes", eyes)):
        where = beside(path, what)
        if one is not None and one.fingerprint != play.fingerprint:
            raise ExperimentError(f"{where}: of another body than {path}; play anew with --forward-model {where}")
    return Child(mind, image, play, eyes)


def merged(paths: Sequence[Path]) -> Child:
    """The first child, with what all of them learned in play.

    Raises:
        BabblingError: see `meet` and `Play.merged`.
    """
    first, *others = (meet(path) for path in paths)
    play = first.play
    for other in others:
        play = play.merged(other.play)
    return replace(first, play=play)
