"""`python -m tests.fuzz`: every reader is given broken files, each one in a process of its own that may die of them.

    python -m tests.fuzz                             what `make test` does: the same cases every time
    python -m tests.fuzz --seconds 600 --seed 7      other cases, so long over all readers
    python -m tests.fuzz --reader urdf --case 123    one case alone, in this process; --keep FILE leaves it there

The law: a reader reads a file, and what it read keeps its promises; or it raises its own error, one line of less than
400 characters. Nothing else is raised, printed, left behind, waited for; no more than a gigabyte is taken.
"""

import argparse
import contextlib
import faulthandler
import json
import os
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
import zlib
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from multiprocessing import Pipe, get_context
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from models import apart
from tests.fuzz.readers import READERS, Reader

MOST_BYTES, MOST_CPU_S, MOST_WALL_S, MOST_DEATHS = 1 << 30, 5.0, 60.0, 6
"""More memory than before; processor seconds of a case; seconds without a word, on a loaded machine; and deaths, after
which a reader is left alone."""
LONGEST_LINE = 400


@dataclass
class Tally:
    """What came of a reader's cases."""

    reader: str
    read: int = 0
    refused: int = 0
    seconds: float = 0.0
    refusals: dict[str, int] = field(default_factory=dict)
    """First words of refusals, numbers left out -> how often: what was reached."""
    bugs: dict[str, list[int]] = field(default_factory=dict)
    """What went wrong -> cases."""

    @property
    def cases(self) -> int:
        return self.read + self.refused + sum(map(len, self.bugs.values()))

    def told(self) -> str:
        """A line, and a line for each bug with how to see it."""
        lines = [line(self.reader, self.cases, self.read, self.refused, self.seconds)]
        for bug, cases in self.bugs.items():
            lines.append(
                f"    {len(cases)} x {bug}\n        --reader '{self.reader}' --case {' '.join(map(str, cases[:4]))}"
            )
        return "\n".join(lines)


def line(name: str, cases: int, read: int, refused: int, seconds: float) -> str:
    return f"{name:<22} {cases:>7} cases {read:>7} read {refused:>7} refused {seconds:7.1f} s"


def main() -> int:
    """The exit status is 1 where something was found."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("--seconds", type=float, help="processor seconds over all readers, instead of the usual cases")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--reader", action="append", choices=READERS, help="this reader alone; more than once")
    parser.add_argument("--case", type=int, nargs="*", help="these cases of it, in this process")
    parser.add_argument("--keep", type=Path, help="where to put the case's file")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--refusals", action="store_true", help="what was refused how often, too: what was reached")
    parser.add_argument("--json", type=Path, help="where to write what was found")
    asked = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)  # whoever began this may be deaf to it, and a pool's end needs it
    names = asked.reader or list(READERS)
    with prepared() as places:
        if asked.case:
            for number in asked.case:
                alone(names[0], places, asked.seed, number, asked.keep)
            return 0
        share = None if asked.seconds is None else asked.seconds / len(names)
        tasks = [(name, places, asked.seed, share) for name in sorted(names, key=lambda name: -READERS[name].cases)]
        with get_context("fork").Pool(min(asked.jobs, len(tasks))) as pool:
            found = []
            for tally in pool.imap_unordered(supervised, tasks):
                print(tally.told(), flush=True)
                if asked.refusals:
                    for what, times in sorted(tally.refusals.items(), key=lambda one: -one[1])[:25]:
                        print(f"    {times:>6} {what}")
                found.append(tally)
    if asked.json:
        asked.json.write_text(json.dumps([asdict(tally) | {"told": tally.told()} for tally in found]))
    print(line("all", *(sum(getattr(one, what) for one in found) for what in ("cases", "read", "refused", "seconds"))))
    return int(any(tally.bugs for tally in found))


def forked(words: list[str], env: dict[str, str]) -> tuple[int, bytes]:
    """Exit status and words of a trial of `models.apart` in a fork of this process, which has loaded everything."""
    reading, writing = os.pipe()
    if (child := os.fork()) == 0:
        os.dup2(writing, 1)
        os.environ.update(env)
        sys.argv[1:] = words[-3:]
        apart.RESERVED += int(Path("/proc/self/statm").read_text().split()[5]) * resource.getpagesize()
        apart._here()
    os.close(writing)
    if not select.select([reading], [], [], MOST_WALL_S / 2)[0]:
        os.kill(child, signal.SIGKILL)
    said = b"".join(iter(lambda: os.read(reading, 1 << 16), b""))
    os.close(reading)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), said


def trials(out: int) -> type:
    """What stands for `subprocess.Popen` in `models.apart`: `forked`, by a process that is begun now and stays without
    threads, for a fork of one that has some may never end."""
    here, there = Pipe()
    if os.fork() == 0:
        os.close(out)
        here.close()
        with contextlib.suppress(EOFError):  # until who asks has ended
            while True:
                there.send(forked(*there.recv()))
        os._exit(0)
    there.close()

    class Trial(contextlib.nullcontext["Trial"]):
        pid = 0

        def __init__(self, words: list[str], *, env: dict[str, str], **_: object) -> None:
            super().__init__(self)
            here.send((words, dict(env)))
            self.returncode, self.said = here.recv()

        def poll(self) -> int:
            return self.returncode

        def kill(self) -> None:
            pass

        def communicate(self) -> tuple[bytes, bytes]:
            return self.said, b""

    return Trial


@contextlib.contextmanager
def prepared() -> Iterator[dict[str, tuple[Path, list[bytes]]]]:
    """A folder and good examples of every reader; all libraries loaded once, for all processes."""
    with tempfile.TemporaryDirectory(prefix="fuzz-") as root:
        places = {}
        for at, (name, reader) in enumerate(READERS.items()):
            folder = Path(root) / str(at)
            folder.mkdir()
            places[name] = folder, list(reader.seeds(folder))
            path = folder / reader.file
            path.parent.mkdir(exist_ok=True)
            for seed in places[name][1][:1]:  # loads what it loads only once
                path.write_bytes(seed)
                with contextlib.chdir(folder), contextlib.suppress(Exception):
                    reader.read(Path(reader.file))
        yield places


def case(name: str, places: dict[str, tuple[Path, list[bytes]]], seed: int, number: int) -> None:
    """Write a case; it depends on nothing else than these."""
    folder, seeds = places[name]
    others = [one for other, (_, some) in places.items() if other != name for one in some[:1] if len(one) < 20_000]
    rng = np.random.default_rng([seed, zlib.crc32(name.encode()), number])
    path = folder / READERS[name].file
    path.unlink(missing_ok=True)
    READERS[name].write(path, seeds, others, number, rng)


def alone(name: str, places: dict[str, tuple[Path, list[bytes]]], seed: int, number: int, keep: Path | None) -> None:
    """Read one case, unprotected, and say what happens."""
    case(name, places, seed, number)
    path = places[name][0] / READERS[name].file
    if keep:
        shutil.copy(path, keep)
    os.chdir(places[name][0])
    started = time.process_time()
    try:
        found = f"read: {READERS[name].read(Path(READERS[name].file))}"
    except READERS[name].error as error:
        found = f"refused: {error}"
    except Exception:
        found = traceback.format_exc()
    print(f"{name} {number}: {path.stat().st_size} bytes, {time.process_time() - started:.2f} s\n{found}")


def supervised(task: tuple[str, dict[str, tuple[Path, list[bytes]]], int, float | None]) -> Tally:
    """All cases of a reader, by a process that is started again after the one of which it died.

    A case hangs that hangs twice, the second time at the beginning of a process: machines have counted as its time what
    was others'.
    """
    name, places, seed, seconds = task
    tally, first, deaths, doubted = Tally(name), 0, 0, -1
    while (seconds is None and first < READERS[name].cases) or (seconds is not None and tally.seconds < seconds):
        at, said, death = attempt(name, places, seed, first, seconds and seconds - tally.seconds)
        for number, (kind, what, spent) in said.items():
            tally.seconds += spent
            if kind == "bug":
                tally.bugs.setdefault(what, []).append(number)
            elif kind == "read":
                tally.read += 1
            else:
                tally.refused += 1
                tally.refusals[what] = tally.refusals.get(what, 0) + 1
        first = at + 1
        if not death:
            break
        suspect = at + (at in said)  # what was judged had ended: it was in making the next one
        if death.startswith("hangs") and suspect != doubted:
            first = doubted = suspect
            continue
        tally.seconds += MOST_CPU_S
        tally.bugs.setdefault(death, []).append(at)
        deaths += 1
        if deaths == MOST_DEATHS:
            break
    return tally


def attempt(
    name: str, places: dict[str, tuple[Path, list[bytes]]], seed: int, first: int, seconds: float | None
) -> tuple[int, dict[int, tuple[str, str, float]], str]:
    """The case at which a process that began with `first` ended, what came of those before, and what it died of."""
    reading, writing = os.pipe()
    if (child := os.fork()) == 0:
        try:
            os.close(reading)
            batch(name, places, seed, first, seconds, writing)
            os._exit(0)
        except BaseException:
            os.write(writing, json.dumps([-1, "bug", traceback.format_exc(), 0.0]).encode() + b"\n")
        finally:
            os._exit(1)
    os.close(writing)
    at, said, rest, death = first, {}, b"", ""
    while True:
        if not select.select([reading], [], [], MOST_WALL_S)[0]:
            os.kill(child, signal.SIGKILL)
            death = f"hangs: nothing for {MOST_WALL_S:g} s"
        if not (some := os.read(reading, 1 << 16)):
            break
        *whole, rest = (rest + some).split(b"\n")
        for line in whole:
            at, *told = json.loads(line)
            if told:
                said[at] = tuple(told)
    os.close(reading)
    status = os.waitpid(child, 0)[1]
    if os.WIFSIGNALED(status) and not death:
        ended = signal.Signals(os.WTERMSIG(status)).name
        death = f"hangs: {MOST_CPU_S:g} s of processor time" if ended == "SIGXCPU" else f"dies of {ended}"
    if -1 in said:
        raise RuntimeError(f"{name}: the case after {max(said)} cannot be made: {said[-1][1]}")
    if not death and at not in said:
        death = "ends the process"
    return at, said, death


def batch(name: str, places: Any, seed: int, first: int, seconds: float | None, out: int) -> None:
    """Cases, one after the other, each with a word before and a word after."""
    reader, folder, started = READERS[name], places[name][0], time.process_time()
    os.chdir(folder)
    apart.subprocess = SimpleNamespace(**vars(subprocess) | {"Popen": trials(out)})
    words = os.open(folder.with_suffix(".words"), os.O_CREAT | os.O_RDWR | os.O_TRUNC)
    os.dup2(words, 1)
    os.dup2(words, 2)
    sys.stdout = sys.stderr = os.fdopen(2, "w", buffering=1, errors="replace", closefd=False)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    faulthandler.disable()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + MOST_BYTES,) * 2)
    number = first
    while number < reader.cases if seconds is None else time.process_time() - started < seconds:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            case(name, places, seed, number)
        os.write(out, json.dumps([number]).encode() + b"\n")
        before = time.process_time()
        resource.setrlimit(resource.RLIMIT_CPU, (int(before + MOST_CPU_S) + 2, resource.RLIM_INFINITY))
        kind, what = judged(reader, folder, number < len(places[name][1]), words)
        spent = time.process_time() - before
        if spent > MOST_CPU_S:
            kind, what = "bug", f"takes more than {MOST_CPU_S:g} s: {kind} {what}"
        os.write(out, json.dumps([number, kind, what, spent]).encode() + b"\n")
        number += 1


def judged(reader: Reader, folder: Path, right: bool, words: int) -> tuple[str, str]:
    """("read" | "refused" | "bug", what of it)."""
    there = {*folder.rglob("*")}
    apart.apart.cache_clear()  # what a file names may have changed
    try:
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            for nobody_sees in (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning):
                warnings.simplefilter("ignore", nobody_sees)
            reader.read(Path(reader.file))
        kind, what = "read", ""
    except reader.error as error:
        kind, what = refusal(error)
    except BaseException as error:
        kind, what = "bug", f"{type(error).__name__}: {shortened(str(error))} ({where(error)})"
    said = [os.pread(words, 300, 0).decode(errors="replace"), *(f"warning: {one.message}" for one in warned)]
    os.ftruncate(words, 0)
    os.lseek(words, 0, os.SEEK_SET)
    if kind != "bug" and any(said):
        kind, what = "bug", f"prints: {shortened(next(filter(None, said)))[:25]} .."
    if left := {*folder.rglob("*")} - there:
        for path in left:
            path.unlink()
        kind, what = "bug", f"leaves {sorted(path.name for path in left)}"
    if right and kind == "refused":
        kind, what = "bug", f"refuses what is right: {what}"
    return kind, what


def refusal(error: BaseException) -> tuple[str, str]:
    """A refusal as the command line prints it, or what is wrong with it."""
    line, cause = f"imitate: {' '.join(str(error).split())}", error
    while (cause := cause.__cause__ or cause.__context__) is not None:  # type: ignore[assignment]
        if isinstance(cause, MemoryError):
            return "bug", f"takes more than a gigabyte: {shortened(line)} ({where(cause)})"
    if len(line) >= LONGEST_LINE or not line.isprintable():
        fault = "an unprintable" if not line.isprintable() else "a long"
        return "bug", f"{fault} line: {shortened(line)[:45]} ({where(error)})"
    return "refused", shortened(line)


def shortened(said: str) -> str:
    """Enough to know it again, without its numbers and what it quotes."""
    kept = "".join(letter for letter in " ".join(said.split())[:150] if letter.isprintable())
    kept = "".join("#" if letter.isdigit() else letter for letter in kept)
    while "##" in kept:
        kept = kept.replace("##", "#")
    head, *quoted = kept.split("'")
    return head + "".join(part if at % 2 else "'..'" for at, part in enumerate(quoted))


def where(error: BaseException) -> str:
    """The innermost line of the project that it came through."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "site-packages" not in frame.filename]
    named = [f"{'/'.join(Path(frame.filename).parts[-2:])}:{frame.lineno}" for frame in frames]
    ours = [place for place in named if not place.startswith("fuzz/")]
    return " < ".join(reversed((ours or named)[-2:]))


if __name__ == "__main__":
    sys.exit(main())
