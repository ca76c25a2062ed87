"""Answers to why, why-not and why-halted, held against plain logic."""

from itertools import pairwise

import pytest
from toy_pasts import RandomTree, act, all_answers, past

from executive.engine.ticks import NodeStatus
from executive.inspector.answer_lines import answer_lines
from executive.inspector.deciding import chain, deciding_leaves
from executive.inspector.why import why, why_ended
from executive.inspector.why_not import why_halted, why_not


def lines_of(run, answer):
    return "\n".join(answer_lines(run, answer))


def about(run, name, tick=None, ask=why):
    return lines_of(run, ask(run, run.names.node(name, tick), tick))


@pytest.mark.parametrize("seed", range(25))
def test_deciding_leaves_are_just_those_that_fix_the_answer(tmp_path, seed):
    tree = RandomTree(seed)
    says = tree.random_answers()
    run = past(tmp_path, tree.root, tree.letters(says))
    last = run.index.last_tick
    assert (run.index.answer(0, last) is NodeStatus.SUCCESS) == tree.answer(says)
    deciding = {run.index.nodes[leaf].name for leaf, _ in deciding_leaves(run.index, 0, last)}
    # Whatever the others answer, the answer of the tree stays.
    worlds = [w for w in all_answers(tree.leaves) if all(w[n] == says[n] for n in deciding)]
    assert {tree.answer(world) for world in worlds} == {tree.answer(says)}
    # Without one of them it does not: each of them could have changed it.
    for free in deciding:
        fixed = deciding - {free}
        worlds = [w for w in all_answers(tree.leaves) if all(w[n] == says[n] for n in fixed)]
        assert len({tree.answer(world) for world in worlds}) == 2


@pytest.mark.parametrize("seed", range(6))
def test_leaves_that_decide_a_parallel_fix_its_answer(tmp_path, seed):
    tree = RandomTree(seed, kinds=("parallel", "selector", "inverter"))
    says = tree.random_answers()
    run = past(tmp_path, tree.root, tree.letters(says))
    leaves = deciding_leaves(run.index, 0, run.index.last_tick)
    deciding = {run.index.nodes[leaf].name for leaf, _ in leaves}
    worlds = [w for w in all_answers(tree.leaves) if all(w[n] == says[n] for n in deciding)]
    assert {tree.answer(world) for world in worlds} == {tree.answer(says)}


@pytest.mark.parametrize("seed", range(10))
def test_the_chain_goes_from_the_root_to_a_leaf_that_decides(tmp_path, seed):
    tree = RandomTree(seed)
    run = past(tmp_path, tree.root, tree.letters(tree.random_answers()))
    way = chain(run.index, 0, run.index.last_tick)
    for (above, _), (below, _) in pairwise(way):
        assert run.index.nodes[below].parent == above
    assert not run.index.children[way[-1][0]]
    assert way[-1] in deciding_leaves(run.index, 0, run.index.last_tick)


MISSION = f"""
retry:
  times: 3
  child:
    sequence:
      name: pick
      children:
        - {act("look", value="$2.5")[:-1]}, out: {{value: $seen}}}}
        - {{when: seen > 2 and seen < 3, name: near}}
        - selector:
            name: get
            children:
              - {{when: seen > 9, name: far}}
              - {act("grasp")}
        - {act("lift")}
"""


@pytest.fixture
def picked(tmp_path):
    """A mission that fails its grasp once, and succeeds in the second attempt."""
    letters = {"look": "RS", "grasp": "RRFRRS", "lift": "RRS"}
    return past(tmp_path, MISSION, letters)


def test_why_without_a_node_says_how_the_mission_ended(picked):
    text = lines_of(picked, why_ended(picked))
    assert text.startswith("t ended in success")
    assert "attempt 2 of 3; attempt 1: pick failed @3" in text
    assert "lift: succeeded  [t.yaml:18]" in text


def test_why_names_values_writers_attempts_and_memory(picked):
    text = about(picked, "grasp")
    assert text.startswith("grasp succeeded, at tick")
    assert "retry: attempt 2 of 3; attempt 1: pick failed @3 (grasp: act.failed" in text
    assert "earlier ones succeeded: look @4, near @4; not asked again (memory)" in text
    assert "far failed @4 (seen > 9 was false; seen is 2.5 (look wrote it at @4)" in text


def test_why_shows_every_part_of_a_condition(picked):
    assert "near succeeded: seen > 2 and seen < 3 was true; seen is 2.5 (look" in about(
        picked, "near"
    )


def test_why_at_a_tick_without_the_node_answers_why_not(picked):
    assert about(picked, "lift", 2).startswith("lift was not asked at tick 2")
    assert "get, before it, is still running" in about(picked, "lift", 2)
    assert "it ran last" not in about(picked, "lift", 2)


def test_why_not_names_who_ended_the_parent(picked):
    text = about(picked, "lift", 3, ask=why_not)
    assert "get, before it, failed, which is enough (grasp: act.failed: grasp was told to)" in text
    assert "first @" in text


def test_why_not_says_that_memory_keeps_a_node_from_being_asked(picked):
    text = about(picked, "look", 2, ask=why_not)
    assert (
        "look succeeded @1, and sequence does not ask it again (memory), get has its turn" in text
    )


def test_why_not_of_a_node_that_ran_says_so(picked):
    assert "it did run: grasp was running" in about(picked, "grasp", 2, ask=why_not)


def test_why_halted_names_the_sibling_that_took_over(tmp_path):
    root = f"""
    reactive_selector:
      children:
        - reactive_sequence:
            name: urgent
            children: [{act("door")}, {act("wait")}]
        - {act("work")}
    """
    run = past(tmp_path, root, {"door": "FFFS", "wait": "RS", "work": "R"})
    text = about(run, "work", ask=why_halted)
    assert text.startswith("work was halted by t at tick 3 (0.3 s): urgent, which comes before it")
    assert about(run, "work", 2, ask=why_halted).startswith("work was not halted at tick 2")
    assert "it never was" in about(run, "door", ask=why_halted)


def test_why_halted_names_the_guard_with_its_value(tmp_path):
    root = f"""
    parallel:
      succeed: [fill]
      children:
        - sequence:
            name: fill
            children:
              - {{set: {{level: 1}}}}
              - {act("pause")}
              - {{set: {{level: 5}}, name: full}}
              - {act("rest")}
        - {{skill: act, name: pour, in: {{name: pour}}, while: level < 3}}
    """
    run = past(tmp_path, root, {"pause": "RRS", "rest": "RS", "pour": "R"})
    text = about(run, "pour", ask=why_halted)
    assert "pour was halted by pour.guard at tick 2" in text
    assert "while level < 3 was false; level is 5 (full wrote it at @2)" in text


def test_why_halted_by_the_runner_gives_the_reason_of_the_end(tmp_path):
    run = past(
        tmp_path, act("work").replace("name: work, in", "in", 1), {"work": "R"}, timeout_s=0.5
    )
    answer = lines_of(run, why_halted(run, 0, None))
    assert "t was halted by the runner" in answer
    assert "mission timeout of 0.5 s passed in t" in answer


def test_a_timeout_decides_by_itself(tmp_path):
    root = f"{{timeout: {{seconds: 0.3, child: {act('work')}}}}}"
    run = past(tmp_path, root, {"work": "R"})
    assert "timeout: not done after 0.3 s" in lines_of(run, why_ended(run))
    assert "work was halted by t" in about(run, "work")


def test_for_each_shows_the_item(tmp_path):
    root = f"{{for_each: {{item: $part, in: [4, 5], child: {act('work')}}}}}"
    run = past(tmp_path, root, {"work": "S"})
    assert "for_each: item 2, part = 5" in about(run, "work")


def test_a_guard_that_answers_for_its_node_is_told_with_what_it_asked(tmp_path):
    run = past(
        tmp_path,
        """
        sequence:
          children:
            - {set: {width: 2}}
            - {skill: act, name: look, in: {name: look}, unless: width > 1}
            - {skill: act, name: lift, in: {name: lift}}
        """,
        {"look": "S", "lift": "RRS"},
    )
    told = about(run, "look", 2, why_not)
    assert "without look (unless width > 1 was true; width is 2 (set wrote it at @0))" in told


def test_a_repeat_that_failed_says_in_which_round(tmp_path):
    run = past(tmp_path, f"repeat: {{times: 5, child: {act('cut')}}}", {"cut": "SSF"})
    assert "repeat failed (round 3 of 5)" in lines_of(run, why_ended(run))
