"""Finished parts of a long study are kept beside its results until these are there: killed, it goes on from there.

Kept files are data: a tree in JSON and its arrays, NPZ, nothing of pickle. Only classes that the work's module or
its annotation names come back, kinds of files (`babbling.kinds`) as such files. What cannot be read is done again.
"""

import hashlib
import io
import json
import os
import platform
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import fields, is_dataclass
from functools import cache, cached_property, partial
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FunctionType
from typing import Any, NamedTuple, TypeVar, get_args, get_type_hints

import numpy as np

import babbling.files as files
from babbling.kinds import KINDS
from babbling.whole import MARK, sweep, try_place, whole
from experiments.errors import ExperimentError
from experiments.shared.options import Options
from experiments.shared.provenance import LIBRARIES, MAKES_NO_DIFFERENCE
from models.files import raw
from models.markup import look

Array = np.ndarray[Any, Any]
Found = TypeVar("Found")
LARGEST, LONGEST_PATH, SUFFIX = 1 << 30, 4096, ".part.npz"
_folders: list[Path] = []


@contextmanager
def keeping(folder: Path, *, stays: bool = False) -> Iterator[None]:
    """A block whose finished parts are kept in this folder. Once the block has ended well they are removed, unless the
    folder `stays`."""
    _folders.append(folder)
    try:
        yield
        if not stays:
            for part in folder.glob(f"*{SUFFIX}"):
                part.unlink(missing_ok=True)
    finally:
        _folders.pop()
        for part in folder.glob(f".*{SUFFIX}{MARK}*"):  # of processes that were killed
            sweep(folder / part.name[1:].rpartition(MARK)[0])
        with suppress(OSError):  # there are parts in it, or somebody else's files, or it never was there
            folder.rmdir()


def studying(config: Options, out: Path) -> AbstractContextManager[None]:
    """For what takes long, a block that keeps its parts in OUT.partial until its results are published."""
    if not getattr(config, "study", True):
        return nullcontext()
    return keeping(out.resolve().with_name(f"{out.resolve().name}.partial"))


def once(work: Callable[..., Found], *task: Any, **aside: Any) -> Found:
    """`work(*task, **aside)`, or what it left in the folder of the block when it was the same task of the same program;
    results must not depend on `aside`.

    Raises:
        ExperimentError: the folder cannot be written.
    """
    return keeper(work)(*task, **aside)


def keeper(work: Callable[..., Found]) -> Callable[..., Found]:
    """`work`, keeping what it finds; it can be handed to another process."""
    return partial(_kept, work, _folders[-1], _program()) if _folders else work


def part_of(work: Callable[..., Found], *task: Any) -> "Part | None":
    """Where the block keeps what `work(*task)` finds, if it does, for who is handed it by somebody else.

    Raises:
        ExperimentError: the folder cannot be written.
    """
    return _part(work, _folders[-1], _program(), task) if _folders else None


class Part(NamedTuple):
    """A file of what was found, and the classes that may be in it."""

    path: Path
    classes: Mapping[str, type]

    def read(self) -> tuple[Any] | None:
        """What was found; None where it is not there, or, which is said, cannot be used."""
        if self.path.exists():
            try:
                return (_read(self.path, self.classes),)
            except Exception as error:  # NumPy, zipfile and HDF5 raise many kinds on damaged files
                print(f"imitate: {self.path}: cannot be used ({str(error)[:80]}); it is done again", file=sys.stderr)
        with _writing(self.path.parent):  # tried now, not after the work
            try_place(self.path)
        return None

    def keep(self, found: Any) -> Any:
        """Write it; what was found, as whoever goes on is given it."""
        arrays = list[Array]()
        tree = np.frombuffer(json.dumps(_put(found, arrays, self.classes)).encode(), np.uint8)
        with _writing(self.path.parent), whole(self.path) as beside, beside.open("wb") as file:
            np.savez(file, tree, *arrays)
        return _take(json.loads(tree.tobytes()), arrays, self.classes)


def _kept(work: Callable[..., Found], folder: Path, program: str, *task: Any, **aside: Any) -> Found:
    part = _part(work, folder, program, task)
    known = part.read()
    found: Found = known[0] if known is not None else part.keep(work(*task, **aside))
    return found


def _part(work: Callable[..., Any], folder: Path, program: str, task: tuple[Any, ...]) -> Part:
    digest = hashlib.sha256(program.encode())
    _tell(digest.update, (work, task))
    bare: Any = work.func if isinstance(work, partial) else work
    classes = dict[str, type]()
    for hint in (get_type_hints(bare, include_extras=True)["return"], *bare.__globals__.values()):
        _classes(hint, classes)
    return Part(folder / f"{bare.__name__}-{digest.hexdigest()[:16]}{SUFFIX}", classes)


@contextmanager
def _writing(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        why = error.strerror or error
        raise ExperimentError(f"{folder}: what is found cannot be kept there ({why}); make room for it") from error


def _read(path: Path, classes: Mapping[str, type]) -> Any:
    with np.load(io.BytesIO(raw(path, LARGEST)), allow_pickle=False) as held:
        tree, *arrays = (held[f"arr_{n}"] for n in range(len(held.files)))
    return _take(json.loads(tree.tobytes()), arrays, classes)


def _program() -> str:
    return repr(versions())


@cache
def versions() -> dict[str, str]:
    """Of all that runs: libraries, Python, and this project with what its files say."""
    digest, home = hashlib.sha256(), Path(__file__).resolve().parents[2]
    for path in sorted(path for name in ("models", "babbling", "imitation", "experiments") for path in home.glob(
        f"{name}/**/*") if path.suffix in (".py", ".xml", ".txt", ".stl", ".obj")):  # fmt: skip
        digest.update(str(path.relative_to(home)).encode() + hashlib.sha256(path.read_bytes()).digest())
    ours = f"{version('imitation-laboratory')} with files {digest.hexdigest()[:12]}"
    libraries = {name: version(name) for name in LIBRARIES}
    return {"imitation-laboratory": ours, "Python": platform.python_version(), **libraries}


def _tell(update: Callable[[bytes], None], thing: Any) -> None:
    """Everything that a task says, files that it names, and that these name, by what is in them."""
    update(type(thing).__qualname__.encode())
    if isinstance(thing, np.ndarray) and thing.dtype != object:
        update(repr((thing.dtype.str, thing.shape)).encode() + np.ascontiguousarray(thing).tobytes())
    elif isinstance(thing, np.random.Generator):
        update(repr(thing.bit_generator.state).encode())
    elif isinstance(thing, type | FunctionType):
        if getattr(thing, "__closure__", None):
            raise TypeError(f"{thing.__qualname__}: what a closure holds cannot be told")
        update(_name(thing).encode())
    elif isinstance(thing, partial):
        _tell(update, [thing.func, thing.args, thing.keywords])
    elif thing is None or isinstance(thing, bool | int | float | str | range | np.generic | Path):
        there = isinstance(thing, Path) or (isinstance(thing, str) and "." in thing)  # a bare word is no file
        there = there and len(str(thing)) < LONGEST_PATH and os.path.isfile(str(thing))
        update(repr(thing.name if there and isinstance(thing, Path) else thing).encode())
        for file in _files(Path(str(thing))) if there else ():
            update(hashlib.sha256(raw(file, LARGEST)).digest())
    else:
        for part in _parts(thing):
            _tell(update, part)
    update(b";")


def _files(path: Path) -> list[Path]:
    """A file, and all that it names where it is a robot's."""
    return [path, *(look(path).named if path.suffix.lower() in (".xml", ".mjcf", ".urdf") else ())]


def _parts(thing: Any) -> Iterator[Any]:
    if isinstance(thing, Mapping):
        yield from (half for pair in thing.items() for half in pair)
    elif isinstance(thing, tuple | list | np.ndarray):
        yield from thing
    else:
        left_out = MAKES_NO_DIFFERENCE if isinstance(thing, Options) else ()
        for name, value in sorted(vars(thing).items()):
            if name not in left_out and not isinstance(getattr(type(thing), name, None), cached_property):
                yield from (name, value)


def _classes(hint: Any, found: dict[str, type]) -> None:
    """Classes of one's own that a type names, by name."""
    for inner in get_args(hint):
        _classes(inner, found)
    named = is_dataclass(hint) or hasattr(hint, "_fields")
    if isinstance(hint, type) and named and _name(hint) not in found:
        found[_name(hint)] = hint
        with suppress(NameError):  # types that are imported for the type checker alone
            for inner in () if _kind(hint) else get_type_hints(hint, include_extras=True).values():
                _classes(inner, found)


def _name(one: Any) -> str:
    return f"{one.__module__}.{one.__qualname__}"


def _kind(holds: type) -> bool:
    return any(kind.holds is holds for kind in KINDS.values())


def _put(thing: Any, arrays: list[Array], classes: Mapping[str, type]) -> Any:
    """As JSON; arrays are numbered."""
    if thing is None or type(thing) in (bool, int, float, str):
        return thing
    if isinstance(thing, np.ndarray | np.generic):
        arrays.append(np.array(thing, order="C"))
        return ["array" if isinstance(thing, np.ndarray) else "number", len(arrays)]
    if type(thing) in (list, tuple):
        return [type(thing).__name__, *(_put(one, arrays, classes) for one in thing)]
    if isinstance(thing, Mapping):
        pairs = [[_put(half, arrays, classes) for half in pair] for pair in thing.items()]
        return ["dict", *pairs]
    name = _name(type(thing))
    if classes.get(name) is not type(thing):
        raise TypeError(f"{name} is nothing that can be kept")
    if _kind(type(thing)):
        with TemporaryDirectory() as folder:
            files.save(thing, Path(folder) / "kind.nc")
            arrays.append(np.frombuffer((Path(folder) / "kind.nc").read_bytes(), np.uint8))
        return ["kind", name, len(arrays)]
    return ["class", name, *(_put(getattr(thing, one), arrays, classes) for one in _names(type(thing)))]


def _names(holds: Any) -> list[str]:
    return [one.name for one in fields(holds) if one.init] if is_dataclass(holds) else list(holds._fields)


def _take(tree: Any, arrays: list[Array], classes: Mapping[str, type]) -> Any:
    if not isinstance(tree, list):
        return tree
    what, *inner = tree
    if what in ("array", "number"):
        return arrays[inner[0] - 1] if what == "array" else arrays[inner[0] - 1][()]
    if what == "kind":
        with TemporaryDirectory() as folder:
            (Path(folder) / "kind.nc").write_bytes(arrays[inner[1] - 1].tobytes())
            return files.load(Path(folder) / "kind.nc", classes[inner[0]])
    if what == "dict":
        return {_take(key, arrays, classes): _take(value, arrays, classes) for key, value in inner}
    if what in ("list", "tuple"):
        return {"list": list, "tuple": tuple}[what](_take(one, arrays, classes) for one in inner)
    holds, values = classes[inner[0]], [_take(one, arrays, classes) for one in inner[1:]]
    return holds(**dict(zip(_names(holds), values, strict=True)))
