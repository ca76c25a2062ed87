"""Imports XML, scripts its stubs, and ticks what comes out."""

import json
from dataclasses import dataclass, field
from pathlib import Path

from executive.core.clock import ManualClock
from executive.core.registry import Registry
from executive.engine.exchange.importing import ImportOptions, import_text
from executive.engine.language.sources import read_source
from executive.engine.loading.loader import load_program
from executive.engine.nodes.builder import build

NOTHING = Registry("skill")
TYPES = Registry("type")


def document(body, *, main="Main", more=""):
    """Return a file with one tree around some XML."""
    tree = f'<BehaviorTree ID="{main}">{body}</BehaviorTree>'
    return f'<root BTCPP_format="4" main_tree_to_execute="{main}">{tree}{more}</root>'.encode()


def imported(xml, **options):
    """Return what an import writes, by file name."""
    data = xml if isinstance(xml, bytes) else document(xml)
    return import_text("t.xml", data, NOTHING, ImportOptions(**options))


def tree_of(xml, name="main", **options):
    """Return one imported document as data."""
    return data_of(imported(xml, **options).files[f"{name}.yaml"])


def data_of(text):
    """Return what YAML text says; the words of YAML 1.2 are not those of PyYAML."""
    source = read_source("t.yaml", text)
    assert source.faults == ()
    return source.data


def root_of(xml, **options):
    """Return the root node of the main tree as data."""
    return tree_of(xml, **options)["root"]


@dataclass
class Run:
    """A tree that was imported and can be ticked.

    Attributes:
        answers: Status of the root, a letter a tick.
        doing: What each leaf did, a letter a tick: R, S, F, or a dot for nothing.
    """

    tree: object
    clock: ManualClock
    answers: str = ""
    doing: dict = field(default_factory=dict)

    def tick(self, count=1, step_s=0.1):
        """Tick some times, and note what the root and every skill answered."""
        skills = [node for node in self.tree.nodes if node.kind == "skill"]
        for _ in range(count):
            for node in skills:
                self.doing.setdefault(node.name, "")
                node.behaviour.ticked = False
            self.tree.root.tick_once()
            self.answers += self.tree.root.status.name[0]
            for node in skills:
                letter = node.behaviour.status.name[0] if node.behaviour.ticked else "."
                self.doing[node.name] += letter
            self.clock.sleep_until(self.clock.now_s() + step_s)
        return self

    def value(self, key):
        """Return the value of a key of the main tree."""
        return self.tree.scope[key]


def run(folder: Path, xml, scripts, **options):
    """Import, script and build.

    Args:
        folder: Where the documents go.
        xml: A node, or a whole file.
        scripts: What stubs do, by ID: `"RRS F"` succeeds in the third tick of its first
            activation, and fails in the first one of every other.
        options: Options of the import.
    """
    for name, text in imported(xml, **options).files.items():
        data = data_of(text)
        for stub in data.get("skills", {}).values():
            wanted = scripts.get(stub["stands_for"])
            if wanted:
                out = stub["outcomes"][0].get("out", {})
                stub["outcomes"] = [_outcome(each, out) for each in wanted.split()]
        (folder / name).write_text(json.dumps(data))
    program = load_program(folder / "main.yaml", skills=NOTHING, types=TYPES)
    clock = ManualClock()
    inputs = dict.fromkeys(program.tree.inputs)
    tree = build(program, devices={}, clock=clock, inputs=inputs)
    for node in tree.nodes:
        if node.kind == "skill":
            _watch(node.behaviour)
    return Run(tree, clock)


def _outcome(letters, out):
    answer = {"S": "success", "F": "failure"}[letters[-1]]
    values = {"out": out} if answer == "success" and out else {}
    return {"ticks": len(letters), "outcome": answer, **values}


def _watch(behaviour):
    """Note whether a leaf was ticked; a status alone does not say."""
    update = behaviour.update

    def watched():
        behaviour.ticked = True
        return update()

    behaviour.update = watched
