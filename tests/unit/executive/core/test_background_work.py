"""Background work: never in the way of a tick, cancelled with its skill, errors raised in it."""

import os
import threading
import time
from typing import ClassVar

import pytest
import work_examples

from executive.core.errors import DeviceError
from executive.core.outcome import Status, failure, success
from executive.core.process_work import ProcessWorker
from executive.core.skill import Port, Skill, SkillRun
from executive.core.work import CancelToken, InlineWorker, ThreadWorker, Worker

WORKERS = {"inline": InlineWorker, "thread": ThreadWorker, "process": ProcessWorker}
BESIDE = ("thread", "process")


@pytest.fixture
def worker(request):
    worker = WORKERS[request.param]()
    yield worker
    worker.close()


every_worker = pytest.mark.parametrize("worker", WORKERS, indirect=True)
workers_beside = pytest.mark.parametrize("worker", BESIDE, indirect=True)


class Compute(Skill):
    """Have a function called, and say what it raised."""

    OUT: ClassVar = {"value": Port(object)}
    REASONS: ClassVar = frozenset({"work.failed"})

    def __init__(self, worker: Worker) -> None:
        self._worker = worker

    def run(self, function, arguments=(), cancellable=False) -> SkillRun:
        run = self._worker.run_cancellable if cancellable else self._worker.run
        try:
            value = yield from run(function, *arguments)
        except KeyError as error:
            return failure("work.failed", str(error))
        return success(value=value)


def begun(worker, function, *arguments, **more):
    skill = Compute(worker)
    skill.start({"function": function, "arguments": arguments, **more})
    return skill


def waited_for(skill, limit_s=20.0):
    """Step a skill to its end; return the outcome, the steps, and the longest one [s]."""
    steps, longest_s, end_s = 0, 0.0, time.monotonic() + limit_s
    while time.monotonic() < end_s:
        began_s = time.perf_counter()
        outcome = skill.step()
        longest_s = max(longest_s, time.perf_counter() - began_s)
        steps += 1
        if outcome.status is not Status.RUNNING:
            return outcome, steps, longest_s
        time.sleep(0.005)
    raise AssertionError("the work never ended")


@every_worker
def test_an_answer_comes_in_a_later_step(worker):
    skill = begun(worker, work_examples.add, 2, 3)
    assert skill.step().status is Status.RUNNING
    outcome, _, _ = waited_for(skill)
    assert outcome.outputs["value"] == 5


def test_inline_work_takes_two_steps_always():
    for _ in range(3):
        assert waited_for(begun(InlineWorker(), work_examples.add, 1, 1))[1] == 2


@every_worker
def test_what_the_work_raises_is_raised_in_the_skill_with_its_cause(worker):
    with pytest.raises(ValueError, match="outer") as caught:
        waited_for(begun(worker, work_examples.broken))
    assert "inner" in f"{caught.value.__cause__!r}{caught.value.__cause__}"


@every_worker
def test_a_skill_may_make_a_failure_of_it(worker):
    outcome, _, _ = waited_for(begun(worker, {}.__getitem__, "absent"))
    assert outcome.reason.code == "work.failed"


@workers_beside
def test_no_step_waits_for_the_work(worker):
    waited_for(begun(worker, work_examples.add, 1, 1))  # starting the first process takes longer
    outcome, steps, longest_s = waited_for(begun(worker, time.sleep, 0.4))
    assert outcome.status is Status.SUCCESS
    assert steps > 3
    assert longest_s < 0.2


def test_threads_share_memory_and_processes_do_not():
    assert waited_for(begun(ThreadWorker(), work_examples.process_id))[0].outputs["value"] == (
        os.getpid()
    )
    other = waited_for(begun(ProcessWorker(), work_examples.process_id))[0].outputs["value"]
    assert other != os.getpid()


def test_a_halt_sets_the_token_of_a_thread():
    seen = []

    def work(token):
        while not token.cancelled:
            time.sleep(0.002)
        seen.append("cancelled")

    skill = begun(ThreadWorker(), work, cancellable=True)
    skill.step()
    skill.halt()
    end_s = time.monotonic() + 5.0
    while not seen and time.monotonic() < end_s:
        time.sleep(0.005)
    assert seen == ["cancelled"]


def test_a_halt_ends_the_process(tmp_path):
    note = tmp_path / "note"
    skill = begun(ProcessWorker(), work_examples.tell, note, 30.0)
    end_s = time.monotonic() + 20.0
    while not (note.exists() and note.read_text()) and time.monotonic() < end_s:
        skill.step()
        time.sleep(0.01)
    pid = int(note.read_text())
    skill.halt()
    while _runs(pid) and time.monotonic() < end_s:
        time.sleep(0.01)
    assert not _runs(pid)
    assert note.read_text() == str(pid)


def _runs(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_token_in_a_process_can_be_looked_at():
    skill = begun(ProcessWorker(), work_examples.sleep, 0.05, cancellable=True)
    assert waited_for(skill)[0].status is Status.SUCCESS


def test_a_process_that_dies_says_so():
    with pytest.raises(DeviceError, match="die ended without an answer; exit code 7"):
        waited_for(begun(ProcessWorker(), work_examples.die))


def test_what_cannot_cross_is_told():
    with pytest.raises(DeviceError, match="cannot be sent to another process"):
        waited_for(begun(ProcessWorker(), lambda: 1))
    with pytest.raises(DeviceError, match="PickyError: this and that"):
        waited_for(begun(ProcessWorker(), work_examples.picky))
    with pytest.raises((DeviceError, AttributeError), match="lambda"):
        waited_for(begun(ProcessWorker(), work_examples.unpicklable))


def test_work_that_never_ends_is_bounded_and_named():
    worker, go_on = ThreadWorker(most=2), threading.Event()
    skills = [begun(worker, go_on.wait) for _ in range(3)]
    skills[0].step()
    skills[1].step()
    skills[0].halt()
    with pytest.raises(DeviceError, match=r"2 go on \(Event.wait\); expected at most 2"):
        skills[2].step()
    go_on.set()
    waited_for(skills[1])
    waited_for(begun(worker, work_examples.add, 1, 1))


def test_closing_a_worker_cancels_what_is_under_way():
    worker, token = ThreadWorker(), CancelToken()
    work = worker.begin(token, lambda: token._event.wait(5.0))
    worker.close()
    assert token.cancelled
    while not work.done:
        time.sleep(0.001)


def test_an_exit_in_a_thread_is_no_silent_end():
    with pytest.raises(DeviceError, match="ended without an answer"):
        waited_for(begun(ThreadWorker(), _leave))


def _leave():
    raise SystemExit(3)
