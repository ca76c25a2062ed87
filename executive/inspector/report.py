"""What a run came to: cycle time, recovery, retries, failures, rate, and why it ended so."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from executive.engine.ticks import NodeStatus
from executive.inspector.answer_lines import answer_lines
from executive.inspector.injected import injected_lines
from executive.inspector.past import PastRun
from executive.inspector.times import NodeTimes, Recovery, attempts, cycle_s, node_times, recovery
from executive.inspector.why import why_ended

_MOST = 5
CONDITION = "condition.false"
"""Code of a condition that was false: a choice more often than a failure."""


@dataclass(frozen=True, slots=True)
class Line:
    """Times of a node, and its names.

    Attributes:
        path: Full path.
        name: Short name.
        what: Its skill or kind; for a station, the tree that stands there.
        where: `file:line`.
        times: What it came to.
    """

    path: str
    name: str
    what: str
    where: str
    times: NodeTimes


@dataclass(frozen=True, slots=True)
class Retries:
    """How many attempts a retry used.

    Attributes:
        name: Short name of the retry.
        activations: How often it started.
        attempts: Attempts in all.
        most: Most attempts in one activation.
        allowed: Attempts that it allows; None where that is worked out as it
            runs, or the recording holds no sources.
    """

    name: str
    activations: int
    attempts: int
    most: int
    allowed: int | None


@dataclass(frozen=True, slots=True)
class Failures:
    """How often something failed in one way.

    Attributes:
        code: Code of the reason; `-` where there was none.
        name: Short name of the node.
        count: How often.
        text: What it said the last time.
    """

    code: str
    name: str
    count: int
    text: str


@dataclass(frozen=True, slots=True)
class SlowTick:
    """A tick that took longer than the tick rate allows.

    Attributes:
        tick: Its number.
        duration_s: How long it took [s].
        asked: Short names of the skills that it asked.
    """

    tick: int
    duration_s: float
    asked: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class RateKept:
    """How well the tick rate was kept.

    Attributes:
        wanted_hz: The rate that was asked for.
        achieved_hz: Ticks a second of the cell's clock.
        p99_s: 99th percentile of how long a tick took [s].
        slow: How many ticks took longer than the rate allows.
        slowest: The slowest of those.
    """

    wanted_hz: float
    achieved_hz: float
    p99_s: float
    slow: int
    slowest: tuple[SlowTick, ...]


@dataclass(frozen=True, slots=True)
class MissionReport:
    """What one run came to.

    Attributes:
        file: The recording.
        mission: Name of the mission.
        seed: Seed of everything random.
        started_utc: When it was started.
        outcome: How it ended; `unfinished` where the recording does not say.
        reason: Why, in one line.
        cycle_s: Duration on the cell's clock [s].
        wall_s: Duration on the machine's clock [s]; None where the recording does not say.
        ticks: Number of ticks.
        chain: Why it ended so, from the root down to the leaf that decided, as lines.
        injected: What came of each fault that was injected, as lines.
        recovery: Time on second tries.
        retries: Attempts of each retry that ran.
        failures: Failures of leaves, skills before conditions, the most frequent first.
        rate: How well the tick rate was kept.
        stations: The mission and every use of a subtree that ran.
        nodes: Every node.
    """

    file: str
    mission: str
    seed: int
    started_utc: str
    outcome: str
    reason: str
    cycle_s: float
    wall_s: float | None
    ticks: int
    chain: tuple[str, ...]
    injected: tuple[str, ...]
    recovery: Recovery
    retries: tuple[Retries, ...]
    failures: tuple[Failures, ...]
    rate: RateKept
    stations: tuple[Line, ...]
    nodes: tuple[Line, ...]

    def longest(self) -> list[Line]:
        """Return the leaves and decorators with the most time of their own."""
        lines = sorted(self.nodes, key=lambda line: -line.times.own_s)
        return [line for line in lines[:_MOST] if line.times.own_s > 0.0]

    def busiest(self) -> list[Line]:
        """Return the skills that took the most computing."""
        lines = sorted(self.nodes, key=lambda line: -line.times.compute_s)
        return [line for line in lines[:_MOST] if line.times.compute_s > 0.0]


def mission_report(run: PastRun) -> MissionReport:
    """Return what a run came to."""
    header, result, index = run.recording.header, run.recording.result, run.index
    times = node_times(index)
    lines = tuple(_line(run, node, times[node]) for node in range(len(times)))
    return MissionReport(
        file=str(run.recording.path),
        mission=header.mission,
        seed=header.seed,
        started_utc=header.started_utc,
        outcome=result.report.outcome if result else "unfinished",
        reason=result.report.reason if result else "killed, or still going on",
        cycle_s=cycle_s(index),
        wall_s=result.report.wall_s if result else None,
        ticks=index.last_tick + 1,
        chain=tuple(answer_lines(run, why_ended(run))),
        injected=injected_lines(run.recording),
        recovery=recovery(index),
        retries=tuple(_retries(run)),
        failures=tuple(_failures(run)),
        rate=_rate(run),
        stations=tuple(lines[node] for node in index.stations if times[node].started),
        nodes=lines,
    )


def _line(run: PastRun, node: int, times: NodeTimes) -> Line:
    recorded = run.index.nodes[node]
    what = recorded.type or recorded.kind
    station = run.trees.stations.get(recorded.path)
    if node in run.index.stations:
        what = station or (run.recording.header.mission if node == 0 else what)
    return Line(recorded.path, run.names.short(node), what, run.names.where(node), times)


def _retries(run: PastRun) -> list[Retries]:
    found = []
    for node, recorded in enumerate(run.index.nodes):
        used = attempts(run.index, node) if recorded.kind == "retry" else []
        if used:
            name, allowed = run.names.short(node), run.times(node)
            found.append(Retries(name, len(used), sum(used), max(used), allowed))
    return found


def _failures(run: PastRun) -> list[Failures]:
    counts: Counter[tuple[str, int]] = Counter()
    texts: dict[tuple[str, int], str] = {}
    for node in range(len(run.index.nodes)):
        for life in run.index.activations(node):
            if life.status is not NodeStatus.FAILURE:
                continue
            reason = run.index.reason(node, life.end)
            if reason is None and run.index.children[node]:
                continue  # its children say why
            what = ("-" if reason is None else reason.code, node)
            counts[what] += 1
            texts[what] = "" if reason is None else reason.text
    found = [
        Failures(code, run.names.short(node), count, texts[code, node])
        for (code, node), count in counts.most_common()
    ]
    return sorted(found, key=lambda failures: failures.code == CONDITION)


def _rate(run: PastRun) -> RateKept:
    index, header = run.index, run.recording.header
    count = index.last_tick + 1
    durations_s = np.sort(index.durations_s[:count])
    p99_s = float(durations_s[int(np.ceil(0.99 * count)) - 1]) if count else 0.0
    span_s = float(index.times_s[count - 1] - index.times_s[0]) if count else 0.0
    achieved_hz = (count - 1) / span_s if span_s > 0.0 else 0.0
    if run.recording.result is not None:
        achieved_hz = run.recording.result.rate.achieved_hz  # knows of pauses
    slow = np.flatnonzero(index.durations_s[:count] > 1.0 / header.tick_hz)
    slowest = sorted(slow.tolist(), key=lambda tick: -float(index.durations_s[tick]))[:_MOST]
    found = tuple(SlowTick(t, float(index.durations_s[t]), _skills(run, t)) for t in slowest)
    return RateKept(header.tick_hz, achieved_hz, p99_s, len(slow), found)


def _skills(run: PastRun, tick: int) -> tuple[str, ...]:
    asked = run.index.asked(tick).tolist()
    return tuple(run.names.short(n) for n in asked if run.index.nodes[n].kind == "skill")
