"""Campaigns that are run: what is kept, what is lost with a process, and how one goes on."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from toy_campaigns import cellwright, write_campaign

from executive.app.campaigns.campaign import Campaign, Where
from executive.app.campaigns.document import read_campaign
from executive.app.campaigns.folder import LOCK, CampaignFolder
from executive.app.campaigns.one_run import RECORDINGS
from executive.core.errors import InputError
from executive.engine.recording.reader import Recording
from executive.engine.result_folders import RESULTS

pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


def campaign(folder, text, out="out"):
    file = write_campaign(folder, text)
    return Campaign(read_campaign(file)[0], folder, folder / out)


def results(one, workers=2):
    return {record.name: record for record in one.run(Where(workers))}


@pytest.mark.parametrize(("way", "parents"), [("neat", 2), ("thread", 1), ("child", 1)])
def test_later_runs_are_forked_from_the_first_if_that_left_nothing_behind(toy, way, parents):
    one = campaign(toy, f"grid: {{way: [{way}]}}\nseeds: [1, 2, 3]\n")
    one.begin()
    found = list(results(one, workers=1).values())
    assert [record.outcome for record in found] == ["success"] * 3
    claimed = [record.measures["claim"] for record in found]  # the process it was forked from
    assert len(set(claimed)) == parents
    assert claimed[1] == claimed[2]


def test_one_run_that_breaks_loses_only_itself(toy):
    one = campaign(
        toy,
        "grid: {way: [well, fail, raise, die, hang, hoard]}\nseeds: [3]\n"
        "limits: {wall_s: 8.0, memory_mb: 250.0}\n",
    )
    one.begin()
    found = {record.settings["way"]: record for record in results(one).values()}
    outcomes = {way: record.outcome for way, record in found.items()}
    assert outcomes == {
        "well": "success",
        "fail": "failure",
        "raise": "error",
        "die": "died",
        "hang": "overdue",
        "hoard": "out of memory",
    }
    assert found["well"].measures == {"claim": 0.5}
    assert found["well"].recording == ""
    assert "toy.told_to" in found["fail"].reason
    assert "SIGKILL" in found["die"].reason
    for way in ("fail", "raise", "die", "hang", "hoard"):
        recording = Recording.open(toy / "out" / found[way].recording)
        assert recording.header.seed == 3
        assert recording.header.inputs["way"] == way
    assert found["hoard"].peak_mb > 250.0 > found["well"].peak_mb
    kept = {path.name for path in (toy / "out" / RECORDINGS).iterdir()}
    assert kept == {Path(one.recording).name for one in found.values() if one.recording}


def test_the_same_campaign_says_the_same_whoever_runs_it(toy):
    text = "grid: {level: [0.1, 0.2]}\nseeds: {count: 3}\n"
    first, second = campaign(toy, text, "a"), campaign(toy, text, "b")
    first.begin()
    second.begin()
    here, there = results(first, 1), results(second, 3)
    strip = {"wall_s", "peak_mb", "host", "recording"}
    assert {name: one.model_dump(exclude=strip) for name, one in here.items()} == {
        name: one.model_dump(exclude=strip) for name, one in there.items()
    }
    assert len(here) == 6


def test_what_is_over_is_not_run_again(toy):
    one = campaign(toy, "grid: {way: [well, die]}\nseeds: {count: 2}\n")
    one.begin()
    some = one.run(Where(1))
    first = next(some)
    some.close()
    again = campaign(toy, "grid: {way: [well, die]}\nseeds: {count: 2}\n")
    again.resume()
    rest = results(again)
    assert first.name not in rest
    kept = list(again.folder.records())
    assert len(kept) == len({record.name for record in kept}) == 4
    assert results(again) == {}
    assert {record.outcome for record in again.run(Where(1), again=True)} == {"died"}


def test_another_campaign_does_not_go_into_the_folder_of_one(toy):
    one = campaign(toy, "seeds: {count: 2}\n")
    one.begin()
    with pytest.raises(InputError, match="holds a campaign already; try --resume"):
        one.begin()
    with pytest.raises(InputError, match="has another 'seeds'"):
        campaign(toy, "seeds: {count: 3}\n").resume()
    (toy / "toy.yaml").write_text((toy / "toy.yaml").read_text() + "# edited\n")
    with pytest.raises(InputError, match=r"toy\.yaml: is not what it was"):
        campaign(toy, "seeds: {count: 2}\n").resume()
    with pytest.raises(InputError, match="holds no campaign"):
        CampaignFolder(toy / "nowhere").plan()


def test_a_mission_that_is_edited_meanwhile_ends_the_campaign(toy):
    one = campaign(toy, "seeds: {count: 2}\n")
    one.begin()
    (toy / "toy.yaml").write_text((toy / "toy.yaml").read_text() + "# edited\n")
    with pytest.raises(InputError, match="is not what it was when the campaign began"):
        results(one)


def test_settings_are_held_against_the_mission_before_anything_is_written(toy):
    with pytest.raises(InputError, match=r"unknown key 'levle'; did you mean 'level'\?"):
        campaign(toy, "grid: {levle: [0.1]}\n")
    assert not (toy / "out").exists()


def test_a_damaged_line_costs_its_own_run_and_no_other(toy):
    one = campaign(toy, "seeds: {count: 4}\n")
    one.begin()
    results(one)
    file = toy / "out" / RESULTS
    lines = file.read_bytes().splitlines(keepends=True)
    file.write_bytes(lines[0] + b"\x00garbage\n" + lines[2] + lines[3][:40])
    one.resume()
    assert len(results(one)) == 2
    assert len(list(one.folder.records())) == 4


def test_two_processes_never_run_one_campaign(toy):
    one = campaign(toy, "seeds: {count: 2}\nset: {way: slow}\n")
    one.begin()
    some = one.run(Where(1))
    next(some)
    with pytest.raises(InputError, match=r"is held by another process \(process \d+\)"):
        next(campaign(toy, "seeds: {count: 2}\nset: {way: slow}\n").run(Where(1)))
    some.close()
    assert (toy / "out" / LOCK).exists()
    assert len(results(one)) == 1


def test_a_process_for_runs_that_is_killed_is_started_anew(toy):
    one = campaign(toy, "seeds: {count: 3}\nset: {way: slow}\n")
    one.begin()

    def kill():
        deadline = time.monotonic() + 20.0
        while time.monotonic() < deadline:
            found = subprocess.run(
                ["ps", "--ppid", str(os.getpid()), "-o", "pid=,args="],
                capture_output=True, text=True, check=False,
            ).stdout  # fmt: skip
            forkers = [line.split()[0] for line in found.splitlines() if "forker" in line]
            if forkers and list((toy / "out" / RECORDINGS).glob("*")):
                os.kill(int(forkers[0]), signal.SIGKILL)
                return
            time.sleep(0.02)

    thread = threading.Thread(target=kill)
    thread.start()
    outcomes = sorted(record.outcome for record in results(one, 1).values())
    thread.join()
    assert outcomes == ["died", "success", "success"]


def test_a_campaign_that_is_killed_leaves_no_process_and_goes_on(toy):
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    file = write_campaign(toy, "seeds: {count: 6}\nset: {way: slow}\n")
    command = [str(Path(sys.executable).with_name("cellwright")), "campaign", str(file)]
    command += ["--out", "out", "--workers", "1"]
    with subprocess.Popen(command, cwd=toy, env=environment, stderr=subprocess.DEVNULL) as process:
        results_file = toy / "out" / RESULTS
        deadline = time.monotonic() + 60.0
        while time.monotonic() < deadline:
            if results_file.exists() and results_file.read_bytes().count(b"\n") >= 2:
                break
            time.sleep(0.05)
        process.kill()
    before = list(CampaignFolder(toy / "out").records())
    assert len(before) >= 2
    deadline = time.monotonic() + 20.0
    while time.monotonic() < deadline and _forkers_of(toy):
        time.sleep(0.1)
    assert _forkers_of(toy) == []
    again = cellwright(toy, environment, *command[1:], "--resume", "--json")
    assert again.returncode == 0, again.stderr
    after = list(CampaignFolder(toy / "out").records())
    assert len(after) == 6
    assert after[: len(before)] == before


def _forkers_of(folder):
    """Return processes for runs that work in a folder."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            if "forker" in (entry / "cmdline").read_text() and (entry / "cwd").readlink() == folder:
                found.append(entry.name)
        except OSError:
            continue
    return found
