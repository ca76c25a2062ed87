"""py_trees 2.6 leaves with ports run unchanged in trees of ours."""

from typing import Any, ClassVar

import pytest
from py_trees.behaviour import Behaviour
from py_trees.blackboard import Blackboard
from py_trees.common import Status
from py_trees.ports import NoDataAvailable, PortInformation, PortsMixin
from toy_language import Colour, Journal, toy_skills, toy_types

from executive.core.errors import DocumentError
from executive.core.skill import input_ports
from executive.engine.loading.loader import load_program
from executive.engine.nodes.builder import build
from executive.engine.nodes.foreign import skill_from_behaviour


class Scale(PortsMixin, Behaviour):
    """Multiply, one tick late."""

    INPUT_PORTS: ClassVar = {
        "value": PortInformation(float, description="what to multiply"),
        "factor": PortInformation(float, default_value=2.0),
        "note": PortInformation(str, required=False),
    }
    OUTPUT_PORTS: ClassVar = {"product": PortInformation(float)}

    def __init__(self, name: str, journal: Journal):
        super().__init__(name)
        self.journal = journal

    def initialise(self):
        self.ticks = 0
        self.journal.note("initialise")

    def update(self):
        self.ticks += 1
        if self.ticks == 1:
            return Status.RUNNING
        if self.get_input("value") < 0:
            self.feedback_message = "negative"
            return Status.FAILURE
        self._set_output("product", self.get_input("value") * self.get_input("factor"))
        return Status.SUCCESS

    def terminate(self, new_status):
        self.journal.note(f"terminate {new_status.value}")


@pytest.fixture(autouse=True)
def no_leftovers():
    """Empty the blackboard of the process."""
    yield
    Blackboard.clear()


def load(bench, root, **leaves):
    skills = toy_skills()
    for name, leaf in {"scale": Scale, **leaves}.items():
        skills.add(name, skill_from_behaviour(leaf))
    return load_program(bench.write_root(root), skills=skills, types=toy_types())


def run(bench, root, ticks):
    program = load(bench, root)
    bench.tree = build(program, devices={"journal": bench.journal}, clock=bench.clock)
    return bench.tick(ticks)


def test_ports_are_read_from_the_declaration():
    ports = input_ports(skill_from_behaviour(Scale))
    assert {name: (port.type, port.required) for name, port in ports.items()} == {
        "value": (float, True),
        "factor": (float, False),
        "note": (str | None, False),
    }


def test_values_cross_from_and_to_the_blackboard_of_the_tree(bench):
    root = """
    sequence:
      - {skill: scale, name: a, in: {value: 3}, out: {product: $p}}
      - {skill: scale, name: b, in: {value: $p, factor: 10}, out: {product: $q}}
    """
    assert run(bench, root, 3) == ["RUNNING", "RUNNING", "SUCCESS"]
    assert bench.tree.scope["q"] == 60.0


def test_failure_carries_the_message_of_the_leaf(bench):
    assert run(bench, "{skill: scale, in: {value: -1}}", 2) == ["RUNNING", "FAILURE"]
    assert str(bench.tree.root.outcome.reason) == "behaviour.failed: negative"


def test_a_halted_leaf_is_terminated_once(bench):
    run(bench, "{skill: scale, in: {value: 1}}", 1)
    bench.tree.root.stop(Status.INVALID)
    bench.tree.root.stop(Status.INVALID)
    assert bench.journal.lines == ["initialise", "terminate INVALID"]


def test_wiring_is_checked_like_that_of_any_skill(bench):
    with pytest.raises(DocumentError) as found:
        load(bench, "{skill: scale, in: {value: x, factr: 2}}")
    messages = str(found.value)
    assert "input 'value': expected float, got 'x'" in messages
    assert "skill 'scale' has no input 'factr'; did you mean 'factor'?" in messages


class Typed(PortsMixin, Behaviour, register=False):
    """Note what comes in at ports of many types."""

    INPUT_PORTS: ClassVar = {
        "table": PortInformation(dict[str, list[int]], required=False),
        "colour": PortInformation(Colour, default_value=Colour.RED),
        "sizes": PortInformation(list[float], required=False),
        "limit": PortInformation(float | None),
        "count": PortInformation(int, default_value=1),
        "answer": PortInformation(Any, required=False),
    }
    OUTPUT_PORTS: ClassVar = {
        "seen": PortInformation(dict[str, Any]),
        "number": PortInformation(int | None, required=False),
    }

    def update(self):
        seen = {name: self.get_input(name) for name in ("colour", "limit", "count")}
        for name in ("table", "sizes"):
            try:
                seen[name] = self.get_input(name)
            except NoDataAvailable:
                seen[name] = "no data"
        self._set_output("seen", seen)
        self._set_output("number", self.get_input("answer", 0) or None)
        return Status.SUCCESS


def seen_by_typed(bench, inputs):
    root = f"{{skill: typed, in: {{{inputs}}}, out: {{seen: $s, number: $n}}}}"
    bench.tree = build(load(bench, root, typed=Typed), devices={}, clock=bench.clock)
    bench.tick()
    return bench.tree.scope["s"]


def test_ports_of_any_type_cross(bench):
    assert seen_by_typed(bench, "limit: null, table: {a: [1, 2]}, colour: green, sizes: [1]") == {
        "limit": None,
        "table": {"a": [1, 2]},
        "colour": Colour.GREEN,
        "sizes": [1.0],
        "count": 1,
    }


def test_inputs_that_are_not_wired_have_no_data(bench):
    seen = seen_by_typed(bench, "limit: 2")
    assert (seen["table"], seen["sizes"], seen["limit"]) == ("no data", "no data", 2.0)


@pytest.mark.parametrize(
    ("wired", "message"),
    [
        ("limit: 1, count: true", "input 'count': expected int, got True"),
        ("limit: 1, table: {a: 3}", "input 'table': expected dict[str, list[int]] | None"),
        ("limit: 1, colour: gren", "Colour has no value 'gren'; did you mean 'green'?"),
        ("limit: '1'", "input 'limit': expected float | None, got '1'"),
        ("count: 2", "skill 'typed' needs the input 'limit'"),
    ],
)
def test_types_of_foreign_ports_are_checked_before_the_first_tick(bench, wired, message):
    with pytest.raises(DocumentError) as found:
        load(bench, f"{{skill: typed, in: {{{wired}}}}}", typed=Typed)
    assert message in str(found.value)


def test_a_foreign_leaf_may_not_write_a_bool_where_it_declares_an_int(bench):
    with pytest.raises(TypeError, match=r"Typed: port 'number': expected int \| None, got True"):
        seen_by_typed(bench, "limit: 1, answer: true")


def test_a_node_without_ports_is_refused():
    with pytest.raises(TypeError, match="expected a py_trees leaf with ports"):
        skill_from_behaviour(Behaviour)
