"""`imitate gesture` as a user runs it: every number in metrics.json can be had again from the recording."""

import io
import json
import shlex
import shutil
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rerun.chunk import RrdReader

from babbling.mirroring import angles_between
from experiments.__main__ import main
from experiments.shared.oracle import at_ticks, retarget
from experiments.shared.watching import Seen, watch
from models.hoap2.facts import JOINTS as HOAP2
from models.hoap2.kinematics import directions
from models.loading import load_body
from models.motion import read_motion
from models.teachers.performing import perform

KEYS = {
    "joint_rmse_deg",
    "joint_rmse_deg_by_joint",
    "direct_replay_rmse_deg",
    "attempts_rmse_deg",
    "babbling_transitions",
    "babbling_body_minutes",
    "babbling_wall_s",
    "babbling_efficiency_factor",
    "select_p50_ms",
    "select_p99_ms",
    "linear_peer_rmse_deg",
    "retarget_error_deg",
    "uninformed_selections",
    "seed",
}
WITHOUT_MIRROR = ("--correspondence", "ik", "--babbling-minutes", "0.3")
JOINTS = ("shoulder", "elbow", "wrist")
ROOT = Path(__file__).resolve().parents[2]


def gesture(arm: Path, wave: Path, out: Path, *more: str) -> dict[str, object]:
    common = ["gesture", "--robot", str(arm), "--demonstration", str(wave), "--out", str(out)]
    assert main([*common, "--babbling-minutes", "1", *more]) == 0
    found: dict[str, object] = json.loads((out / "metrics.json").read_text())
    return found


@pytest.fixture(scope="module")
def told(arm: Path, wave: Path, hasty: None, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A run, and its last line."""
    out, said = tmp_path_factory.mktemp("gesture") / "result", io.StringIO()
    with redirect_stdout(said):
        gesture(arm, wave, out, "--attempts", "2", "--threads", "1", "--seed", "3")
    return out, said.getvalue().splitlines()[-1]


@pytest.fixture(scope="module")
def done(told: tuple[Path, str]) -> Path:
    return told[0]


def test_the_last_line_opens_what_was_made(told: tuple[Path, str]) -> None:
    way, page = told[1].removeprefix("to open it: ").split("; ")
    viewer, recording = shlex.split(way)
    assert shutil.which(viewer) and Path(recording) == told[0] / "recording.rrd" and Path(recording).exists()
    assert shlex.split(page.removesuffix(" in a browser")) == [str(told[0] / "report.html")]


def metrics(out: Path) -> dict[str, object]:
    found: dict[str, object] = json.loads((out / "metrics.json").read_text())
    return found


def series(recording: Path) -> dict[str, np.ndarray]:
    """Entity -> its scalars through time."""
    reader = RrdReader(recording)
    found: dict[str, list[np.ndarray]] = {}
    for chunk in reader.stream(store=reader.recordings()[0]):
        batch = chunk.to_record_batch()
        if not chunk.is_static and "Scalars:scalars" in batch.schema.names:
            assert {"sim_time", "step"} <= set(chunk.timeline_names)
            values = np.array(batch.column("Scalars:scalars").flatten(), float)
            order = np.array(batch.column("step"))
            found.setdefault(str(chunk.entity_path), []).append(values[np.argsort(order)])
    return {entity: np.concatenate(parts) for entity, parts in found.items()}


def test_everything_is_there(done: Path) -> None:
    names = {p.name for p in done.iterdir()}
    assert {"config.json", "metrics.json", "recording.rrd"} <= names and any(n.endswith(".png") for n in names)
    assert metrics(done).keys() >= KEYS
    config = json.loads((done / "config.json").read_text())
    assert config["options"]["attempts"] == 2 and config["options"]["seed"] == 3
    assert set(config["files"]) == names
    assert [p for p in done.parent.iterdir()] == [done]  # nothing half done beside it


def bars(recording: Path, entity: str) -> tuple[np.ndarray, np.ndarray]:
    """(T, N) rows of a bar chart that changes, and (N,) where its bars stand."""
    reader, found = RrdReader(recording), {}
    for chunk in reader.stream(store=reader.recordings()[0]):
        if str(chunk.entity_path) == entity:
            batch = chunk.to_record_batch()
            for name in {"BarChart:values", "BarChart:abscissa"} & set(batch.schema.names):
                rows = [row[0]["buffer"] for row in batch.column(name).to_pylist() if row]
                found[name] = np.array(rows)
    return found["BarChart:values"], found["BarChart:abscissa"][0]


def test_the_error_can_be_recomputed_from_the_recording(done: Path) -> None:
    told = metrics(done)
    seen = series(done / "recording.rrd")
    error = {j: seen[f"/joints/{j}/imitated"] - seen[f"/joints/{j}/demonstrated"] for j in JOINTS}
    assert np.sqrt(np.mean([e**2 for e in error.values()])) == pytest.approx(told["joint_rmse_deg"], abs=1e-4)
    for joint, e in error.items():
        assert np.sqrt(np.mean(e**2)) == pytest.approx(told["joint_rmse_deg_by_joint"][joint], abs=1e-4)
    replay = [seen[f"/joints/{j}/replayed"] - seen[f"/joints/{j}/demonstrated"] for j in JOINTS]
    assert np.sqrt(np.mean(np.square(replay))) == pytest.approx(told["direct_replay_rmse_deg"], abs=1e-4)


def test_every_other_figure_of_joints_can_be_had_again_too(done: Path) -> None:
    told, seen = metrics(done), series(done / "recording.rrd")
    goals = np.stack([seen[f"/joints/{j}/demonstrated"] for j in JOINTS], 1)
    error = np.stack([seen[f"/joints/{j}/imitated"] for j in JOINTS], 1) - goals
    by_joint = np.sqrt(np.mean(error**2, axis=0))
    assert told["worst_joint"] == JOINTS[by_joint.argmax()]
    assert told["worst_joint_deg"] == pytest.approx(by_joint.max(), abs=1e-4)
    assert told["largest_error_deg"] == pytest.approx(np.abs(error).max(), abs=1e-4)
    assert told["moving_joints_rmse_deg"] == pytest.approx(told["joint_rmse_deg"])  # all of them move
    assert told["ringing_worst_deg"] >= told["ringing_deg"] > 0
    assert told["approach_error_deg"] < 0.2
    assert told["slowed_factor"] == 1 and told["demonstration_changed_deg"] == 0 and told["limb_error_deg"] is None


@pytest.mark.parametrize("faster", [2.0, 3.0])
def test_a_movement_too_fast_is_slowed_and_keeps_its_shape(
    arm: Path, hasty: None, tmp_path: Path, faster: float
) -> None:
    """Joint angles at that many times the speed limit of 5 rad/s."""
    t = np.arange(0, 0.6, 0.002)
    angles = np.stack([0.5 * np.sin(10 * faster * t), 0.8 + 0 * t, 0 * t], 1)
    path = tmp_path / "fast.csv"
    rows = [",".join(map(repr, (moment, *row))) for moment, row in zip(t.tolist(), angles.tolist(), strict=True)]
    path.write_text("\n".join(["time,shoulder,elbow,wrist", *rows]) + "\n")
    body = load_body(arm)
    seen = watch(str(path), body)
    assert seen.slowed == pytest.approx(faster, rel=0.01)
    assert np.abs(np.diff(seen.angles, axis=0)).max() <= 5 * body.tick_s
    late = np.arange(len(seen.angles)) * body.tick_s / seen.slowed
    assert late[-1] <= t[-1] < late[-1] + 2 * body.tick_s
    np.testing.assert_allclose(seen.angles[:, 0], 0.5 * np.sin(10 * faster * late), atol=0.02)
    np.testing.assert_array_equal(body.sensations(seen.angles), seen.movement.senses)


def test_a_teacher_too_fast_is_compared_with_at_the_same_pace() -> None:
    usual, body = perform("g1-squat"), load_body("hoap2")
    fast = replace(usual, time=usual.time / 3)
    oracle = retarget(fast)
    paced = Seen.paced("fast", oracle.angles, oracle.found.slowed, body)
    seen = replace(paced, performance=fast, oracle=oracle)
    assert 1.5 < seen.slowed < 3 and seen.teacher is not None
    showed = np.stack([*at_ticks(seen.teacher, body.tick_s).values()], 1)[: len(seen.angles)]
    assert np.rad2deg(angles_between(directions(seen.angles), showed)).mean() < 0.3
    assert np.rad2deg(angles_between(directions(seen.angles[:60]), oracle.teacher[:60])).mean() > 3


def test_the_headline_is_where_the_body_points_against_the_teacher(hasty: None, tmp_path: Path) -> None:
    """Once more by other means: recorded angles, Pinocchio's kinematics, the teacher's own directions (a whole run of
    the robot with limbs, so it takes a while)."""
    out = tmp_path / "squat"
    assert main(["gesture", "--demonstration", "g1-squat", *WITHOUT_MIRROR, "--out", str(out)]) == 0
    told, seen = metrics(out), series(out / "recording.rrd")
    assert told["slowed_factor"] == 1
    showed = np.stack([way for way in at_ticks(perform("g1-squat"), 0.02).values()], 1)
    for who, key in (("imitated", "limb_error_deg"), ("replayed", "direct_replay_limb_error_deg")):
        angles = np.deg2rad(np.stack([seen[f"/joints/{joint}/{who}"] for joint in HOAP2], 1))
        away = np.rad2deg(angles_between(directions(angles), showed))
        assert told[key] == pytest.approx(away.mean(), abs=1e-3)
        np.testing.assert_allclose(seen[f"/limbs/{who}"], away.mean(1), atol=1e-3)
    assert told["limb_error_deg"] == pytest.approx(np.mean([*told["limb_error_deg_by_part"].values()]))
    assert told["limb_error_deg"] < told["limb_reachable_deg"] + 0.1 < told["direct_replay_limb_error_deg"]
    assert 0 < told["demonstration_changed_mean_deg"] < told["demonstration_changed_deg"] < 1
    assert told["limb_error_steadied_deg"] == pytest.approx(told["limb_error_deg"], abs=0.05)  # seen without noise


def test_what_was_demonstrated_is_the_file_at_fifty_hertz(done: Path, wave: Path) -> None:
    wanted = np.rad2deg(read_motion(wave).reordered(JOINTS).angles)
    seen = series(done / "recording.rrd")
    for number, joint in enumerate(JOINTS):
        np.testing.assert_allclose(seen[f"/joints/{joint}/demonstrated"], wanted[:, number], atol=1e-4)


def test_the_recording_opens_on_its_blueprint_and_shows_the_beliefs(done: Path) -> None:
    reader = RrdReader(done / "recording.rrd")
    assert len(reader.recordings()) == 1 and len(reader.blueprints()) == 1
    store = reader.store(store=reader.recordings()[0])
    paths = {str(path) for path in store.schema().entity_paths()}
    assert "/summary" in paths
    for root in (
        "/world/imitator/",
        "/world/sub-goals/",
        "/world/teacher/",
        "/belief/",
        "/loop/",
        "/figures/",
        "/error/",
    ):
        assert any(path.startswith(root) for path in paths), root
    columns = {column.name for column in store.schema().index_columns()}
    assert {"sim_time", "step"} <= columns
    steps = []
    for chunk in reader.stream(store=reader.recordings()[0]):
        if str(chunk.entity_path) == "/world/imitator/hand" and not chunk.is_static:
            batch = chunk.to_record_batch()
            steps.append(np.diff(np.array(batch.column("sim_time").cast("int64"))))
            places = np.array(batch.column("Transform3D:translation").flatten().flatten()).reshape(-1, 3)
            assert np.ptp(places, axis=0).max() > 0.1  # it moves
    np.testing.assert_array_equal(np.concatenate(steps), 20_000_000)  # 50 Hz, ns
    assert (done / "recording.rrd").stat().st_size < 30e6 * 2 / 20


def test_the_loop_that_is_shown_is_the_one_that_went_round(done: Path) -> None:
    """What was felt is what was done, but for the encoder; the chosen command is the likeliest of Eq. (1)'s bars, and
    as far beside the sub-goal after it as the commanded line says."""
    seen = series(done / "recording.rrd")
    for joint in JOINTS:
        goal = seen[f"/joints/{joint}/demonstrated"]
        felt = seen[f"/loop/{joint}/0"] + goal
        assert np.abs(felt - seen[f"/joints/{joint}/imitated"]).max() < 0.01
        assert np.abs(seen[f"/loop/{joint}/3"]).max() == 0
        (posterior, places), (chosen, _) = (bars(done / "recording.rrd", f"/belief/{joint}/now/{which}")
                                            for which in ("posterior", "chosen"))  # fmt: skip
        assert posterior.sum(1) == pytest.approx(1, abs=1e-4)
        at = places[chosen.argmax(1)]
        assert np.median(np.abs(at - places[posterior.argmax(1)])) <= np.diff(places).mean() * 1.01
        beside = seen[f"/joints/{joint}/commanded"][:-1] - goal[1:]
        assert np.abs(at[:-1] - beside).max() <= np.diff(places).mean()


def test_it_imitates_better_than_replay_and_better_the_second_time(done: Path) -> None:
    told = metrics(done)
    first, second = told["attempts_rmse_deg"]
    assert first <= 0.2 * told["direct_replay_rmse_deg"]
    assert second < first and second == pytest.approx(told["joint_rmse_deg"])
    assert told["uninformed_selections"] == 0
    assert told["body_schema_correct_share"] == 1


def test_same_seed_same_numbers_at_any_thread_count(
    done: Path, arm: Path, wave: Path, hasty: None, tmp_path: Path
) -> None:
    def timeless(told: dict[str, object]) -> dict[str, object]:
        return {k: v for k, v in told.items() if not k.endswith(("_s", "_ms", "_factor"))}

    again = gesture(arm, wave, tmp_path / "again", "--attempts", "2", "--threads", "2", "--seed", "3")
    assert timeless(again) == timeless(metrics(done))


def test_with_crossed_wires_it_is_as_good_and_finds_every_motor(
    done: Path, arm: Path, wave: Path, hasty: None, tmp_path: Path
) -> None:
    straight, crossed = metrics(done), gesture(arm, wave, tmp_path / "crossed", "--scramble", "5", "--seed", "3")
    assert crossed["body_schema_correct_share"] == 1
    assert crossed["joint_rmse_deg"] <= 2 * straight["attempts_rmse_deg"][0]  # a second's rehearsal chooses by luck
    assert crossed["direct_replay_rmse_deg"] == pytest.approx(straight["direct_replay_rmse_deg"])


def test_a_result_is_replaced_whole_and_other_things_never(
    done: Path, arm: Path, wave: Path, hasty: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "result"
    shutil.copytree(done, out)
    gesture(arm, wave, out, "--selection", "matching")
    assert metrics(out)["selection"] == "matching"
    (out / "thesis.txt").write_text("years of work")
    common = ["gesture", "--robot", str(arm), "--demonstration", str(wave), "--out", str(out)]
    capsys.readouterr()
    assert main(common) == 2
    assert "this folder holds other things than a result ('thesis.txt')" in capsys.readouterr().err
    assert (out / "thesis.txt").read_text() == "years of work"
