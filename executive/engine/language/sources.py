"""Reads YAML text into plain values, and remembers where each of them stood.

YAML 1.2 core rules: only `true` and `false` are booleans, so `on` and `no` stay words. What
would make a document mean something else than it seems to is refused: duplicate keys, keys
that are no strings, tags, anchors and aliases (a subtree is the way to say things once).
"""

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import yaml
from yaml.nodes import MappingNode, Node, ScalarNode, SequenceNode
from yaml.resolver import BaseResolver

from executive.core.errors import Fault

YamlPath = tuple[str | int, ...]
Mark = tuple[int, int]

MAX_LEVELS = 250
"""How deep mappings and lists may be nested in one file."""

_TRY = "try a subtree for what is inside"
_TAG = "tag:yaml.org,2002:"
_PLAIN_TAGS = frozenset(_TAG + name for name in ("null", "bool", "int", "float", "str"))


class _Resolver(BaseResolver):
    """Which plain scalars are no strings: the core schema of YAML 1.2."""


for _name, _pattern, _first in (
    ("null", r"null|~|", ["n", "~", ""]),
    ("bool", r"true|false", list("tf")),
    ("int", r"[-+]?[0-9]+", list("-+0123456789")),
    (
        "float",
        r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|[-+]?\.inf|\.nan",
        list("-+.0123456789"),
    ),
):
    _Resolver.add_implicit_resolver(_TAG + _name, re.compile(rf"^(?:{_pattern})$"), _first)

_PARSER: Any = yaml.CSafeLoader if yaml.__with_libyaml__ else yaml.SafeLoader


class StrictLoader(_PARSER):
    """PyYAML's parser with the resolver of YAML 1.2."""

    yaml_implicit_resolvers = _Resolver.yaml_implicit_resolvers


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """One file as it was read.

    Attributes:
        file: Path as the user gave it, or as it was found.
        text: What the file held.
        data: Its values: dict, list, str, int, float, bool, None.
        keys: Line and column of each key or list item, by the path to it, counted from 1.
        values: Line and column of each value.
        faults: What could not be read; `data` holds the rest.
    """

    file: str
    text: str
    data: object
    keys: Mapping[YamlPath, Mark]
    values: Mapping[YamlPath, Mark]
    faults: tuple[Fault, ...] = ()

    @property
    def sha256(self) -> str:
        """Hash of the text, hexadecimal."""
        return hashlib.sha256(self.text.encode()).hexdigest()

    def key_mark(self, path: YamlPath) -> Mark:
        """Return where the key at the end of a path stands, or the nearest thing above."""
        return self._nearest(self.keys, path)

    def value_mark(self, path: YamlPath) -> Mark:
        """Return where the value at the end of a path begins, or the nearest thing above."""
        return self._nearest(self.values, path)

    @staticmethod
    def _nearest(marks: Mapping[YamlPath, Mark], path: YamlPath) -> Mark:
        for length in range(len(path), -1, -1):
            if path[:length] in marks:
                return marks[path[:length]]
        return (1, 1)


@dataclass(slots=True)
class _Reading:
    """What is gathered while the nodes of one file are walked."""

    file: str
    keys: dict[YamlPath, Mark] = field(default_factory=dict)
    values: dict[YamlPath, Mark] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)

    def complain(self, mark: Any, message: str) -> None:
        self.faults.append(Fault(self.file, mark.line + 1, mark.column + 1, "", message))

    def value(self, node: Node, path: YamlPath) -> object:
        mark = _mark(node)
        if len(path) > MAX_LEVELS:
            self.complain(node.start_mark, f"nested deeper than {MAX_LEVELS} levels; {_TRY}")
            return None
        self.values[path] = mark
        self.keys.setdefault(path, mark)
        if isinstance(node, MappingNode):
            return self._mapping(node, path)
        if isinstance(node, SequenceNode):
            return [self.value(item, (*path, i)) for i, item in enumerate(node.value)]
        return self._scalar(node)

    def _mapping(self, node: MappingNode, path: YamlPath) -> dict[str, object]:
        values: dict[str, object] = {}
        for key, value in node.value:
            name = key.value if isinstance(key, ScalarNode) else None
            if name is None or key.tag != _TAG + "str":
                self.complain(key.start_mark, f"a key must be a word; got {name!r}, try quotes")
                continue
            if name in values:
                first = self.keys[(*path, name)]
                self.complain(
                    key.start_mark,
                    f"duplicate key {name!r}; the first one is in line {first[0]}",
                )
                continue
            self.keys[(*path, name)] = _mark(key)
            values[name] = self.value(value, (*path, name))
        return values

    def _scalar(self, node: Node) -> object:
        text: str = node.value
        if node.tag not in _PLAIN_TAGS:
            self.complain(node.start_mark, f"unknown tag {node.tag!r}; values carry no tags here")
            return None
        kind = node.tag.removeprefix(_TAG)
        if kind == "int":
            return int(text)
        if kind == "float":
            return float(text.replace(".inf", "inf").replace(".nan", "nan"))
        if kind in ("bool", "null"):
            return text == "true" if kind == "bool" else None
        return text


def read_source(file: str, text: str) -> Source:
    """Read YAML text; what is wrong with it comes back as the faults of the source."""
    reading = _Reading(file)
    data: object = None
    try:
        loader = StrictLoader(text)
        try:
            _refuse_anchors(text, reading)
            root = loader.get_single_node()
            data = None if reading.faults or root is None else reading.value(root, ())
        finally:
            loader.dispose()
    except yaml.MarkedYAMLError as error:
        mark: Any = error.problem_mark or error.context_mark
        reading.complain(mark, _not_yaml(error, text.split("\n")[mark.line : mark.line + 1]))
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        reading.faults.append(Fault(file, line, 1, "", f"not YAML: {error.reason}"))
    except RecursionError:
        reading.faults.append(Fault(file, 1, 1, "", f"nested much too deeply; {_TRY}"))
    except ValueError as error:  # a number of thousands of digits
        reading.faults.append(Fault(file, 1, 1, "", f"cannot be read: {error}"))
    return Source(file, text, data, reading.keys, reading.values, tuple(reading.faults))


def _not_yaml(error: yaml.MarkedYAMLError, line: list[str]) -> str:
    """Say what the parser found, and what is behind it most often."""
    indentation = re.match(r"\s*", line[0] if line else "")
    if indentation and "\t" in indentation[0]:
        return "not YAML: a tab in the indentation; expected blanks"
    what = f"not YAML: {', '.join(part for part in (error.context, error.problem) if part)}"
    hints = {"block": "the indentation of this line", "flow": "brackets, commas and quotes"}
    hint = next((hint for word, hint in hints.items() if word in (error.context or "")), "")
    if "quoted" in (error.context or ""):
        hint = "the closing quote"
    return f"{what}; look at {hint}" if hint else what


def _refuse_anchors(text: str, reading: _Reading) -> None:
    """Find anchors and aliases in the event stream: composed nodes no longer show them."""
    if "&" not in text and "*" not in text:
        return
    for event in yaml.parse(text, Loader=StrictLoader):
        name = getattr(event, "anchor", None)
        if name is not None:
            reading.complain(
                event.start_mark,
                f"anchor or alias {name!r}; documents carry none, try a subtree",
            )


def _mark(node: Node) -> Mark:
    return (node.start_mark.line + 1, node.start_mark.column + 1)
