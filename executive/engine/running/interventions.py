"""What something outside the tree did to a run, noted for the recording."""

import threading

from executive.core.outcome import Status
from executive.core.world import StreamMessage
from executive.engine.recording.messages import INTERVENTIONS_TOPIC, InterventionMessage


class InterventionLog:
    """Interventions that are still to be recorded; any thread may note one."""

    def __init__(self) -> None:
        """Start empty."""
        self._lock = threading.Lock()
        self._notes: list[InterventionMessage] = []

    def note(self, tick: int, node: int, what: str, by: str, answer: Status | None = None) -> None:
        """Take note of one; the arguments are those of `InterventionMessage`."""
        note = InterventionMessage(tick=tick, node=node, what=what, by=by, answer=answer)
        with self._lock:
            self._notes.append(note)

    def drain(self, time_s: float) -> list[StreamMessage]:
        """Return the messages of those since the last call, as of a time [s]."""
        if not self._notes:
            return []
        with self._lock:
            notes, self._notes = self._notes, []
        return [
            StreamMessage(
                INTERVENTIONS_TOPIC, "InterventionMessage", time_s, note.model_dump_json().encode()
            )
            for note in notes
        ]
