"""XML from strangers, MJCF and URDF: looked at by a plain reader before a native one meets it.

What is no well-formed XML is left to the native reader, which says so.
"""

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import prod
from pathlib import Path
from xml.parsers import expat

from models.errors import BodyError
from models.files import NUMBER, checked, raw

LARGEST_FILE, LARGEST_FILES = 128 * 2**20, 512 * 2**20
"""Bytes of a mesh or texture, and of all that are named."""
DEEPEST, MOST_ELEMENTS, MOST_NAMES, MOST_CELLS = 300, 20_000, 5000, 1 << 24
"""Elements within each other; elements, as often as they are repeated; files named; cells of a grid of numbers."""
WORDS = {"name", "class", "childclass", "model", "prefix", "file", "filename", "key"}
"""Attributes that may say anything; the numbers of others are finite."""
NO_NUMBER = re.compile(r"(?:^|[\s,])([+-]?(?:nan|inf|infinity|[\d.]+e\+?0*[1-9]\d\d\d*|\d{100,}))(?=$|[\s,])", re.I)
COMMENT = re.compile(rb"<!--.*?(?:-->|\Z)", re.DOTALL)
RANGED = {"joint", "position", "motor", "velocity", "general", "tendon", "spatial", "fixed"}
REPEATED = {("replicate", "count"), ("composite", "count"), ("flexcomp", "count")}
FOLDERS = ("meshdir", "texturedir", "assetdir")
GRIDS = {"hfield": ("nrow", "ncol"), "texture": ("width", "height")}


@dataclass
class Look:
    """What was seen of a file and of those it includes."""

    path: Path
    elements: float = 0
    """How many there are, as often as they are repeated."""
    files: list[tuple[str, str]] = field(default_factory=list)
    """Element and file that it names."""
    folders: set[str] = field(default_factory=lambda: {""})
    """Where files may be."""
    included: set[Path] = field(default_factory=set)

    @property
    def named(self) -> list[Path]:
        """Files that it names and that are there, wherever they may be, in order.

        Raises:
            BodyError: too many.
        """
        if len(self.files) * len(self.folders) > MOST_NAMES:
            raise BodyError(f"{self.path}: names more than {MOST_NAMES} files; leave some out")
        named = {self.path.parent / folder / name for _, name in self.files for folder in self.folders}
        return sorted(file for file in named if os.path.exists(file))

    @property
    def bytes(self) -> int:
        """Of all of them.

        Raises:
            BodyError: one that is no file, or is too large, or all are.
        """
        total = sum(checked(file, LARGEST_FILE).stat().st_size for file in self.named)
        if total > LARGEST_FILES:
            raise BodyError(
                f"{self.path}: names {total / 2**20:,.0f} MB of meshes and textures where at most "
                f"{LARGEST_FILES / 2**20:,.0f} MB are read; thin them out"
            )
        return total


def look(path: Path, content: bytes | None = None) -> Look:
    """What a file that MuJoCo or urdfdom is to read is made of.

    Raises:
        BodyError: a file that cannot be read, is not UTF-8, declares entities, is too deep or too large, or holds a
            number that is none (which line).
    """
    seen = Look(path)
    _look(path, raw(path) if content is None else content, seen, 0, 1.0)
    return seen


def _look(path: Path, content: bytes, seen: Look, above: int, times: float) -> None:
    if path.resolve() in seen.included:
        return
    seen.included.add(path.resolve())
    content = COMMENT.sub(lambda said: b"\n" * said[0].count(b"\n"), content)
    try:
        content.decode()
    except UnicodeDecodeError as error:
        raise BodyError(f"{path}: line {content[: error.start].count(10) + 1} is not UTF-8; save it so") from None
    parser, repeated = expat.ParserCreate("utf-8"), [times]

    def refuse(wrong: str) -> None:
        raise BodyError(f"{path}: line {parser.CurrentLineNumber}: {wrong}")

    def start(tag: str, told: dict[str, str]) -> None:
        if above + len(repeated) > DEEPEST:
            refuse(f"more than {DEEPEST} elements within each other; flatten it")
        for name, value in told.items():
            if name not in WORDS and (wrong := NO_NUMBER.search(value)):
                refuse(f"{name} of <{tag}> holds {wrong[1][:30]!r}; finite numbers below 1e100 are possible")
            if name.endswith("range") and tag in RANGED:
                ends = [float(word) for word in value.split() if NUMBER.fullmatch(word)]
                if ends != sorted(ends):
                    refuse(f"{name} of <{tag}> goes down from {ends[0]:g} to {ends[-1]:g}; put the lower end first")
        count = repeated[-1] * prod(n for key in told if (tag, key) in REPEATED for n in _counts(told[key]))
        seen.elements += max(count, repeated[-1])
        repeated.append(max(count, repeated[-1]))
        if seen.elements > MOST_ELEMENTS:
            refuse(f"more than {MOST_ELEMENTS} elements, all repetitions counted; make it simpler")
        if prod(n for key in GRIDS.get(tag, ()) for n in _counts(told.get(key, ""))) > MOST_CELLS:
            refuse(f"a {tag} of more than {MOST_CELLS} cells; make it coarser")
        if tag == "compiler":
            seen.folders |= {told[key] for key in FOLDERS if key in told}
        for name in (value for key, value in told.items() if key.startswith("file") and value):
            seen.files.append((tag, name))
            if tag in ("include", "model"):
                for inner in dict.fromkeys((path.parent / name, seen.path.parent / name)):
                    if os.path.exists(inner):
                        _look(inner, raw(inner), seen, above + len(repeated), repeated[-1])

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda tag: repeated.pop()
    parser.StartDoctypeDeclHandler = lambda *_: refuse("declares entities, which no robot needs; remove the DOCTYPE")
    try:
        parser.Parse(content, True)
    except expat.ExpatError:
        return


def _counts(told: str) -> Iterator[float]:
    """Whole numbers in an attribute, those above 1."""
    yield from (float(word) for word in re.findall(r"(?<!\S)\+?\d{1,20}(?=\.?\d*(?:\s|$))", told) if float(word) > 1)
