"""README's list of what the imitator is told, held to the code: nothing else goes through the door."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from babbling.body import Body
from babbling.mind import Mind, learn
from babbling.mirroring import mirror_babble
from experiments.gaze.run import LESSONS, SHOWN_TRIALS
from experiments.shared.caregiver import CARE_DEG, FACE
from experiments.shared.eyes import LARGEST, REACH_PAN
from imitation.acting.loop import imitate
from imitation.acting.movement import Movement
from imitation.acting.rehearsal import REHEARSERS, made_up_movement, rehearse
from models.hoap2.facts import JOINTS
from models.loading import load_body
from models.mirror import Mirror
from models.robots import ROBOTS, head_of
from models.teachers.performance import PARTS
from tests.babbling.creature import Creature, motors, schema

ROOT = Path(__file__).resolve().parents[1]
TOLD = (ROOT / "README.md").read_text().split("## What the imitator is told\n")[1].split("\n## ")[0]
PROTOCOL = {name for name in vars(Body) if not name.startswith("_")}


class Door:
    """A body of which nothing can be asked but what the protocol says."""

    def __init__(self, body: Any) -> None:
        self.__body = body

    def __getattr__(self, name: str) -> Any:
        assert name in PROTOCOL, f"the mind asked its body for {name!r}"
        return getattr(self.__body, name)


def sources(*packages: str) -> Iterator[tuple[str, ast.Module]]:
    for package in packages:
        for file in sorted((ROOT / package).rglob("*.py")):
            yield str(file.relative_to(ROOT)), ast.parse(file.read_text())


def said(tree: ast.Module) -> set[str]:
    """Texts in the code, docstrings left aside."""
    papers = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    texts = (node for node in ast.walk(tree) if isinstance(node, ast.Constant) and id(node) not in papers)
    return {node.value for node in texts if isinstance(node.value, str)}


def test_a_mind_asks_its_body_for_nothing_but_the_protocol(arm: Path, arm_mind: Mind, hasty: None) -> None:
    def through(door: Any) -> tuple[Mind, Movement, np.ndarray]:
        mind = learn(door(load_body(arm, copies=8)), minutes=0.2, seed=0)
        movement = made_up_movement(door(load_body(arm)), arm_mind, np.random.default_rng(1), seconds=1.0)
        [attempt] = imitate(door(load_body(arm)), movement, arm_mind, rng=np.random.default_rng(2))
        tempered = rehearse(door(load_body(arm, copies=REHEARSERS)), arm_mind, 0)
        return mind, movement, np.concatenate([attempt.senses.ravel(), tempered.temper.eagerness])

    (one, seen, felt), (other, same, again) = through(Door), through(lambda body: body)
    np.testing.assert_array_equal(one.forward_model.moments, other.forward_model.moments)
    np.testing.assert_array_equal(one.forward_model.table.counts, other.forward_model.table.counts)
    np.testing.assert_array_equal(seen.senses, same.senses)
    np.testing.assert_array_equal(felt, again)


def test_a_mirror_is_asked_for_parts_and_directions_alone() -> None:
    creature = Creature(copies=4)
    seen = mirror_babble(Door(creature), creature, schema(), motors(), 0.4, 0)
    assert seen.directions.shape[1:] == (4, len(creature.parts), 3)
    assert {name for name in vars(Mirror(load_body("hoap2"))) if not name.startswith("_")} == {"parts", "noise"}


def test_the_minds_side_has_no_word_for_joints_parts_or_channels() -> None:
    heads = {motor for robot in ROBOTS.values() if robot.head for motor in robot.head.motors}
    words = {*JOINTS, *PARTS, *heads, "angle", "place", "speed"}
    assert {name: said(tree) & words for name, tree in sources("babbling", "imitation") if said(tree) & words} == {}


def test_channels_read_by_name_are_the_listed_ones() -> None:
    names = re.compile(r"senses\.(?:read|lines)\((?:[^()]|\([^()]*\))*?['\"]([\w ]+)['\"]")
    asked = {found for _, tree in sources("experiments") for found in names.findall(ast.unparse(tree))}
    assert asked <= set(re.findall(r"`(\w+)`", TOLD))


def test_everything_that_a_body_offers_stands_in_the_list() -> None:
    acts = {"act", "fingerprint"}  # what is done, and what guards files
    assert PROTOCOL - acts <= set(re.findall(r"`(\w+)`", TOLD))


def test_numbers_of_the_list_are_those_of_the_code() -> None:
    lessons = int(re.search(r"(\d+) lessons in which", TOLD)[1])  # type: ignore[index]
    labelled = int(re.search(r"(\d+) labelled lessons", TOLD)[1])  # type: ignore[index]
    assert (lessons, labelled) == (LESSONS, SHOWN_TRIALS)
    assert f"within {CARE_DEG:g} deg" in TOLD and f"{REACH_PAN:.2f} rad of pan" in TOLD and len(FACE) == 5
    assert all(f"{largest:.2f}" in TOLD for largest in LARGEST)
    assert head_of("biclops").tilt != head_of("hoap2").tilt  # "the head's own reach of tilt"


def test_hand_set_numbers_are_as_many_as_the_list_says() -> None:
    count = 0
    for _, tree in sources("babbling", "imitation"):
        for node in tree.body:
            told = {ast.Assign: lambda one: one.targets[0], ast.AnnAssign: lambda one: one.target}.get(type(node))
            if told and node.value and isinstance(target := told(node), ast.Name | ast.Tuple):
                names = [one.id for one in ast.walk(target) if isinstance(one, ast.Name)]
                values = [one.value for one in ast.walk(node.value) if isinstance(one, ast.Constant)]
                if all(name.lstrip("_").isupper() for name in names) and {int, float} & set(map(type, values)):
                    count += len(names)
    about = int(re.search(r"About (\d+) capitals", TOLD)[1])  # type: ignore[index]
    assert count == pytest.approx(about, rel=0.12)
