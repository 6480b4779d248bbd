"""`imitate robot`: a card that is true, also of robots that are refused, and a movement that can be imitated."""

import csv
from pathlib import Path

import numpy as np
import pytest

from experiments.__main__ import main
from experiments.robot.run import INSET, SECONDS, SPEED_SHARE, SWINGS, WIDEST, template, write
from experiments.shared.baselines import direct_replay
from experiments.shared.watching import fastest, watch
from models.card import closed
from models.errors import BodyError
from models.loading import load_body
from models.robots import ROBOTS

ELBOW = '<position name="elbow" joint="elbow"/>'
ODD = {
    '<motor name="elbow" joint="elbow"/>': "not a position servo but a torque motor",
    '<velocity name="elbow" joint="elbow" kv="1"/>': "not a position servo but a speed servo",
    '<position name="elbow" joint="shoulder"/>': "another one moves it too",
    '<muscle name="elbow" joint="elbow"/>': "has dynamics of its own",
    '<position name="elbow" site="here" inheritrange="0"/>': "neither a joint nor a tendon",
}


@pytest.fixture(autouse=True)
def wide(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "240")


def spoiled(arm: Path, tmp_path: Path, **instead: str) -> Path:
    """The arm, some of its text replaced."""
    text = arm.read_text()
    for old, new in instead.items():
        old = {"elbow": ELBOW, "joint": '<joint name="elbow"', "end": "</mujoco>"}[old]
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "robot.xml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("name", ROBOTS)
def test_every_registered_robot_has_a_card(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robot", name]) == 0
    shown, body = capsys.readouterr().out, load_body(name, threads=1)
    rows = {line.split()[1]: line for line in shown.splitlines() if line.split()[:1] and line.split()[0].isdigit()}
    assert list(rows) == list(body.joints)
    assert all("servo, kp" in row for row in rows.values()) and "REFUSED" not in shown
    for joint, ends, scale in zip(body.joints, body.joint_range, body.shown_scale, strict=True):
        low, _, high = rows[joint].split()[2:5]
        np.testing.assert_allclose([float(low), float(high)], scale * ends, rtol=0.005)
    assert all(channel in shown for channel in body.senses.channels) and f"{body.substeps} physics steps" in shown


@pytest.mark.parametrize("name", [name for name, one in ROBOTS.items() if one.babbles == "joints"])
def test_a_template_reads_back_and_is_gentle(name: str, tmp_path: Path) -> None:
    body, path = load_body(name, threads=1), tmp_path / "wave.csv"
    body.reset()
    rest, wanted = body.joint_angles[0].copy(), template(body)
    write(path, body, wanted)
    seen = watch(str(path), body)
    assert seen.slowed == 1 and list(tmp_path.iterdir()) == [path]
    np.testing.assert_allclose(seen.angles, wanted, atol=1e-7)
    low, high = body.joint_range.T
    assert ((wanted >= low) & (wanted <= high)).all() and len(wanted) == SECONDS / body.tick_s + 1
    inset = INSET * (high - low)
    np.testing.assert_allclose(wanted[[0, -1]], np.clip([rest, rest], low + inset, high - inset), atol=1e-9)
    assert (np.abs(np.diff(wanted, axis=0)) <= SPEED_SHARE * fastest(body)).all()
    way = wanted - wanted[0]
    farthest = way[np.abs(way).argmax(0), np.arange(len(rest))]
    room = np.where(farthest > 0, high - wanted[0], wanted[0] - low)
    assert (room >= (high - low) / 2 - 1e-9).all()  # to the roomier side, and not across rest
    assert (np.abs(farthest) <= np.minimum(room / 2, WIDEST) + 1e-9).all() and (np.abs(farthest) > 0.1).all()
    swings = ((np.abs(way[1:-1]) > np.abs(way[:-2])) & (np.abs(way[1:-1]) >= np.abs(way[2:]))).sum(0)
    np.testing.assert_array_equal(swings, 1 + np.arange(len(rest)) % SWINGS)


def test_a_torque_arm_is_refused_after_its_card_and_moves_with_servos(
    arm: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, wave = tmp_path / "torque.xml", tmp_path / "wave.csv"
    path.write_text(arm.read_text().replace("<position name", '<motor ctrlrange="-3 3" name'))
    assert main(["robot", str(path), "--template", str(wave)]) == 2
    told = capsys.readouterr()
    assert told.out.count("REFUSED: is not a position servo but a torque motor") == 3 and "timestep" in told.out
    assert told.err.count("\n") == 1 and "--servos gives each such motor one" in told.err and not wave.exists()
    assert main(["robot", str(path), "--servos", "--template", str(wave)]) == 0
    shown = capsys.readouterr().out
    assert shown.count("-3 .. 3 N m, given by --servos") == 3 and f"--servos --demonstration {wave}" in shown
    assert watch(str(wave), load_body(path, give_servos=True)).slowed == 1


@pytest.mark.parametrize("actuator", ODD)
def test_every_actuator_is_listed_with_what_is_wrong(
    arm: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], actuator: str
) -> None:
    path = spoiled(arm, tmp_path, elbow=actuator, joint='<site name="here"/><joint name="elbow"')
    assert main(["robot", str(path)]) == 2
    told = capsys.readouterr()
    assert "2  " in told.out and told.out.count("servo, kp 20 N m/rad, kv 1") == 2 and told.out.count("REFUSED") == 1
    assert ODD[actuator] in told.out and told.err.count("\n") == 1
    with pytest.raises(BodyError) as caught:
        load_body(path)
    assert str(caught.value) in told.err


def test_the_card_says_what_hangs_what_is_loose_and_what_is_closed(
    arm: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = '<equality><connect body1="upper" body2="hand" anchor="0 0 -0.6"/></equality><keyframe><key name="up"/>'
    path = spoiled(arm, tmp_path, end=more + "</keyframe></mujoco>", joint='<joint name="loose"/><joint name="elbow"')
    free = '<body pos="0 0 1"><freejoint/><geom size="0.05" mass="0.35"/><body name="upper">'
    text = path.read_text().replace('<body name="upper" pos="0 0 1">', free)
    path.write_text(text.replace("</worldbody>", "</body></worldbody>"))
    assert main(["robot", str(path)]) == 0
    shown = capsys.readouterr().out
    assert "1 connect: closed chains" in shown and "1: loose" in shown and "rests at the first, 'up'" in shown
    assert "free (1 joint); it is hung" in shown and "1 kg, of which 0.65 kg move" in shown
    assert main(["robot", str(arm)]) == 0
    shown = capsys.readouterr().out
    assert "fixed" in shown and "zero, within the ranges" in shown and "0.005 s, 4 physics steps" in shown


def test_where_a_chain_is_closed_the_template_is_what_it_lets_become(arm: Path, tmp_path: Path) -> None:
    tied = '<equality><connect body1="upper" body2="hand" anchor="0 0 -0.6"/></equality></mujoco>'
    body = load_body(spoiled(arm, tmp_path, end=tied), threads=1)
    assert closed(body.model)
    wanted, open_ = template(body), template(load_body(arm, threads=1))
    low, high = body.joint_range.T
    assert ((wanted >= low) & (wanted <= high)).all()
    error = [np.sqrt(np.mean((direct_replay(body, one) - one) ** 2)) for one in (wanted, open_)]
    assert error[0] < error[1] / 2


def test_what_slides_is_in_millimetres(arm: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, wave = tmp_path / "slide.xml", tmp_path / "wave.csv"
    path.write_text(arm.read_text().replace('name="wrist" axis', 'type="slide" name="wrist" axis'))
    assert main(["robot", str(path), "--template", str(wave)]) == 0
    shown = capsys.readouterr().out
    assert "mm" in shown and "N/m" in shown and "mm/s" in shown
    with wave.open() as file:
        assert next(csv.reader(file)) == ["time", "shoulder [deg]", "elbow [deg]", "wrist [mm]"]
    body = load_body(path, threads=1)
    np.testing.assert_allclose(watch(str(wave), body).angles, template(body), atol=1e-7)


def test_nothing_is_overwritten_or_left_in_halves(
    arm: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kept = tmp_path / "kept.csv"
    kept.write_text("mine")
    for words, message in (
        (["--template", str(kept)], "is there already"),
        (["--template", str(tmp_path / "wave.nc")], "name it wave.csv"),
        (["--template", str(kept / "wave.csv")], "cannot be written"),
        (["--out", str(tmp_path / "card")], "a card is printed"),
    ):
        assert main(["robot", str(arm), *words]) == 2
        said = capsys.readouterr().err
        assert message in said and said.count("\n") == 1
    body = load_body(arm, threads=1)
    with pytest.raises(ValueError, match="cannot be written"):
        write(kept, body, template(body))  # it came up in the meantime
    assert [file.name for file in tmp_path.iterdir()] == ["kept.csv"] and kept.read_text() == "mine"


def test_who_shakes_itself_apart_is_refused(arm: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stiff = spoiled(arm, tmp_path, elbow='<position name="elbow" joint="elbow" kp="1e9"/>')
    stiff.write_text(stiff.read_text().replace('integrator="implicitfast"', 'integrator="Euler"'))
    assert main(["robot", str(stiff), "--template", str(tmp_path / "wave.csv")]) == 2
    told = capsys.readouterr()
    assert "kp 1000000000" in told.out and "unstable at joint 'elbow'" in told.err
    assert not (tmp_path / "wave.csv").exists()


def test_a_slow_robot_gets_a_slow_template(arm: Path, tmp_path: Path) -> None:
    slow = '<custom><numeric name="speed_limit" data="0.1"/></custom></mujoco>'
    body = load_body(spoiled(arm, tmp_path, end=slow), threads=1)
    share = np.abs(np.diff(template(body), axis=0)).max(0) / fastest(body)
    np.testing.assert_allclose(share, SPEED_SHARE, rtol=0.01)
