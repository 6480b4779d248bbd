"""Good examples of everything that is read, and the words that their formats are made of."""

import io
import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd
import pytest
from PIL import Image

from experiments.battery.table import IMITATOR, WHOLE, Trial, tidy
from experiments.benchmark.lives import Point
from experiments.registry import EXPERIMENTS
from experiments.shared import kept
from models.maze import MazeBody, default_maze, parse_maze
from models.maze.drawing import draw
from models.maze.teacher import demonstrate
from models.maze.walk_file import write_walks
from models.teachers.amc import BONES, write_amc
from tests.conftest import ARM
from tests.experiments.test_compare import left
from tests.kinds import write_kinds
from tests.models.test_bvh import skeleton


def tokens(said: str) -> tuple[bytes, ...]:
    return tuple(word.encode() for word in said.split(" "))


def tables(folder: Path) -> list[bytes]:
    rows = [(i / 50, *np.sin(np.arange(3) + i / 9)) for i in range(12)]
    plain = "time,shoulder,elbow,wrist\n" + "".join(",".join(f"{value:.5f}" for value in row) + "\n" for row in rows)
    german = plain.replace(",", ";").replace(".", ",").replace("time", "sep=;\nt (s)")
    spread = '"","t","shoulder (deg)","elbow_rad"\n' + "".join(f'"{i + 1}",{i / 50},{i},0.{i}\n' for i in range(9))
    windows = "# unit: deg\r\n" + plain.replace("\n", "\r\n")
    return [*(one.encode() for one in (plain, german, spread, plain.replace(",", "\t"))), windows.encode("utf-16")]


TABLE = (
    *tokens(
        "time t time_ms time_ns Time [ms] shoulder elbow gripper [deg] _deg (mm) # unit: deg rad sep=; nan , ; ,,,"
    ),
    *(b"# unit: deg\n", b"# unit: " + b"x" * 500 + b"\n", b"sep=|\n", b"\n\n", b"\t", b'"', b'" "', b"\xef\xbb\xbf"),
)


def motion_files(folder: Path) -> list[bytes]:
    rng = np.random.default_rng(0)
    rows = ["20,0," + ",".join(map(str, rng.integers(-500, 500, 21).tolist())) + ",60,0,0,0" for _ in range(6)]
    return ["\n".join(rows).encode(), b"\r\n".join(row.replace(",", " ").encode() for row in rows)]


def archives(folder: Path) -> list[bytes]:
    arrays = {"time": np.arange(20) / 50, "angles": np.zeros((20, 2)), "joints": np.array(["shoulder", "elbow"])}
    made = []
    for more, writes in (({}, np.savez), ({"unit": np.array("deg")}, np.savez_compressed)):
        writes(folder / "made.npz", **arrays, **more)
        made.append((folder / "made.npz").read_bytes())
        (folder / "made.npz").unlink()
    return made


ARCHIVE = (
    *tokens(
        "'descr': '<f8' '>f8' '|O' '<U9' '<U100000000' '|S5' '<M8[s]' '<c16' '|V9' '<f2' '<i8' '|b1' 'shape': (20,)"
    ),
    *tokens(
        "(20,2) (20,20) (2,) (0,) () (-1,) (1000000000000,) (20,2,1) True False 'fortran_order': {} } [('a','<f8')]"
    ),
    *(b"\x93NUMPY", b"\x93NUMPY\x02\x00", b"\x93NUMPY\x03\x00", b"\x93NUMPY\x09\x00", b"(1" + b"0" * 30 + b",)"),
    b"'shape': (" + b"9" * 5000 + b",)",
)


def amc(folder: Path) -> list[bytes]:
    write_amc(np.random.default_rng(0).normal(size=(4, sum(BONES.values()))), folder / "made.amc")
    made = (folder / "made.amc").read_bytes()
    (folder / "made.amc").unlink()
    return [made, b"# CMU\r\n\r\n" + made.replace(b"\n", b"\r\n")]


def bvh(folder: Path) -> list[bytes]:
    return [skeleton(np.random.default_rng(0).normal(size=(5, 51)) * 5).encode()]


BVH = (
    *tokens(
        "HIERARCHY ROOT JOINT End Site OFFSET CHANNELS 3 6 Xrotation Yrotation Zrotation Xposition MOTION Frames: Frame"
    ),
    *tokens("Time: { } Hips LeftArm RightArm LeftUpLeg 0 1e999"),
    *(b"CHANNELS 6" + b" Xrotation" * 6 + b"\n", b"JOINT x\n{\n" * 600),
)


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


URDF = (
    *tokens(
        'type="revolute" type="continuous" type="prismatic" type="floating" type="planar" type="fixed" type="ball"'
    ),
    *tokens(
        '<link name="torso" name="left_elbow" link="torso" link="left_wrist_link" <!-- --> <![CDATA[ ]]> &amp; &x;'
    ),
    *tokens("</joint> </robot> <robot> <!DOCTYPE <!ENTITY <?xml?> xmlns:a="),
    *(b'xyz="0 0 0"', b'xyz="nan 0 0"', b'rpy="inf 0 0"', b'<mass value="-1"/>', b'<dynamics damping="nan"/>'),
    b'<mimic joint="left_elbow" multiplier="1e300"/>',
)
TETRAHEDRON = np.array([[0, 0, 0.2], [0.02, 0.02, 0], [-0.02, 0.02, 0], [0, -0.02, 0]], "f4")

FACES_OF = np.array([[1, 2, 0], [2, 3, 0], [3, 1, 0], [3, 2, 1]])

DRESSED = """<mujoco model="dressed"><compiler angle="radian" autolimits="true"/>
<option timestep="0.005" integrator="implicitfast"/><size memory="1M"/><default><joint damping="0.05" armature="0.01"/>
<position kp="20" kv="1" inheritrange="1"/><default class="a"/></default>
<asset><mesh name="link" file="link.obj" scale="1 1 1"/><mesh name="stone" file="link.stl"/>
<texture name="t" type="2d" file="t.png"/><material name="m" texture="t"/>
<hfield name="h" file="h.png" size="1 1 .1 .1"/></asset>
<worldbody><light pos="0 0 3"/><geom type="hfield" hfield="h" pos="0 0 -2"/>
<body name="root" pos="0 0 1"><freejoint name="free"/><geom type="mesh" mesh="stone" mass=".4"/>
<body name="upper" childclass="a"><joint name="shoulder" axis="0 1 0" range="-1.5 1"/>
<geom name="g" type="mesh" mesh="link" material="m" mass="0.4"/><site name="s" size=".01"/><camera name="eye"/>
<body name="fore" pos="0 0 -.3"><joint name="elbow" axis="0 1 0" range="-.4 2"/>
<geom type="capsule" fromto="0 0 0 0 0 -.2" size=".02"/>
<body name="slide" pos="0 0 -.2"><joint name="slide" type="slide" range="0 .1"/><geom size=".01"/></body></body></body>
</body></worldbody>
<tendon><fixed name="two"><joint joint="elbow" coef="1"/><joint joint="slide" coef="2"/></fixed></tendon>
<equality><joint joint1="elbow" joint2="slide" polycoef="0 1 0 0 0" active="false"/></equality>
<contact><exclude body1="upper" body2="fore"/></contact>
<actuator><position name="shoulder" joint="shoulder"/><position name="elbow" joint="elbow"/>
<general name="slide" joint="slide" gainprm="50" biastype="affine" biasprm="0 -50 -1" ctrlrange="0 .1"/></actuator>
<sensor><gyro name="gyro" site="s"/><jointpos joint="elbow"/></sensor>
<keyframe><key name="home" qpos="0 0 1 1 0 0 0 .1 .2 .05" ctrl="0.1 0.2 0.05"/></keyframe>
<custom><numeric name="n" data="1 2"/></custom></mujoco>"""

MJCF = (
    *tokens('type="hinge" type="slide" type="ball" type="free" type="mesh" type="box" type="sphere" type="plane"'),
    *tokens('type="hfield" limited="false" timestep="0" timestep="1e-9" timestep="nan" timestep="1e9" mass="-1"'),
    *tokens('mass="nan" mass="1e300" inheritrange="2" kp="-5" kp="1e300" kv="1e20" damping="-1" armature="-1"'),
    *tokens('armature="1e-300" <motor <velocity <intvelocity <position <general <muscle <adhesion joint="elbow"'),
    *tokens(
        'joint="slide" tendon="two" name="elbow" name="" childclass="a" file="link.obj" file="link.stl" file="t.png"'
    ),
    *tokens(
        'file="/dev/zero" file="." file="case.xml" file="h.png" size="0" size="1e300" integrator="RK4" solver="PGS"'
    ),
    *tokens('integrator="Euler" integrator="implicit" coordinate="global" angle="degree" ref="9" springref="nan"'),
    *tokens('stiffness="1e300" frictionloss="-1" nkey="99999999" njmax="-1" memory="1T" memory="-1" </body> <body>'),
    *tokens("<freejoint/> <geom/> </geom> <site/> <light/> <!-- --> <extension/> &#0;"),
    *(b'range="1 -1"', b'range="0 0"', b'range="-nan nan"', b'gravity="0 0 1e300"', b'ctrlrange="-1 1"'),
    *(b'pos="1e300 0 0"', b'quat="0 0 0 0"', b'axis="0 0 0"', b"<!DOCTYPE a>", b'<frame euler="nan 0 0"/>'),
    *(b'<include file="case.xml"/>', b'<replicate count="-1"><site/></replicate>', b'<option gravity="0 0 1e300"/>'),
    b'<replicate count="100000000"><site/></replicate>',
    b'<composite type="cable" count="99999 1 1" size="1"><geom size=".1"/></composite>',
    b'<flexcomp type="grid" count="1000 1000 1000" name="f" spacing=".1 .1 .1"/>',
    b'<plugin plugin="mujoco.elasticity.cable"/>',
    b'<asset><model name="x" file="case.xml"/></asset>',
    b'<attach model="x" body="y" prefix="z"/>',
    b'<inertial pos="0 0 0" mass="nan" diaginertia="1 1 1"/>',
)
OBJ, STL = tokens("v vn vt f l g o usemtl 1/1/1 -1 99"), tokens("solid facet normal vertex endloop")
OPTIONS = tokens("--seed --robot --out --quiet -1 1e9 nan")


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


HALL = "# a hall\n+--+--+--+\n|    2| 1|\n+  +--+  +\n| *      |\n+--+--+--+\n"


def drawings(folder: Path) -> list[bytes]:
    return [HALL.encode(), draw(default_maze()).encode()]


def walks(folder: Path) -> list[bytes]:
    maze = parse_maze(HALL)
    body, rng = MazeBody(maze, copies=1), np.random.default_rng(0)
    shown = [walk for goal in (1, 2, 2) for walk in demonstrate(body, goal, rng)]
    write_walks(shown, folder / "made.csv")
    made = (folder / "made.csv").read_bytes()
    (folder / "made.csv").unlink()
    return [made, made.replace(b"\n", b"\r\n").replace(b",", b";")]


def battery() -> pd.DataFrame:
    told = [Trial(n, n, WHOLE, IMITATOR, 3, "panel", "free", 0, "hand", "head", 0.0, options="head|hand",
                  likelihood="0.25|0.75", prior="0.5|0.5") for n in range(4)]  # fmt: skip
    return tidy(told, {n: {"memory": n / 2} for n in range(4)})


def trials(folder: Path) -> list[bytes]:
    whole = battery()
    few = whole[["agent", "task", "condition", "trial", "response", "options", "likelihood"]]
    return [one.to_csv(index=False, sep=sep).encode() for one, sep in ((whole, ","), (few, ";"))]


def parquets(folder: Path) -> list[bytes]:
    return [battery().to_parquet(None, index=False, compression=way) for way in ("snappy", None)]


@cache
def kinds() -> dict[str, bytes]:
    """A small file of every kind."""
    with TemporaryDirectory() as folder:
        (arm := Path(folder) / "arm.xml").write_text(ARM)
        return {name: path.read_bytes() for name, path in write_kinds(arm, Path(folder), pytest.MonkeyPatch()).items()}


def folder_of(file: str) -> Callable[[Path], list[bytes]]:
    def seeds(folder: Path) -> list[bytes]:
        if not (folder / "run").exists():
            left(folder / "run", selection="mean")
        return [(folder / "run" / file).read_bytes()]

    return seeds


def older(folder: Path) -> list[bytes]:
    """What says which files are its own."""
    (folder / "run").mkdir()
    (folder / "run" / "metrics.json").write_text("{}")
    return [b'{"experiment": "gesture", "options": {}, "files": ["config.json", "metrics.json"]}']


JSON = (
    *tokens(
        '"experiment" "options" "files" "seed" {} [] null true false NaN Infinity -Infinity 1e999 "\\ud800" "\\u0000"'
    ),
    *tokens('"" : , { [ ] } {"a":1}'),
    *(b'{"a":' * 3000, b"9" * 5000, b'"experiment": 3', b'"options": []', b'"files": [1]', b'"files": "config.json"'),
)


def parts(folder: Path) -> list[bytes]:
    """A kept part of a study."""
    point, arrays = Point(2.0, {"average": [0.1]}, {"average": np.array([0.5, 0.25])}, [[0.1, 0.05]], {}), list[Any]()
    tree = json.dumps(kept._put(point, arrays, {kept._name(Point): Point})).encode()
    np.savez(content := io.BytesIO(), np.frombuffer(tree, np.uint8), *arrays)
    return [content.getvalue()]


def lines(folder: Path) -> list[bytes]:
    """Words, one a line, of every experiment."""
    (folder / "wave.csv").write_text("time,a\n0,0\n")
    some = [f"{name}\n--seed\n3\n--quiet" for name in EXPERIMENTS]
    some += ["gesture\n--robot\nhoap2\n--demonstration\nicub-wave\n--attempts\n3\n--selection\nmean\n--film\ngif"]
    some += ["maze\n--maze\nwave.csv\n--goal-prior\n0.5,0.5\n--smoothing\n0.1", "compare\nwave.csv\nwave.csv"]
    some += ["gesture\n--stand\n--push\n1,0,4,0\n--robot\nhoap2", "play\n--out\nplay.nc"]
    return [line.encode() for line in some]
