"""The keys of the inspector: what the help shows is what is bound."""

from dataclasses import dataclass
from typing import Final

from textual.binding import Binding


@dataclass(frozen=True, slots=True)
class Key:
    """One key, or one with its opposite.

    Attributes:
        keys: As textual calls them, separated by commas.
        shown: As people call it.
        action: What it does.
        told: What it does, in words.
        foot: Its name in the bottom line; empty to leave it out.
    """

    keys: str
    shown: str
    action: str
    told: str
    foot: str = ""


GROUPS: Final = {
    "Ticks": (
        Key("right", "→", "tick_by(1)", "one tick on"),
        Key("left", "←", "tick_by(-1)", "one tick back"),
        Key("shift+right", "Shift →", "tick_by(10)", "ten ticks on"),
        Key("shift+left", "Shift ←", "tick_by(-10)", "ten ticks back"),
        Key("home", "Home", "first", "first tick"),
        Key("end", "End", "last", "last tick; follows a live run"),
        Key("g", "g", "ask('go')", "go to a tick or a time", "go to"),
        Key("space", "Space", "play", "play, or stop playing", "play"),
        Key("greater_than_sign", ">", "speed(1)", "play faster"),
        Key("less_than_sign", "<", "speed(-1)", "play slower"),
        Key("plus,equals_sign", "+", "zoom(0.5)", "show fewer ticks in the lanes"),
        Key("minus", "-", "zoom(2.0)", "show more ticks in the lanes"),
    ),
    "Find": (
        Key("c", "c", "seek('change',1)", "next change of the node, or of one below it", "change"),
        Key("C", "C", "seek('change',-1)", "the change before"),
        Key("f", "f", "seek('failure',1)", "next failure of the node, or below", "failure"),
        Key("F", "F", "seek('failure',-1)", "the failure before"),
        Key("w", "w", "seek('write',1)", "next write of the selected key", "write"),
        Key("W", "W", "seek('write',-1)", "the write before"),
        Key(
            "e",
            "e",
            "ask('where')",
            "search ticks by an expression; ↑ for earlier ones",
            "expression",
        ),
        Key("n", "n", "seek('where',1)", "next tick where it holds"),
        Key("N", "N", "seek('where',-1)", "the one before"),
    ),
    "Panes": (
        Key("tab", "Tab", "app.focus_next", "next pane (Shift Tab: the one before)"),
        Key("slash", "/", "ask('filter')", "filter nodes; keys in the blackboard", "filter"),
        Key("h", "h", "fold_idle", "fold what never ran, or unfold all"),
        Key("z", "z", "zoom_pane", "give the pane all the room, or share it again", "zoom"),
        Key("t", "t", "theme", "light or dark"),
        Key("question_mark", "?", "help", "this help", "help"),
        Key("q", "q", "quit", "leave; a live mission goes on", "quit"),
    ),
    "A live run": (
        Key("p", "p", "pause_or_resume", "pause, or go on", "pause"),
        Key("s", "s", "step('tick')", "one tick"),
        Key("i", "i", "step('into')", "into: to the next node"),
        Key("o", "o", "step('over')", "over: until this node has answered"),
        Key("u", "u", "step('out')", "out: until its parent has answered"),
        Key("b", "b", "ask('break')", "break at the node", "break"),
        Key("x", "x", "stop", "stop the mission in order"),
        Key("X", "X", "emergency_stop", "stop the arms now; asks once"),
    ),
}

TABS: Final = ("board", "key", "tick", "why", "yaml", "report", "debug")
TITLES: Final = ("Board", "Key", "Tick", "Why", "YAML", "Report", "Debug")
LIVE_ACTIONS: Final = frozenset({"pause_or_resume", "step", "stop", "emergency_stop"})
LEGEND: Final = (
    "▶ running  ✓ success  ✗ failure  · not asked, or halted  ■ halted  ● written in this tick",
    "lanes: ▄ running  ▂ success  █ failure  ▒ halted; ▼ this tick, • ticks that a search found",
    "Enter folds a node, opens a key, goes where a line leads; 1 to 7 choose a pane",
    "The mouse works: lanes, rows, tabs and the bottom line.",
)


def bindings() -> list[Binding]:
    """Return all keys as textual binds them, and a number for each tab."""
    found = [
        Binding(
            key.keys, key.action, key.foot or key.told, show=bool(key.foot), key_display=key.shown
        )
        for keys in GROUPS.values()
        for key in keys
        if key.keys != "tab"
    ]
    for number, (name, title) in enumerate(zip(TABS, TITLES, strict=True), start=1):
        found.append(Binding(str(number), f"tab('{name}')", title, show=False))
    return found
