"""The suite itself finds what it is there to find: each fault, in a reader that has it."""

import ctypes
import json
import os
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from models.errors import BodyError
from tests.fuzz import __main__ as fuzz
from tests.fuzz.mutations import mutated
from tests.fuzz.readers import Reader


def gently() -> None:
    try:
        np.zeros(1 << 29).sum()
    except MemoryError:
        raise BodyError("is too large") from None


def forever() -> None:
    while True:
        pass


class Bare(BodyError):
    """An error that says its words as they are."""

    __str__ = ValueError.__str__


def refuse(words: str) -> None:
    raise Bare(words)


FAULTS: dict[str, tuple[Callable[[], object], str]] = {
    "another error": (lambda: {}["x"], "KeyError"),
    "a law": (lambda: (_ for _ in ()).throw(AssertionError("not finite")), "AssertionError: not finite"),
    "a crash": (lambda: ctypes.string_at(0), "dies of SIGSEGV"),
    "an end": (lambda: os._exit(0), "ends the process"),
    "no end": (forever, "hangs: 0.2 s of processor time"),
    "waiting": (lambda: time.sleep(99), "hangs: nothing for 2 s"),
    "slow": (lambda: [0 for _ in iter(lambda: time.process_time() < fuzz.begun + 0.6, False)], "takes more than 0.2 s"),
    "much": (lambda: np.zeros(1 << 29), "takes more than a gigabyte|MemoryError"),
    "much, told as something else": (gently, "takes more than a gigabyte"),
    "native words": (lambda: os.write(2, b"Error: bad\n"), "prints: Error: bad"),
    "words": (lambda: print("hm", file=sys.stderr), "prints: hm"),
    "a warning": (lambda: warnings.warn("overflow", RuntimeWarning, stacklevel=1), "prints: warning: overflow"),
    "a file": (lambda: Path("MUJOCO_LOG.TXT").write_text("x"), "leaves ['MUJOCO_LOG.TXT']"),
    "a long line": (lambda: refuse("x" * 400), "a long line"),
    "an unprintable line": (lambda: refuse("\x1b[31m"), "an unprintable line"),
    "what is right": (lambda: refuse("no"), "refuses what is right: imitate: no"),
}
NONE: dict[str, Callable[[], object]] = {"reads": lambda: None, "refuses": lambda: refuse("case.txt: is bad")}


@pytest.fixture
def tried(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> Iterator[Callable[[str, Callable[[], object]], fuzz.Tally]]:
    """A reader that does something at its third case (or, to refuse what is right, at its first)."""
    monkeypatch.setattr(fuzz, "MOST_CPU_S", 0.2)

    def supervised(name: str, does: Callable[[], object]) -> fuzz.Tally:
        def read(path: Path) -> None:
            at = json.loads(path.read_bytes())
            fuzz.begun = time.process_time()  # type: ignore[attr-defined]
            if at == 2 or name == "what is right" or name in NONE:
                does()

        def make(path: Path, seeds: object, others: object, number: int, rng: object) -> None:
            path.write_text(str(number))

        monkeypatch.setattr(fuzz, "MOST_WALL_S", 2.0 if name == "waiting" else 60.0)
        monkeypatch.setitem(fuzz.READERS, name, Reader("case.txt", lambda _: [b"0"], read, BodyError, (), 5, make))
        (folder := tmp_path / name).mkdir()
        return fuzz.supervised((name, {name: (folder, [b"0"])}, 0, None))

    yield supervised


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found_and_the_other_cases_are_tried_all_the_same(
    fault: str, tried: Callable[..., fuzz.Tally]
) -> None:
    does, said = FAULTS[fault]
    found = tried(fault, does)
    [(bug, cases)] = found.bugs.items()
    assert any(one in bug for one in said.split("|")) and cases == [0 if fault == "what is right" else 2]
    assert found.cases == 5 and f"--reader '{fault}' --case {cases[0]}" in found.told()


@pytest.mark.parametrize("name", NONE)
def test_a_reader_that_keeps_the_law_has_no_fault(name: str, tried: Callable[..., fuzz.Tally]) -> None:
    found = tried(name, NONE[name])
    if name == "refuses":  # the first one is right
        assert found.bugs.pop("refuses what is right: imitate: case.txt: is bad") == [0]
    assert not found.bugs and (found.read, found.refused) == ((5, 0) if name == "reads" else (0, 4))


def test_a_case_is_the_same_every_time_and_no_two_seeds_make_the_same_cases() -> None:
    seeds, words = [b"<a><b c='1'/></a>", b"time,a\n0,1\n" * 9], (b"time", b"nan")

    def made(seed: int) -> list[bytes]:
        return [mutated(seeds, words, [b"x"], n, np.random.default_rng([seed, n])) for n in range(300)]

    assert made(0) == made(0) != made(1)
    assert made(0)[:2] == seeds and len(set(made(0))) > 200
