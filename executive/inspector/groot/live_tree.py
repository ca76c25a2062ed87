"""The whole tree of a run as the XML that Groot2 draws, with a number on every node.

An export merges nodes into what BehaviorTree.CPP would run. Here every node that has a status
stands for itself, guards included, and each use of a subtree is a node besides, as it is there.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from executive.core.errors import InputError
from executive.engine.blackboard import Blackboard
from executive.engine.exchange.vocabulary import COUNTERPARTS
from executive.engine.exchange.xmltext import XmlElement, printable
from executive.engine.language.block_models import BLOCKS, DecoratorBody
from executive.engine.recording.messages import MissionHeader, RecordedNode
from executive.inspector.groot.ports import Ports, ports_of
from executive.inspector.groot.wire import MOST_NODES, TREE_ID_BYTES
from executive.inspector.rebuilt import Rebuilt

_TAGS: Final[Mapping[str, str]] = {
    **COUNTERPARTS,
    "when": "ScriptCondition",
    "set": "Script",
    "retry": "RetryUntilSuccessful",
}
_CONTROLS: Final = frozenset(
    kind for kind, model in BLOCKS.items() if not issubclass(model, DecoratorBody)
)


@dataclass(frozen=True, slots=True)
class Station:
    """One use of a tree.

    Attributes:
        tree: Name of the tree.
        path: Path of its root.
        root: Index of its root.
        uid: Number of the node that stands for the use; 0 for the main tree, which has none.
    """

    tree: str
    path: str
    root: int
    uid: int


class LiveTree:
    """The tree of a run, numbered.

    The node of index i has the number i + 1; uses of subtrees are numbered after all nodes.

    Attributes:
        nodes: The nodes.
        stations: The main tree first, then every use of a subtree in the order of the nodes.
        boards: Path of the station that each key belongs to, by what the key begins with.
        xml: The tree.
        tree_id: Sixteen bytes that another run does not share.
    """

    def __init__(self, header: MissionHeader) -> None:
        """Write the tree of a run.

        Raises:
            InputError: It has more nodes than the protocol can number.
        """
        self.nodes = header.nodes
        written = Rebuilt(header, Blackboard())
        self._ports = {path: ports_of(node) for path, node in written.nodes.items()}
        self.stations = _stations(header, written.stations)
        self.boards: Mapping[str, str] = written.owners
        count = len(self.nodes) + len(self.stations) - 1
        if count > MOST_NODES:
            raise InputError(f"{count} nodes: Groot2's protocol numbers {MOST_NODES} at most")
        self._children: dict[int | None, list[int]] = {}
        for index, node in enumerate(self.nodes):
            self._children.setdefault(node.parent, []).append(index)
        self._uses = {station.root: station for station in self.stations[1:]}
        self.xml = self._document()
        told = f"{header.mission} {header.seed} {header.started_utc} {self.xml}"
        self.tree_id = hashlib.sha256(told.encode()).digest()[:TREE_ID_BYTES]

    def index(self, uid: int) -> int:
        """Return the index of the node that a number stands for, its root for a subtree.

        Raises:
            InputError: There is no such number.
        """
        if 1 <= uid <= len(self.nodes):
            return uid - 1
        station = uid - len(self.nodes)
        if not 1 <= station < len(self.stations):
            most = len(self.nodes) + len(self.stations) - 1
            raise InputError(f"node {uid} not found; expected 1 to {most}")
        return self.stations[station].root

    def _document(self) -> str:
        root = XmlElement(
            "root", {"BTCPP_format": "4", "main_tree_to_execute": self.stations[0].tree}
        )
        root.children = [self._tree(station) for station in self.stations]
        root.children.append(XmlElement("TreeNodesModel", {}, self._models()))
        return "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', *root.lines(), ""])

    def _tree(self, station: Station) -> XmlElement:
        place = "" if station.uid == 0 else station.path
        attributes = {"ID": station.tree, "_fullpath": place}
        return XmlElement("BehaviorTree", attributes, [self._node(station.root)])

    def _node(self, index: int) -> XmlElement:
        node = self.nodes[index]
        ports = self._ports.get(node.path, Ports())
        attributes = {"name": node.name, "_uid": str(index + 1)}
        attributes |= {**ports.inputs, **ports.outputs}
        children = [self._use_or_node(child) for child in self._children.get(index, [])]
        return XmlElement(_tag(node), attributes, children)

    def _use_or_node(self, index: int) -> XmlElement:
        use = self._uses.get(index)
        if use is None:
            return self._node(index)
        name = use.path.rpartition("/")[2]
        attributes = {"ID": use.tree, "name": name, "_fullpath": use.path, "_uid": str(use.uid)}
        return XmlElement("SubTree", attributes)

    def _models(self) -> list[XmlElement]:
        """Return a model of each kind of node, with every port that a node of it has."""
        models: dict[str, XmlElement] = {}
        for node in self.nodes:
            model = models.setdefault(_tag(node), XmlElement(_category(node), {"ID": _tag(node)}))
            known = {port.attributes["name"] for port in model.children}
            ports = self._ports.get(node.path, Ports())
            for tag, names in (("input_port", ports.inputs), ("output_port", ports.outputs)):
                model.children += [
                    XmlElement(tag, {"name": name}) for name in names if name not in known
                ]
        trees = dict.fromkeys(station.tree for station in self.stations)
        return [*models.values(), *(XmlElement("SubTree", {"ID": tree}) for tree in trees)]


def _stations(header: MissionHeader, subtrees: Mapping[str, str]) -> list[Station]:
    stations = [Station(header.mission, header.mission, 0, 0)]
    for index, node in enumerate(header.nodes):
        # A guard is around the use of the tree, and no part of it.
        if index and node.path in subtrees:
            uid = len(header.nodes) + len(stations)
            stations.append(Station(subtrees[node.path], node.path, index, uid))
    return stations


def _tag(node: RecordedNode) -> str:
    if node.kind == "skill":
        return printable(node.type)
    words = node.kind.split("_")
    return _TAGS.get(node.kind, "".join(word.capitalize() for word in words))


def _category(node: RecordedNode) -> str:
    if node.kind in _CONTROLS:
        return "Control"
    if node.kind in BLOCKS or node.kind in ("guard", "checkpoint"):
        return "Decorator"
    return "Condition" if node.kind in ("when", "chance") else "Action"
