"""What a run looks like while it goes on."""

import time
from collections.abc import Sequence
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.live import Live
from rich.text import Text

from executive.core.world import StreamMessage
from executive.engine.recording.actions import ActionLog
from executive.engine.recording.messages import (
    PAUSES_TOPIC,
    ActionReport,
    PauseMessage,
    RecordedNode,
)
from executive.engine.ticks import Tick

STATUS_STYLES = {"success": "green", "failure": "red", "halted": "yellow", "running": "yellow"}
_REDRAW_S = 0.1


class RunDisplay:
    """Shows a run while it goes on: finished actions as lines, the present one below them."""

    def __init__(self, console: Console, nodes: Sequence[RecordedNode]) -> None:
        """Show the actions of the nodes of a table."""
        self._console, self._nodes = console, nodes
        self._actions = ActionLog(nodes)
        self._shown = 0
        self._live = Live(console=console, auto_refresh=False, transient=True)
        self._drawn_s = 0.0

    def __enter__(self) -> Self:
        if self._console.is_terminal:
            self._live.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._live.stop()

    def on_tick(self, tick: Tick) -> None:
        """Show what a tick changed."""
        self._actions.on_tick(tick)
        ended = self._actions.ended
        for action in ended[self._shown :]:
            self._console.print(_action_line(action), soft_wrap=True)
        self._shown = len(ended)
        now_s = time.monotonic()
        if self._live.is_started and now_s - self._drawn_s > _REDRAW_S:
            self._drawn_s = now_s
            doing = ", ".join(self._actions.current) or "no action"
            line = f"{tick.time_s:8.1f} s  tick {tick.number}  {doing}"
            self._live.update(Text(line, "bright_black"), refresh=True)

    def on_streams(self, messages: Sequence[StreamMessage]) -> None:
        """Show pauses, and nothing else of what the cell streams."""
        for message in messages:
            if message.topic == PAUSES_TOPIC:
                pause = PauseMessage.model_validate_json(message.data)
                self._console.print(self._pause_line(pause), soft_wrap=True)

    def _pause_line(self, pause: PauseMessage) -> Text:
        leaves = ", ".join(f"{self._nodes[one.node].path}: {one.policy}" for one in pause.leaves)
        told = f"by {pause.by}" + (f" ({leaves})" if pause.state == "paused" and leaves else "")
        return Text.assemble(f"{pause.time_s:8.1f} s  {pause.state:<20}", (told, "bright_black"))


def _action_line(action: ActionReport) -> Text:
    return Text.assemble(
        f"{action.start_s:8.1f} s  {action.name:<20}",
        (f"{action.status:<8}", STATUS_STYLES[action.status]),
        f"{action.duration_s:6.1f} s",
        f"  {action.reason}" if action.reason else "",
    )
