"""Finished parts of a long study are kept beside its results until these are there: killed, it goes on where it stopped.

Kept files are data: a tree in JSON and its arrays, NPZ, nothing of pickle. Only classes that the work's own annotation
names come back, kinds of files (`babbling.kinds`) as such files. What cannot be read is said, and done again.
"""

import hashlib
import json
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import fields, is_dataclass
from functools import cache, cached_property, partial
from importlib.metadata import version
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FunctionType
from typing import Any, TypeVar, get_args, get_type_hints

import numpy as np

import babbling.files as files
from babbling.kinds import KINDS
from experiments.errors import ExperimentError
from experiments.shared.experiment import LIBRARIES
from experiments.shared.options import Options

Found = TypeVar("Found")
LARGEST, SUFFIX = 1 << 30, ".part.npz"
MAKES_NO_DIFFERENCE = ("out", "quiet", "workers", "threads", "keep")
"""Options that results do not depend on."""
_folders: list[Path] = []


@contextmanager
def keeping(folder: Path, *, stays: bool = False) -> Iterator[None]:
    """A block whose finished parts are kept in this folder. Once the block has ended well they are removed, unless the
    folder `stays`."""
    _folders.append(folder)
    try:
        yield
    finally:
        _folders.pop()
    if not stays:
        for part in folder.glob(f"*{SUFFIX}"):
            part.unlink(missing_ok=True)
        with suppress(OSError):  # somebody else's files are in it, or it never was there
            folder.rmdir()


def beside(out: Path) -> Path:
    """Where parts of a result are kept until it is there."""
    whole = out.resolve()
    return whole.with_name(f"{whole.name}.partial")


def kept(work: Callable[..., Found], *task: Any, **aside: Any) -> Found:
    """`work(*task, **aside)`, or what it left in the folder of the block when it was the same task of the same program;
    results must not depend on `aside`.

    Raises:
        ExperimentError: the folder cannot be written.
    """
    return keeper(work)(*task, **aside)


def keeper(work: Callable[..., Found]) -> Callable[..., Found]:
    """`work`, keeping what it finds; it can be handed to another process."""
    return partial(_kept, work, _folders[-1], _program()) if _folders else work


def _kept(work: Callable[..., Found], folder: Path, program: str, *task: Any, **aside: Any) -> Found:
    digest = hashlib.sha256(program.encode())
    _tell(digest.update, (work, task))
    bare = work.func if isinstance(work, partial) else work
    holds = get_type_hints(bare, include_extras=True)["return"]
    path = folder / f"{bare.__name__}-{digest.hexdigest()[:16]}{SUFFIX}"
    if path.exists():
        try:
            found: Found = _read(path, holds)
        except Exception as error:  # NumPy, zipfile and HDF5 raise many kinds on damaged files
            print(f"imitate: {path}: cannot be used ({str(error)[:80]}); it is done again", file=sys.stderr)
        else:
            return found
    found = work(*task, **aside)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with unfinished.open("wb") as file:
            arrays: list[np.ndarray[Any, Any]] = []
            tree = json.dumps(_put(found, arrays)).encode()
            np.savez(file, np.frombuffer(tree, np.uint8), *arrays)
        unfinished.replace(path)
    except OSError as error:
        unfinished.unlink(missing_ok=True)
        why = error.strerror or error
        raise ExperimentError(f"{folder}: what was found cannot be kept there ({why}); make room for it") from error
    return found


def _read(path: Path, holds: Any) -> Any:
    if path.stat().st_size > LARGEST:
        raise ValueError("too large")
    with np.load(path, allow_pickle=False) as held:
        tree, *arrays = (held[f"arr_{n}"] for n in range(len(held.files)))
    return _take(json.loads(tree.tobytes()), arrays, _classes(holds, {}))


@cache
def _program() -> str:
    """All that runs, and the libraries it was found with."""
    digest = hashlib.sha256(repr([(name, version(name)) for name in LIBRARIES]).encode())
    home = Path(__file__).resolve().parents[2]
    for path in sorted(path for name in ("models", "babbling", "imitation", "experiments") for path in home.glob(
        f"{name}/**/*") if path.suffix in (".py", ".xml", ".txt", ".stl", ".obj")):  # fmt: skip
        digest.update(str(path.relative_to(home)).encode() + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _tell(update: Callable[[bytes], None], thing: Any) -> None:
    """Everything that a task says, files that it names by what is in them."""
    update(type(thing).__qualname__.encode())
    if isinstance(thing, np.ndarray) and thing.dtype != object:
        update(repr((thing.dtype.str, thing.shape)).encode() + np.ascontiguousarray(thing).tobytes())
    elif isinstance(thing, np.random.Generator):
        update(repr(thing.bit_generator.state).encode())
    elif isinstance(thing, type | FunctionType):
        if getattr(thing, "__closure__", None):
            raise TypeError(f"{thing.__qualname__}: what a closure holds cannot be told")
        update(f"{thing.__module__}.{thing.__qualname__}".encode())
    elif isinstance(thing, partial):
        _tell(update, [thing.func, thing.args, thing.keywords])
    elif thing is None or isinstance(thing, bool | int | float | str | range | np.generic | Path):
        update(repr(thing).encode())
        if isinstance(thing, str | Path) and len(str(thing)) < 1000 and os.path.isfile(thing):
            update(hashlib.sha256(Path(thing).read_bytes()).digest())
    else:
        for part in _parts(thing):
            _tell(update, part)
    update(b";")


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


def _classes(hint: Any, found: dict[str, type]) -> dict[str, type]:
    """Classes of one's own that a type names, by name."""
    for inner in get_args(hint):
        _classes(inner, found)
    named = is_dataclass(hint) or hasattr(hint, "_fields")
    if isinstance(hint, type) and named and hint.__qualname__ not in found:
        found[hint.__qualname__] = hint
        if not _kind(hint):
            for inner in get_type_hints(hint, include_extras=True).values():
                _classes(inner, found)
    return found


def _kind(holds: type) -> bool:
    return any(kind.holds is holds for kind in KINDS.values())


def _put(thing: Any, arrays: list[np.ndarray[Any, Any]]) -> Any:
    """As JSON; arrays are numbered."""
    if thing is None or type(thing) in (bool, int, float, str):
        return thing
    if isinstance(thing, np.ndarray | np.generic):
        arrays.append(np.asarray(thing))
        return ["array" if isinstance(thing, np.ndarray) else "number", len(arrays)]
    if _kind(type(thing)):
        with TemporaryDirectory() as folder:
            files.save(thing, Path(folder) / "kind.nc")
            arrays.append(np.frombuffer((Path(folder) / "kind.nc").read_bytes(), np.uint8))
        return ["kind", type(thing).__qualname__, len(arrays)]
    if type(thing) in (list, tuple):
        return [type(thing).__name__, *(_put(one, arrays) for one in thing)]
    if type(thing) is dict:
        return ["dict", *([_put(key, arrays), _put(value, arrays)] for key, value in thing.items())]
    if not (is_dataclass(thing) or hasattr(thing, "_fields")):
        raise TypeError(f"{type(thing).__qualname__} is nothing that can be kept")
    return [
        "class", type(thing).__qualname__, *(_put(getattr(thing, name), arrays) for name in _names(type(thing)))
    ]  # fmt: skip


def _names(holds: Any) -> list[str]:
    return [one.name for one in fields(holds) if one.init] if is_dataclass(holds) else list(holds._fields)


def _take(tree: Any, arrays: list[np.ndarray[Any, Any]], classes: Mapping[str, type]) -> Any:
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
