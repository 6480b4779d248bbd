"""Shards: the same bytes here, in processes and on a cluster, whoever is killed, joins late, fails or is another."""

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing, contextmanager, suppress
from multiprocessing import active_children
from pathlib import Path
from typing import Any

import psutil
import pytest

from experiments.errors import ExperimentError
from experiments.shared import cluster, options
from experiments.shared.dealing import AHEAD, Failure, Killed, dealt, failure
from experiments.shared.fresh_process import in_new_process
from experiments.shared.kept import keeping, versions
from experiments.shared.options import LOCAL, ShardOptions
from experiments.shared.parallel import attempted, in_order, in_parallel, succeeded
from tests.experiments.shards import Drawn, Shard, done, draw, listening, meet

ROOT = Path(__file__).resolve().parents[2]


def same(found: Sequence[Drawn | Failure], shards: Sequence[Shard]) -> bool:
    """To the last bit what each shard finds, in order."""
    wanted = [(one.seed, draw(Shard(one.seed, one.notes.parent)).numbers.tobytes()) for one in shards]
    return [(one.seed, one.numbers.tobytes()) for one in found if isinstance(one, Drawn)] == wanted


@pytest.fixture
def notes(tmp_path: Path) -> Path:
    (folder := tmp_path / "notes").mkdir()
    return folder


# --- how they are dealt ----------------------------------------------------------------------------------------------


class Threads:
    """Workers that are watched; who does `fatal` is killed, and with him all that is under way."""

    tries = 3

    def __init__(self, workers: int, fatal: int = -1) -> None:
        self.count, self.fatal, self.most, self.under = workers, fatal, 0, set[int]()
        self.together: list[set[int]] = []
        self.pool = ThreadPoolExecutor(workers)

    def begin(self, work: Callable[[int], int], task: int) -> "Future[int]":
        self.under.add(task)
        self.most = max(self.most, len(self.under))
        future: Future[int] = self.pool.submit(lambda: work(task))
        future.task = task  # type: ignore[attr-defined]
        return future

    def result(self, future: "Future[int]") -> int:
        if self.fatal in self.under:
            self.together.append(set(self.under))
        self.under.discard(future.task)  # type: ignore[attr-defined]
        if future.task == self.fatal:  # type: ignore[attr-defined]
            raise Killed
        return future.result()

    def attend(self) -> None:
        pass


def test_a_few_are_under_way_and_all_are_done() -> None:
    workers = Threads(3)
    ended = dict(dealt(lambda task: -task, range(100), workers))
    assert ended == {task: -task for task in range(100)} and workers.most == 3 * AHEAD


def test_who_kills_its_workers_is_alone_at_last_and_named() -> None:
    workers = Threads(2, fatal=4)
    ended = dict(dealt(lambda task: -task, range(10), workers))
    assert str(ended.pop(4)).startswith("4: whoever did this was killed again and again")
    assert ended == {task: -task for task in range(10) if task != 4}
    assert workers.together[-1] == {4} and len(workers.together[0]) > 1


def test_a_failure_says_whose_it_is(tmp_path: Path) -> None:
    told = failure(Shard(3, tmp_path), KeyError("x\ny"))
    assert str(told) == r"seed 3: KeyError: 'x\ny'"
    assert str(failure(("a", 1), ExperimentError("--x 1:\nit is wrong"))) == "('a', 1): --x 1: it is wrong"
    with pytest.raises(ExperimentError, match=r"^2 of 3 failed: seed 3: KeyError.* \| 'b': ValueError: nothing is sai"):
        succeeded([told, 1, failure("'b'", ValueError())])
    assert succeeded([1, None]) == [1, None]


# --- here and in processes -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("workers", [1, 2])
def test_the_same_comes_of_one_process_and_of_two(workers: int, notes: Path) -> None:
    """The first shard ends last; one fails, the others go on."""
    shards = [Shard(seed, notes, takes_s=0.5 * (seed == 0), fails=seed == 2) for seed in range(6)]
    found = attempted(draw, shards, workers, "drawing")
    assert same(found, [one for one in shards if not one.fails]) and isinstance(found[2], Failure)
    assert [len(done(one)) for one in shards] == [1] * 6
    assert len({pid for one in shards for pid in done(one)} - {os.getpid()}) == (0 if workers == 1 else 2)
    with pytest.raises(KeyError):
        in_parallel(draw, shards[2:], 1, "drawing")


def test_a_process_that_is_killed_costs_what_it_was_doing(notes: Path) -> None:
    shards = [Shard(seed, notes, deaths=seed == 3) for seed in range(8)]
    with keeping(notes / "parts"):
        assert same(in_parallel(draw, shards, 2, "drawing"), shards)
    tries = [len(done(one)) for one in shards]
    assert tries[3] == 2 and max(tries) == 2 and sum(tries) <= 8 + 2
    assert [p.name for p in notes.glob("parts*")] == [] and not active_children()


def test_a_shard_that_always_kills_its_process_is_named_and_the_others_are_done(notes: Path) -> None:
    shards = [Shard(seed, notes, deaths=99 * (seed == 1)) for seed in range(4)]
    found = attempted(draw, shards, 2, "drawing")
    assert same(found, [one for one in shards if not one.deaths]) and len(done(shards[1])) == 3
    with pytest.raises(ExperimentError, match=r"^1 of 4 failed: seed 1: whoever did this was killed again"):
        succeeded(found)


def once_killed(folder: Path, tries: Path) -> int:
    """The second process does it."""
    (tries / str(os.getpid())).touch()
    if len(list(tries.iterdir())) == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return 7


def test_a_new_process_that_is_killed_is_followed_by_another(notes: Path) -> None:
    assert in_new_process(once_killed, {}, notes) == 7 and len(list(notes.iterdir())) == 2


def test_who_asks_no_further_ends_the_processes(notes: Path) -> None:
    shards = [Shard(seed, notes, takes_s=60 * (seed > 0)) for seed in range(4)]
    found = in_order(draw, shards, 2)
    assert same([next(found)], shards[:1]) and len(active_children()) == 2
    found.close()
    assert not active_children()


# --- on a cluster ----------------------------------------------------------------------------------------------------


def environment(home: Path = ROOT) -> dict[str, str]:
    few = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"}  # deaths that the scheduler says nothing of
    return {**os.environ, "PYTHONPATH": str(home), **few}


@contextmanager
def program(*words: str, home: Path = ROOT) -> Iterator["subprocess.Popen[str]"]:
    """One that runs beside, and is ended with all that it began."""
    quiet: Any = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    running = subprocess.Popen(
        [sys.executable, "-m", *words], env=environment(home), cwd=home, text=True, start_new_session=True, **quiet
    )
    try:
        yield running
    finally:
        with suppress(ProcessLookupError):
            os.killpg(running.pid, signal.SIGKILL)
        running.wait()


@contextmanager
def scheduler(folder: Path) -> Iterator[str]:
    """The address of a scheduler without workers."""
    pytest.importorskip("distributed", reason="distributed is not installed: extra `cluster`")
    told = folder / "scheduler.json"
    words = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(told))
    with program("distributed.cli.dask_scheduler", *words):
        until = time.monotonic() + 100
        while not told.exists() and time.monotonic() < until:
            time.sleep(0.02)
        time.sleep(0.1)  # it is being written
        yield str(json.loads(told.read_text())["address"])


def worker(address: str, scratch: Path, home: Path = ROOT) -> Any:
    """A worker that is followed by another when it is killed."""
    words = ("--nthreads", "1", "--host", "127.0.0.1", "--no-dashboard", "--local-directory", str(scratch))
    return program("distributed.cli.dask_worker", address, *words, home=home)


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A cluster of two workers."""
    folder = tmp_path_factory.mktemp("cluster")
    with scheduler(folder) as address, worker(address, folder), worker(address, folder):
        yield address


@pytest.fixture(scope="module")
def empty(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A scheduler whose workers come and go."""
    with scheduler(tmp_path_factory.mktemp("cluster")) as address:
        yield address


def test_the_same_comes_of_a_cluster_and_this_process_keeps_it(two: str, notes: Path) -> None:
    """The workers are not told where; one shard fails; one has its worker killed."""
    shards = [Shard(seed, notes, 0.5 * (seed == 0), deaths=seed == 3, fails=seed == 2) for seed in range(6)]
    with keeping(notes.parent / "parts", stays=True):
        found = attempted(draw, shards, 2, "drawing", two)
        assert same(found, [one for one in shards if not one.fails])
        assert len(list(notes.parent.glob("parts/*"))) == 5
        assert same(attempted(draw, shards, 2, "drawing", two), [one for one in shards if not one.fails])
    assert [len(done(one)) for one in shards[2:4]] == [2, 2] and len(done(shards[0])) <= 2
    with pytest.raises(ExperimentError, match=r"^1 of 6 failed: seed 2: KeyError: 2$"):
        succeeded(found)


def test_a_shard_that_always_kills_its_workers_is_named(two: str, notes: Path) -> None:
    shards = [Shard(seed, notes, deaths=99 * (seed == 1)) for seed in range(3)]
    found = attempted(draw, shards, 2, "drawing", two)
    assert same(found, [shards[0], shards[2]]) and "seed 1: whoever did this was killed again" in str(found[1])


def test_a_client_that_is_killed_goes_on(two: str, notes: Path) -> None:
    shards = [Shard(seed, notes, takes_s=0.3) for seed in range(8)]
    with program("tests.experiments.shards", two, str(notes), "8", "0.3") as client:
        until = time.monotonic() + 100
        while len(kept := list(notes.glob("parts/*.npz"))) < 2 and client.poll() is None and time.monotonic() < until:
            time.sleep(0.01)
        client.kill()
        client.wait()
    kept = list(notes.glob("parts/*.npz"))
    assert 2 <= len(kept) < 8
    with keeping(notes / "parts"):
        assert same(in_parallel(draw, shards, 2, "drawing", two), shards)
    tries = [len(done(one)) for one in shards]
    assert sum(one > 1 for one in tries) <= 8 - len(kept) and max(tries) == 2 and not (notes / "parts").exists()


def test_a_worker_that_joins_late_works_too(empty: str, notes: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shards = [Shard(seed, notes) for seed in range(3)]
    with ThreadPoolExecutor(1) as beside, worker(empty, notes.parent):
        asked = beside.submit(lambda: in_parallel(meet, shards, 2, "meeting", empty))
        until = time.monotonic() + 100
        while not list(notes.glob("process-*")) and time.monotonic() < until:
            time.sleep(0.02)
        with worker(empty, notes.parent):
            assert len(set(asked.result(timeout=100))) == 2


@pytest.fixture(scope="module")
def another(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """This program, but for a line."""
    home = tmp_path_factory.mktemp("another")
    for package in ("models", "babbling", "imitation", "experiments", "tests"):
        shutil.copytree(ROOT / package, home / package, ignore=shutil.ignore_patterns("*.stl", "*.png", "__pycache__"))
    with (home / "babbling" / "loop.py").open("a") as file:
        file.write("# Another.\n")
    return home


@pytest.mark.parametrize("when", ["first", "late"])
def test_a_worker_that_is_another_program_is_refused(
    when: str, empty: str, another: Path, notes: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with worker(empty, notes.parent, another):
        if when == "late":
            monkeypatch.setattr(cluster.Cluster, "check", lambda machines: None)
        else:
            wait_for_workers(empty)
        with pytest.raises(ExperimentError) as caught:
            in_parallel(draw, [Shard(0, notes)], 2, "drawing", empty)
    said, ours = str(caught.value), versions()["imitation-laboratory"]
    assert f"--scheduler {empty}: the worker tcp://127.0.0.1:" in said and "is another program" in said
    assert f"(here {ours})" in said and "imitation-laboratory 0.1.0 with files" in said and "numpy" not in said
    assert "\n" not in said and not done(Shard(0, notes))


def wait_for_workers(address: str) -> None:
    distributed = pytest.importorskip("distributed")
    with distributed.Client(address, set_as_default=False) as client:
        client.wait_for_workers(1, timeout=100)


def test_a_scheduler_that_goes_ends_it_in_a_line(tmp_path: Path, notes: Path) -> None:
    with scheduler(tmp_path) as address, worker(address, tmp_path) as only:
        shards = [Shard(seed, notes, takes_s=60 * (seed == 1)) for seed in range(2)]
        with closing(in_order(draw, shards, 2, address)) as found:
            assert same([next(found)], shards[:1])
            [one] = [
                one for one in psutil.net_connections("tcp")
                if one.status == "LISTEN" and one.laddr.port == int(address.rpartition(":")[2])
            ]  # fmt: skip
            assert one.pid not in (None, only.pid)
            os.kill(int(str(one.pid)), signal.SIGKILL)
            with pytest.raises(ExperimentError, match=f"^--scheduler {address}: it is gone; start it, and"):
                next(found)


@pytest.mark.parametrize("silent", [False, True])
def test_where_no_scheduler_is_a_line_says_so(silent: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed", reason="distributed is not installed: extra `cluster`")
    monkeypatch.setattr(cluster, "PATIENCE_S", 0.5)
    with socket.socket() as place:
        place.bind(("127.0.0.1", 0))
        if silent:
            place.listen()
        address = f"tcp://127.0.0.1:{place.getsockname()[1]}"
        with pytest.raises(
            ExperimentError, match=f"--scheduler {address}: no Dask scheduler answers there; "
        ) as caught:
            in_parallel(len, ["a"], 2, "counting", address)
    assert "\n" not in str(caught.value)


def test_a_cluster_of_this_machine_can_be_reached_from_it_alone_and_ends(notes: Path) -> None:
    """The same comes of it, a worker that is killed is followed by another, and nothing is left."""
    pytest.importorskip("distributed", reason="distributed is not installed: extra `cluster`")
    before, shards = set(active_children()), [Shard(seed, notes, deaths=seed == 1) for seed in range(3)]
    assert same(in_parallel(draw, shards, 2, "drawing", LOCAL), shards) and len(done(shards[1])) == 2
    [heard] = in_parallel(listening, shards[:1], 1, "listening", LOCAL)
    assert {*heard} == {"127.0.0.1"}
    assert {*active_children()} <= before
    assert not [one for one in psutil.Process().net_connections("tcp") if one.status == "LISTEN"]


@pytest.mark.parametrize("address", ["there", "tcp://there", "http://there:8786", "tcp://:1", "tcp://a b:1"])
def test_what_cannot_be_an_address_is_refused(address: str) -> None:
    with pytest.raises(
        ExperimentError, match=r"--scheduler .*: it must be tcp://HOST:PORT of a Dask scheduler, or loc"
    ):
        ShardOptions(scheduler=address).check()


def test_without_dask_a_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(options, "find_spec", lambda name: None)
    for asked in (ShardOptions(scheduler=LOCAL).check, lambda: in_parallel(len, ["a"], 2, "counting", LOCAL)):
        with pytest.raises(ExperimentError, match=r"^--scheduler: the package distributed is not installed; pip insta"):
            asked()
