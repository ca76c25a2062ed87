"""The line at the top: which run, how it stands, and the tick that is shown."""

from collections.abc import Mapping
from typing import Any

from rich.text import Text
from textual.widgets import Static

from executive.inspector.terminal.opened import OpenedRun

_STANDINGS = {
    "live": ("▶", "$text-warning"),
    "paused": ("‖", "$text-accent"),
    "killed": ("✗", "$text-error"),
    "success": ("✓", "$text-success"),
}


def standing(opened: OpenedRun, state: Mapping[str, Any] | None) -> str:
    """Return the outcome of a run, or `live`, `paused` or `killed` while it has none."""
    result = opened.recording.result
    if result is not None:
        return result.report.outcome
    if state is None:
        return "killed"
    return "paused" if state["paused"] else "live"


class Bar(Static):
    """One line."""

    DEFAULT_CSS = """
    Bar { height: 1; background: $panel; color: $text; }
    """

    def show(
        self, opened: OpenedRun, state: Mapping[str, Any] | None, tick: int, speed: str
    ) -> None:
        """Show a run at a tick.

        Args:
            opened: The run.
            state: What its debugger says, None where nothing runs it.
            tick: The tick that is shown.
            speed: How fast it is played; empty when it is not.
        """
        header = opened.recording.header
        words = standing(opened, state)
        mark = _STANDINGS.get(words, ("✗", ""))[0]
        left = Text.assemble((header.mission, "bold"), f"  seed {header.seed}  {opened.path.name}")
        right = Text(f"{mark} {words}  ", "bold")
        right.append(_place(opened, tick), "not bold").append(f"  {speed}" if speed else "")
        room = self.size.width - right.cell_len - 2
        left.truncate(max(0, room), overflow="ellipsis", pad=True)
        self.update(Text.assemble(left, "  ", right))


def _place(opened: OpenedRun, tick: int) -> str:
    if opened.last < 0:
        return "before the first tick"
    record, budget_s = opened.recording.tick(tick), 1.0 / opened.recording.header.tick_hz
    slow = " slow" if record.duration_s > budget_s else ""
    return (
        f"tick {tick}/{opened.last}  {record.time_s:.2f} s  {record.duration_s * 1e3:.0f} ms{slow}"
    )
