"""A process of its own, that knows nothing but files and arguments: for what has to work from memory alone."""

from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

Files = Mapping[str, Callable[[Path], object]]
"""Name and writer of each."""
Found = TypeVar("Found")


def in_new_process(work: Callable[..., Found], files: Files, *words: object) -> Found:
    """What `work(FOLDER, *words)` comes to in a new interpreter; `files` are written to FOLDER first."""
    with TemporaryDirectory() as folder, ProcessPoolExecutor(1, get_context("spawn")) as pool:
        for name, write in files.items():
            write(Path(folder) / name)
        return pool.submit(work, Path(folder), *words).result()
