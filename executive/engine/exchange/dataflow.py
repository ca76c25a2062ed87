"""Which keys of a set of foreign trees are one and the same, and who reads and writes them.

There, a tree declares no ports: what a subtree shares with the tree around it shows only in
its remapping, and whether a custom node reads or writes a port only in its model, if there is
one. So the trees are gone through as they would run, subtrees put in, and each access to a key
is noted. What no model says follows from the order: a node that mentions a key first gives it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Final, Literal

from executive.core.errors import Fault, InputError
from executive.engine.exchange.cpptypes import our_type
from executive.engine.exchange.foreign import Direction, ForeignPort, ForeignTrees
from executive.engine.exchange.markup import Element
from executive.engine.exchange.scripts import Vocabulary, read_script
from executive.engine.exchange.vocabulary import CONDITIONS, ENDINGS, EXPLICIT, PORTS

MAX_NODES: Final = 20_000
"""How many nodes the trees may have when every subtree is put in."""
MAX_DEPTH: Final = 200
"""How deep they may be then, which is as deep as our own may be."""

Mode = Literal["read", "write", "both", "unknown"]
PortName = tuple[str, str]
"""ID of a node, and the name of one of its ports."""

_MODES: Final[Mapping[Direction, Mode]] = {"in": "read", "out": "write", "inout": "both"}
_SCRIPTS: Final = frozenset({"code", "if"})


@dataclass(frozen=True, slots=True)
class Access:
    """One access of one node to a key.

    Attributes:
        at: Its place in the order of all accesses.
        mode: Read, write, both, or not known yet.
        element: The node.
        port: The port behind it, None for a script.
        type: Type of the port, `any` where none is known.
    """

    at: int
    mode: Mode
    element: Element
    port: PortName | None
    type: str = "any"


@dataclass(slots=True, eq=False)
class Entry:
    """A key as the blackboard holds it, whatever each tree calls it.

    Attributes:
        accesses: Who reads and writes it, in order.
        literal: Whether a tree was given a text for it.
    """

    accesses: list[Access] = field(default_factory=list)
    literal: str | None = None


@dataclass(slots=True, eq=False)
class Scope:
    """The keys that one use of a tree sees.

    Attributes:
        tree: ID of the tree.
        outer: The scope of the tree that uses it.
        remapped: Keys that the outer tree gave it.
        automatic: Whether all other keys are those of the outer tree.
        keys: Every key that was looked up.
        start: Place of its first access.
        end: Place after its last access.
    """

    tree: str
    outer: "Scope | None"
    remapped: Mapping[str, Entry]
    automatic: bool
    start: int
    keys: dict[str, Entry] = field(default_factory=dict)
    end: int = 0

    def entry(self, key: str) -> Entry:
        """Return the entry behind a key."""
        if key not in self.keys:
            if key in self.remapped:
                self.keys[key] = self.remapped[key]
            elif self.automatic and self.outer is not None and not key.startswith("_"):
                self.keys[key] = self.outer.entry(key)
            else:
                self.keys[key] = Entry()
        return self.keys[key]

    def inside(self, entry: Entry) -> list[Access]:
        """Return the accesses to an entry that this use of the tree makes."""
        return [access for access in entry.accesses if self.start <= access.at < self.end]


def node_id(element: Element) -> str:
    """Return the ID of the node that an element stands for."""
    return element.attributes.get("ID", "") if element.tag in EXPLICIT else element.tag


def subtree_of(element: Element, trees: ForeignTrees) -> str | None:
    """Return the ID of the tree that an element puts in, None if it is another node."""
    if element.tag == "SubTree":
        return element.attributes.get("ID", "")
    is_tree = element.tag in trees.trees and element.tag not in trees.models
    return element.tag if is_tree and not element.children else None


def key_in(text: str, port: str) -> str | None:
    """Return the key that an attribute refers to: `goal` for `{goal}`; None for a literal."""
    bare = text.strip()
    if bare in ("{=}", "="):
        return port
    return bare[1:-1].strip() if len(bare) > 2 and bare[0] == "{" and bare[-1] == "}" else None


def ports_of(element: Element, trees: ForeignTrees) -> Mapping[str, ForeignPort]:
    """Return the ports that are declared for a node, by its maker or by a model."""
    name = node_id(element)
    if name in PORTS:
        return PORTS[name]
    model = trees.models.get(name)
    return model.ports if model else {}


def wired_ports(element: Element, trees: ForeignTrees) -> Iterator[tuple[str, str]]:
    """Yield name and text of every port of a node, with the defaults that refer to keys."""
    for name, text in element.attributes.items():
        if name not in ("ID", "name") and not name.startswith("_"):
            yield name, text
    for name, port in ports_of(element, trees).items():
        default = port.default
        if name not in element.attributes and default and key_in(default, name) is not None:
            yield name, default


class Dataflow:
    """The accesses to all keys, and what follows from them.

    Attributes:
        scopes: Every use of a tree.
        directions: Direction of every port that no model declares.
        notes: What was taken for granted.
        faults: What cannot be followed.
    """

    def __init__(self, trees: ForeignTrees, enums: Mapping[str, int]) -> None:
        """Go through the trees."""
        self._trees, self._enums = trees, enums
        self._count = self._nodes = self._depth = 0
        self.scopes: list[Scope] = []
        self.directions: dict[PortName, Direction] = {}
        self.notes: list[Fault] = []
        self.faults: list[Fault] = []
        self._literals: set[PortName] = set()
        self._full = False
        self._follow_all()
        self._settle()

    def _follow_all(self) -> None:
        first = [self._trees.main] if self._trees.main else []
        for tree in (*first, *self._trees.trees):
            if not any(scope.tree == tree for scope in self.scopes):
                self._follow(Scope(tree, None, {}, False, self._count), (tree,))

    def _follow(self, scope: Scope, above: tuple[str, ...]) -> None:
        self.scopes.append(scope)
        self._node(self._trees.trees[scope.tree].children[0], scope, above)
        scope.end = self._count

    def _node(self, element: Element, scope: Scope, above: tuple[str, ...]) -> None:
        self._nodes += 1
        if self._nodes > MAX_NODES or self._depth > MAX_DEPTH:
            if not self._full:
                much = f"{MAX_NODES} nodes, or deeper than {MAX_DEPTH},"
                self.faults.append(element.fault(f"more than {much} with all subtrees put in"))
            self._full = True
            return
        self._depth += 1
        for keyword in CONDITIONS:
            self._script(element, keyword, scope)
        tree = subtree_of(element, self._trees)
        if tree is not None:
            self._subtree(element, tree, scope, above)
        else:
            self._plain(element, scope, above)
        for keyword in ENDINGS:
            self._script(element, keyword, scope)
        self._depth -= 1

    def _plain(self, element: Element, scope: Scope, above: tuple[str, ...]) -> None:
        wired = list(self._wired(element))
        for mode in ("read", "both", "unknown"):
            self._ports(element, scope, [one for one in wired if one[2] == mode])
        is_builtin = node_id(element) in PORTS
        for name in sorted(_SCRIPTS & element.attributes.keys()) if is_builtin else ():
            self._script(element, name, scope)
        writes = [one for one in wired if one[2] == "write"]
        is_loop = bool(element.children)
        self._ports(element, scope, writes if is_loop else [])
        for child in element.children:
            self._node(child, scope, above)
        self._ports(element, scope, [] if is_loop else writes)

    def _wired(self, element: Element) -> Iterator[tuple[str, str, Mode, str]]:
        name = node_id(element)
        declared = ports_of(element, self._trees)
        for port, text in wired_ports(element, self._trees):
            if name == "SetBlackboard" and port == "output_key":
                text = text if key_in(text, port) is not None else f"{{{text}}}"
            if name == "UnsetBlackboard" and port == "key":
                continue
            if (key := key_in(text, port)) is None:
                self._literals.add((name, port))
                continue
            known = declared.get(port)
            mode: Mode = _MODES[known.direction] if known else "unknown"
            kind = our_type(known.type) if known else "any"
            yield port, key, mode, kind

    def _ports(
        self, element: Element, scope: Scope, ports: list[tuple[str, str, Mode, str]]
    ) -> None:
        name = node_id(element)
        for port, key, mode, kind in ports:
            self._access(scope, key, mode, element, (name, port), kind)

    def _script(self, element: Element, attribute: str, scope: Scope) -> None:
        text = element.attributes.get(attribute)
        if text is None:
            return
        try:
            statements = read_script(text, Vocabulary(lambda name: name, enums=self._enums))
        except InputError:
            return  # told where the node is translated
        for statement in statements:
            for key in statement.reads:
                self._access(scope, key, "read", element, None)
            if statement.key:
                self._access(scope, statement.written, "write", element, None)

    def _access(
        self,
        scope: Scope,
        key: str,
        mode: Mode,
        element: Element,
        port: PortName | None,
        kind: str = "any",
    ) -> None:
        scope.entry(key).accesses.append(Access(self._count, mode, element, port, kind))
        self._count += 1

    def _subtree(self, element: Element, tree: str, scope: Scope, above: tuple[str, ...]) -> None:
        if tree not in self._trees.trees:
            return  # told where the node is translated
        if tree in above:
            chain = " > ".join((*above[above.index(tree) :], tree))
            self.faults.append(element.fault(f"tree {tree!r} would contain itself: {chain}"))
            return
        remapped: dict[str, Entry] = {}
        for port, text in wired_ports(element, self._trees):
            key = key_in(text, port)
            remapped[port] = Entry(literal=text) if key is None else scope.entry(key)
        inner = Scope(tree, scope, remapped, is_automatic(element), self._count)
        self._follow(inner, (*above, tree))

    def _settle(self) -> None:
        """Find the direction of every port that no model declares."""
        for port in sorted(self._literals):
            self.directions[port] = "in"
        entries = list(
            {id(entry): entry for scope in self.scopes for entry in scope.keys.values()}.values()
        )
        while (found := self._next_direction(entries)) is not None:
            access, direction = found
            port = access.port or ("", "")
            self.directions[port] = direction
            word = "input" if direction == "in" else "output"
            self.notes.append(
                access.element.fault(
                    f"no model says what {port[1]!r} is; taken as an {word}, try --models FILE "
                    "with a TreeNodesModel if it is not"
                )
            )

    def _next_direction(self, entries: list[Entry]) -> tuple[Access, Direction] | None:
        guess: tuple[Access, Direction] | None = None
        for entry in entries:
            unknown = [each for each in entry.accesses if self.mode(each) == "unknown"]
            if not unknown:
                continue
            writers = [a for a in entry.accesses if self.mode(a) in ("write", "both")]
            if writers or entry.literal is not None:
                return unknown[0], "in"
            is_first = entry.accesses[0] is unknown[0]
            shared = len({id(access.element) for access in entry.accesses}) > 1
            guess = guess or (unknown[0], "out" if is_first and shared else "in")
        return guess

    def mode(self, access: Access) -> Mode:
        """Return the mode of an access as far as it is known by now."""
        if access.mode == "unknown" and access.port in self.directions:
            return _MODES[self.directions[access.port]]
        return access.mode

    def direction(self, element: Element, port: str) -> Direction:
        """Return the direction of a port of a custom node."""
        declared = ports_of(element, self._trees).get(port)
        if declared is not None:
            return declared.direction
        return self.directions.get((node_id(element), port), "in")

    def reads(self, accesses: list[Access]) -> bool:
        """Return whether the first of some accesses needs a value."""
        return bool(accesses) and self.mode(accesses[0]) != "write"

    def writes(self, accesses: list[Access]) -> bool:
        """Return whether one of some accesses gives a value."""
        return any(self.mode(access) in ("write", "both") for access in accesses)


def is_automatic(element: Element) -> bool:
    """Return whether a subtree sees all keys of the tree around it."""
    return element.attributes.get("_autoremap", "").strip().lower() in ("true", "1")
