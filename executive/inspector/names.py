"""How people name nodes, keys and ticks on the command line, and how they are shown."""

import difflib
import re
from collections.abc import Iterable, Sequence
from fnmatch import fnmatchcase
from pathlib import PurePath

from executive.core.errors import InputError
from executive.core.registry import closest
from executive.inspector.index import RunIndex

_TIME = re.compile(r"^(-?\d+(?:\.\d*)?)s$")
_SHOWN = 12


class Names:
    """Short names of the nodes and keys of one run, and the way back from them."""

    def __init__(self, index: RunIndex) -> None:
        """Work out the shortest name of every node that no other node has too."""
        self._index = index
        self._paths = [node.path for node in index.nodes]
        self._short = shortest_suffixes(self._paths)

    def short(self, node: int) -> str:
        """Return the end of a node's path that says which node it is."""
        return self._short[node]

    def of_path(self, path: str) -> str:
        """Return the short name of a path, the path itself where there is no such node."""
        node = self._index.indices.get(path)
        return path if node is None else self._short[node]

    def where(self, node: int) -> str:
        """Return `file:line` of a node, the file without its folders."""
        recorded = self._index.nodes[node]
        return f"{PurePath(recorded.file).name}:{recorded.line}"

    def nodes(self, text: str) -> tuple[int, ...]:
        """Return the nodes that a full path, the end of one, or a glob names.

        Raises:
            InputError: There is none.
        """
        if text in self._index.indices:
            return (self._index.indices[text],)
        found = tuple(i for i, path in enumerate(self._paths) if _names(text, path))
        if not found:
            known = sorted({*self._short, *(node.name for node in self._index.nodes)})
            raise InputError(f"no node {text!r}; {_closest(text, known)}")
        return found

    def node(self, text: str, tick: int | None = None) -> int:
        """Return the one node that a text names; where several fit, the one that ran then.

        Raises:
            InputError: There is none, or more than one.
        """
        found = self.nodes(text)
        if len(found) > 1 and tick is not None:
            found = tuple(i for i in found if self._index.answers[tick, i]) or found
        if len(found) > 1:
            some = ", ".join(self._short[i] for i in found[:_SHOWN])
            more = f" and {len(found) - _SHOWN} more" if len(found) > _SHOWN else ""
            raise InputError(f"{text!r} names {len(found)} nodes: {some}{more}; try one of them")
        return found[0]

    def keys(self, text: str) -> tuple[str, ...]:
        """Return the keys that a full key, a bare name, or a glob names, in order of writing.

        Raises:
            InputError: There is none.
        """
        written = [*self._index.writes]
        found = tuple(key for key in written if _names_key(text, key))
        if not found:
            known = sorted({key.rpartition(":")[2] for key in written})
            raise InputError(f"no key {text!r} was written; {_closest(text, known)}")
        return found

    def key(self, text: str) -> str:
        """Return the one key that a text names.

        Raises:
            InputError: There is none, or more than one.
        """
        found = self.keys(text)
        if len(found) > 1:
            raise InputError(
                f"{text!r} names {len(found)} keys: {', '.join(found[:_SHOWN])}; try one of them"
            )
        return found[0]

    def tick(self, text: str) -> int:
        """Return the tick that `41`, `-1`, `last`, `first` or `12.3s` names.

        A time names the last tick that had begun by then.

        Raises:
            InputError: There is no such tick, or the text is none of these.
        """
        index = self._index
        if text in ("last", "first"):
            return index.last_tick if text == "last" else 0
        if timed := _TIME.match(text):
            begun = int((index.times_s <= float(timed[1]) + 1e-9).sum()) - 1
            return self._checked(text, min(begun, index.last_tick))
        try:
            number = int(text)
        except ValueError:
            raise InputError(
                f"{text!r} is no tick; expected a number, -1, last, or a time such as 12.3s"
            ) from None
        return self._checked(text, number + index.last_tick + 1 if number < 0 else number)

    def _checked(self, text: str, number: int) -> int:
        last = len(self._index) - 1
        if not 0 <= number <= last:
            ends_s = self._index.times_s[-1]
            raise InputError(f"no tick {text}; expected 0 to {last} (0s to {ends_s:.1f}s)")
        return number


def split_at(text: str) -> tuple[str, str | None]:
    """Split `NODE@TICK`; the tick is None where there is no `@`."""
    name, at, tick = text.rpartition("@")
    return (name, tick) if at else (text, None)


def shortest_suffixes(paths: Sequence[str]) -> list[str]:
    """Return for each path the fewest last names that no other path ends with."""
    counts: dict[str, int] = {}
    for path in paths:
        for suffix in _suffixes(path):
            counts[suffix] = counts.get(suffix, 0) + 1
    return [next((s for s in _suffixes(path) if counts[s] == 1), path) for path in paths]


def _suffixes(path: str) -> Iterable[str]:
    names = path.split("/")
    return ("/".join(names[start:]) for start in range(len(names) - 1, -1, -1))


def _names(text: str, path: str) -> bool:
    return path.endswith(f"/{text}") or fnmatchcase(path, text) or fnmatchcase(path, f"*/{text}")


def _names_key(text: str, key: str) -> bool:
    path, _, name = key.rpartition(":")
    ends = text in (key, name) or key.endswith(f"/{text}")
    return ends or fnmatchcase(key, text) or fnmatchcase(name, text) or text == f"{path}:{name}"


def _closest(text: str, known: Sequence[str]) -> str:
    """Answer with the closest names only: a tree of hundreds of nodes is no help."""
    near = difflib.get_close_matches(text.rpartition("/")[2], known, n=5, cutoff=0.5)
    return closest(text.rpartition("/")[2], near or [*known[:_SHOWN]])
