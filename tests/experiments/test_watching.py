"""What a movement that somebody brings is taken for is said: joints that rest, frames that lack, curves bent."""

from pathlib import Path

import numpy as np
import pytest

from experiments.__main__ import main
from experiments.shared.watching import watch
from models.errors import BodyError
from models.loading import load_body


def write(path: Path, time: np.ndarray, **joints: np.ndarray) -> str:
    rows = np.column_stack([time, *(np.broadcast_to(angles, len(time)) for angles in joints.values())])
    np.savetxt(path, rows, fmt="%.17g", delimiter=";", header=";".join(["time", *joints]), comments="")
    return str(path)


TIME = np.arange(50) * 0.02


def test_joints_that_are_not_named_rest_at_home(arm: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bent = tmp_path / "bent.xml"
    home = '<keyframe><key name="home" qpos="0.1 0.5 0.2" ctrl="0.1 0.5 0.2"/></keyframe></mujoco>'
    bent.write_text(arm.read_text().replace("</mujoco>", home))
    elbow = 0.5 + 0.3 * np.sin(2 * TIME)
    path = write(tmp_path / "a.tsv", TIME, elbow=elbow)
    seen = watch(path, load_body(bent))
    np.testing.assert_allclose(seen.angles, np.column_stack([0 * TIME + 0.1, elbow, 0 * TIME + 0.2]), atol=1e-12)
    assert seen.remarks == (f"{path}: names 1 of 3 joints; at rest stay shoulder, wrist",)
    assert capsys.readouterr().err == f"imitate: {seen.remarks[0]}\n"
    whole = write(tmp_path / "b.csv", TIME, elbow=elbow, wrist=0 * TIME, shoulder=0 * TIME)
    assert watch(whole, load_body(arm)).remarks == ()


def test_what_is_bent_or_slowed_is_said(arm: Path, tmp_path: Path) -> None:
    body = load_body(arm)
    step = np.where(np.arange(20) < 10, 0, 1.0)
    path = write(tmp_path / "a.csv", np.arange(20) / 2.5, shoulder=step, elbow=0, wrist=0)
    seen = watch(path, body)
    [line] = seen.remarks
    assert f"{path}: between its frames joint 'shoulder' would swing " in line and "beyond its range at " in line
    assert seen.angles.max() == 1.0
    path = write(tmp_path / "b.csv", TIME, shoulder=0.5 * np.sin(20 * TIME), elbow=0, wrist=0)
    seen = watch(path, body)
    [line] = seen.remarks
    assert "joint 'shoulder' moves 2.0 times as fast as its servo can at 0." in line
    assert line.endswith(f"the whole is done {seen.slowed:.2f} times as slowly") and seen.slowed == pytest.approx(
        2, 0.02
    )
    late = np.where(np.arange(50) < 25, TIME, TIME + 3)
    [line] = watch(write(tmp_path / "c.csv", late, shoulder=0.1 * np.sin(TIME), elbow=0, wrist=0), body).remarks
    assert "no frame for 3.02 s after 0.48 s (elsewhere every 0.02 s)" in line


def test_the_command_lines_unit_is_of_the_file_alone(
    arm: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path / "a.txt", TIME, shoulder=30 * np.sin(2 * TIME))
    body = load_body(arm)
    with pytest.raises(BodyError, match="fit as degrees: declare that unit"):
        watch(path, body)
    np.testing.assert_allclose(watch(path, body, unit="deg").angles[:, 0], np.deg2rad(30 * np.sin(2 * TIME)))
    assert main(["gesture", "--demonstration", "icub-wave", "--unit", "deg"]) == 2
    assert "--unit: this is for files of joint angles; icub-wave is none" in capsys.readouterr().err
