"""An infant watches a face and does the same; what it remembers, it does later; a study's figures are what they say."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from babbling.dark import FaceMind
from babbling.files import load
from babbling.relations import RELATIONS
from experiments.errors import ExperimentError
from experiments.face import once, one, recording
from experiments.face.answering import Answers, together
from experiments.face.found import confusion, falling, tries_until
from experiments.face.infants import HABITS, Group, raised
from experiments.face.later import after_day, after_pacifier
from experiments.face.options import Config
from experiments.face.run import run
from experiments.face.study import EACH, VIEWS, lookings
from experiments.face.theories import GESTURES, LABELS
from experiments.shared.experiment import publish
from imitation.deferred import FaceMemory
from imitation.errors import ImitationError
from models.errors import BodyError
from models.face import FACES

QUICK = Config(acts=150, tries=2, gesture="tongue out", adult="adult-long")


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """What a quick run leaves; few frames are looked at."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(one, "NEUTRAL_TICKS", 1)
        for module in (once, one, recording):
            patch.setattr(module, "TICK_S", 0.1)
        patch.setattr(recording, "ACT_TICKS", 3)
        config = replace(QUICK, out=tmp_path_factory.mktemp("face") / "run")
        yield publish("face", config, run(config))


def test_it_does_what_it_saw_and_says_so(shown: Path) -> None:
    found = json.loads((shown / "metrics.json").read_text())
    assert max(found["organ"], key=lambda name: found["organ"][name]) == "tongue"
    assert sum(found["organ"].values()) == pytest.approx(1)
    assert found["done"] == ["tongue out"] * 2 and found["match_error_share"][-1] < 0.1
    assert set(found["moved"]) == {"gap", "beyond"}


def test_the_recording_holds_what_was_seen_felt_and_believed(shown: Path) -> None:
    found = json.loads((shown / "metrics.json").read_text())
    reader = RrdReader(shown / "recording.rrd")
    chunks = {str(chunk.entity_path): chunk for chunk in reader.stream(store=reader.recordings()[0])}
    assert {"/eyes/left", "/relations/seen_beyond", "/relations/felt_beyond", "/world/infant/jaw"} <= set(chunks)
    series = [
        chunk.to_record_batch().column("Scalars:scalars").to_pylist()
        for chunk in reader.stream(store=reader.recordings()[0])
        if str(chunk.entity_path) == "/organ/tongue" and "Scalars:scalars" in chunk.to_record_batch().schema.names
    ]
    assert series[0][-1][0] == pytest.approx(found["organ"]["tongue"], abs=1e-6)


def test_what_is_remembered_is_done_another_day(shown: Path, tmp_path: Path) -> None:
    before = {name: (shown / name).read_bytes() for name in ("mind.nc", "memory.nc")}
    later = run(replace(QUICK, mind=shown / "mind.nc", memory=shown / "memory.nc"))
    assert later.metrics["done"] == ["tongue out"] * 2 and later.metrics["gesture"] is None
    assert before == {name: (shown / name).read_bytes() for name in before}
    with pytest.raises(ImitationError, match="belongs to another body"):
        load(shown / "memory.nc", FaceMemory).check("somebody else", len(RELATIONS))
    with pytest.raises(Exception, match="learned by another body"):
        run(replace(QUICK, face="newborn-worn", mind=shown / "mind.nc", memory=shown / "memory.nc"))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"gesture": "wink"}, "unknown gesture"),
        ({"face": "toddler"}, "unknown face"),
        ({"infants": 0}, "--infants 0"),
        ({"acts": 1}, "--acts 1"),
        ({"distance": 3.0}, "--distance 3"),
        ({"memory": Path("x.nc")}, "--mind"),
    ],
)
def test_what_cannot_be_meant_is_refused(change: dict[str, object], said: str) -> None:
    with pytest.raises((ExperimentError, BodyError), match=said) as error:
        replace(QUICK, **change).check()  # type: ignore[arg-type]
    assert len(str(error.value).splitlines()) == 1


def test_infants_are_themselves_in_whatever_company() -> None:
    """Also: their own acts are of their own organs."""
    both = raised(Group(FACES["newborn"], 0, 2, 90, 5))
    assert not np.array_equal(both[0].mind.motors, []) and not np.array_equal(both[0].habits, both[1].habits)
    again = raised(Group(FACES["newborn"], 0, 2, 90, 5))
    for first, second in zip(both, again, strict=True):
        np.testing.assert_array_equal(first.habits, second.habits)
        np.testing.assert_array_equal(first.mind.forward_model.counts, second.mind.forward_model.counts)
    assert sum(share for _, share in HABITS.values()) == pytest.approx(1)
    assert both[0].habit.min() >= 0 and both[0].habit.max() < LABELS


def test_memories_outlast_a_pacifier_and_a_process() -> None:
    group = Group(FACES["newborn"], 0, 1, 150, 5)
    [infant] = raised(group)
    target = infant.mind.still.copy()
    target[[0, 1]] = 0.4, 0.3
    memory = FaceMemory(infant.mind.fingerprint, target, np.array([1, 1, 0, 0, 0, 0, 0, 0]))
    found = after_pacifier(group, [infant], [memory], [], 2)
    assert found.stopped[0] != 0 and (found.labels == 0).all()
    assert (after_day(group, [infant], [memory], 1) == 0).all()
    assert isinstance(infant.mind, FaceMind)


def answers(labels: list[list[int]], gesture: list[int]) -> Answers:
    """One infant's."""
    count, tries = len(gesture), len(labels[0])
    nothing = np.zeros((1, count, tries))
    return Answers(
        gesture=np.array([gesture]), strong=np.ones((1, count), bool), metres=np.full((1, count), 0.3),
        front=np.ones((1, count), bool), organ=np.eye(6)[[[1] * count]], peers=np.ones((2, 1, count), np.int64),
        labels=np.array([labels]), missed=nothing, felt=nothing, tongue_mm=nothing, line=nothing[..., 0],
    )  # fmt: skip


def test_figures_of_a_study_are_what_they_say() -> None:
    both = together([answers([[0, 0], [0, 2]], [0, 2]), answers([[0, 6], [2, 2]], [0, 2])])
    table = confusion(both, both.strong)
    assert table["tongue out"]["tongue out"] == table["tongue out"]["nothing"] == 0.5
    assert table["mouth open"]["mouth open"] == 1.0
    assert both.right.tolist() == [[True, False]] * 2  # tongue for tongue, tongue for jaw
    np.testing.assert_array_equal(falling(np.array([[0.1, 0.05, 0.06, 0.01]])), [True, False, True])
    np.testing.assert_array_equal(tries_until(np.array([[0.1, 0.02, 0.5], [0.1, 0.2, 0.3]])), [2, 4])


def test_the_bank_is_seen_from_everywhere_once() -> None:
    views = lookings(3)
    assert len({one.seed for one in views}) == len(views)
    assert sum(one.condition != "course" for one in views) == sum(map(len, VIEWS.values()))
    assert EACH * len(GESTURES) * 2 >= 36
