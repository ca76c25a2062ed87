"""What the page may ask of one recording, whether its run has ended or still goes on."""

import threading
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

from markdown_it import MarkdownIt

from executive.core.errors import InputError, recording_named_by_the_user
from executive.core.registry import closest
from executive.engine.recording.growing import GrowingRecording
from executive.engine.recording.reader import KeyState, Recording
from executive.engine.ticks import NodeStatus
from executive.inspector.activity import Activity, Codes
from executive.inspector.answer_view import answer_document, written_document
from executive.inspector.brief import brief
from executive.inspector.finding import Wish, found
from executive.inspector.overlays import picture_of
from executive.inspector.past import PastRun
from executive.inspector.provenance import who_wrote
from executive.inspector.report import mission_report
from executive.inspector.report_text import report_markdown
from executive.inspector.why import why, why_ended
from executive.inspector.why_not import why_halted, why_not

# Ticks that are taken into the lanes at a time, so that nobody waits long for an answer.
_STRIDE = 100


class Session:
    """One recording, read again as it grows; its methods may be called from any thread."""

    def __init__(self, path: Path) -> None:
        """Open a recording.

        Raises:
            RecordingError: It cannot be read.
        """
        self.path = path
        self._lock = threading.RLock()
        self._growing = GrowingRecording(path)
        self._activity = Activity(len(self.recording.header.nodes))
        self._past: PastRun | None = None
        self._catching_up = threading.Thread()
        self._fill_lanes()

    @property
    def recording(self) -> Recording:
        """The recording as far as it has been read."""
        return self._growing.recording

    @property
    def ended(self) -> bool:
        """Whether the run came to its end and said so."""
        return self.recording.result is not None

    @property
    def complete(self) -> bool:
        """Whether there is nothing more to tell: the run has ended, and the lanes show it."""
        return self.ended and len(self._activity) == len(self.recording)

    def refresh(self) -> bool:
        """Read what has been written since; return whether there was anything."""
        with self._lock:
            grew = self._growing.refresh()
            if grew:
                self._tick_document.cache_clear()
            self._fill_lanes()
            return grew

    def _fill_lanes(self) -> None:
        """Take into the lanes what is not in yet: a little at once, much in the background."""
        if len(self.recording) - len(self._activity) <= _STRIDE:
            self._activity.follow(self.recording)
        elif not self._catching_up.is_alive():
            self._catching_up = threading.Thread(target=self._catch_up, name="lanes", daemon=True)
            self._catching_up.start()

    def _catch_up(self) -> None:
        while len(self._activity) < len(self.recording):
            with self._lock:
                self._activity.follow(self.recording, len(self._activity) + _STRIDE)

    def progress(self) -> dict[str, object]:
        """Return how far the run is: what a page needs to hear again and again."""
        result, count = self.recording.result, len(self.recording)
        return {
            "ticks": count,
            "in_lanes": len(self._activity),
            "complete": self.complete,
            "time_s": self.recording.tick(count - 1).time_s if count else 0.0,
            "ended": self.ended,
            "report": None if result is None else result.report.model_dump(mode="json"),
            "rate": None if result is None else asdict(result.rate),
        }

    def run(self) -> dict[str, object]:
        """Return what is run: the mission, its nodes, and how far it is."""
        header = self.recording.header
        return {
            "file": self.path.name,
            "mission": header.mission,
            "about": header.about,
            "seed": header.seed,
            "tick_hz": header.tick_hz,
            "started_utc": header.started_utc,
            "inputs": header.inputs,
            "scenario": header.scenario,
            "versions": header.versions,
            "nodes": [node.model_dump(mode="json") for node in header.nodes],
            "sources": [source.model_dump(mode="json") for source in header.sources],
            **self.progress(),
        }

    def lanes(self, first: int, last: int, columns: int) -> Codes:
        """Return what every node did between two ticks; see `Activity.lanes`."""
        with self._lock:
            return self._activity.lanes(first, last, columns)

    def tick(self, number: int) -> dict[str, Any]:
        """Return everything about one tick.

        Raises:
            InputError: There is no such tick.
        """
        self._check(number)
        return self._tick_document(number)

    def _check(self, number: int) -> None:
        count = len(self.recording)
        if not 0 <= number < count:
            raise InputError(f"no tick {number}; expected 0 to {count - 1}")

    @lru_cache(maxsize=512)  # noqa: B019 - a session lives as long as the server
    def _tick_document(self, number: int) -> dict[str, Any]:
        with self._lock:
            recording = self.recording
            tick, states = recording.tick(number), recording.blackboard(number)
            reasons = recording.reasons(number)
            statuses = recording.statuses(number)
        picture = picture_of(states)
        return {
            "tick": number,
            "time_s": tick.time_s,
            "duration_s": tick.duration_s,
            "statuses": [status.value for status in statuses],
            "visited": tick.visited,
            "reasons": {node: str(reason) for node, reason in reasons.items()},
            "halts": [asdict(halt) for halt in tick.halts],
            "faults": [asdict(fault) for fault in tick.faults],
            "board": [_row(key, state, number) for key, state in states.items()],
            "picture": picture
            and {**asdict(picture), "time_s": recording.tick(picture.tick).time_s},
        }

    def history(self, key: str) -> dict[str, object]:
        """Return every write of a key, with values in one line.

        Raises:
            InputError: Nothing ever wrote it.
        """
        index = self.past().index
        places = index.writes.get(key)
        if places is None:
            raise InputError(f"nothing writes {key!r}; {closest(key, [*index.writes])}")
        writes = [
            {"tick": place.tick, "writer": place.writer, "value": brief(index.value_at(place))}
            for place in places
        ]
        return {"key": key, "writes": writes}

    def find(self, wish: Wish) -> int | None:
        """Return the nearest tick that a wish asks for, None where there is none.

        Raises:
            InputError: It names what the recording does not have.
        """
        return found(self.past().index, wish)

    def answers(self, path: str, tick: int) -> list[dict[str, object]]:
        """Return why a node did what it did in a tick, or why it did not run, or who halted it.

        Raises:
            InputError: There is no such node or tick.
        """
        run = self.past()
        node = run.names.node(path)
        self._check(tick)
        if tick in run.index.halts and run.index.halted_by(node, tick) is not None:
            answers = [why_halted(run, node, tick)]
        elif run.index.answer(node, tick) is NodeStatus.INVALID:
            answers = [why_not(run, node, tick)]
        else:
            answers = [why(run, node, tick)]
        if self.ended and tick >= run.index.last_tick and node == 0:
            answers.insert(0, why_ended(run))
        return [answer_document(run, answer) for answer in answers]

    def who(self, key: str, tick: int) -> dict[str, object]:
        """Return who wrote a key last before a tick, what it was before, and who read it.

        Raises:
            InputError: Nothing had written the key by then.
        """
        run = self.past()
        written = who_wrote(run, run.names.key(key), tick)
        if written is None:
            raise InputError(f"{key!r} has no value at tick {tick}")
        return written_document(run, written)

    def report(self) -> str:
        """Return what the run came to so far, as HTML."""
        text = report_markdown(mission_report(self.past()))
        return MarkdownIt("js-default").render(text)  # which lets no HTML of values through

    def past(self) -> PastRun:
        """Return the run as questions need it, as far as the recording has been read."""
        with self._lock:
            if self._past is None or len(self._past.index) != len(self.recording):
                self._past = PastRun(self.recording)
            return self._past

    def image(self, number: int) -> bytes:
        """Return an image as a PNG file.

        Raises:
            InputError: There is no such image.
        """
        with self._lock, recording_named_by_the_user():
            return self.recording.png(number)


def _row(key: str, state: KeyState, number: int) -> dict[str, object]:
    return {
        "key": key,
        "value": brief(state.value),
        "writer": state.writer,
        "tick": state.tick,
        "fresh": state.tick == number,
    }
