"""A Dask cluster, whose workers do the same shards as processes of this machine would, and find the same.

Its workers share nothing with this machine but what is sent: a shard and what it finds. They must be the same program
(`experiments.shared.kept.versions`), which every shard checks: workers may join, leave and die at any time.
"""

import asyncio
import logging
import os
import warnings
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from multiprocessing import active_children
from tempfile import TemporaryDirectory
from threading import Lock
from typing import Any

from experiments.errors import ExperimentError
from experiments.shared.dealing import Killed, NobodyWorks
from experiments.shared.fresh_process import signals_held
from experiments.shared.kept import versions
from experiments.shared.options import LOCAL, a_scheduler
from experiments.stopping import say

PATIENCE_S = 8.0
"""For a scheduler to answer."""
AT_ONCE_S, LOADED_S = 2.0, 100.0
"""For workers of this machine to end where others failed, and where all is well: one that takes the place of another
that was killed loads first."""
_ONE = Lock()
"""A worker does one shard at a time, however many threads it was given: libraries here need not stand more."""


class Differs(Exception):
    """A worker that is another program: where it is, and what it runs."""


@contextmanager
def cluster(scheduler: str, count: int) -> Iterator["Cluster"]:
    """A block that has the cluster of this scheduler; or, if it is `local`, one of `count` processes of this machine,
    which end with the block.

    Raises:
        ExperimentError: `distributed` is not installed, there is no scheduler, or a worker is another program.
    """
    a_scheduler("--scheduler", scheduler)
    distributed = import_module("distributed")
    for name in list(logging.root.manager.loggerDict):
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL)  # what matters is said here
    with ExitStack() as stack:
        stack.enter_context(warnings.catch_warnings())
        warnings.filterwarnings("ignore", module="distributed")
        address = stack.enter_context(_of_this_machine(count)) if scheduler == LOCAL else scheduler
        try:
            with ThreadPoolExecutor(1) as beside:  # a loop may run in this thread
                beside.submit(asyncio.run, _greet(address)).result()
            client = distributed.Client(address, timeout=PATIENCE_S, set_as_default=False)
        except Exception as error:  # whatever it makes of what somebody else may answer
            raise ExperimentError(
                f"--scheduler {scheduler}: no Dask scheduler answers there; start one (dask scheduler), name its "
                f"address (tcp://HOST:8786), or take --scheduler {LOCAL}"
            ) from error
        stack.callback(client.close)
        machines = Cluster(
            client, scheduler, 3 if scheduler == LOCAL else 2
        )  # a scheduler itself gives several of each
        machines.check()
        yield machines


async def _greet(address: str) -> None:
    """See whether a scheduler answers; a client would wait for ever for somebody who is there and silent."""
    comm = import_module("distributed.comm")
    await (await asyncio.wait_for(comm.connect(address, timeout=PATIENCE_S), PATIENCE_S)).close()


@contextmanager
def _of_this_machine(count: int) -> Iterator[str]:
    """The address of a cluster that can be reached from this machine alone."""
    distributed, config = import_module("distributed"), import_module("dask.config")
    others = {process.pid for process in active_children()}
    asked = {
        "distributed.scheduler.allowed-failures": 0,  # it is counted here
        "distributed.deploy.lost-worker-timeout": "1 day",  # new ones load for long where there is much to do
    }
    with TemporaryDirectory(prefix="imitate-", ignore_cleanup_errors=True) as folder, config.set(asked):
        with signals_held():
            own = distributed.LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                host="127.0.0.1",
                dashboard_address=None,
                memory_limit=0,
                local_directory=folder,
                silence_logs=logging.CRITICAL,
            )
        patience_s = AT_ONCE_S
        try:
            yield own.scheduler_address
            patience_s = LOADED_S
        finally:
            with suppress(TimeoutError):
                own.close(timeout=patience_s)
            for process in active_children():
                if process.pid not in others:
                    process.kill()


class Cluster:
    """The workers of a scheduler."""

    def __init__(self, client: Any, scheduler: str, tries: int) -> None:
        self._client, self._scheduler, self.tries, self._waited = client, scheduler, tries, False

    def check(self) -> None:
        """Compare the workers that are there with this program.

        Raises:
            ExperimentError: one differs.
        """
        for address, theirs in self._client.run(versions, on_error="return").items():
            if theirs != versions():
                raise self._differs(address, theirs if isinstance(theirs, Mapping) else {})

    def _differs(self, address: str, theirs: Mapping[str, str]) -> NobodyWorks:
        ours = versions()
        other = {name: theirs.get(name, "unknown") for name in ours if theirs.get(name) != ours[name]}
        told = ", ".join(f"{name} {one} (here {ours[name]})" for name, one in other.items())
        return NobodyWorks(
            f"--scheduler {self._scheduler}: the worker {address} is another program: {told}; install the same there"
        )

    def _gone(self) -> NobodyWorks:
        return NobodyWorks(f"--scheduler {self._scheduler}: it is gone; start it, and this again, which then goes on")

    @property
    def count(self) -> int:
        """Workers at present, as far as they are known here."""
        return len(self._client.scheduler_info()["workers"])

    def begin(self, work: Callable[[Any], Any], task: Any) -> Any:
        """A future of `work(task)`."""
        import cloudpickle

        told = cloudpickle.dumps((work, task))  # opened only by the same program
        return self._client.submit(_shard, versions(), os.environ.get("MUJOCO_GL"), told, pure=False)

    def result(self, future: Any) -> Any:
        """What it came to.

        Raises:
            Killed: several workers were.
            NobodyWorks: a worker is another program, or the scheduler is gone.
        """
        from distributed import KilledWorker

        try:
            return future.result()
        except KilledWorker as error:
            raise Killed from error
        except Differs as error:
            raise self._differs(*error.args) from error
        except CancelledError as error:
            raise self._gone() from error
        finally:
            future.release()

    def attend(self) -> None:
        """Say it once when there are no workers.

        Raises:
            NobodyWorks: the scheduler is gone.
        """
        if self._client.status != "running":
            raise self._gone()
        if not self._waited and not self.count:
            self._waited = True
            say(f"--scheduler {self._scheduler}: there are no workers; waiting for some (dask worker ADDRESS)")


def _shard(asked: Mapping[str, str], graphics: str | None, told: bytes) -> Any:
    """Done by a worker."""
    import cloudpickle
    from distributed import get_worker

    if versions() != asked:
        raise Differs(get_worker().address, versions())
    if graphics is not None:
        os.environ.setdefault("MUJOCO_GL", graphics)
    with _ONE:
        work, task = cloudpickle.loads(told)
        return work(task)
