"""Make stand.xml from hoap2.xml: the same robot, its torso a fixed part of a stand.

MJCF has no way to include a body without its joint (`include` cannot drop it, `attach` must rename every element), so
the file is made, not written: the robot's text minus its free joint, plus what stands around it. `derive_gains` writes
it; a test keeps the two together.
"""

import numpy as np

from models.errors import BodyError
from models.hoap2.facts import HOME_DEG, JOINTS

TORSO_HEIGHT = 0.45
"""m, waist axis above the floor; test_stand_reaches_nothing measures what is left below the feet and hands."""

HEADER = """\
<!-- HOAP-2 hung by its torso on a stand: 25 joints move, nothing touches anything. This is where it babbles.
     Made from hoap2.xml by `python -m models.hoap2.derive_gains --write`; change that file, not this one. -->
<mujoco model="hoap2_stand">
  <option timestep="0.002" integrator="implicitfast">
    <flag contact="disable"/>
  </option>
  <statistic center="0 0 0.4" extent="0.7"/>

  <default>
    <default class="stand">
      <geom group="2" contype="0" conaffinity="0" rgba="0.35 0.36 0.38 1"/>
    </default>
  </default>
"""

SURROUNDINGS = """\
    <light name="sun" type="directional" pos="1 1 3" dir="-0.3 -0.3 -1"/>
    <camera name="front" pos="1.1 -0.6 0.7" xyaxes="0.48 0.88 0 -0.25 0.14 0.96" fovy="40"/>
    <geom name="floor" type="plane" size="3 3 0.05" rgba="0.55 0.58 0.55 1"/>
    <body name="stand" pos="-0.22 0 0">
      <geom name="stand_foot" class="stand" type="cylinder" size="0.12 0.008" pos="0 0 0.008"/>
      <geom name="stand_pole" class="stand" type="capsule" size="0.012" fromto="0 0 0 0 0 0.54"/>
      <geom name="stand_arm" class="stand" type="capsule" size="0.01" fromto="0 0 0.54 0.09 0 0.54"/>
    </body>
"""


def stand_xml(robot: str) -> str:
    """Text of stand.xml, from the text of hoap2.xml.

    Raises:
        BodyError: a line that is to be changed does not stand there once.
    """
    postures = {"home": [np.deg2rad(HOME_DEG.get(joint, 0.0)) for joint in JOINTS], "zero": [0.0] * len(JOINTS)}
    keys = ""
    for name, posture in postures.items():
        angles = " ".join(f"{angle:.9g}" for angle in posture)
        keys += f'    <key name="{name}" qpos="{angles}" ctrl="{angles}"/>\n'
    text = robot[max(robot.find("<mujoco"), 0) :]
    for old, new in (
        ('<mujoco model="hoap2">\n', HEADER),
        ("  <worldbody>\n", "  <worldbody>\n" + SURROUNDINGS),
        ('name="torso" pos="0 0 0.2905"', f'name="torso" pos="0 0 {TORSO_HEIGHT}"'),
        ('      <freejoint name="root"/>\n', ""),
        ("</mujoco>", f"\n  <keyframe>\n{keys}  </keyframe>\n</mujoco>"),
    ):
        if text.count(old) != 1:
            raise BodyError(f"hoap2.xml: {old.strip()!r} stands there {text.count(old)} times; the stand needs it once")
        text = text.replace(old, new)
    return text
