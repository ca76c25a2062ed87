"""What Dask's workers have of a campaign; imported where Dask is."""

import queue
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from distributed import WorkerPlugin, get_worker

from executive.app.campaigns.jobs import Assignment, Job, RunRecord
from executive.app.campaigns.one_run import lost
from executive.app.campaigns.run_process import RunProcess


class RunsPlugin(WorkerPlugin):
    """Holds the processes of one worker; Dask sets it up and tears it down there."""

    name = "cellwright"

    def __init__(self, assignment: str) -> None:
        """Take an `Assignment` as JSON."""
        self._assignment = assignment

    def setup(self, worker: Any) -> None:
        """Begin with no process: each thread that runs something starts one."""
        del worker
        self.shared = Assignment.model_validate_json(self._assignment)
        self._free: queue.SimpleQueue[RunProcess] = queue.SimpleQueue()
        self._all: list[RunProcess] = []
        self._closed = False

    def teardown(self, worker: Any) -> None:
        """End all processes, and what runs in them."""
        del worker
        self._closed = True
        for process in self._all:
            process.close()

    @contextmanager
    def process(self) -> Iterator[RunProcess]:
        """Lend a process that nobody else has."""
        try:
            process = self._free.get_nowait()
        except queue.Empty:
            process = RunProcess(self.shared)
            self._all.append(process)
        try:
            yield process
        finally:
            self._free.put(process)

    def run(self, job: Job) -> RunRecord:
        """Run one mission."""
        with self.process() as process:
            if self._closed:
                return lost(job, "died", "the campaign was stopped", self.shared)
            return process.run(job)


def run_on_worker(job: str) -> str:
    """Run one mission in a thread of a Dask worker; JSON in, JSON out."""
    plugin: RunsPlugin = get_worker().plugins[RunsPlugin.name]
    return plugin.run(Job.model_validate_json(job)).model_dump_json()
