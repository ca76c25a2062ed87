"""What faults from outside cost: kills, full disks, damaged files, slow links, two processes.

Each fault is injected into processes as a user starts them. A row is the share of injections
after which the cell did what it owes: it went on from what was recorded, or said what is wrong
and kept what it had. `docs/faults.md` tells what that is for each.
"""

import json
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from functools import cache, partial
from pathlib import Path

import numpy as np

from benchmarks.fault_missions import (
    call,
    command,
    environment,
    killed_when,
    readable_ticks,
    write_work,
)
from benchmarks.harness import Row, share
from executive.app.campaigns.folder import CampaignFolder
from executive.app.missions import load
from executive.core.errors import CellwrightError, DeviceError, InputError
from executive.engine.loading.library import packaged_trees
from executive.engine.recording.reader import Recording

LIMITS_BYTES = (2_000, 20_000, 60_000, 120_000)
_REFUSED, _BROKEN = 2, 3

Trial = Callable[[Path, np.random.Generator], bool]


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Inject 200 kills into missions and campaigns, and some of every other fault."""
    kills, files, few = (4, 20, 1) if quick else (100, 400, 5)
    lost: list[int] = []
    trials: list[tuple[str, int, Trial]] = [
        ("mission_killed_and_resumed", kills, partial(_mission_killed, lost)),
        ("campaign_killed_and_resumed", kills, _campaign_killed),
        ("recording_on_full_disk_told_and_kept", few * len(LIMITS_BYTES), _disk_full),
        ("campaign_on_full_disk_told_and_resumed", few, _campaign_on_full_disk),
        ("frozen_camera_told", few, _frozen_camera),
        ("frozen_driver_told", few, _frozen_driver),
        ("second_service_refused", few, _second_service),
        ("damaged_recording_read_or_refused", files, _damaged_recording),
        ("damaged_tree_refused_or_sound", files, _damaged_tree),
        ("damaged_weights_refused", few, _damaged_weights),
    ]
    rows: list[Row] = []
    for name, count, trial in trials:
        rng = np.random.default_rng([seed, len(rows)])
        rows.append(share(name, sum(_held(name, trial, rng) for _ in range(count)), count, "= 1"))
    return [
        *rows,
        Row("recorded_ticks_lost", sum(lost), "1", len(lost), min(lost), max(lost), "= 0"),
    ]


def _held(name: str, trial: Trial, rng: np.random.Generator) -> bool:
    with tempfile.TemporaryDirectory() as folder:
        write_work(Path(folder))
        held = trial(Path(folder), rng)
    if not held:
        print(f"{name}: did not hold")
    return held


def _mission_killed(lost: list[int], folder: Path, rng: np.random.Generator) -> bool:
    """Kill a mission at a random tick, and go on with it to its end."""
    file, again = folder / "killed.mcap", folder / "again.mcap"
    due = int(rng.integers(1, 3500))
    seen = 0

    def is_due() -> bool:
        nonlocal seen
        seen = max(seen, readable_ticks(file))
        return seen >= due

    killed_when(folder, ("run", "work.yaml", "--record", file), is_due)
    kept = readable_ticks(file)
    lost.append(max(0, seen - kept))
    words = ("resume", file, "--record", again, "--as-it-stands", "--json")
    answer = call(folder, *words)
    report = json.loads(answer.stdout.strip().splitlines()[-1])
    if answer.returncode == _REFUSED:
        return "has ended" in report["reason"] or "no checkpoint yet" in report["reason"]
    ended = str(report["outcome"]) == "success"
    return ended and len(Recording.open(again)) >= int(report["ticks"])


def _campaign_killed(folder: Path, rng: np.random.Generator) -> bool:
    """Kill a campaign after a random number of results; go on, and look at what is there."""
    results, due = folder / "out" / "results.jsonl", int(rng.integers(0, 22))

    def is_due() -> bool:
        return (folder / "out").exists() and (
            due == 0 or (results.exists() and results.read_bytes().count(b"\n") >= due)
        )

    words = ("campaign", "works.yaml", "--out", "out", "--workers", "1")
    killed_when(folder, words, is_due)
    kept = CampaignFolder(folder / "out")
    try:
        kept.plan()
    except InputError:  # killed before the folder was begun: it is begun anew
        return call(folder, *words).returncode == 0
    before = list(kept.records())
    again = call(folder, *words, "--resume")
    after = list(kept.records())
    same = after[: len(before)] == before
    return again.returncode == 0 and same and len({one.name for one in after}) == 24


def _disk_full(folder: Path, rng: np.random.Generator) -> bool:
    """Let no file grow beyond a size: what fits is kept, and the run says what is wrong."""
    limit = int(rng.choice(LIMITS_BYTES))
    answer = call(folder, "run", "work.yaml", "--record", "full.mcap", "--json", most_bytes=limit)
    said = answer.stdout + answer.stderr
    if answer.returncode != _BROKEN or "cannot write the recording" not in said:
        return False
    file = folder / "full.mcap"
    return limit < 10_000 or readable_ticks(file) > 0


def _campaign_on_full_disk(folder: Path, rng: np.random.Generator) -> bool:
    """Let the results not grow; make room, and go on."""
    words = ("campaign", "works.yaml", "--out", "out", "--workers", "1")
    limit = int(rng.integers(4_500, 7_000))
    first = call(folder, *words, most_bytes=limit)
    told = first.returncode != 0 and (
        "cannot be written" in first.stderr or "No space" in first.stderr or "error" in first.stderr
    )
    again = call(folder, *words, "--resume", "--again")
    names = {record.name for record in CampaignFolder(folder / "out").records()}
    return told and again.returncode == 0 and len(names) == 24


def _frozen_camera(folder: Path, rng: np.random.Generator) -> bool:
    """Let the camera hand out its first frame for ever: no second look may act on it."""
    answer = call(
        folder,
        *("run", "untangle", "--timeout", "60", "--seed", int(rng.integers(1000))),
        *("--set", "camera.freezes_after=1", "--record", "frozen.mcap", "--json"),
    )
    told = json.loads(answer.stdout.strip().splitlines()[-1])["reason"]
    ended = Recording.open(folder / "frozen.mcap").result is not None
    return answer.returncode == _BROKEN and "camera: has frozen" in told and ended


def _frozen_driver(_: Path, rng: np.random.Generator) -> bool:
    """Let a controller hang while its arms move: the driver says so, and nothing waits for it."""
    from robots.drivers.socket_arms import SocketArms
    from robots.dual_arm import PlannedDualArm
    from robots.interfaces import MotionFailure
    from simulation.loopback.process import LoopbackProcess

    with LoopbackProcess() as controller:
        driver = SocketArms(controller.host, controller.port)
        arms = PlannedDualArm(driver, seed=0)
        motion = arms.plan_line({"left": np.array([0.0, 0.0, 0.05])})
        assert not isinstance(motion, MotionFailure)
        arms.start(motion)
        driver.clock.sleep_until(driver.clock.now_s() + float(rng.uniform(0.0, 0.3)))
        controller.freeze()
        deadline = time.monotonic() + 20.0
        try:
            while time.monotonic() < deadline:
                time.sleep(0.02)
                arms.moving()
        except DeviceError:
            return True
        finally:
            controller.thaw()
            driver.close()
    return False


def _second_service(folder: Path, _: np.random.Generator) -> bool:
    """Serve a cell twice."""
    (folder / "own.yaml").write_text("format: 1\ncell: own\nworld: dry\n", encoding="utf-8")
    words = ("serve", "own.yaml", "--port", "0")
    with subprocess.Popen(
        command(*words), cwd=folder, stderr=subprocess.PIPE, text=True, env=environment()
    ) as first:
        assert first.stderr is not None
        first.stderr.readline()
        second = call(folder, *words, "--out", "elsewhere")
        first.terminate()
        first.wait(60.0)
    return second.returncode == _REFUSED and f"process {first.pid}" in second.stderr


def _damaged_recording(folder: Path, rng: np.random.Generator) -> bool:
    """Cut or change a recording anywhere: it is read as far as it is sound, or refused."""
    file = folder / "damaged.mcap"
    data = bytearray(_sound_recording())
    if rng.uniform() < 0.5:
        del data[int(rng.integers(len(data))) :]
    for place in rng.integers(max(1, len(data)), size=int(rng.integers(1, 20))):
        if data:
            data[place % len(data)] ^= int(rng.integers(1, 256))
    file.write_bytes(data)
    try:
        recording = Recording.open(file)
        for number in range(len(recording)):
            recording.tick(number)
    except CellwrightError:
        return True
    return True


def _damaged_tree(folder: Path, rng: np.random.Generator) -> bool:
    """Change a mission's file anywhere: it is refused with its place, or still sound."""
    text = bytearray((packaged_trees() / "missions" / "untangle.yaml").read_bytes())
    for place in rng.integers(len(text), size=int(rng.integers(1, 8))):
        text[place] = int(rng.integers(256))
    file = folder / "untangle.yaml"
    file.write_bytes(text)
    try:
        load(file)
    except CellwrightError as error:
        return bool(str(error))
    return True


def _damaged_weights(folder: Path, rng: np.random.Generator) -> bool:
    """Cut off the file of a network's weights, or flip a bit of it."""
    import shutil

    from perception.models import store

    source = min(store.FOLDER.glob("**/weights.safetensors"), key=lambda one: one.stat().st_size)
    shutil.copytree(source.parent, folder / "model")
    weights = folder / "model" / source.name
    data = weights.read_bytes()
    if rng.uniform() < 0.5:
        damaged = bytearray(data)
        damaged[int(rng.integers(len(data)))] ^= 1 << int(rng.integers(8))
        weights.write_bytes(damaged)
    else:
        weights.write_bytes(data[: int(rng.integers(len(data)))])
    try:
        store.load_network(folder / "model")
    except InputError as error:
        return source.name in str(error)
    return False


@cache
def _sound_recording() -> bytes:
    """Return the bytes of a sound recording."""
    with tempfile.TemporaryDirectory() as name:
        write_work(Path(name))
        call(Path(name), "run", "work.yaml", "--record", "sound.mcap", "--set", "parts=30")
        return (Path(name) / "sound.mcap").read_bytes()
