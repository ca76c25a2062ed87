"""What faults from outside cost: kills, full disks, damaged files, hanging devices, two processes.

Each fault is injected into processes as a user starts them. A row is the share of injections
after which the cell did what it owes: it went on from what was recorded, or said what is wrong
and kept what it had. `docs/faults.md` tells what that is for each.
"""

import argparse
import tempfile
from collections.abc import Sequence
from pathlib import Path

from benchmarks import fault_damage, fault_devices, fault_kills
from benchmarks.fault_trials import Fault, rows, table, tried
from benchmarks.harness import Row


def run(quick: bool, seed: int, words: Sequence[str] = ()) -> Sequence[Row]:
    """Inject 200 kills into missions and campaigns, and some of every other fault."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks faults")
    parser.add_argument("--out", type=Path, help="folder of trials; those there are not repeated")
    out: Path | None = parser.parse_args([*words]).out
    faults = _faults(quick)
    with tempfile.TemporaryDirectory() as name:
        trials = tried(faults, seed, out or Path(name))
    print(table(faults, trials))
    return rows(faults, trials)


def _faults(quick: bool) -> list[Fault]:
    kills, files, few = (4, 20, 1) if quick else (100, 400, 5)
    by_resume, at_write = "at resume, by a recording without its end", "at the write that fails"
    by_lock = "when the second starts, by a lock"
    return [
        Fault("mission_killed_and_resumed", "kill -9 of a mission", by_resume, kills,
              fault_kills.mission_killed),
        Fault("campaign_killed_and_resumed", "kill -9 of a campaign", "at resume", kills,
              fault_kills.campaign_killed),
        Fault("run_of_campaign_killed_and_told", "kill -9 of a run of a campaign", "at once", few,
              fault_kills.run_of_campaign_killed),
        Fault("service_killed_and_known_again", "kill -9 of a service", "at the next start", few,
              fault_kills.service_killed),
        Fault("recording_on_full_disk_told_and_kept", "full disk, recording", at_write, 4 * few,
              fault_kills.disk_full),
        Fault("campaign_on_full_disk_told_and_resumed", "full disk, results", at_write, few,
              fault_kills.campaign_on_full_disk),
        Fault("frozen_camera_told", "frozen camera", "at the next look, by its stamp", few,
              fault_devices.frozen_camera),
        Fault("frozen_driver_told", "controller that hangs", "within its silence limit", few,
              fault_devices.frozen_driver),
        Fault("lagging_driver_borne_or_told", "controller that lags", "by its echoes", 2 * few,
              fault_devices.lagging_driver),
        Fault("second_service_refused", "two services on one cell", by_lock, few,
              fault_kills.second_service),
        Fault("run_beside_service_refused", "a run and a service on one cell", by_lock, few,
              fault_kills.run_beside_service),
        Fault("second_campaign_refused", "two processes on one campaign", by_lock, few,
              fault_kills.second_campaign),
        Fault("damaged_recording_read_or_refused", "damaged recording", "when it is read", files,
              fault_damage.damaged_recording),
        Fault("damaged_tree_refused_or_sound", "damaged tree", "before anything moves", files,
              fault_damage.damaged_tree),
        Fault("damaged_weights_refused", "damaged weights", "when loaded, by a checksum", 4 * few,
              fault_damage.damaged_weights),
    ]  # fmt: skip
