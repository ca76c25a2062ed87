"""Runs the missions of a campaign with Dask: on the cores here, or on a cluster.

Dask decides who runs what; each of its threads has a `RunProcess`, so that no mission runs in a
process of Dask's and none of them is lost with a mission.
"""

import time
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING

from executive.app.campaigns.jobs import Assignment, Job, RunRecord
from executive.app.campaigns.one_run import lost
from executive.core.errors import InputError

if TYPE_CHECKING:
    from distributed import Client, Future

AHEAD = 2
"""Runs that are with Dask for each of its threads: one runs, one waits."""

_LOOK_S = 5.0
# What Dask would note of itself: samples of its threads and of the machine, each second anew.
_NO_NOTES = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.system-monitor.log-length": 60,
    "distributed.admin.low-level-log-length": 100,
}
_LOOPBACK = "127.0.0.1"


class Cluster:
    """A Dask cluster that runs the missions of one campaign; close it."""

    def __init__(self, assignment: Assignment, workers: int, scheduler: str | None) -> None:
        """Start a cluster here, or connect to one.

        Args:
            assignment: What is run.
            workers: Runs at a time, on a cluster here.
            scheduler: Address of the scheduler of another one.

        Raises:
            InputError: Dask is not installed, or nobody answers at that address.
        """
        self._assignment = assignment
        self._stack = ExitStack()
        try:
            self._client = self._stack.enter_context(self._connected(workers, scheduler))
            from executive.app.campaigns.on_worker import RunsPlugin

            self._client.register_plugin(RunsPlugin(assignment.model_dump_json()))
            self._stack.callback(self._client.unregister_worker_plugin, RunsPlugin.name)
        except BaseException:
            self._stack.close()
            raise

    @contextmanager
    def _connected(self, workers: int, scheduler: str | None) -> Iterator["Client"]:
        try:
            from dask import config
            from distributed import Client, LocalCluster
        except ImportError:
            raise InputError(
                "campaign: Dask is not installed; try pip install 'cellwright[campaign]'"
            ) from None
        if scheduler is not None:
            try:
                client = Client(scheduler, timeout="10s")
            except (OSError, ValueError) as error:
                raise InputError(
                    f"--scheduler {scheduler}: no Dask scheduler answers there; got {error}; "
                    "try tcp://HOST:8786"
                ) from None
            with client:
                yield client
            return
        # Threads of this process: the missions have processes of their own.
        with (
            config.set(_NO_NOTES),
            LocalCluster(
                n_workers=1,
                threads_per_worker=workers,
                processes=False,
                dashboard_address=f"{_LOOPBACK}:0",
                worker_dashboard_address=f"{_LOOPBACK}:0",
                memory_limit=0,
            ) as cluster,
            Client(cluster) as client,
        ):
            yield client

    def run(self, jobs: Iterable[Job]) -> Iterator[RunRecord]:
        """Run missions and yield what each came to, as they end.

        Only a few more than can run at a time are with Dask, so that ten thousand take no more
        memory than ten.

        Raises:
            InputError: The mission cannot be run on a worker, or the cluster is gone.
        """
        from distributed import as_completed

        left = iter(jobs)
        ending = as_completed()
        under_way: dict[str, Job] = {}
        looked_s, room = 0.0, 0
        while True:
            if time.monotonic() - looked_s > _LOOK_S:
                looked_s, room = time.monotonic(), AHEAD * max(1, self.threads)
            while len(under_way) < room and (job := next(left, None)) is not None:
                future = self._submitted(job)
                under_way[future.key] = job
                ending.add(future)
            if not under_way:
                return
            future = next(ending)
            record = self._record(under_way.pop(future.key), future)
            future.release()
            yield record

    @property
    def threads(self) -> int:
        """How many missions can run at a time; of a cluster that grows, the number now."""
        return sum(self._client.nthreads().values())

    def close(self) -> None:
        """End what still runs, and let go of the cluster."""
        self._stack.close()

    def _submitted(self, job: Job) -> "Future[str]":
        from executive.app.campaigns.on_worker import run_on_worker

        return self._client.submit(run_on_worker, job.model_dump_json(), pure=False)

    def _record(self, job: Job, future: "Future[str]") -> RunRecord:
        from distributed.scheduler import KilledWorker

        try:
            return RunRecord.model_validate_json(future.result())
        except KilledWorker as error:
            return lost(job, "died", " ".join(str(error).split())[:300], self._assignment)
