"""Kills, full disks and two processes: faults of processes as a user starts them."""

import json
import os
import signal
import time
from contextlib import suppress
from pathlib import Path

import numpy as np

from benchmarks.fault_missions import (
    BROKEN,
    REFUSED,
    call,
    killed_when,
    readable_ticks,
    started,
    write_campaign,
)
from benchmarks.fault_services import served, wait_until, write_served
from benchmarks.fault_trials import Answer
from executive.app.campaigns.folder import CampaignFolder
from executive.core.errors import InputError
from executive.engine.recording.reader import Recording

LIMITS_BYTES = (2_000, 20_000, 60_000, 120_000)
# The recording of the mission has about that many bytes in the end.
_WHOLE_BYTES = 190_000
_CAMPAIGN = ("campaign", "works.yaml", "--out", "out", "--workers", "1")
_RUNS = 24
_TOLD_AT_RESUME = {
    "has ended": "says that it has ended",
    "no checkpoint yet": "says that there is no checkpoint yet",
}


def mission_killed(folder: Path, rng: np.random.Generator) -> Answer:
    """Kill a mission at a random moment, and go on with it to its end."""
    file, again = folder / "killed.mcap", folder / "again.mcap"
    due_bytes, delay_s = int(rng.integers(1, _WHOLE_BYTES)), float(rng.uniform(0.0, 0.02))
    seen = 0

    def is_due() -> bool:
        nonlocal seen
        if not file.exists() or file.stat().st_size < due_bytes:
            return False
        time.sleep(delay_s)
        seen = readable_ticks(file)
        return True

    killed_when(folder, ("run", "work.yaml", "--record", file), is_due)
    kept = readable_ticks(file)
    words = ("resume", file, "--record", again, "--as-it-stands", "--json")
    answer = call(folder, *words)
    report = json.loads(answer.stdout.strip().splitlines()[-1])
    lost = max(0, seen - kept)
    if answer.returncode == REFUSED:
        for told, did in _TOLD_AT_RESUME.items():
            if told in report["reason"]:
                return Answer(lost == 0, did, lost)
        return Answer(False, str(report["reason"]), lost)
    held = report["outcome"] == "success" and readable_ticks(again) >= int(report["ticks"]) > 0
    return Answer(held and lost == 0, "went on from the last checkpoint to its end", lost)


def campaign_killed(folder: Path, rng: np.random.Generator) -> Answer:
    """Kill a campaign after a random number of results; go on, and look at what is there."""
    results, due = folder / "out" / "results.jsonl", int(rng.integers(0, _RUNS))
    delay_s = float(rng.uniform(0.0, 0.1))

    def is_due() -> bool:
        begun = (folder / "out").exists()
        if not begun or (due and not results.exists()):
            return False
        if due and results.read_bytes().count(b"\n") < due:
            return False
        time.sleep(delay_s)
        return True

    killed_when(folder, _CAMPAIGN, is_due)
    kept = CampaignFolder(folder / "out")
    try:
        kept.plan()
    except InputError:
        begun_anew = call(folder, *_CAMPAIGN).returncode == 0
        return Answer(begun_anew, "had not begun, was begun anew")
    before = list(kept.records())
    again = call(folder, *_CAMPAIGN, "--resume")
    after = {record.name: record for record in kept.records()}
    lost = sum(after.get(one.name) != one for one in before)
    held = again.returncode == 0 and len(after) == _RUNS and lost == 0
    return Answer(held, "went on and ran nothing again that was over", lost)


def run_of_campaign_killed(folder: Path, rng: np.random.Generator) -> Answer:
    """Kill the process of a run while a campaign is under way."""
    write_campaign(folder, "{parts: 200}")
    count = int(rng.integers(2, 6))
    killed: list[int] = []
    with started(folder, *_CAMPAIGN) as campaign:
        while campaign.poll() is None:
            for run in _grandchildren(campaign.pid):
                if run not in killed and len(killed) < count:
                    killed.append(run)
                    _kill(run)
            time.sleep(float(rng.uniform(0.0, 0.3)))
    records = list(CampaignFolder(folder / "out").records())
    died = sum(record.outcome == "died" for record in records)
    rest = sum(record.outcome == "success" for record in records)
    held = campaign.returncode == 1 and died >= 1 and died + rest == _RUNS == len(records)
    return Answer(held, "kept it as died, ran all others")


def service_killed(folder: Path, rng: np.random.Generator) -> Answer:
    """Kill a service in the middle of a mission, and start it again."""
    write_served(folder)
    recording = folder / "runs" / "own" / "mission_000001.mcap"
    with served(folder) as first:
        first.ask("POST", "/missions", {"mission": "work", "settings": {"parts": 100_000}})
        due = int(rng.integers(1, 2000))
        wait_until(lambda: readable_ticks(recording) >= due)
        first.kill()
    before = readable_ticks(recording)
    wait_until(lambda: Recording.open(recording).result is not None)
    with served(folder) as second:
        lost_it = second.ask("GET", "/missions/1")["state"] == "lost"
        held = second.ask("GET", "/cell")["state"] == "held"
    lost = max(0, before - readable_ticks(recording))
    return Answer(lost_it and held and not lost, "stopped the mission in order, was held", lost)


def disk_full(folder: Path, rng: np.random.Generator) -> Answer:
    """Let no file grow beyond a size: what fits is kept, and the run says what is wrong."""
    limit = int(rng.choice(LIMITS_BYTES))
    answer = call(folder, "run", "work.yaml", "--record", "full.mcap", "--json", most_bytes=limit)
    told = "cannot write the recording" in answer.stdout + answer.stderr
    kept = limit < 10_000 or readable_ticks(folder / "full.mcap") > 0
    held = answer.returncode == BROKEN and told and kept
    return Answer(held, "stopped in order, exit code 3, kept what fits")


def campaign_on_full_disk(folder: Path, rng: np.random.Generator) -> Answer:
    """Let the results not grow; make room, and go on."""
    write_campaign(folder, f"{{parts: 1, note: {'long ' * 500}}}")
    limit = int(rng.integers(34_000, 46_000))  # a recording fits in, all results do not
    first = call(folder, *_CAMPAIGN, most_bytes=limit)
    told = first.returncode == REFUSED and "results.jsonl: cannot be written" in first.stderr
    again = call(folder, *_CAMPAIGN, "--resume")
    names = {record.name for record in CampaignFolder(folder / "out").records()}
    held = told and again.returncode == 0 and len(names) == _RUNS
    return Answer(held, "ended with the file's name, went on when there was room")


def second_service(folder: Path, _: np.random.Generator) -> Answer:
    """Serve a cell twice."""
    return _beside_a_service(folder, "serve", "own.yaml", "--port", "0", "--out", "elsewhere")


def run_beside_service(folder: Path, _: np.random.Generator) -> Answer:
    """Run a mission from the command line on a cell that is served."""
    return _beside_a_service(folder, "run", "work.yaml")


def _beside_a_service(folder: Path, *words: str) -> Answer:
    write_served(folder)
    with served(folder) as first:
        second = call(folder, *words)
    told = f"process {first.pid}" in second.stderr + second.stdout
    return Answer(second.returncode == REFUSED and told, "refused the second, named the first")


def second_campaign(folder: Path, _: np.random.Generator) -> Answer:
    """Go on with a campaign that is under way."""
    lock = folder / "out" / "campaign.lock"
    with started(folder, *_CAMPAIGN) as first:
        while first.poll() is None and not (lock.exists() and lock.read_bytes()):
            time.sleep(0.01)
        second = call(folder, *_CAMPAIGN, "--resume")
    held = first.returncode == 0 and second.returncode == REFUSED
    return Answer(held and f"process {first.pid}" in second.stderr, "refused the second")


def _grandchildren(pid: int) -> list[int]:
    return [run for child in _children(pid) for run in _children(child)]


def _children(pid: int) -> list[int]:
    found: list[int] = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with suppress(OSError):  # it has ended meanwhile
            found += [int(word) for word in task.read_text().split()]
    return found


def _kill(pid: int) -> None:
    with suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)
