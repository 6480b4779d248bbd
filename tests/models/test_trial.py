"""Strangers' bodies are tried apart: what kills, hangs, talks or costs there is one line here."""

import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import models.apart
from models.apart import tried
from models.card import as_written
from models.errors import BodyError, unknown
from models.face import FACES
from models.face.body import face_body
from models.loading import load_body
from models.markup import MOST_ELEMENTS, look
from models.robots import ROBOTS, Robot
from models.teachers.urdf import read_urdf
from tests.conftest import ARM, apart


@pytest.fixture
def really(monkeypatch: pytest.MonkeyPatch) -> None:
    """Trials are processes, as outside of tests."""
    monkeypatch.setattr(models.apart, "apart", apart)


@pytest.mark.parametrize(
    ("work", "said"),
    [
        ("crash", "its reader dies of it, SIGSEGV"),
        ("abort", "its reader dies of it, SIGABRT"),
        ("wait", "does not end"),
        ("spin", "more than 1 s of computing"),
        ("eat", "needs more than 768 MB"),
        ("reserve", "needs more than"),
        ("talk", "a.xml: no body"),
        ("stumble", "cannot be used .KeyError: 'what'"),
    ],
)
def test_what_a_reader_dies_of_is_one_line(
    work: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(models.apart, "WALL_S", 4.0 if work == "wait" else 60.0)
    (tmp_path / "numpy.py").write_text("raise SystemExit('code of a stranger ran')")
    with pytest.raises(BodyError, match=said) as caught:
        apart(f"tests.models.dying:{work}", str(tmp_path / "a.xml"), 1 if work in ("spin", "wait") else 20, ())
    assert str(caught.value).isprintable() and "a.xml" in str(caught.value)
    assert capfd.readouterr() == ("", "") and [file.name for file in tmp_path.iterdir()] == ["numpy.py"]


def test_a_file_is_tried_once_and_again_when_it_changes(really: None, arm: Path, tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    before = apart.cache_info().misses
    for _ in range(2):
        load_body(path), as_written(Robot(path, ""))
    assert apart.cache_info().misses == before + 1
    path.write_text(ARM + "\n")
    load_body(path)
    assert apart.cache_info().misses == before + 2


def test_ones_own_are_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise AssertionError("tried")

    monkeypatch.setattr(models.apart, "apart", refuse)
    for robot in ROBOTS:
        load_body(robot, threads=1)
    for face in FACES.values():
        face_body(face, threads=1)
    with pytest.raises(AssertionError, match="tried"):
        tried("tests.models.dying:well", Path(__file__))


LINK = '<link name="{}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>' \
    "</inertial></link>"  # fmt: skip
HINGE = '<joint name="j{0}" type="revolute"><parent link="{0}"/><child link="{1}"/><limit lower="-1" upper="1" ' \
    'effort="1" velocity="1"/></joint>'  # fmt: skip


def urdf(path: Path, joints: int, more: str = "") -> Path:
    links = "".join(LINK.format(i) for i in range(joints + 1))
    path.write_text(f'<robot name="r">{links}{"".join(HINGE.format(i, i + 1) for i in range(joints))}{more}</robot>')
    return path


def test_a_urdf_that_overflows_its_reader(really: None, tmp_path: Path) -> None:
    with pytest.raises(BodyError, match=f"more than {MOST_ELEMENTS} elements"):
        read_urdf(urdf(tmp_path / "a.urdf", 18_000))
    with pytest.raises(BodyError, match=r"a\.urdf: cannot be loaded \(its reader dies of it, SIGSEGV"):
        tried("tests.models.dying:parse", tmp_path / "a.urdf")


def test_native_words_are_not_heard(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """urdfdom speaks of a link without a parent; MuJoCo of inertias, and leaves a log."""
    with pytest.raises(BodyError):
        read_urdf(urdf(tmp_path / "a.urdf", 3, LINK.format("alone")))
    stiff = tmp_path / "a.xml"
    stiff.write_text(ARM.replace('kp="20"', 'kp="1e9"').replace("implicitfast", "Euler"))
    os.chdir(tmp_path)
    load_body(stiff)
    assert capfd.readouterr() == ("", "")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.urdf", "a.xml"]


def replaced(old: str, new: str) -> Callable[[], str]:
    assert old in ARM
    return lambda: ARM.replace(old, new, 1)


W = "<worldbody>"
ODD: dict[str, tuple[str, str, str]] = {
    "mass nan": ('mass="0.4"', 'mass="nan"', "line 12: mass of <geom> holds 'nan'"),
    "range inf": ('"-0.4 2.0"', '"-inf 2.0"', "range of <joint> holds '-inf'"),
    "gravity": ('timestep="', 'gravity="0 0 -1e300" timestep="', "gravity of <option> holds '-1e300'"),
    "digits": ('mass="0.4"', f'mass="{"9" * 400}"', "mass of <geom> holds '9999"),
    "entities": ("<mujoco", '<!DOCTYPE a [<!ENTITY b "c">]><mujoco', "declares entities"),
    "depth": (W, W + 301 * "<body>" + 301 * "</body>", "within each other"),
    "elements": (W, W + 20_000 * "<geom/>", "more than 20000 elements"),
    "replicate": (
        W,
        W + '<replicate count="200"><replicate count="200"><geom size="1"/></replicate></replicate>',
        "elem",
    ),
    "composite": (W, W + '<body><composite type="cable" count="100000000 1 1"/></body>', "more than 20000 elements"),
    "flexcomp": (W, W + '<flexcomp count="100 100 100"/>', "more than 20000 elements"),
    "height field": (W, '<asset><hfield nrow="99999" ncol="99999"/></asset>' + W, "hfield of more than"),
    "texture": (W, '<asset><texture width="99999" height="99999"/></asset>' + W, "texture of more than"),
    "endless mesh": (W, '<asset><mesh file="/dev/zero"/></asset>' + W, "/dev/zero: this is no regular file"),
    "endless skin": (W, '<asset><skin file="/dev/zero"/></asset>' + W, "/dev/zero: this is no regular file"),
    "endless part": (W, '<include file="/dev/zero"/>' + W, "/dev/zero: this is no regular file"),
    "reversed": ('"-0.4 2.0"', '"2 -0.4"', "range of <joint> goes down from 2 to -0.4"),
    "rest": ("</mujoco>", '<keyframe><key name="home" qpos="1e90 0 0"/></keyframe></mujoco>', "its rest is at 1e"),
    "freedom": (W, W + 601 * '<body><joint/><geom size="1"/></body>', "604 degrees of freedom"),
    "letters": ('name="elbow"', 'name="\udce4lbow"', "is not UTF-8"),
    "timestep": ('"0.005"', '"1e-9"', "its timestep of 1e-09 s"),
    "far": ('"-0.4 2.0"', '"-1e20 1e20"', "a sense of it may read 1e\\+20"),
    "ctrlrange": (
        'joint="elbow"/>',
        'joint="elbow" inheritrange="0" ctrllimited="true" ctrlrange="1 1"/>',
        "invalid control range",
    ),
    "memory": (W, '<size memory="20T"/>' + W, "a.xml: "),
}


@pytest.mark.parametrize("name", ODD)
def test_a_body_that_cannot_be_is_refused_before_it_babbles(
    name: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    old, new, said = ODD[name]
    assert old in ARM
    path = tmp_path / "a.xml"
    path.write_text(ARM.replace(old, new, 1), errors="surrogateescape")
    with pytest.raises(BodyError, match=said) as caught:
        load_body(path)
    assert str(caught.value).isprintable() and len(str(caught.value)) < 390
    assert capfd.readouterr() == ("", "")


def many(count: int, step: str = "0.005") -> str:
    bodies = "".join(
        f'<body pos="{i} 0 0"><joint name="j{i}" range="-1 1" damping="1"/><geom size=".05" pos="0 0 .1"/></body>'
        for i in range(count)
    )
    servos = "".join(f'<position joint="j{i}" kp="5"/>' for i in range(count))
    return (
        f'<mujoco><compiler autolimits="true"/><option timestep="{step}" integrator="implicitfast"/><worldbody>{bodies}'
        f"</worldbody><actuator>{servos}</actuator></mujoco>"
    )


@pytest.mark.parametrize(
    ("content", "said"),
    [(many(151), "it has 151 motors; bodies of up to 150"), (many(140, "2e-5"), r"a body-minute of it takes \d+ min")],
)
def test_what_would_babble_for_ever_is_refused_with_its_cost(
    content: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("models.trial.SLOWEST", 0.05)
    path = tmp_path / "a.xml"
    path.write_text(content)
    with pytest.raises(BodyError, match=said):
        load_body(path)


def test_comments_repeated_includes_and_words_do_no_harm(tmp_path: Path) -> None:
    part, path = tmp_path / "part.xml", tmp_path / "a.xml"
    part.write_text('<mujoco><!-- a -- b \n --><include file="a.xml"/><geom name="inf" class="nan"/></mujoco>')
    path.write_text('<mujoco><include file="part.xml"/><include file="part.xml"/></mujoco>')
    assert look(path).elements == 6
    path.write_text("<mujoco><a></b>")  # is MuJoCo's to say
    with pytest.raises(BodyError, match="MuJoCo cannot compile it"):
        load_body(path)


def test_a_line_is_never_too_long() -> None:
    assert len(str(BodyError("x" * 5000))) <= 380
    assert str(BodyError("a\n\x1b b\ud800")) == "a ? b?"
    assert len(unknown("joint", "j" * 10**7, ["knee"])) > 10**7, "names are quoted whole, errors cut them"


def test_comments_that_do_not_end_are_looked_at_once(tmp_path: Path) -> None:
    """Half a second of processor time is a thousand times what it takes; a look for every one took minutes."""
    (path := tmp_path / "x.xml").write_bytes(b"<mujoco>" + b"<!--" * 500_000)
    started = time.process_time()
    assert look(path).elements <= 1
    assert time.process_time() - started < 0.5
