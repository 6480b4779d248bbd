"""Derive seat.xml, HOAP-2 on a seat at a table's edge, from hoap2.xml.

On its stand the torso is fixed and the waist moves the legs: a head that hangs so cannot lean forward. Seated, the
pelvis is fixed instead and the very same waist joint, seen from the other side (axis 0 1 0 for 0 -1 0), moves the
torso. Palms and forehead become places that touch and are touched. Nothing else changes.

    python -m models.hoap2.derive_seat           # exit 1 if seat.xml says something else
    python -m models.hoap2.derive_seat --write   # writes it
"""

import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from typing import Final

import numpy as np

from models.hoap2 import ROBOT, SEAT
from models.hoap2.facts import JOINTS, SEATED_DEG, SIDES, WAIST_HEIGHT

TITLE: Final = """<!-- HOAP-2 on a seat: from hoap2.xml by `python -m models.hoap2.derive_seat`, not by hand. -->
"""
PALM: Final = {"pos": "0.015 0 0", "size": "0.004", "group": "4"}
"""The middle of the hand's box."""
FOREHEAD: Final = {"pos": "0.027 0 0.02", "size": "0.004", "group": "4"}
"""On the head's sphere, above the visor."""
HAND_SKIN: Final = {"pos": "0.015 0 0", "type": "box", "size": "0.035 0.0165 0.014", "group": "4"}
HEAD_SKIN: Final = {"pos": "0 0 -0.007", "size": "0.042", "group": "4"}
"""4 mm around what touches, so that a touch sensor feels all of it."""
HAND_FRICTION: Final = "1 0.02 0.001"
OPTION: Final = {"timestep": "0.004", "integrator": "implicitfast", "cone": "elliptic", "impratio": "3"}
"""Elliptic cones and the friction-to-normal ratio keep what is held from slipping out of a hand by itself."""


def derive(robot: str) -> str:
    """Text of seat.xml from that of hoap2.xml."""
    root = ET.fromstring(robot)
    root.set("model", "hoap2_seat")
    world = root.find("worldbody")
    torso = _body(root, "torso")
    pelvis, waist = _body(root, "pelvis"), _named(root, "joint", "body_joint_1")
    torso.remove(_named(root, "freejoint", "root"))
    torso.remove(pelvis)
    pelvis.remove(waist)
    waist.set("axis", "0 1 0")
    pelvis.set("pos", f"0 0 {WAIST_HEIGHT:g}")
    pelvis.set("childclass", torso.attrib.pop("childclass"))
    torso.set("pos", "0 0 0")
    torso.insert(0, waist)
    assert world is not None
    world.remove(torso)
    world.append(pelvis)
    pelvis.append(torso)
    for side in SIDES:
        hand = _body(root, f"{side}_hand")
        _named(root, "geom", f"{side}_hand_collision").attrib |= {"friction": HAND_FRICTION, "condim": "4"}
        _touchable(root, hand, f"{side}_palm", PALM, HAND_SKIN)
    _touchable(root, _body(root, "head"), "forehead", FOREHEAD, HEAD_SKIN)
    ET.SubElement(root, "option", OPTION)
    in_tree = [joint.get("name", "") for joint in pelvis.iter("joint")]  # no longer the order of the servos
    ET.SubElement(
        ET.SubElement(root, "keyframe"), "key", name="home", qpos=_angles(in_tree), ctrl=_angles(JOINTS)
    )  # fmt: skip
    ET.indent(root)
    return TITLE + ET.tostring(root, encoding="unicode") + "\n"


def _angles(joints: Iterable[str]) -> str:
    return " ".join(f"{np.deg2rad(SEATED_DEG.get(joint, 0.0)):.9g}" for joint in joints)


def _touchable(root: ET.Element, body: ET.Element, place: str, point: dict[str, str], skin: dict[str, str]) -> None:
    ET.SubElement(body, "site", {"name": place, **point})
    ET.SubElement(body, "site", {"name": f"{place}_skin", **skin})
    sensors = root.find("sensor")
    assert sensors is not None
    ET.SubElement(sensors, "touch", name=f"{place}_touch", site=f"{place}_skin")


def _named(root: ET.Element, kind: str, name: str) -> ET.Element:
    return next(element for element in root.iter(kind) if element.get("name") == name)


def _body(root: ET.Element, name: str) -> ET.Element:
    return _named(root, "body", name)


def main() -> int:
    """Compare or write; the exit status says whether the file on disk is up to date."""
    text = derive(ROBOT.read_text())
    if "--write" in sys.argv[1:]:
        SEAT.write_text(text)
    current = SEAT.exists() and SEAT.read_text() == text
    print(f"{SEAT.name} is {'up to date' if current else 'not what this derives: run with --write'}")
    return 0 if current else 1


if __name__ == "__main__":
    sys.exit(main())
