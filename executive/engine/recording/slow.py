"""Which nodes had steps that took longer than they may; live or from a recording."""

from collections.abc import Sequence

from executive.core.world import StreamMessage
from executive.engine.recording.messages import RecordedNode, SlowNode
from executive.engine.ticks import SlowStep, Tick


class SlowLog:
    """Gathers slow steps from ticks; an observer of a run."""

    def __init__(self, nodes: Sequence[RecordedNode]) -> None:
        """Watch the nodes of a table."""
        self._nodes = nodes
        self._worst: dict[int, SlowStep] = {}
        self._times: dict[int, int] = {}

    def on_tick(self, tick: Tick) -> None:
        """Take the slow steps of one tick."""
        for step in tick.slow:
            worst = self._worst.get(step.node)
            self._times[step.node] = self._times.get(step.node, 0) + 1
            if worst is None or step.seconds > worst.seconds:
                self._worst[step.node] = step

    def on_streams(self, messages: Sequence[StreamMessage]) -> None:
        """Streams say nothing about steps."""

    def reports(self) -> tuple[SlowNode, ...]:
        """Return every node that was too slow, the one with the longest step first."""
        worst = sorted(self._worst.values(), key=lambda step: -step.seconds)
        return tuple(
            SlowNode(
                path=self._nodes[step.node].path,
                times=self._times[step.node],
                worst_s=step.seconds,
                budget_s=step.budget_s,
            )
            for step in worst
        )
