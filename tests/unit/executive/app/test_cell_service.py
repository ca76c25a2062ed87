"""A cell that runs missions one at a time: its queue, its stops, and what a kill leaves."""

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from executive.app.service import cell_service
from executive.app.service.cell_service import BusyError, CellService, UnknownMissionError
from executive.app.service.journal import Journal
from executive.app.service.messages import MissionRequest
from executive.core.errors import InputError
from executive.engine.recording.reader import Recording

PATIENCE_S = 60.0


def request(way="well", **more):
    return MissionRequest(mission="toy", settings={"way": way}, **more)


def serving(folder):
    return CellService("toy_cell", folder / "served", folder / "toy_cell.lock")


@pytest.fixture
def service(toy):
    with serving(toy) as found:
        yield found


def until(condition, what):
    """Wait until something holds."""
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline, f"never: {what}"
        time.sleep(0.02)


def ended(service, number):
    until(lambda: service.mission(number).state in ("done", "lost"), f"mission {number} ends")
    return service.mission(number)


def under_way(service):
    until(lambda: service.state().state == "running" and service.state().ticks, "it runs")


def test_missions_run_in_order_and_each_has_its_report_and_recording(service):
    first, second = service.submit(request(seed=3)), service.submit(request("fail", seed=4))
    assert (first.id, second.id, second.ahead) == (1, 2, 1)
    done = [ended(service, number) for number in (1, 2)]
    assert [one.report.outcome for one in done] == ["success", "failure"]
    assert [Recording.open(Path(one.report.recording)).header.seed for one in done] == [3, 4]
    assert service.state().state == "idle"
    ticks = service.ticks(-1, 100)
    assert [tick.mission for tick in ticks] == [2] * len(ticks)
    assert "toy.told_to" in ticks[-1].outcomes["toy"]
    assert service.ticks(ticks[0].tick, 100) == ticks[1:]
    assert service.ticks(-1, 100, mission=1) == ()


def test_a_pause_a_stop_and_going_on(service):
    service.submit(request("long"))
    waiting = service.submit(request())
    gone = service.submit(request())
    under_way(service)
    assert service.pause().state == "paused"
    time.sleep(0.3)  # what was under way is over, and has been read
    ticks = service.state().ticks
    time.sleep(0.3)
    assert service.state().ticks == ticks
    assert service.go_on().state == "running"
    until(lambda: service.state().ticks > ticks + 1, "it goes on")
    assert service.withdraw(gone.id).state == "withdrawn"
    assert service.stop().state == "stopping"
    view = ended(service, 1)
    assert (view.report.outcome, "the service" in view.report.reason) == ("aborted", True)
    assert (service.state().state, service.state().queued) == ("held", 1)
    time.sleep(0.3)
    assert service.mission(waiting.id).state == "queued"
    service.go_on()
    assert ended(service, waiting.id).report.outcome == "success"
    assert service.mission(gone.id).state == "withdrawn"
    with pytest.raises(InputError, match="is withdrawn already"):
        service.withdraw(gone.id)


def test_a_mission_that_dies_costs_neither_the_service_nor_the_queue(service):
    service.submit(request("die"))
    service.submit(request())
    view = ended(service, 1)
    assert (view.state, view.report) == ("lost", None)
    assert "SIGKILL" in view.reason
    state = service.state()
    assert (state.state, state.queued) == ("held", 1)
    assert "mission 1 was lost" in state.why_held
    assert Recording.open(Path(view.recording)).result is None
    assert service.resume(1).resumes == 1
    service.go_on()
    assert ended(service, 2).report.outcome == "success"
    again = ended(service, 3)
    assert "no checkpoint" in again.report.reason
    with pytest.raises(InputError, match="nothing to go on with"):
        service.resume(2)


def test_an_emergency_stop_ends_even_a_mission_that_hangs(service, monkeypatch):
    monkeypatch.setattr("executive.app.service.mission_process.END_S", 0.5)
    service.submit(request("hang"))
    under_way(service)
    service.emergency_stop()
    assert ended(service, 1).state in ("done", "lost")
    assert service.state().why_held == "emergency stop"


def test_what_comes_twice_with_one_key_is_one_mission(service):
    with ThreadPoolExecutor(8) as pool:
        views = list(pool.map(service.submit, [request(key="order 7")] * 8))
    assert {view.id for view in views} == {1}
    with pytest.raises(InputError, match="key 'order 7': is that of mission 1"):
        service.submit(request("fail", key="order 7"))
    ended(service, 1)
    assert service.submit(request(key="order 7")).report.outcome == "success"


def test_what_cannot_run_is_refused_at_once(service, toy):
    with pytest.raises(InputError, match="unknown mission 'tov'"):
        service.submit(MissionRequest(mission="tov"))
    with pytest.raises(InputError, match=r"unknown key 'wya'; did you mean 'way'\?"):
        service.submit(MissionRequest(mission="toy", settings={"wya": 1}))
    (toy / "other.yaml").write_text("format: 1\nmission: other\ncell: dry\nroot: {wait: 1.0}\n")
    with pytest.raises(
        InputError, match="runs on the cell 'dry'; expected a mission of 'toy_cell'"
    ):
        service.submit(MissionRequest(mission="other"))
    with pytest.raises(UnknownMissionError):
        service.mission(1)
    with pytest.raises(BusyError, match="pause: no mission is under way"):
        service.pause()
    assert service.missions() == []


def test_a_queue_has_an_end(service, monkeypatch):
    monkeypatch.setattr(cell_service, "MOST_QUEUED", 3)
    service.stop()
    for _ in range(3):
        service.submit(request())
    with pytest.raises(BusyError, match="3 missions are queued; try again later"):
        service.submit(request())


def test_a_second_process_is_refused(service, toy):
    with pytest.raises(InputError, match=rf"the cell 'toy_cell' is held .*process {os.getpid()}"):
        serving(toy).__enter__()


SERVE = """
import sys, threading
from pathlib import Path
from executive.app.service.cell_service import CellService
from executive.app.service.messages import MissionRequest
folder = Path(sys.argv[1])
with CellService("toy_cell", folder / "served", folder / "toy_cell.lock") as service:
    for way in ("long", "well"):
        service.submit(MissionRequest(mission="toy", settings={"way": way}, key=way))
    print("serving", flush=True)
    threading.Event().wait()
"""


def test_after_a_kill_missions_are_known_again_and_nothing_moves_by_itself(toy):
    with subprocess.Popen(
        [sys.executable, "-c", SERVE, str(toy)], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "serving\n"
        recording = toy / "served" / "mission_000001.mcap"
        until(lambda: recording.exists() and recording.stat().st_size > 5000, "it runs")
        process.send_signal(signal.SIGKILL)
    until(lambda: Recording.open(recording).result is not None, "the mission is stopped in order")
    assert Recording.open(recording).result.report.outcome == "aborted"
    with serving(toy) as service:
        state = service.state()
        assert (state.state, state.queued, state.last) == ("held", 1, 1)
        assert state.why_held == "the service was started anew"
        assert service.mission(1).state == "lost"
        assert service.submit(request("long", key="long")).id == 1
        service.go_on()
        assert ended(service, 2).report.outcome == "success"
        assert service.submit(request()).id == 3
        ended(service, 3)


def test_a_journal_that_is_damaged_gives_what_is_left(toy):
    with serving(toy) as service:
        for _ in range(3):
            service.submit(request())
        ended(service, 3)
    file = toy / "served" / cell_service.JOURNAL
    data = file.read_bytes()
    file.write_bytes(b"\x00\xff not json\n" + data[:-30])
    found = {view.id: view.state for view in Journal(file).read()}
    assert found == {1: "done", 2: "done", 3: "running"}


def test_many_clients_at_once_lose_no_command(service):
    service.stop()
    found, wrong = [], []

    def client(number):
        try:
            for place in range(5):
                found.append(service.submit(request(key=f"{number}/{place}")).id)
                service.state()
        except Exception as error:
            wrong.append(error)

    threads = [threading.Thread(target=client, args=(number,)) for number in range(10)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []
    assert sorted(found) == list(range(1, 51))
    assert [view.id for view in service.missions()] == list(range(1, 51))
