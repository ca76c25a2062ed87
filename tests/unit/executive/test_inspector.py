"""What `inspect` prints is what the recording holds."""

import io
import itertools

import pytest
from py_trees.common import Status
from py_trees.composites import Sequence
from rich.console import Console
from toy_runs import Leaf, busy_tree, record

from executive.core.errors import InputError
from executive.core.outcome import failure
from executive.engine.blackboard import Blackboard
from executive.engine.ticks import NodeStatus
from executive.inspector.brief import MAX_LENGTH, brief
from executive.inspector.changes import matching_nodes, status_changes
from executive.inspector.documents import tick_document
from executive.inspector.views import summary_view, tick_view

RUNNING, SUCCESS = Status.RUNNING, Status.SUCCESS


def text_of(*views):
    console = Console(file=io.StringIO(), width=120, no_color=True)
    console.print(*views)
    return console.file.getvalue()


def everything(recording):
    return frozenset(range(len(recording.header.nodes)))


@pytest.fixture
def failed(tmp_path):
    """A mission of three ticks that misses a grasp."""
    blackboard = Blackboard()

    def look():
        blackboard.write("mission:goal", {"x": 0.25}, "mission/look")
        return SUCCESS

    pull = Leaf("pull", RUNNING, failure("grasp.missed", "nothing held"))
    root = Sequence("mission", memory=True, children=[Leaf("look", RUNNING, look), pull])
    return record(tmp_path / "failed.mcap", root, blackboard)[0]


def test_the_summary_says_what_was_run_and_why_it_failed(failed):
    text = text_of(summary_view(failed))
    assert "toy" in text
    assert "failure" in text
    assert "mission/pull: grasp.missed: nothing held" in text


def test_a_killed_run_is_said_to_have_no_result(tmp_path):
    recording, _ = record(tmp_path / "a.mcap", Leaf("work", SUCCESS), result=False)
    assert "no result" in text_of(summary_view(recording))


def test_the_tree_at_a_tick_shows_statuses_reasons_and_the_blackboard(failed):
    first, last = (text_of(tick_view(failed, k, everything(failed))) for k in (0, 2))
    assert "├─ ▶ look" in first
    assert "└─ · pull" in first
    assert "goal" not in first
    assert "✗ mission" in last
    assert "├─ ✓ look" in last
    assert "✗ pull" in last
    assert "grasp.missed: nothing held" in last
    assert ["1", "mission:goal", "look", "{x:", "0.25}"] in [
        line.split() for line in last.splitlines()
    ]


def test_an_exception_is_shown_with_its_traceback(tmp_path):
    def broken():
        raise ValueError("broken wire")

    recording, _ = record(tmp_path / "a.mcap", Leaf("work", broken))
    text = text_of(tick_view(recording, 0, everything(recording)))
    assert "! work: ValueError: broken wire" in text
    assert "Traceback" in text


def test_changes_of_matching_nodes_carry_reasons_and_halts(tmp_path):
    recording, _ = record(tmp_path / "a.mcap", busy_tree())
    nodes = matching_nodes(recording.header.nodes, "mission/wait/*")
    changes = list(status_changes(recording, nodes))
    assert {change.path for change in changes} == {"mission/wait/guard", "mission/wait/hold"}
    reasons = {change.reason for change in changes if change.new is NodeStatus.FAILURE}
    assert "guard.open: door 1" in reasons
    halts = {change.reason for change in changes if change.new is NodeStatus.INVALID}
    assert "halted by mission/wait" in halts
    for before, after in itertools.pairwise(changes):
        assert before.tick <= after.tick


def test_every_change_begins_where_the_last_one_of_its_node_ended(tmp_path):
    recording, _ = record(tmp_path / "a.mcap", busy_tree())
    statuses = {}
    for change in status_changes(recording, everything(recording)):
        assert change.old is statuses.get(change.path, NodeStatus.INVALID)
        assert change.new is not change.old
        statuses[change.path] = change.new


def test_a_pattern_that_matches_nothing_names_the_closest_node(failed):
    with pytest.raises(InputError, match="did you mean 'pull'"):
        matching_nodes(failed.header.nodes, "pul")


def test_the_json_of_a_tick_says_the_same(failed):
    document = tick_document(failed, 2, everything(failed))
    assert document["outcome"] == "failure"
    assert [node["status"] for node in document["nodes"]] == ["FAILURE", "SUCCESS", "FAILURE"]
    assert document["nodes"][2]["reason"] == "grasp.missed: nothing held"
    assert document["blackboard"]["mission:goal"]["value"] == {"x": 0.25}


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, "null"),
        (0.123456, "0.1235"),
        ("two words", '"two words"'),
        ([1, 2, 3, 4, 5], "[1, 2, 3, 4, … 5 in all]"),
        ({"$type": "tuple", "items": [1, 2]}, "(1, 2)"),
        ({"$type": "a.b.End", "name": "LOST", "value": "lost"}, "End.LOST"),
        ({"$type": "a.b.Claim", "untangled": True}, "Claim(untangled=true)"),
        ({"$type": "image", "image": 3, "shape": [773, 1032]}, "<image 3 773x1032>"),
        ({"$type": "ndarray", "dtype": "float32", "shape": [9, 2], "hash": "x"}, "<float32 9x2>"),
        ({"$type": "ndarray", "dtype": "f", "shape": [2], "values": [0.5, 1]}, "[0.5, 1]"),
        ({"$type": "object", "repr": "<x>"}, "<x>"),
    ],
)
def test_values_fit_on_one_line(value, text):
    assert brief(value) == text


def test_long_values_are_cut():
    assert len(brief({"key": "x" * 500})) == MAX_LENGTH
