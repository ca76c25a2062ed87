"""Which skills moved something, when, and how that ended; live or from a recording."""

from collections.abc import Sequence
from typing import Literal

from executive.core.world import StreamMessage
from executive.engine.recording.messages import ActionReport, RecordedNode
from executive.engine.ticks import RUNNER, NodeOutcome, NodeStatus, Tick

_FINISHED = (NodeStatus.SUCCESS, NodeStatus.FAILURE)


class ActionLog:
    """Gathers the activations of acting skills from ticks; an observer of a run."""

    def __init__(self, nodes: Sequence[RecordedNode]) -> None:
        """Watch the nodes of the table that act."""
        self._nodes = nodes
        self._acting = frozenset(index for index, node in enumerate(nodes) if node.acts)
        self._statuses: dict[int, NodeStatus] = {}
        self._outcomes: dict[int, NodeOutcome] = {}
        self._began_s: dict[int, float] = {}
        self._reports: list[ActionReport] = []
        self._now_s = 0.0

    @property
    def current(self) -> tuple[str, ...]:
        """Names of the actions that are under way."""
        return tuple(self._nodes[node].name for node in self._began_s)

    @property
    def ended(self) -> tuple[ActionReport, ...]:
        """Activations that have ended, in that order."""
        return tuple(self._reports)

    def on_tick(self, tick: Tick) -> None:
        """Take what one tick says about actions."""
        self._now_s = tick.time_s
        self._statuses.update(tick.changes)
        self._outcomes.update((outcome.node, outcome) for outcome in tick.outcomes)
        fresh = {outcome.node for outcome in tick.outcomes}
        for node in tick.visited:
            if node in self._acting:
                self._began_s.setdefault(node, tick.time_s)
                # A leaf that ends as it did in the tick before has no outcome of its own.
                if node in fresh or self._statuses.get(node) in _FINISHED:
                    self._end_as(self._outcomes[node])
        for halt in tick.halts:
            if halt.node in self._began_s:
                by = "the runner" if halt.by == RUNNER else self._nodes[halt.by].path
                self._end(halt.node, "halted", f"halted by {by}")

    def on_streams(self, messages: Sequence[StreamMessage]) -> None:
        """Streams say nothing about actions."""

    def reports(self) -> tuple[ActionReport, ...]:
        """Return every activation in the order in which they ended, unfinished ones last."""
        running = (self._report(node, "running", "") for node in self._began_s)
        return (*self._reports, *running)

    def _end_as(self, outcome: NodeOutcome) -> None:
        failed = outcome.status is NodeStatus.FAILURE
        reason = "" if outcome.reason is None else str(outcome.reason)
        self._end(outcome.node, "failure" if failed else "success", reason)

    def _end(self, node: int, status: Literal["success", "failure", "halted"], reason: str) -> None:
        self._reports.append(self._report(node, status, reason))
        del self._began_s[node]

    def _report(
        self, node: int, status: Literal["running", "success", "failure", "halted"], reason: str
    ) -> ActionReport:
        began_s = self._began_s[node]
        return ActionReport(
            name=self._nodes[node].name,
            start_s=began_s,
            duration_s=self._now_s - began_s,
            status=status,
            reason=reason,
        )
