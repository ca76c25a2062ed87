"""Commands to a live run: pause, step, stop, breakpoints, forced answers."""

from collections.abc import Mapping
from typing import Any

from textual import work

from executive.core.errors import InputError
from executive.engine.running.remote import send
from executive.inspector.terminal.keys import LIVE_ACTIONS
from executive.inspector.terminal.moving import Moving
from executive.inspector.terminal.overlays import Sure


class Commanding(Moving):
    """A view of a run that can be commanded while it goes on."""

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer what commands a live run only while there is one."""
        breaks = action == "ask" and parameters == ("break",)
        return self._live if action in LIVE_ACTIONS or breaks else True

    @work(thread=True, group="command")
    def command(self, name: str, **arguments: object) -> None:
        """Send a command to the live run."""
        try:
            state = send(self._path, name, by="terminal", **arguments)
        except InputError as error:
            self.call_later(self._refuse, str(error))
            return
        self.call_later(self._commanded, state)

    def _commanded(self, state: Mapping[str, Any]) -> None:
        self.note("")
        self._leave_prompt()
        self._take_progress(more=False, state=state)

    def action_pause_or_resume(self) -> None:
        """Pause the mission, or let it go on."""
        self.command("resume" if self._state and self._state["paused"] else "pause")

    def action_step(self, step: str) -> None:
        """Go on by a tick or a node."""
        self._following = True
        self.command("step", step=step)

    def action_stop(self) -> None:
        """Stop the mission in order."""
        self.command("stop")

    def action_emergency_stop(self) -> None:
        """Stop the arms at once, if the user is sure."""

        def answered(sure: bool | None) -> None:
            if sure:
                self.command("emergency_stop")

        self.push_screen(Sure("Stop the arms now?"), answered)

    def action_force(self, answer: str) -> None:
        """Let the selected node answer something else."""
        if self._opened is not None:
            path = self._opened.recording.header.nodes[self.node].path
            self.command("force", nodes=path, answer=answer)

    def action_unforce(self, nodes: str) -> None:
        """Let a node answer for itself again."""
        self.command("unforce", nodes=nodes)

    def action_unbreak(self, number: int) -> None:
        """Remove a breakpoint."""
        self.command("unbreak", number=number)
