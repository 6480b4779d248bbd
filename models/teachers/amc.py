"""Strict reading of CMU `.amc` files: every broken file gets one line that names the place and the remedy.

A file is comment lines (#), flag lines (:), then frames: a line with the frame's number, and one line per bone with
its numbers in degrees (the root's: three lengths, then three angles). Bones may come in any order; frames count up
by one from any number. Blank lines and Windows line ends do no harm.
"""

import os
import re
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from models.arrays import FloatArray
from models.errors import BodyError
from models.files import checked, finite, lines, text
from models.teachers.performance import TeacherError

_ARM = {"clavicle": 2, "humerus": 3, "radius": 1, "wrist": 1, "hand": 2, "fingers": 1, "thumb": 2}
_LEG = {"femur": 3, "tibia": 1, "foot": 2, "toes": 1}
BONES: dict[str, int] = {
    "root": 6,
    **dict.fromkeys(("lowerback", "upperback", "thorax", "lowerneck", "upperneck", "head"), 3),
    **{side + bone: count for limb in (_ARM, _LEG) for side in "rl" for bone, count in limb.items()},
}
"""Bone -> how many numbers it has, in the order in which the database lists them."""
MIN_FRAMES = 4
"""A cubic spline needs four."""
MAX_FRAMES = 100_000


def read_amc(path: str | os.PathLike[str]) -> FloatArray:
    """Numbers of a checked file, (frames, 62), bones in the order of BONES; TeacherError says what is wrong where."""
    path = checked(path)
    frames, whole = list[dict[str, list[float]]](), list[FloatArray]()
    number: int | None = None
    for place, raw in lines(path, text(path)):
        words = raw.split()
        if words[0].startswith("#"):
            continue
        if words[0].startswith(":"):
            if words[0].upper() == ":RADIANS":
                raise TeacherError(f"{path}: line {place}: angles in radians are not read; convert them to :DEGREES")
            continue
        if len(words) == 1 and re.fullmatch(r"\d{1,9}", words[0], re.ASCII):
            if frames:
                whole.append(_whole(frames.pop(), number, path, place))
            if len(whole) == MAX_FRAMES:
                raise TeacherError(f"{path}: line {place}: more than {MAX_FRAMES} frames; cut the file into clips")
            if number is not None and int(words[0]) != number + 1:
                raise TeacherError(
                    f"{path}: line {place}: frame {words[0]} follows frame {number}; frames must count up by one"
                )
            number = int(words[0])
            frames.append({})
            continue
        if not frames:
            raise TeacherError(
                f"{path}: line {place}: {_short(raw)!r} stands before the first frame number; is this an .amc file?"
            )
        _bone(words, frames[-1], number, path, place)
    if not frames:
        raise TeacherError(f"{path}: holds no frame; give an .amc file of the CMU database")
    whole.append(_whole(frames.pop(), number, path, None))
    if len(whole) < MIN_FRAMES:
        raise TeacherError(f"{path}: has {len(whole)} frames; a movement needs at least {MIN_FRAMES}")
    return np.array(whole)


def write_amc(frames: FloatArray, path: str | os.PathLike[str]) -> None:
    """Write (frames, 62) numbers in the plainest form of the format, frames counted from 1."""
    edges = np.cumsum([0, *BONES.values()])
    lines = [":FULLY-SPECIFIED", ":DEGREES"]
    for number, values in enumerate(frames.tolist(), start=1):
        lines.append(str(number))
        for bone, start, end in zip(BONES, edges, edges[1:], strict=False):
            lines.append(" ".join((bone, *map(repr, values[start:end]))))
    Path(path).write_text("\n".join(lines) + "\n", encoding="utf-8")


def _bone(words: list[str], frame: dict[str, list[float]], number: int | None, path: Path, place: int) -> None:
    """Check one bone's line and put its numbers into the frame."""
    bone, *cells = words
    here = f"{path}: line {place} (frame {number})"
    if bone not in BONES:
        close = get_close_matches(bone[:40], BONES, n=1, cutoff=0.5)
        hint = f"; did you mean {close[0]!r}?" if close else "; only the skeleton of the CMU database is known"
        raise TeacherError(f"{here}: bone {_short(bone)!r} does not exist{hint}")
    if bone in frame:
        raise TeacherError(f"{here}: bone {bone!r} comes twice; give each bone once per frame")
    if len(cells) != BONES[bone]:
        raise TeacherError(f"{here}: bone {bone!r} has {len(cells)} numbers where {BONES[bone]} are needed")
    try:
        frame[bone] = [finite(cell, f"{here}: bone {bone!r}") for cell in cells]
    except BodyError as error:
        raise TeacherError(f"{error}; record or mend this frame") from None


def _whole(frame: dict[str, list[float]], number: int | None, path: Path, place: int | None) -> FloatArray:
    """Numbers of a frame that is over, (62,), once it is sure that it has every bone."""
    missing = [bone for bone in BONES if bone not in frame]
    if missing:
        where = "the file ends" if place is None else f"line {place}: the next frame begins"
        raise TeacherError(
            f"{path}: {where} in the middle of frame {number}: {len(missing)} of {len(BONES)} bones are missing, "
            f"first {missing[0]!r}; download the file again or cut the frame off"
        )
    return np.array([value for bone in BONES for value in frame[bone]])


def _short(word: str) -> str:
    return word if len(word) <= 40 else word[:37] + "..."
