"""`imitate correspondence`: as near as inverse kinematics whatever the wiring, the size and the way of a teacher."""

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from types import MethodType
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from rerun.chunk import RrdReader

import experiments.correspondence.run
import experiments.shared.mirrors
from babbling.mirroring import MirrorExperience, angles_between, mirror_babble
from babbling.organs import find_organs
from babbling.pilot import Pilot, pilot
from experiments.__main__ import main
from experiments.correspondence.acts import HARDER, Hard, put_to_parts, seen_hard
from experiments.correspondence.recording import coloured
from experiments.shared.minds import body_of
from experiments.shared.mirrors import Pupil, image_of, look_into_mirror
from experiments.shared.options import BodyOptions
from experiments.shared.oracle import Retargeted, retarget
from experiments.shared.palette import REPLAYED, SERIES
from models.body import SimulatedBody
from models.teachers.anatomy import BodyPoses, perform
from models.teachers.cmu import perform_amc
from models.teachers.performance import Performance
from models.teachers.performing import joint_motion, perform_motion
from models.teachers.robots import load
from tests.babbling.creature import Creature, directions, motors, schema

COPIES = 24


def obeys(self: SimulatedBody, motors: NDArray[np.float64]) -> NDArray[np.float64]:
    """A body without inertia, which is where it is told to be: mirrors show postures, not dynamics."""
    low, high = self.joint_range.T
    self.batch.qpos[:, self._qpos] = np.clip(self.commands(motors), low, high)
    return self._feel()


def babbled_without_inertia(body: SimulatedBody, *rest: Any, **more: Any) -> MirrorExperience:
    body.act = MethodType(obeys, body)  # type: ignore[method-assign]
    return mirror_babble(body, *rest, **more)


@pytest.fixture(scope="module")
def quick() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(experiments.shared.mirrors, "mirror_babble", babbled_without_inertia)
        patch.setattr(experiments.shared.mirrors, "COPIES", COPIES)
        patch.setattr(experiments.correspondence.run, "CURVE_POINTS", 1)
        yield


@pytest.fixture(scope="module")
def found() -> dict[int | None, Pilot]:
    """Body schemas, straight and scrambled; with dynamics."""
    return {wiring: pilot(body_of(BodyOptions(scramble=wiring), 8), 0) for wiring in (None, 4)}


def through(pilot: Pilot, scramble: int | None, noise_deg: float, seen: Performance) -> tuple[Retargeted, Retargeted]:
    options = BodyOptions(scramble=scramble)
    image = image_of(look_into_mirror(options, pilot, 5.0, noise_deg), options, pilot)
    body, oracle = body_of(options, 1), retarget(seen)
    return Pupil(body, pilot, image, noise_deg).follow(seen, np.random.default_rng(0)), oracle


def beyond_oracle(found: Retargeted, oracle: Retargeted) -> float:
    reachable = oracle.found.reachable
    return found.mean_error_deg(reachable) - oracle.mean_error_deg(reachable)


@pytest.mark.parametrize(("scramble", "noise_deg", "allowed"), [(None, 0.0, 0.3), (4, 0.0, 0.3), (4, 3.0, 2.5)])
def test_as_near_as_inverse_kinematics(
    quick: None, found: dict[int | None, Pilot], scramble: int | None, noise_deg: float, allowed: float
) -> None:
    seen = perform_motion("icub", joint_motion("icub-reach"))
    learned, oracle = through(found[scramble], scramble, noise_deg, seen)
    assert beyond_oracle(learned, oracle) <= allowed
    pace = np.abs(np.diff(learned.angles, axis=0)) / 0.02
    assert np.quantile(pace, 0.999) <= 5.0


@pytest.mark.parametrize("clip", [None, "02_01.amc"])
def test_without_names_it_is_imitated_all_the_same(
    quick: None, found: dict[int | None, Pilot], clip: str | None, request: pytest.FixtureRequest
) -> None:
    """What is taken for another part pointed alike all the time, so the movement is the same."""
    seen = perform_motion("icub", joint_motion("icub-reach"))
    if clip:
        seen = perform_amc(request.getfixturevalue("cmu") / clip)
    image = image_of(look_into_mirror(BodyOptions(), found[None], 5.0), BodyOptions(), found[None])
    pupil = Pupil(body_of(BodyOptions(), 1), found[None], image, named=False)
    learned = pupil.follow(seen, np.random.default_rng(0))
    assert learned.recognised["parts_alike_share"] == 1
    assert clip is None or learned.recognised["parts_right_share"] == 1
    assert beyond_oracle(learned, retarget(seen)) <= 0.3


def changed(poses: BodyPoses, scale: float, heading: NDArray[np.float64], way: NDArray[np.float64]) -> BodyPoses:
    """Arms and legs of other lengths, the whole body turned by heading (T,) and carried along the way (T, 3)."""
    cosine, sine, none = np.cos(heading), np.sin(heading), np.zeros_like(heading)
    turn = np.stack([cosine, -sine, none, sine, cosine, none, none, none, none + 1], 1).reshape(-1, 3, 3)
    at = dict(poses.positions)
    for side in ("left", "right"):
        for chain in (("shoulder", "elbow", "wrist"), ("hip", "knee", "ankle")):
            for inner, outer in pairwise(chain):
                bone = poses.positions[f"{side}_{outer}"] - poses.positions[f"{side}_{inner}"]
                at[f"{side}_{outer}"] = at[f"{side}_{inner}"] + scale * bone
    return BodyPoses(
        {name: turn @ value for name, value in poses.rotations.items()},
        {name: np.einsum("tij,tj->ti", turn, value) + way for name, value in at.items()},
    )


@pytest.mark.parametrize("scale", [0.5, 3.0])
def test_size_heading_and_walking_away_change_nothing(
    quick: None, found: dict[int | None, Pilot], scale: float
) -> None:
    trajectory = joint_motion("talos-salute")
    poses, upright = load("talos").motion(load("talos").postures(trajectory)), load("talos").reference
    count = len(trajectory.time)
    heading, way = np.linspace(1, 3, count), np.linspace(0, 5, count)[:, None] * [1.0, 0.5, 0]
    other = changed(poses, scale, heading, way)
    grown = changed(upright, scale, np.zeros(1), np.zeros((1, 3)))
    one = perform("one", "talos", trajectory.time, poses, upright)
    two = perform("two", "talos", trajectory.time, other, grown)
    image = image_of(look_into_mirror(BodyOptions(), found[None], 3.0), BodyOptions(), found[None])
    body = body_of(BodyOptions(), 1)
    a, b = (Pupil(body, found[None], image).follow(seen, np.random.default_rng(0)) for seen in (one, two))
    np.testing.assert_allclose(a.angles, b.angles, atol=np.deg2rad(0.05))


@pytest.fixture(scope="module")
def done(quick: None, hasty: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("correspondence") / "result"
    words = ["--demonstrations", "talos-salute", "--mirror-minutes", "6", "--acts", "40", "--tries", "4"]
    words += ["--learners", "2", "--harder-acts", "2"]
    assert main(["correspondence", *words, "--out", str(out)]) == 0
    return out


def test_what_a_run_leaves_behind(done: Path) -> None:
    assert {path.name for path in done.iterdir()} == {
        "config.json", "metrics.json", "report.html", "recording.rrd", "body_image.nc", "structure.png", "teachers.png",
        "learning_curve.png", "tries.png", "harder_acts.png",
    }  # fmt: skip
    metrics = json.loads((done / "metrics.json").read_text())
    assert metrics["organ_identification_rate"] >= 0.95
    assert metrics["limb_direction_error_deg"] <= metrics["ik_limb_direction_error_deg"] + 0.3
    assert metrics["worst_beyond_ik_noisy_deg"] <= 2.5
    assert metrics["last_try_error_deg"] < metrics["first_try_error_deg"]
    assert set(metrics["organ_harder"]) == set(HARDER)
    assert metrics["unreachable_frames"] == 0 and metrics["correspond_p50_ms"] > 0


PAIRS = ("head", "left_thigh", "right_thigh")


def test_acts_are_as_hard_as_asked() -> None:
    rng = np.random.default_rng(5)
    shown = rng.standard_normal((400, 3, 3))
    shown /= np.linalg.norm(shown, axis=-1, keepdims=True)
    np.testing.assert_array_equal(seen_hard(shown, PAIRS, Hard(noise_deg=0.0), rng), shown)
    np.testing.assert_array_equal(seen_hard(shown, PAIRS, Hard(noise_deg=0.0, exchanged=1.0), rng), shown[:, [0, 2, 1]])
    half = seen_hard(shown, PAIRS, Hard(noise_deg=0.0, exchanged=0.5), rng)
    assert (half[:, 1] == shown[:, 2]).all(1).mean() == pytest.approx(0.5, abs=0.1)
    noisy = seen_hard(shown, PAIRS, Hard(noise_deg=3.0), rng)
    assert np.rad2deg(angles_between(noisy, shown)).mean() == pytest.approx(3 * np.sqrt(np.pi / 2), rel=0.05)


def test_rules_agree_on_a_plain_act_and_the_largest_turn_takes_what_is_carried() -> None:
    experience = mirror_babble(creature := Creature(), creature, schema(), motors(), 8.0, 0)
    organs = find_organs(experience)
    way = np.clip((np.arange(50) - 9) / 30, 0, 1)[:, None]
    said = {part: put_to_parts(organs, directions(0.8 * way * np.eye(5)[part]), 0.02) for part in range(1, 5)}
    assert all(rules[0] == rules[1] == part for part, rules in said.items())
    assert said[2][2] == 2 and said[4][2] == 4  # forearms turn alone
    small = put_to_parts(organs, directions(0.02 * way * np.eye(5)[2]), 0.02)
    assert small[0] == small[1] == 2  # the size tells nothing


def test_recording_holds_both_bodies_and_the_organ(done: Path) -> None:
    reader = RrdReader(done / "recording.rrd")
    paths = {str(chunk.entity_path) for chunk in reader.stream(store=reader.recordings()[0])}
    wanted = {"world/directions/teacher", "world/directions/imitator", "world/teacher", "organ/identified", "structure"}
    assert wanted <= {path.strip("/") for path in paths}


def test_a_part_has_one_colour_and_nothing_has_none() -> None:
    probability = np.full((4, 11), 0.01)
    probability[:, 3], probability[:, 10] = 0.4, 0.5
    names = [*"abcdefghij", "nothing"]
    colours = coloured(names, probability)
    assert list(colours) == names and colours["d"] == SERIES[0] and colours["nothing"] == REPLAYED
    assert len({*colours.values()}) == 1 + len(SERIES)


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["correspondence", "--acts", "0"], "--acts 0: it must lie between 1 and 100000"),
        (["correspondence", "--seeing-noise-deg", "99"], "--seeing-noise-deg 99: it must lie between 0 and 30"),
        (["correspondence", "--mirror-minutes", "0"], "--mirror-minutes 0: it must be more than 0"),
        (["correspondence", "--demonstrations", "icub-wav"], "did you mean 'icub-wave'"),
        (["gesture", "--seeing-noise-deg", "-1"], "--seeing-noise-deg -1: it must lie between 0 and 30"),
        (["gesture", "--motion", "README.md"], "only a robot's .urdf performs a motion, 'icub-wave' is none"),
    ],
)
def test_bad_options_are_answered_in_a_line(words: list[str], reason: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words) == 2
    said = capsys.readouterr().err
    assert reason in said and said.count("\n") == 1
