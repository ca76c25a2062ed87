"""The blackboard after a tick: what each key holds, who wrote it and when."""

from collections import Counter
from collections.abc import Mapping

from rich.text import Text

from executive.engine.recording.reader import KeyState
from executive.inspector.brief import brief
from executive.inspector.terminal.rows import Rows

FRESH = "●"
_WRITER, _TICK, _LEAST = 18, 7, 10


class BoardRows(Rows):
    """One row for each key; those that were written in the tick are marked."""

    def __init__(self, *, id: str) -> None:
        """Begin without keys."""
        super().__init__(id=id)
        self._states: Mapping[str, KeyState] = {}
        self._shown: list[str] = []
        self._names: Counter[str] = Counter()
        self._tick = 0
        self._words, self._kept = "", ""
        self._values: dict[tuple[str, int], str] = {}

    def set_tick(self, states: Mapping[str, KeyState], tick: int) -> None:
        """Show what the blackboard held after a tick; the cursor stays on its key.

        It comes back to the key in ticks at which it has a value.
        """
        self._kept = self.selected or self._kept
        self._states, self._tick = states, tick
        self._show(self._kept)

    def filter(self, words: str) -> None:
        """Show only keys with these words in their full name."""
        self._words = words.strip().lower()
        self._show(self.selected)

    def select(self, key: str) -> None:
        """Put the cursor on a key, if it has a value."""
        if self._words not in key.lower():
            self._words = ""
        self._kept = key
        self._show(key)

    @property
    def selected(self) -> str:
        """Full name of the key under the cursor, empty where there is none."""
        return self._shown[self.cursor] if self.cursor < len(self._shown) else ""

    @property
    def count(self) -> int:
        """Number of keys that are shown."""
        return len(self._shown)

    def row(self, index: int) -> Text:
        """Return one key with its value, its writer and the tick of the write."""
        key = self._shown[index]
        state = self._states[key]
        fresh = state.tick == self._tick
        names, values = self._widths()
        writer = state.writer.rpartition("/")[2] or "input"
        text = Text.assemble((f"{FRESH if fresh else ' '} ", self.look("running")))
        text.append(_fitted(self._short(key), names), self.look("strong" if fresh else "name"))
        text.append("  ").append(_fitted(self._value(key, state), values))
        text.append("  ").append(_fitted(writer, _WRITER), self.look("muted"))
        return text.append(f"@{state.tick}".rjust(_TICK), self.look("muted"))

    def _value(self, key: str, state: KeyState) -> str:
        """Return a value in one line; values change only when they are written."""
        place = (key, state.tick)
        if place not in self._values:
            self._values[place] = brief(state.value)
        return self._values[place]

    def _widths(self) -> tuple[int, int]:
        """Return the widths of names and of values."""
        room = max(2 * _LEAST, self.room - 2 - 2 - 4 - _WRITER - _TICK)
        longest = max((len(self._short(key)) for key in self._shown), default=0)
        names = max(_LEAST, min(longest, room // 2))
        return names, room - names

    def _short(self, key: str) -> str:
        """Return the name of a key, with its scope where others have the name too."""
        scope, _, name = key.rpartition("/")[2].rpartition(":")
        return f"{name} ({scope})" if self._names[name] > 1 else name

    def _show(self, key: str) -> None:
        self._names = Counter(name.rpartition(":")[2] for name in self._states)
        self._shown = [name for name in self._states if self._words in name.lower()]
        self.changed()
        if key in self._states and key in self._shown:
            self.put_cursor(self._shown.index(key))


def _fitted(text: str, width: int) -> str:
    return text.ljust(width) if len(text) <= width else f"{text[: width - 1]}…"
