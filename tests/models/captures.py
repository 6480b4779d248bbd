"""Skeletons in .bvh files for tests: dm_control's human (CMU's skeleton), under any names and conventions."""

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from dm_control.suite.utils import parse_amc
from scipy.spatial.transform import Rotation

from models.teachers.anatomy import perform
from models.teachers.cmu import _human, _poses
from models.teachers.performance import Performance

Y_UP = Rotation.from_euler("x", -90, degrees=True).as_matrix()
UPRIGHT = (np.sqrt(0.5), np.sqrt(0.5), 0, 0)


@cache
def postures(clip: Path | None = None) -> np.ndarray:
    """(1 + T, nq): upright, arms sideways; then a clip's, or made-up ones, knees bent a little and ever more."""
    physics = _human()
    model = physics.model.ptr
    upright = np.zeros((1, model.nq))
    upright[0, 3:7] = UPRIGHT
    if clip is not None:
        return np.concatenate([upright, parse_amc.convert(str(clip), physics, parse_amc.MOCAP_DT).qpos.T])
    rng, moves = np.random.default_rng(0), np.tile(upright, (60, 1))
    for joint in range(1, model.njnt):
        name, (low, high) = model.joint(joint).name, model.jnt_range[joint]
        end = rng.choice([low, high]) if "tibia" not in name else high if high > -low else low
        share = 0.1 if "tibia" in name else 0.25 if name[1:].startswith(("femur", "foot")) else 0.6
        moves[:, model.jnt_qposadr[joint]] += share * end * np.linspace(0, 1, 60) ** 2
    return np.concatenate([upright, moves])


def shown(clip: Path | None = None) -> Performance:
    """What is seen of it without any file."""
    qpos = postures(clip)
    time = np.arange(len(qpos) - 1) * parse_amc.MOCAP_DT
    return perform("made up", "human", time, _poses(_human(), qpos[1:]), _poses(_human(), qpos[:1]))


@cache
def moving(clip: Path | None) -> tuple[tuple[str, ...], tuple[int, ...], np.ndarray, np.ndarray]:
    """Bodies, their parents (-1: none), places (1 + T, J, 3) and rotations (1 + T, J, 3, 3); first upright, z up."""
    physics = _human()
    model, data = physics.model.ptr, physics.data.ptr
    places, turns = [], []
    for posture in postures(clip):
        data.qpos[:] = posture
        mujoco.mj_kinematics(model, data)
        places.append(data.xpos[1:].copy())
        turns.append(data.xmat[1:].reshape(-1, 3, 3).copy())
    rotations = np.array(turns)
    names = tuple(model.body(i).name for i in range(1, model.nbody))
    parents = tuple(int(p) - 1 for p in model.body_parentid[1:])
    return names, parents, np.array(places), rotations @ rotations[0].swapaxes(-1, -2)


def write_bvh(
    path: Path,
    clip: Path | None,
    called: Callable[[int, str], str] = lambda number, name: name,
    *,
    without: Sequence[str] = (),
    world: np.ndarray = Y_UP,
    scale: float = 100.0,
    zero: np.ndarray | None = None,
    order: str = "ZXY",
    frames: slice = slice(None),
) -> Path:
    """A clip's movement as .bvh. called: joints by number and CMU's name; without: joints left out, with all below;
    world: rotation from z up into the file's axes; zero (J, 3, 3): each joint's axes in the upright posture."""
    names, parents, places, turns = moving(clip)
    places, turns = places[:, :] @ world.T * scale, world @ turns @ world.T
    axes = np.tile(np.eye(3), (len(names), 1, 1)) if zero is None else zero
    rest, places, turns = places[0], places[1:][frames], (turns[1:] @ axes)[frames]
    rows: list[Any] = [places[:, 0]]
    lines: list[str] = ["HIERARCHY"]

    def joint(number: int) -> None:
        above = parents[number]
        before = np.broadcast_to(np.eye(3), turns[:, 0].shape) if above < 0 else turns[:, above]
        offset = np.zeros(3) if above < 0 else axes[above].T @ (rest[number] - rest[above])
        rows.append(Rotation.from_matrix(before.swapaxes(-1, -2) @ turns[:, number]).as_euler(order, degrees=True))
        place = "Xposition Yposition Zposition " if above < 0 else ""
        lines.append(f"{'ROOT' if above < 0 else 'JOINT'} {called(number, names[number])}\n{{")
        lines.append("OFFSET " + " ".join(f"{value:.9f}" for value in offset))
        lines.append(f"CHANNELS {6 if place else 3} {place}" + " ".join(f"{axis}rotation" for axis in order))
        below = [i for i, p in enumerate(parents) if p == number and names[i] not in without]
        for child in below:
            joint(child)
        if not below:
            on = axes[number].T @ (rest[number] - rest[above]) * (names[number] == "head")
            lines.append("End Site\n{\nOFFSET " + " ".join(map(str, on)) + "\n}")
        lines.append("}")

    joint(0)
    numbers = np.concatenate(rows, axis=1)
    lines += ["MOTION", f"Frames: {len(numbers)}", f"Frame Time: {parse_amc.MOCAP_DT:.9f}"]
    lines += [" ".join(f"{value:.8f}" for value in row) for row in numbers]
    path.write_text("\n".join(lines) + "\n")
    return path
