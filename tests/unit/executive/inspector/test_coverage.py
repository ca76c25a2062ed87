"""Which branches runs took, held against plain logic."""

import pytest
from toy_pasts import RandomTree, act, all_answers, past

from executive.core.errors import InputError
from executive.inspector.cover import cover_run, merged
from executive.inspector.cover_html import cover_html
from executive.inspector.cover_text import cover_lines


def taken(cover):
    return {(node.path, branch) for node in cover.nodes for branch, n in node.taken.items() if n}


@pytest.mark.parametrize("seed", range(8))
def test_what_is_covered_together_is_the_union(tmp_path, seed):
    tree = RandomTree(seed)
    covers = [
        cover_run(past(tmp_path, tree.root, tree.letters(tree.random_answers()), name=f"r{n}"))
        for n in range(4)
    ]
    both = merged(covers)
    assert taken(both) == set.union(*map(taken, covers))
    assert both.total == covers[0].total
    assert both.percent >= max(cover.percent for cover in covers)
    assert sum(n.started for n in both.nodes) == sum(n.started for c in covers for n in c.nodes)
    assert taken(merged([both])) == taken(both)


def test_all_ways_to_answer_cover_all_branches(tmp_path):
    root = f"{{selector: [{{sequence: [{act('a')}, {act('b')}]}}, {act('c')}]}}"
    runs = (
        past(
            tmp_path, root, {name: "S" if yes else "F" for name, yes in says.items()}, name=f"r{n}"
        )
        for n, says in enumerate(all_answers("abc"))
    )
    cover = merged(cover_run(run) for run in runs)
    assert cover.percent == 100.0
    assert next(iter(cover_lines(cover))).startswith("100 % covered: 12 of 12 branches")
    assert "not covered:" not in list(cover_lines(cover))


def test_missing_branches_are_named_with_file_and_line(tmp_path):
    root = f"""
    selector:
      - sequence:
          name: try
          children: [{act("a")}, {act("b")}]
      - {act("c")}
    """
    cover = cover_run(past(tmp_path, root, {"a": "F", "b": "S", "c": "S"}))
    lines = list(cover_lines(cover))
    assert "  t.yaml:6  try: all succeeded; ended by failure of b" in lines
    assert "  t.yaml:8  b: never ran" in lines
    assert any(line.endswith("t: ended by success of try; all failed") for line in lines)


def test_retries_tell_the_attempts_that_they_used(tmp_path):
    root = f"{{retry: {{times: 3, child: {act('a')}}}}}"
    runs = [past(tmp_path, root, {"a": said}, name=said) for said in ("S", "FFS", "F")]
    cover = merged(map(cover_run, runs))
    retry = next(node for node in cover.nodes if node.kind == "retry")
    assert retry.attempts == {1: 1, 3: 2}
    assert retry.taken == {
        "first attempt succeeded": 1,
        "later attempt succeeded": 1,
        "gave up": 1,
    }


def condition(tmp_path, text, ports, inputs, name):
    root = f"{{selector: [{{when: {text}, name: asked}}, {{set: {{done: 1}}}}]}}"
    cover = cover_run(past(tmp_path, root, {}, ports, name=name, inputs=inputs))
    return next(node for node in cover.nodes if node.path == "t/asked")


def test_each_part_of_a_condition_must_have_decided(tmp_path):
    ports = "in: {a: {type: bool}, b: {type: bool}}"
    seen = {}
    for a in (True, False):
        for b in (True, False):
            node = condition(tmp_path, "a and b", ports, {"a": a, "b": b}, f"{a}{b}")
            seen[a, b] = {branch for branch, count in node.taken.items() if count}
    assert seen[True, True] == {"true", "a decided, true", "b decided, true"}
    assert seen[False, True] == {"false", "a decided, false"}
    assert seen[True, False] == {"false", "b decided, false"}
    assert seen[False, False] == {"false"}
    assert set.union(*seen.values()) == set(node.taken)


def test_a_part_that_was_not_asked_decides_nothing(tmp_path):
    root = f"""
    retry:
      times: 1
      child:
        selector:
          - {{when: written(late) and late > 2, name: asked}}
          - {act("a", value=3.0)[:-1]}, out: {{value: $late}}}}
    """
    cover = cover_run(past(tmp_path, root, {"a": "S"}))
    node = next(node for node in cover.nodes if node.kind == "when")
    # With `late` at hand it would still hang on its value: neither part decided alone.
    assert {branch for branch, count in node.taken.items() if count} == {"false"}


def test_guards_are_true_and_false(tmp_path):
    root = f"""
    sequence:
      - {{set: {{level: 1}}}}
      - parallel:
          succeed: [fill]
          children:
            - sequence:
                name: fill
                children: [{act("pause")}, {{set: {{level: 5}}}}, {act("rest")}]
            - {{skill: act, name: pour, in: {{name: pour}}, if: level > 0, while: level < 3}}
    """
    letters = {"pause": "RRS", "rest": "RS", "pour": "R"}
    cover = cover_run(past(tmp_path, root, letters))
    guard = next(node for node in cover.nodes if node.kind == "guard")
    assert {branch for branch, count in guard.taken.items() if count} == {
        *("if true", "while true", "while false"),
    }
    assert guard.missing == ("if false",)


def test_runs_of_other_trees_are_refused(tmp_path):
    one = cover_run(past(tmp_path, f"{{sequence: [{act('a')}]}}", {"a": "S"}))
    other = cover_run(past(tmp_path, f"{{selector: [{act('a')}]}}", {"a": "S"}, name="b"))
    with pytest.raises(InputError, match="a run of another tree"):
        merged([one, other])


def test_the_page_holds_every_line_of_the_yaml(tmp_path):
    root = f"{{selector: [{act('a')}, {{when: 1 < 2, name: always}}]}}"
    run = past(tmp_path, root, {"a": "S"})
    page = cover_html(cover_run(run))
    text = run.recording.header.sources[0].text
    assert page.count("<tr ") == len(text.splitlines())
    assert "1 &lt; 2" in page
    assert "prefers-color-scheme: dark" in page
    assert "http" not in page
