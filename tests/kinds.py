"""A file of every kind: small ones, which are read sooner."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from babbling.axes import Axis
from babbling.body_image import BodyImage, learn_image
from babbling.files import save
from babbling.forward_model import ForwardModel
from babbling.looking import LookingMind, pilot_looking
from babbling.loop import babble
from babbling.mind import Mind, learn
from babbling.mirroring import mirror_babble
from babbling.organs import find_organs
from babbling.own_eyes import OwnEyes
from experiments.shared.journal import Episode as Stood
from experiments.shared.journal import Lived
from experiments.shared.minds import Interrupted
from imitation.acting.rehearsal import EAGERNESS
from imitation.deferred import ActMemory, FaceMemory, HeadMemory, IntentMemory, StepMemory
from imitation.episodes import Episode
from models.loading import load_body
from tests.babbling import soles
from tests.babbling.creature import Creature, motors, schema
from tests.babbling.faces import small_mind
from tests.babbling.test_looking import REACH, GeometricHead
from tests.babbling.test_play import played

FILES: dict[str, Callable[[Mind], object]] = {
    "mind": lambda mind: mind,
    "interrupted babble": lambda mind: interrupted(mind),
    "interrupted learning to stand": lambda mind: Lived((Stood(np.ones((4, 9))), Stood(np.zeros((2, 9))))),
    "eyes": lambda mind: eyes(),
    "body image": lambda mind: learned_image(),
    "balance": lambda mind: soles.stood(np.random.default_rng(0)),
    "maze memory": lambda mind: StepMemory(counted_moves(), (walk(1, [3, 4, 4], [1, 1]), walk(0, [7], []))),
    "play": lambda mind: played(0),
    "own eyes": lambda mind: OwnEyes("e", np.array([0, 2]), *np.zeros((3, 2)), np.ones((3, 36)), 0.003),
    "act memory": lambda mind: ActMemory("b", "panel", np.array([0, 6]), np.array([0.2, 0.8])),
    "intention memory": lambda mind: IntentMemory("b", "cup", np.array([0.2, 0.8]), 0.9, np.array([0, 3])),
    "head memory": lambda mind: HeadMemory("b", 0.02, "nod", np.full((4, 2), 0.1), np.full((4, 2), 0.01)),
    "face mind": lambda mind: small_mind(),
    "face memory": lambda mind: FaceMemory("b", np.full(8, 0.2), np.array([1, 1, 0, 0, 0, 0, 0, 0])),
}


def interrupted(mind: Mind) -> Interrupted:
    felt = np.full((2, len(EAGERNESS), len(mind.forward_model.factors)), 0.1)
    return Interrupted(mind, 1.0, 0.1, 1, np.array([[0.5, 0.02, 0.03]]), felt, np.array([1.0, 2.0]))


def eyes() -> LookingMind:
    """A head that has looked about for a moment."""
    found = pilot_looking(GeometricHead(), REACH, 0)
    return LookingMind(found, babble(GeometricHead(), found, (12,), 0), 0.5)


def learned_image() -> BodyImage:
    body = Creature()
    seen, end = mirror_babble(body, body, schema(), motors(), 3.0, 0), np.full(5, 1.5)
    return learn_image(seen, find_organs(seen), -end, end, 0 * end, 0, body.fingerprint)


def walk(goal: int, states: list[int], actions: list[int]) -> Episode:
    return Episode(goal, np.array(states), np.array(actions, int))


def counted_moves() -> ForwardModel:
    moves = ForwardModel((), Axis.categorical("action", ("N", "S")), Axis.categorical("outcome", ("N", "S", "X")))
    moves.observe((), np.array([[0], [0], [1]]), np.array([[0], [2], [1]]))
    return moves


def write_kinds(arm: Path, folder: Path, patch: pytest.MonkeyPatch) -> dict[str, Path]:
    """A file of every kind in a folder; small ones, which are tried sooner, as long as the patch lasts."""
    for name, size in (("looking.GRID", (3, 3, 3, 5, 7)), ("frame.GRID", (3, 9, 9)), ("balance.CELLS", (5, 5, 7))):
        patch.setattr(f"babbling.{name}", size)
    paths, mind = {name: folder / f"{name}.nc" for name in FILES}, learn(load_body(arm, copies=8), minutes=0.5, seed=0)
    for name, path in paths.items():
        save(FILES[name](mind), path)
    return paths
