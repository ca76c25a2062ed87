"""Where the time of a run went: node by node, in recovery, and in computing.

The time from one tick to the next belongs to every node that is RUNNING after the first of
them. A node's own time is what is left of its time when no child of it is RUNNING, so the own
times of a tree without parallels add up to the time of its root.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.engine.ticks import NodeStatus
from executive.inspector.deciding import SELECTORS
from executive.inspector.index import RUNNING, RunIndex

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class NodeTimes:
    """What one node came to in a run.

    Attributes:
        node: Index of the node.
        started: How often it started.
        succeeded: How often it succeeded.
        failed: How often it failed.
        halted: How often it was halted.
        running_s: Time in which it was RUNNING [s].
        own_s: The part of it in which no child was RUNNING [s].
        compute_s: Its share of the time that ticks took on the machine's clock [s]: each tick
            is shared equally by the skills that it asked. 0 for everything but skills.
    """

    node: int
    started: int
    succeeded: int
    failed: int
    halted: int
    running_s: float
    own_s: float
    compute_s: float


@dataclass(frozen=True, slots=True)
class Recovery:
    """Time that a run spent on a second try.

    Attributes:
        total_s: In fallbacks or in repeated attempts, each moment counted once [s].
        fallbacks_s: In children of selectors after the first [s].
        retries_s: In retries from the first failed attempt on, pauses included [s].
    """

    total_s: float
    fallbacks_s: float
    retries_s: float


def node_times(index: RunIndex) -> tuple[NodeTimes, ...]:
    """Return what every node came to, in the order of the node table."""
    steps_s, compute_s = _steps_s(index), _compute_s(index)
    return tuple(_times(index, node, steps_s, compute_s[node]) for node in range(len(index.nodes)))


def recovery(index: RunIndex) -> Recovery:
    """Return how long a run was in recovery."""
    steps_s = _steps_s(index)
    fallbacks, retries = np.zeros((2, len(index)), np.bool_)
    for node, recorded in enumerate(index.nodes):
        if recorded.kind in SELECTORS:
            for child in index.children[node][1:]:
                fallbacks |= index.statuses[:, child] == RUNNING
        if recorded.kind == "retry":
            retries |= _later_attempts(index, node)
    total_s, fallbacks_s, retries_s = (
        float(steps_s[mask].sum()) for mask in (fallbacks | retries, fallbacks, retries)
    )
    return Recovery(total_s, fallbacks_s, retries_s)


def attempts(index: RunIndex, retry: int) -> list[int]:
    """Return how many attempts each activation of a retry took."""
    child = index.children[retry][0]
    starts = np.array([life.start for life in index.activations(child)])
    lives = index.activations(retry)
    return [int(((starts >= life.start) & (starts <= life.end)).sum()) for life in lives]


def _later_attempts(index: RunIndex, retry: int) -> Mask:
    """Return the ticks after which a retry runs though an attempt of it has failed."""
    later = np.zeros(len(index), np.bool_)
    child = index.children[retry][0]
    failed = [life.end for life in index.activations(child) if life.status is NodeStatus.FAILURE]
    for life in index.activations(retry):
        first = next((end for end in failed if life.start <= end <= life.end), life.end)
        later[first : life.end] = True
    return later


def cycle_s(index: RunIndex) -> float:
    """Return how long the mission took on the cell's clock [s], until the runner stopped it."""
    result = index.recording.result
    if result is not None:
        return result.report.sim_s
    return float(index.times_s[max(index.last_tick, 0)] - index.times_s[0])


def _steps_s(index: RunIndex) -> NDArray[np.float64]:
    """Return how long it was from each tick to the next; the mission's end ends the last one."""
    ends_s = np.minimum(np.append(index.times_s[1:], np.inf), index.times_s[0] + cycle_s(index))
    return np.maximum(ends_s - index.times_s, 0.0)


def _compute_s(index: RunIndex) -> NDArray[np.float64]:
    skills = [node for node, recorded in enumerate(index.nodes) if recorded.kind == "skill"]
    asked = index.answers[:, skills] != 0
    shares_s = index.durations_s / np.maximum(asked.sum(axis=1), 1)
    compute_s = np.zeros(len(index.nodes))
    compute_s[skills] = shares_s @ asked
    return compute_s


def _times(index: RunIndex, node: int, steps_s: NDArray[np.float64], compute_s: float) -> NodeTimes:
    running = index.statuses[:, node] == RUNNING
    below = np.zeros_like(running)
    for child in index.children[node]:
        below |= index.statuses[:, child] == RUNNING
    ends = [life.status for life in index.activations(node)]
    return NodeTimes(
        node=node,
        started=len(ends),
        succeeded=ends.count(NodeStatus.SUCCESS),
        failed=ends.count(NodeStatus.FAILURE),
        halted=ends.count(NodeStatus.INVALID),
        running_s=float(steps_s[running].sum()),
        own_s=float(steps_s[running & ~below].sum()),
        compute_s=float(compute_s),
    )
