"""The page on an hour of recording, and what a run pays for being watched.

The hour is that of `ticks`: 36,000 ticks of 177 nodes. Opening is timed as a person waits for
it, from the first byte of the recording to a page with every status in it; a scrub is one tick
fetched over HTTP. A run is watched twice: at ten times the usual rate, and ticking as fast as
it can, which shows what the watcher takes from a machine with nothing to spare.
"""

import json
import multiprocessing
import shutil
import tempfile
import threading
import time
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from multiprocessing.synchronize import Event
from pathlib import Path

import numpy as np

from benchmarks.harness import Row, median, percentile_95
from benchmarks.tick_trees import Scripts, cell, our_tree
from benchmarks.ticks import HOUR_TICKS, STATIONS, Ours
from executive.inspector.web.server import PageServer, application
from executive.inspector.web.session import Session

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
COLUMNS = 1500
FAST_HZ = 100.0


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Open an hour, jump about in it, and watch runs that go on."""
    pairs, opens = (4, 2) if quick else (8, 10)
    with tempfile.TemporaryDirectory() as folder:
        hour = Path(folder) / "hour.mcap"
        _record(hour, HOUR_TICKS, seed)
        rows = [*_opening(hour, opens), *_scrubbing(hour, seed, 100 if quick else 500)]
        rows.append(_watching(Path(folder), seed, pairs, FAST_HZ))
        return [*rows, _watching(Path(folder), seed, pairs, None)]


def _record(path: Path, ticks: int, seed: int, rate_hz: float | None = None) -> float:
    """Tick the cell at a rate, or as fast as it goes; return how long that took [s]."""
    shape = cell(STATIONS)
    ours = Ours(our_tree(shape, Scripts(shape, seed)), path)
    began_s = time.perf_counter()
    for number in range(ticks):
        ours.tick()
        if rate_hz is not None:
            left_s = (number + 1) / rate_hz - (time.perf_counter() - began_s)
            time.sleep(max(0.0, left_s))
    took_s = time.perf_counter() - began_s
    if ours.writer is not None:
        ours.writer.close()
    return took_s


@contextmanager
def _served(session: Session) -> Iterator[str]:
    server = PageServer(application(session), "127.0.0.1", 0)
    thread = threading.Thread(target=server.serve, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.port}/"
    finally:
        server.stop()
        thread.join()


def _opening(path: Path, times: int) -> list[Row]:
    reading_s, showing_s = [], []
    for _ in range(times):
        began_s = time.perf_counter()
        session = Session(path)
        reading_s.append(time.perf_counter() - began_s)
        if CHROMIUM is not None:
            with _served(session) as address:
                showing_s.append(_shown_s(address))
    rows = [median("open_hour_s", reading_s, "s")]
    if showing_s:
        whole_s = [a + b for a, b in zip(reading_s, showing_s, strict=True)]
        rows.append(median("page_of_an_hour_s", whole_s, "s", "<= 2"))
    return rows


def _shown_s(address: str) -> float:
    """Return how long a browser that is open already takes to show the page [s]."""
    from playwright.sync_api import sync_playwright

    flags = ["--no-sandbox", "--disable-gpu", "--disable-background-networking"]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
        page = browser.new_page(viewport={"width": 1600, "height": 900})
        began_s = time.perf_counter()
        page.goto(address)
        page.wait_for_selector(".row .mark:not(:empty)")
        took_s = time.perf_counter() - began_s
        browser.close()
    return took_s


def _scrubbing(path: Path, seed: int, times: int) -> list[Row]:
    session = Session(path)
    numbers = np.random.default_rng(seed).integers(0, len(session.recording), times)
    ticks_ms, lanes_ms = [], []
    progress = session.progress()
    while progress["in_lanes"] != progress["ticks"]:  # a second or two after it was opened
        time.sleep(0.05)
        progress = session.progress()
    with _served(session) as address:
        for number in numbers.tolist():
            ticks_ms.append(_fetched_ms(f"{address}api/tick/{number}"))
            span = f"from={number // 2}&to={number}&columns={COLUMNS}"
            lanes_ms.append(_fetched_ms(f"{address}api/lanes?{span}"))
    return [
        percentile_95("scrub_ms", ticks_ms, "ms", "<= 100"),
        percentile_95("lanes_ms", lanes_ms, "ms", "<= 100"),
    ]


def _fetched_ms(address: str) -> float:
    began_s = time.perf_counter()
    with urllib.request.urlopen(address) as answer:
        answer.read()
    return 1e3 * (time.perf_counter() - began_s)


def _watching(folder: Path, seed: int, pairs: int, rate_hz: float | None) -> Row:
    """Compare runs that are watched over a websocket with runs that are not, in turns."""
    ticks, ratios = HOUR_TICKS // (120 if rate_hz else 6), []
    for number in range(pairs):
        alone_s = _record(folder / "alone.mcap", ticks, seed, rate_hz)
        path = folder / f"watched{number}.mcap"
        with _watcher(path):
            watched_s = _record(path, ticks, seed, rate_hz)
        path.unlink()
        ratios.append(alone_s / watched_s)
    if rate_hz is None:
        return median("watched_full_speed_ratio", ratios, "1")
    return median("watched_tick_ratio", ratios, "1", ">= 0.95")


@contextmanager
def _watcher(path: Path) -> Iterator[None]:
    """Serve the page of a run in another process, with one page that listens to it."""
    stop = multiprocessing.Event()
    watching = multiprocessing.Process(target=_watch, args=(path, stop), daemon=True)
    watching.start()
    try:
        yield
    finally:
        stop.set()
        watching.join()


def _watch(path: Path, stop: Event) -> None:
    from websockets.sync.client import connect
    from websockets.typing import Origin

    while not path.exists() or path.stat().st_size == 0:
        if stop.wait(0.01):
            return
    time.sleep(0.2)
    with _served(Session(path)) as address:
        live = f"{address.replace('http', 'ws')}api/live"
        with connect(live, origin=Origin(address.rstrip("/"))) as page:
            while not stop.is_set():
                try:
                    number = json.loads(page.recv(timeout=0.2))["ticks"] - 1
                except TimeoutError:
                    continue
                _fetched_ms(f"{address}api/tick/{number}")
                _fetched_ms(f"{address}api/lanes?from=0&to={number}&columns={COLUMNS}")
