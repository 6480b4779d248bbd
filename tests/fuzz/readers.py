"""Everything that reads a file or words of a stranger: good examples, words of the format, and what holds once it was
read."""

import io
import json
import os
import zipfile
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
import pytest
from PIL import Image

from babbling.errors import BabblingError
from babbling.files import _seal, is_kind, load, save
from babbling.kinds import KINDS
from experiments.__main__ import parse
from experiments.benchmark import kept
from experiments.benchmark.lives import Point
from experiments.compare.reading import Tracks, read_run
from experiments.errors import ExperimentError
from experiments.registry import EXPERIMENTS, entry
from experiments.shared.experiment import as_json, check_out
from models.errors import BodyError
from models.face import FACE, FACES
from models.face.body import face_model
from models.hoap2.facts import JOINTS
from models.loading import load_body
from models.maze import MazeBody, default_maze, parse_maze, read_maze
from models.maze.drawing import draw
from models.maze.teacher import check_walk, demonstrate
from models.maze.walk_file import read_walks, write_walks
from models.meshes import meshes
from models.motion import JointTrajectory, read_motion
from models.teachers.amc import BONES, write_amc
from models.teachers.performance import PARTS, Performance
from models.teachers.performing import perform
from models.teachers.urdf import perform_urdf, remarks
from tests.conftest import ARM
from tests.experiments.test_compare import left
from tests.fuzz import hdf5
from tests.fuzz.mutations import Rng, mutated, pick
from tests.models.test_bvh import skeleton
from tests.test_conformance import write_kinds

Made = Callable[[Path, Sequence[bytes], Sequence[bytes], int, Rng], None]


class Reader(NamedTuple):
    """One way in."""

    file: str
    """What a case is called, in the folder of all cases."""
    seeds: Callable[[Path], Sequence[bytes]]
    """Good examples; what else has to lie in that folder is put there."""
    read: Callable[[Path], object]
    """Read it and hold what was read to what it promises: AssertionError is a finding, like any other exception but"""
    error: type[Exception] | tuple[type[Exception], ...]
    words: tuple[bytes, ...] = ()
    cases: int = 150
    make: Made | None = None
    """Write case `number` to a path; by default `mutated` of the seeds."""

    def write(self, path: Path, seeds: Sequence[bytes], others: Sequence[bytes], number: int, rng: Rng) -> None:
        if self.make is not None and number >= len(seeds):
            self.make(path, seeds, others, number, rng)
        else:
            path.write_bytes(mutated(seeds, self.words, others, number, rng))


def tokens(said: str) -> tuple[bytes, ...]:
    return tuple(word.encode() for word in said.split(" "))


def finite(*arrays: np.ndarray) -> bool:
    return all(np.isfinite(one).all() for one in arrays)


# ------------------------------------------------------------------------------------------------------- movements


def a_movement(path: Path, ranges: bool = False) -> None:
    joints = {joint: (-3.2, 3.2) for joint in (*JOINTS, "shoulder", "elbow", "wrist")}
    found = read_motion(path, joints if ranges else None, slides=("gripper",))
    for one in (found, found.resampled(0.02)):
        assert one.time[0] == 0 and (np.diff(one.time) > 0).all() and finite(one.time, one.angles)
        assert one.angles.shape == (len(one.time), len(one.joints)) and len({*one.joints}) == len(one.joints) > 0
    assert all(0 < len(name) < 1000 for name in found.joints)


def in_ranges(path: Path) -> None:
    a_movement(path, True)


def tables(folder: Path) -> list[bytes]:
    rows = [(i / 50, *np.sin(np.arange(3) + i / 9)) for i in range(12)]
    plain = "time,shoulder,elbow,wrist\n" + "".join(",".join(f"{value:.5f}" for value in row) + "\n" for row in rows)
    german = plain.replace(",", ";").replace(".", ",").replace("time", "sep=;\nt (s)")
    spread = '"","t","shoulder (deg)","elbow_rad"\n' + "".join(f'"{i + 1}",{i / 50},{i},0.{i}\n' for i in range(9))
    windows = "# unit: deg\r\n" + plain.replace("\n", "\r\n")
    return [*(one.encode() for one in (plain, german, spread, plain.replace(",", "\t"))), windows.encode("utf-16")]


TABLE = tokens(
    'time t time_ms Time [ms] time_ns shoulder elbow [deg] _deg (mm) gripper #unit: deg rad sep=; " "" , ; \t'
)
TABLE += (b"# unit: deg\n", b"# unit: " + b"x" * 500 + b"\n", b"sep=|\n", b"\n\n", b"nan", b",,,", b"\xef\xbb\xbf")


def motion_files(folder: Path) -> list[bytes]:
    rng = np.random.default_rng(0)
    lines = [[20, 0, *rng.integers(-500, 500, 21), 60, 0, 0, 0] for _ in range(6)]
    return [
        "\n".join(",".join(map(str, line)) for line in lines).encode(),
        (" ".join(map(str, lines[0])) + "\n").encode() * 4,
    ]


def archives(folder: Path) -> list[bytes]:
    arrays = {"time": np.arange(20) / 50, "angles": np.zeros((20, 2)), "joints": np.array(["shoulder", "elbow"])}
    made = []
    for more, writes in (({}, np.savez), ({"unit": np.array("deg")}, np.savez_compressed)):
        writes(folder / "made.npz", **arrays, **more)
        made.append((folder / "made.npz").read_bytes())
        (folder / "made.npz").unlink()
    return made


ARCHIVE = tokens(
    "'descr': '<f8' '>f8' '|O' '<U9' '<U100000000' '|S5' '<M8[s]' '<c16' '|V9' '<f2' '<i8' '|b1' 'shape': (20,) (20,2) (20,20) "
    "(2,) (0,) () (-1,) (1000000000000000000000000000000,) (1000000000000,) (20,2,1) True False 'fortran_order': {} } \x93NUMPY"
) + (
    b"[('a','<f8')]",
    b"\x93NUMPY\x02\x00",
    b"\x93NUMPY\x03\x00",
    b"\x93NUMPY\x09\x00",
    b"'shape': (" + b"9" * 5000 + b",)",
)


def an_archive(path: Path, seeds: Sequence[bytes], others: Sequence[bytes], number: int, rng: Rng) -> None:
    """Members changed, then put together again; sometimes the whole is changed as well."""
    with zipfile.ZipFile(io.BytesIO(pick(seeds, rng))) as whole:
        members = {name: whole.read(name) for name in whole.namelist()}
    names = sorted(members)
    for _ in range(int(rng.integers(1, 3))):
        name = str(rng.choice(names))
        members[name] = mutated([members[name]], ARCHIVE, [members[one] for one in names], number, rng)
    way = int(rng.choice([zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA]))
    with zipfile.ZipFile(path, "w", way) as whole:
        for name, content in members.items():
            whole.writestr(name, content)
        if rng.random() < 0.1:
            whole.writestr(str(rng.choice(["time_ms.npy", "../x.npy", "joints.txt", "x" * 60000])), members[names[0]])
        if rng.random() < 0.05:
            for other in range(2000):
                whole.writestr(f"{other}.npy", b"")
    if rng.random() < 0.3:
        path.write_bytes(mutated([path.read_bytes()], (), others, number, rng))


# ------------------------------------------------------------------------------------------------------- captures


def seen(found: Performance) -> None:
    assert found.time[0] == 0 and (np.diff(found.time) > 0).all() and finite(found.time, found.points)
    for part, ways in found.directions.items():
        assert part in PARTS and ways.shape == (len(found.time), 3)
        np.testing.assert_allclose(np.linalg.norm(ways, axis=-1), 1, atol=1e-6)
    assert all(len(remark) < 400 and len(remark.splitlines()) == 1 for remark in found.remarks)


def amc(folder: Path) -> list[bytes]:
    write_amc(np.random.default_rng(0).normal(size=(4, sum(BONES.values()))), folder / "made.amc")
    made = (folder / "made.amc").read_bytes()
    (folder / "made.amc").unlink()
    return [made, b"# CMU\r\n\r\n" + made.replace(b"\n", b"\r\n")]


def bvh(folder: Path) -> list[bytes]:
    return [skeleton(np.random.default_rng(0).normal(size=(5, 51)) * 5).encode()]


BVH = tokens(
    "HIERARCHY ROOT JOINT End Site OFFSET CHANNELS 3 6 Xrotation Yrotation Zrotation Xposition MOTION Frames: Frame Time: { } "
    "Hips LeftArm RightArm LeftUpLeg 0 1e999"
) + (b"CHANNELS 6 Xrotation Xrotation Xrotation Xrotation Xrotation Xrotation\n", b"JOINT x\n{\n" * 600)


def urdf(folder: Path) -> list[bytes]:
    """Two arms of three joints."""
    parts = ['<link name="torso"/>']
    for side, y in (("left", 0.2), ("right", -0.2)):
        above = "torso"
        for at, (name, axis) in enumerate((("shoulder", "0 1 0"), ("elbow", "0 1 0"), ("wrist", "0 0 1"))):
            this = f"{side}_{name}_link"
            parts.append(
                f'<joint name="{side}_{name}" type="revolute"><parent link="{above}"/><child link="{this}"/>'
                f'<origin xyz="0 {y if at == 0 else 0} {0.4 if at == 0 else -0.3}" rpy="0 0 0"/><axis xyz="{axis}"/>'
                f'<limit lower="-2" upper="2" effort="9" velocity="3"/></joint><link name="{this}"><inertial>'
                '<mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>'
                f'<visual><geometry><mesh filename="package://robot/{this}.stl"/></geometry></visual></link>'
            )
            above = this
    return [f'<?xml version="1.0"?><robot name="two arms">{"".join(parts)}</robot>'.encode()]


URDF = tokens(
    'type="revolute" type="continuous" type="prismatic" type="floating" type="planar" type="fixed" type="ball" <link '
    'name="torso" name="left_elbow" link="torso" link="left_wrist_link" <mimic joint="left_elbow" multiplier="1e300"/> '
    '<dynamics damping="nan"/> xyz="0 0 0" xyz="nan 0 0" rpy="inf 0 0" <mass value="-1"/> <!-- --> <![CDATA[ ]]> &amp; &x; </joint> '
    "</robot> <robot> <!DOCTYPE <!ENTITY <?xml?> xmlns:a="
)


def a_teacher(path: Path) -> None:
    time = np.arange(4) / 10
    performance, found = perform_urdf(path, JointTrajectory("x", time, ("left_elbow",), np.sin(time)[:, None]))
    seen(performance)
    assert all(len(" ".join(line.split())) < 2000 for line in remarks(found, path))


# ------------------------------------------------------------------------------------------------------- bodies

TETRAHEDRON = np.array([[0, 0, 0.2], [0.02, 0.02, 0], [-0.02, 0.02, 0], [0, -0.02, 0]], "f4")
FACES_OF = np.array([[1, 2, 0], [2, 3, 0], [3, 1, 0], [3, 2, 1]])
DRESSED = """<mujoco model="dressed"><compiler angle="radian" autolimits="true"/>
<option timestep="0.005" integrator="implicitfast"/><size memory="1M"/>
<default><joint damping="0.05" armature="0.01"/><position kp="20" kv="1" inheritrange="1"/><default class="a"/></default>
<asset><mesh name="link" file="link.obj" scale="1 1 1"/><mesh name="stone" file="link.stl"/><texture name="t" type="2d" file="t.png"/>
<material name="m" texture="t"/><hfield name="h" file="h.png" size="1 1 .1 .1"/></asset>
<worldbody><light pos="0 0 3"/><geom type="hfield" hfield="h" pos="0 0 -2"/>
<body name="root" pos="0 0 1"><freejoint name="free"/><geom type="mesh" mesh="stone" mass=".4"/>
<body name="upper" childclass="a"><joint name="shoulder" axis="0 1 0" range="-1.5 1"/>
<geom name="g" type="mesh" mesh="link" material="m" mass="0.4"/><site name="s" size=".01"/><camera name="eye"/>
<body name="fore" pos="0 0 -.3"><joint name="elbow" axis="0 1 0" range="-.4 2"/><geom type="capsule" fromto="0 0 0 0 0 -.2" size=".02"/>
<body name="slide" pos="0 0 -.2"><joint name="slide" type="slide" range="0 .1"/><geom size=".01"/></body></body></body></body></worldbody>
<tendon><fixed name="two"><joint joint="elbow" coef="1"/><joint joint="slide" coef="2"/></fixed></tendon>
<equality><joint joint1="elbow" joint2="slide" polycoef="0 1 0 0 0" active="false"/></equality>
<contact><exclude body1="upper" body2="fore"/></contact>
<actuator><position name="shoulder" joint="shoulder"/><position name="elbow" joint="elbow"/>
<general name="slide" joint="slide" gainprm="50" biastype="affine" biasprm="0 -50 -1" ctrlrange="0 .1"/></actuator>
<sensor><gyro name="gyro" site="s"/><jointpos joint="elbow"/></sensor>
<keyframe><key name="home" qpos="0 0 1 1 0 0 0 .1 .2 .05" ctrl="0.1 0.2 0.05"/></keyframe><custom><numeric name="n" data="1 2"/></custom></mujoco>"""
MJCF = tokens(
    'type="hinge" type="slide" type="ball" type="free" type="mesh" type="box" type="sphere" type="plane" type="hfield" range="1 -1" range="0 0" '
    'range="-nan nan" limited="false" timestep="0" timestep="1e-9" timestep="nan" timestep="1e9" gravity="0 0 1e300" mass="-1" mass="nan" '
    'mass="1e300" inheritrange="2" ctrlrange="-1 1" forcerange="-1 1" kp="-5" kp="1e300" kv="1e20" damping="-1" armature="-1" '
    'armature="1e-300" <motor <velocity <intvelocity <position <general <muscle <adhesion joint="elbow" joint="slide" tendon="two" name="elbow" '
    'name="" childclass="a" file="link.obj" file="link.stl" file="t.png" file="/dev/zero" file="." file="case.xml" file="h.png" size="0" '
    'size="1e300" pos="1e300 0 0" quat="0 0 0 0" axis="0 0 0" integrator="RK4" integrator="Euler" integrator="implicit" solver="PGS" '
    'coordinate="global" angle="degree" ref="9" springref="nan" stiffness="1e300" frictionloss="-1" nkey="99999999" njmax="-1" memory="1T" memory="-1" '
    "</body> <body> <freejoint/> <geom/> </geom> <site/> <light/>"
) + (
    b'<include file="case.xml"/>', b'<replicate count="100000000"><site/></replicate>', b'<replicate count="-1"><site/></replicate>',
    b'<composite type="cable" count="99999 1 1" size="1"><geom size=".1"/></composite>', b'<plugin plugin="mujoco.elasticity.cable"/>',
    b'<flexcomp type="grid" count="1000 1000 1000" name="f" spacing=".1 .1 .1"/>', b'<frame euler="nan 0 0"/>', b"<!--", b"-->",
    b'<attach model="x" body="y" prefix="z"/>', b'<asset><model name="x" file="case.xml"/></asset>', b"<!DOCTYPE a>", b"&#0;",
    b'<inertial pos="0 0 0" mass="nan" diaginertia="1 1 1"/>', b'<extension/>', b'<option gravity="0 0 1e300"/>',
)  # fmt: skip


def assets(folder: Path) -> None:
    lines = [f"v {x} {y} {z}" for x, y, z in TETRAHEDRON] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES_OF]
    (folder / "link.obj").write_text("\n".join(lines) + "\n")
    record = np.zeros(4, np.dtype([("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")]))
    record["v"] = TETRAHEDRON[FACES_OF]
    (folder / "link.stl").write_bytes(b"\0" * 80 + np.uint32(4).tobytes() + record.tobytes())
    Image.fromarray(np.full((4, 4, 3), 99, np.uint8)).save(folder / "t.png")
    Image.fromarray(np.arange(64, dtype=np.uint8).reshape(8, 8)).save(folder / "h.png")
    (folder / "body.xml").write_text(DRESSED)


def bodies(folder: Path) -> list[bytes]:
    assets(folder)
    return [ARM.encode(), DRESSED.encode()]


def asset(name: str) -> Callable[[Path], list[bytes]]:
    def seeds(folder: Path) -> list[bytes]:
        assets(folder)
        return [(folder / name).read_bytes()]

    return seeds


def it_moves(path: Path) -> None:
    """What loads can be moved: all it feels is finite and in range, at rest and anywhere else."""
    body = load_body(path, copies=1, threads=1)
    low, high, rng = body.motor_low, body.motor_high, np.random.default_rng(0)
    assert (
        finite(low, high, body.sense_low, body.sense_high, body.joint_range)
        and (body.sense_low < body.sense_high).all()
    )
    felt = [body.reset(), *(body.act(rng.uniform(low, high)[None]) for _ in range(5))]
    assert finite(*felt) and np.abs(felt).max() < 1e9
    assert body.tick_s == 0.02 and len(body.motor_labels) == len(low) > 0


def it_is_dressed(path: Path) -> None:
    """What the body beside it is made of, as it moves and as it is drawn."""
    it_moves(beside := path.with_name("body.xml"))
    model = load_body(beside, copies=1, threads=1).model
    for drawn in meshes(
        model, [i for i in range(model.ngeom) if model.geom_dataid[i] >= 0 and model.geom_type[i] == 7], 500
    ).values():
        assert finite(drawn.corners, drawn.normals) and drawn.triangles.max(initial=0) < len(drawn.corners)


def a_face(path: Path) -> None:
    model = face_model.__wrapped__(replace(next(iter(FACES.values())), path=path))
    assert finite(model.body_mass, model.jnt_range)


# ------------------------------------------------------------------------------------------------------- mazes

HALL = "# a hall\n+--+--+--+\n|    2| 1|\n+  +--+  +\n| *      |\n+--+--+--+\n"


def drawings(folder: Path) -> list[bytes]:
    return [HALL.encode(), draw(default_maze()).encode()]


def a_maze(path: Path) -> None:
    found = read_maze(path)
    again = parse_maze(draw(found))
    assert np.array_equal(again.walls, found.walls) and (again.start, again.goals) == (found.start, found.goals)


def walks(folder: Path) -> list[bytes]:
    maze = parse_maze(HALL)
    body, rng = MazeBody(maze, copies=1), np.random.default_rng(0)
    shown = [walk for goal in (1, 2, 2) for walk in demonstrate(body, goal, rng)]
    write_walks(shown, folder / "made.csv")
    made = (folder / "made.csv").read_bytes()
    (folder / "made.csv").unlink()
    return [made, made.replace(b"\n", b"\r\n").replace(b",", b";")]


def some_walks(path: Path) -> None:
    maze = parse_maze(HALL)
    for walk in read_walks(path, maze):
        check_walk(maze, walk, "again")


# ------------------------------------------------------------------------------------------------------- what was learned


@cache
def kinds() -> dict[str, bytes]:
    """A small file of every kind."""
    with TemporaryDirectory() as folder:
        (arm := Path(folder) / "arm.xml").write_text(ARM)
        return {name: path.read_bytes() for name, path in write_kinds(arm, Path(folder), pytest.MonkeyPatch()).items()}


LARGE = ("balance", "body image", "eyes", "face mind", "interrupted babble", "mind", "play")


def a_kind(name: str) -> Reader:
    """Files of what was learned, in HDF5."""

    def seeds(folder: Path) -> list[bytes]:
        return [kinds()[name]]

    def read(path: Path) -> None:
        holds, again = KINDS[name].holds, path.with_name("again.nc")
        known, thing = is_kind(path, holds), load(path, holds)
        assert known
        try:
            save(thing, again)
            load(again, holds)
        except BabblingError as error:
            raise AssertionError(f"what was read cannot be written and read again: {error}") from error
        finally:
            again.unlink(missing_ok=True)

    return Reader("case.nc", seeds, read, KINDS[name].error, (), 25 if name in LARGE else 80, a_netcdf)


def a_netcdf(path: Path, seeds: Sequence[bytes], others: Sequence[bytes], number: int, rng: Rng) -> None:
    whole = pick(seeds, rng)
    if number % 4:
        path.write_bytes(whole)
        hdf5.spoil(path, rng)
    elif number % 16:  # as another program might have left it: no checksum tells that it is damaged
        path.write_bytes(mutated([whole[: -len(_seal(b""))]], (), others, number + 1, rng))
    else:
        path.write_bytes(mutated(seeds, (), others, number, rng))


def folders(file: str) -> Callable[[Path], list[bytes]]:
    def seeds(folder: Path) -> list[bytes]:
        if not (folder / "run").exists():
            left(folder / "run", selection="mean")
        return [(folder / "run" / file).read_bytes()]

    return seeds


def a_run(path: Path) -> None:
    run = read_run(path.parent, "run")
    assert finite(*run.metrics.values()) and all(name.isprintable() for name in (*run.metrics, run.experiment))
    if isinstance(tracks := run.tracks, Tracks):
        assert finite(tracks.time, tracks.demonstrated, tracks.imitated, tracks.error) and tracks.tick_s > 0
        assert tracks.busiest and tracks.of(tracks.busiest).demonstrated.shape == tracks.demonstrated.shape


def older(folder: Path) -> list[bytes]:
    """What says which files are its own."""
    (folder / "run").mkdir()
    (folder / "run" / "metrics.json").write_text("{}")
    return [b'{"experiment": "gesture", "options": {}, "files": ["config.json", "metrics.json"]}']


def an_older_result(path: Path) -> None:
    check_out(path.parent)


JSON = tokens(
    '"experiment" "options" "files" "seed" {} [] {"a": null true false NaN Infinity -Infinity 1e999 "\\ud800" "\\u0000" "" : , { [ ] }'
)
JSON += (b'{"a":' * 3000, b"9" * 5000, b'"experiment": 3', b'"options": []', b'"files": [1]', b'"files": "config.json"')


def lives(folder: Path) -> list[bytes]:
    point = Point(2.0, {"average": [0.1, 0.2]}, {"average": np.array([0.5, 0.25])}, [[0.1, 0.05]], {})
    return [as_json([asdict(point)] * 2).encode()]


def a_life(path: Path) -> None:
    for point in kept._read(path):
        assert isinstance(point.minutes, float | int) and finite(*point.ringing.values())
        assert all(finite(np.array(values, float)) for values in (*point.errors.values(), point.last))


# ------------------------------------------------------------------------------------------------------- command lines


def lines(folder: Path) -> list[bytes]:
    """Words, one a line, of every experiment."""
    (folder / "wave.csv").write_text("time,a\n0,0\n")
    some = [f"{name}\n--seed\n3\n--quiet" for name in EXPERIMENTS]
    some += ["gesture\n--robot\nhoap2\n--demonstration\nicub-wave\n--attempts\n3\n--selection\nmean\n--film\ngif"]
    some += ["maze\n--maze\nwave.csv\n--goal-prior\n0.5,0.5\n--smoothing\n0.1", "compare\nwave.csv\nwave.csv"]
    some += ["gesture\n--stand\n--push\n1,0,4,0\n--robot\nhoap2", "play\n--out\nplay.nc"]
    return [line.encode() for line in some]


def a_command(path: Path) -> None:
    """The words are parsed and the options checked; nothing is done."""
    words = [os.fsdecode(word) for word in path.read_bytes().split(b"\n")]
    with redirect_stdout(io.StringIO()):  # --help
        config = parse(entry(words[0]).options(), words[0], words[1:])
    if config is not None:
        config.check()


# ------------------------------------------------------------------------------------------------------- all of them

READERS: dict[str, Reader] = {
    "table": Reader("case.csv", tables, a_movement, BodyError, TABLE, 500),
    "table in ranges": Reader("case.tsv", tables, in_ranges, BodyError, TABLE, 300),
    "motion file": Reader("case.txt", motion_files, in_ranges, BodyError, TABLE, 150),
    "archive": Reader("case.npz", archives, a_movement, BodyError, ARCHIVE, 150, an_archive),
    "amc": Reader("case.amc", amc, lambda path: seen(perform(path)), BodyError, tuple(b.encode() for b in BONES), 400),
    "bvh": Reader("case.bvh", bvh, lambda path: seen(perform(path)), BodyError, BVH, 400),
    "urdf": Reader("case.urdf", urdf, a_teacher, BodyError, URDF, 200),
    "body": Reader("case.xml", bodies, it_moves, BodyError, MJCF, 300),
    "mesh as text": Reader("link.obj", asset("link.obj"), it_is_dressed, BodyError, tokens("v vn vt f l g o usemtl 1/1/1 -1 99"), 80),
    "mesh": Reader("link.stl", asset("link.stl"), it_is_dressed, BodyError, tokens("solid facet normal vertex endloop"), 150),
    "texture": Reader("t.png", asset("t.png"), it_is_dressed, BodyError, tokens("IHDR IDAT IEND PLTE tRNS zTXt"), 80),
    "height field": Reader("h.png", asset("h.png"), it_is_dressed, BodyError, tokens("IHDR IDAT IEND PLTE tRNS"), 60),
    "face": Reader("case.xml", lambda folder: [FACE.read_bytes()], a_face, BodyError, MJCF, 100),
    "maze": Reader("case.txt", drawings, a_maze, BodyError, tokens("+ -- | * 1 2 3 9 +--+ # ١ ² \t"), 800),
    "walks": Reader("case.csv", walks, some_walks, BodyError, tokens("walk goal step x y action N E S W X 1,2,3 ٣ ² -1"), 250),
    **{f"{name}.nc": a_kind(name) for name in sorted(KINDS)},
    "run/config.json": Reader("run/config.json", folders("config.json"), a_run, (ExperimentError, BodyError), JSON, 500),
    "run/metrics.json": Reader("run/metrics.json", folders("metrics.json"), a_run, (ExperimentError, BodyError), JSON, 500),
    "run/trajectories.nc": Reader("run/trajectories.nc", folders("trajectories.nc"), a_run, (ExperimentError, BodyError), (), 100, a_netcdf),
    "older result": Reader("run/config.json", older, an_older_result, ExperimentError, JSON, 500),
    "kept life": Reader("case.json", lives, a_life, ExperimentError, JSON, 800),
    "command line": Reader("words", lines, a_command, (BabblingError, BodyError), tokens("--seed --robot --out --quiet -1 1e9 nan"), 200),
}  # fmt: skip
