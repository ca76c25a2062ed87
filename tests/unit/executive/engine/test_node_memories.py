"""Every kind of node says what it remembers: a copy that is told goes on like the original."""

from enum import Enum

import pytest
from killed_toys import WorldCell, skills, types, write_mission
from py_trees.behaviour import Behaviour

from executive.engine.checkpoints.memories import Child, memory_of, recall
from executive.engine.language.block_models import BLOCKS, LEAVES
from executive.engine.loading.loader import load_mission
from executive.engine.nodes.builder import build

# The kinds that remember something only while they run are caught in the middle of it.
NODES = {
    "skill": "{skill: work, in: {label: a, fails: 3}}",
    "when": "{when: size(list) == 3}",
    "set": "{set: {a: 1}}",
    "unset": "sequence: [{set: {a: 1}}, {wait: 0.25}, {unset: [a]}]",
    "wait": "{wait: 0.25}",
    "wait_for": "{wait_for: size(list) == 4}",
    "fail": "{fail: toy.bad}",
    "chance": "{chance: 0.5}",
    "sequence": "sequence: [{when: true}, {wait: 0.15}, {wait: 0.25}]",
    "selector": "selector: [{when: false}, {wait: 0.15}, {wait: 0.25}]",
    "reactive_sequence": "reactive_sequence: [{when: true}, {wait: 0.25}]",
    "reactive_selector": "reactive_selector: [{when: false}, {wait: 0.25}]",
    "parallel": "parallel: {on_done: wait, succeed: 1, children: [{wait: 0.15}, {wait: 0.35}]}",
    "retry": "retry: {times: 9, delay_s: 0.15, child: {when: false}}",
    "repeat": "repeat: {times: 9, delay_s: 0.15, child: {when: true}}",
    "timeout": "timeout: {seconds: 0.75, child: {wait: 9.0}}",
    "cooldown": "cooldown: {seconds: 0.75, child: {wait: 0.15}}",
    "for_each": "for_each: {item: $x, in: $list, child: {wait: 0.15}}",
    "run_once": "run_once: {child: {wait: 0.15}}",
    "if_then_else": "if_then_else: [{when: true}, {wait: 0.15}, {wait: 0.25}]",
    "while_do_else": "while_do_else: [{when: true}, {wait: 0.15}, {wait: 0.25}]",
    "switch": "switch: {on: size(list), cases: {'3': {wait: 0.15}}, default: {wait: 0.35}}",
    "reactive_switch": "reactive_switch: {on: size(list), cases: {'3': {wait: 0.15}}}",
    "observe": "observe: {counts: $n, child: {wait: 0.15}}",
}
# What py_trees, or building, keeps on a node: no memory, or set anew by whoever asks.
NOT_MEMORY = {"iterator", "status", "feedback_message", "outcome", "logger"}


def loaded(folder, root):
    return load_mission(write_mission(folder, root), skills=skills(), types=types())


def built(mission, cell):
    return build(mission, devices=cell.devices, clock=cell.clock, seed=3)


def state_of(node):
    """Return every attribute that could be memory: plain values, and children by place."""
    state = {}
    for name, value in vars(node).items():
        if name in NOT_MEMORY:
            continue
        if isinstance(value, Behaviour) and value in node.children and name != "decorated":
            state[name] = Child(node.children.index(value))
        elif value is None or isinstance(value, bool | int | float | str | list | Enum):
            state[name] = list(value) if isinstance(value, list) and name != "children" else value
    state.pop("children", None)
    return state


def kinds():
    return sorted((LEAVES | BLOCKS).keys() - {"subtree"})


@pytest.mark.parametrize("kind", kinds())
def test_a_node_that_is_told_what_another_one_remembered_has_its_state(tmp_path, kind):
    root = NODES.get(kind) or f"{kind}: {{child: {{wait: 0.15}}}}"
    mission, cell = loaded(tmp_path, root), WorldCell()
    tree = built(mission, cell)
    for _ in range(12):
        tree.root.tick_once()
        fresh = built(mission, WorldCell())
        for old, new in zip(tree.nodes, fresh.nodes, strict=True):
            recall(new.behaviour, memory_of(old.behaviour))
            assert state_of(new.behaviour) == state_of(old.behaviour), old.path
        cell.clock.sleep_until(cell.clock.now_s() + 0.1)


def test_the_memory_of_another_kind_of_node_is_refused(tmp_path):
    retry = built(loaded(tmp_path, NODES["retry"]), WorldCell()).root
    timeout = built(loaded(tmp_path, NODES["timeout"]), WorldCell()).root
    with pytest.raises(KeyError):
        recall(retry, memory_of(timeout))
