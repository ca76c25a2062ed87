"""Every rule of `cellwright lint`: what it finds, and what it leaves alone."""

from collections import defaultdict
from typing import ClassVar

import pytest
from toy_language import toy_skills, toy_types

from executive.core.outcome import failure, success
from executive.core.skill import Port, Skill
from executive.engine.language.block_models import BLOCKS, KINDS
from executive.engine.lint.certain import COMBINED
from executive.engine.lint.linter import lint_files
from executive.engine.lint.outcomes import TRAITS
from executive.engine.lint.rules import RULES, WAIVER_CODE

WORK = "{skill: work, in: {label: a}}"
FIND = "{skill: find, out: {part: $p}}"
CELL = "format: 1\ncell: c\nworld: toy\n"


class Shove(Skill):
    """Move something, and say nothing of how it stops."""

    ACTS = True
    REASONS: ClassVar = frozenset({"shove.failed"})

    def run(self):
        return failure("shove.failed")
        yield


class Glue(Skill):
    """What cannot be done twice."""

    REPEATABLE = False
    REASONS: ClassVar = frozenset({"glue.failed"})
    OUT: ClassVar = {"strength": Port(float)}

    def run(self):
        return success(strength=1.0)
        yield


def skills():
    """Return the toy skills and those for these tests."""
    registry = toy_skills()
    registry.add("shove", Shove)
    registry.add("glue", Glue)
    return registry


def seq(*nodes, kind="sequence", more=""):
    """Return a block of nodes."""
    return f"{{{kind}: {{{more}children: [{', '.join(nodes)}]}}}}"


def around(kind, child, more=""):
    """Return a node with one child."""
    return f"{{{kind}: {{{more}child: {child}}}}}"


BOTH = seq(WORK, FIND, "{when: p.mass_kg > 1}")
DEEP = WORK
for _ in range(5):
    DEEP = seq(around("inverter", DEEP), WORK)
OUT = "out: {p: {type: Part}}"
BOOLS = "in: {a: {type: bool}, b: {type: bool}}"
MISSION = "mission"

BAD = [
    ("L101", seq(FIND, WORK, WORK, kind="selector"), ""),
    ("L101", seq(WORK, around("force_failure", WORK), WORK), ""),
    ("L101", seq("{fail: a.b}", WORK), ""),
    ("L101", seq("{wait: 1}", WORK, WORK, kind="if_then_else"), ""),
    ("L101", seq(WORK, around("inverter", "{wait: 2}"), WORK), ""),
    ("L102", seq("{when: 1 < 2}", WORK), ""),
    ("L102", "{skill: work, in: {label: a}, if: 'true'}", ""),
    ("L102", "{skill: work, in: {label: a}, unless: 2 > 3}", ""),
    ("L102", "{skill: work, in: {label: a}, while: 'not false'}", ""),
    (
        "L103",
        seq(
            FIND,
            seq(FIND, seq("{when: p.mass_kg > 1}", WORK), kind="parallel"),
        ),
        "",
    ),
    (
        "L103",
        seq(
            FIND,
            seq(
                FIND,
                seq(around("inverter", "{when: p.mass_kg > 1}"), WORK),
                kind="reactive_sequence",
            ),
        ),
        "",
    ),
    ("L104", seq(WORK, WORK, kind="reactive_sequence"), ""),
    ("L104", seq(WORK, WORK, kind="reactive_selector"), ""),
    ("L104", seq(WORK, "{wait: 3}", kind="while_do_else"), ""),
    ("L104", seq("{subtree: acting}", "{wait: 3}", kind="reactive_sequence"), ""),
    ("L105", around("retry", "{skill: glue}", "times: 2, "), ""),
    ("L105", around("repeat", seq(WORK, "{skill: glue}"), "times: 2, "), ""),
    ("L106", seq(WORK), ""),
    ("L106", seq(WORK, kind="parallel", more="on_success: {a: 1}, "), ""),
    ("L107", around("retry", "{wait: 1}", "times: 2, "), ""),
    ("L107", around("retry", "{fail: a.b}", "times: 2, gives_up_on: [a.c], "), ""),
    ("L107", around("force_success", "{wait: 1}"), ""),
    ("L107", around("force_failure", around("force_success", WORK)), ""),
    ("L107", around("force_failure", "{fail: a.b}"), ""),
    ("L108", DEEP, ""),
    ("L109", seq("{when: a, on_halt: {x: 1}}", "{when: x > 0 and b}"), BOOLS),
    ("L110", around("timeout", "{when: a or b}", "seconds: 3, "), BOOLS),
    ("L110", around("timeout", around("timeout", WORK, "seconds: 3, "), "seconds: 3, "), ""),
    (
        "L110",
        around("timeout", around("retry", WORK, "times: 4, delay_s: 2, "), "seconds: 5, "),
        "",
    ),
    ("L111", around("timeout", WORK, "seconds: 60, "), MISSION),
    ("L111", "{subtree: slow}", MISSION),
    ("L112", around("cooldown", WORK, "seconds: 2, "), MISSION),
    (
        "L112",
        around("retry", around("cooldown", WORK, "seconds: 2, "), "times: 3, delay_s: 2, "),
        MISSION,
    ),
    ("L112", around("retry", around("cooldown", WORK, "seconds: 2, "), "times: 3, "), MISSION),
    ("L201", seq(seq(FIND, FIND, kind="parallel"), "{when: p.mass_kg > 1}"), ""),
    ("L202", seq(FIND, WORK), ""),
    ("L202", seq("{set: {x: 1}}", "{unset: x}", WORK), ""),
    ("L202", around("for_each", WORK, "item: $i, in: [1, 2], "), ""),
    ("L203", WORK, "in: {a: {type: bool}}"),
    ("L204", seq(WORK, FIND, kind="selector"), OUT),
    ("L204", around("force_success", seq(WORK, "{subtree: gives, out: {p: $p}}")), OUT),
    ("L204", "{skill: find, out: {part: $p}, unless: a and b}", f"{BOOLS}\n{OUT}"),
    ("L204", around("for_each", FIND, "item: $i, in: [1], "), OUT),
    ("L301", "{skill: shove}", ""),
    (
        "L401",
        seq(
            "{skill: work, name: x, in: {label: a}}",
            seq("{skill: work, name: x, in: {label: b}}", WORK),
        ),
        "",
    ),
    ("L401", seq("{skill: work, name: find, in: {label: a}}", WORK), ""),
]
GOOD = [
    ("L101", seq(WORK, FIND, kind="selector"), ""),
    ("L101", seq(WORK, around("force_success", WORK), WORK), ""),
    ("L101", seq("{when: a}", "{wait: 1}", "{wait: 2}", kind="if_then_else"), BOOLS),
    ("L102", seq("{when: a}", "{skill: work, in: {label: a}, while: written(b)}"), BOOLS),
    ("L103", seq(FIND, "{when: p.mass_kg > 1}", WORK), ""),
    ("L103", seq(FIND, seq(FIND, seq(WORK, "{when: p.mass_kg > 1}"), kind="parallel")), ""),
    (
        "L103",
        seq(FIND, seq(FIND, seq("{when: p.mass_kg > 1}", "{when: written(p)}"), kind="parallel")),
        "",
    ),
    ("L104", seq("{when: a and b}", WORK, kind="reactive_sequence"), BOOLS),
    ("L104", seq(WORK, "{when: a and b}", kind="reactive_sequence"), BOOLS),
    ("L104", seq(around("run_once", WORK), WORK, kind="reactive_sequence"), ""),
    ("L104", seq(WORK, WORK), ""),
    (
        "L104",
        seq("{skill: work, in: {label: a}, unless: a or b}", WORK, kind="reactive_selector"),
        BOOLS,
    ),
    ("L105", around("retry", around("run_once", "{skill: glue}"), "times: 2, "), ""),
    ("L105", around("retry", WORK, "times: 2, "), ""),
    ("L106", seq(WORK, WORK), ""),
    ("L107", around("retry", WORK, "times: 2, "), ""),
    ("L107", around("retry", seq(WORK, "{fail: a.b}"), "times: 2, gives_up_on: [a.b], "), ""),
    ("L107", around("force_failure", "{wait: 1}"), ""),
    ("L107", around("force_success", seq(WORK, FIND)), ""),
    ("L108", seq(around("inverter", seq(around("inverter", WORK), WORK)), WORK), ""),
    ("L109", "{skill: work, in: {label: a}, on_halt: {x: 1}}", ""),
    ("L110", around("timeout", around("timeout", WORK, "seconds: 2, "), "seconds: 3, "), ""),
    (
        "L110",
        around("timeout", around("retry", WORK, "times: 3, delay_s: 2, "), "seconds: 5, "),
        "",
    ),
    ("L110", around("timeout", WORK, "seconds: $2 * t, "), "in: {t: {type: float, default: 1.0}}"),
    ("L111", around("timeout", WORK, "seconds: 59, "), MISSION),
    (
        "L112",
        around("repeat", seq(around("cooldown", WORK, "seconds: 2, "), WORK), "times: 3, "),
        MISSION,
    ),
    ("L201", seq(seq(FIND, WORK, kind="parallel"), "{when: p.mass_kg > 1}"), ""),
    ("L202", seq(FIND, "{when: p.mass_kg > 1}"), ""),
    ("L202", FIND, OUT),
    ("L202", seq(FIND, around("inverter", "{subtree: takes, in: {p: $p}}")), ""),
    ("L203", "{when: a}", "in: {a: {type: bool}}"),
    ("L204", seq(FIND, seq(WORK, around("inverter", WORK), kind="selector")), OUT),
    ("L204", seq(seq(WORK, FIND), FIND, kind="selector"), OUT),
    ("L204", around("inverter", around("force_failure", FIND)), OUT),
    ("L204", "{subtree: gives, out: {p: $p}}", OUT),
    ("L204", around("timeout", around("retry", FIND, "times: 2, "), "seconds: 9, "), OUT),
    ("L301", WORK, ""),
    ("L401", seq("{skill: work, name: x, in: {label: a}}", WORK, WORK), ""),
]
SUBTREES = {
    "acting": f"format: 1\ntree: acting\nroot: {WORK}\n",
    "slow": f"format: 1\ntree: slow\nroot: {around('timeout', WORK, 'seconds: 61, ')}\n",
    "gives": f"format: 1\ntree: gives\nout: {{p: {{type: Part}}}}\nroot: {FIND}\n",
    "takes": "format: 1\ntree: takes\nin: {p: {type: Part}}\nroot: {when: p.mass_kg > 1}\n",
}


@pytest.fixture
def lint(tmp_path):
    """Return a way to look at one tree or mission."""

    def look(text):
        for name, subtree in SUBTREES.items():
            (tmp_path / f"{name}.yaml").write_text(subtree)
        (tmp_path / "c.yaml").write_text(CELL)
        (tmp_path / "t.yaml").write_text(text)
        report = lint_files([tmp_path / "t.yaml"], skills=skills(), types=toy_types())
        assert report.faults == ()
        return report

    return look


def written(root, ports):
    """Return a tree or a mission of one root node."""
    if ports == MISSION:
        return f"format: 1\nmission: t\ncell: c\ntimeout_s: 60.0\nroot: {root}\n"
    return f"format: 1\ntree: t\n{ports}\nroot: {root}\n"


@pytest.mark.parametrize(("code", "root", "ports"), BAD)
def test_what_is_surely_wrong_is_found(lint, code, root, ports):
    codes = [finding.code for finding in lint(written(root, ports)).findings]
    assert code in codes


@pytest.mark.parametrize(("code", "root", "ports"), GOOD)
def test_what_may_be_right_is_left_alone(lint, code, root, ports):
    codes = [finding.code for finding in lint(written(root, ports)).findings]
    assert code not in codes


def test_every_rule_has_a_bad_and_a_good_tree():
    seen = defaultdict(set)
    for kind, cases in (("bad", BAD), ("good", GOOD)):
        for code, _, _ in cases:
            seen[code].add(kind)
    assert dict(seen) == {rule.code: {"bad", "good"} for rule in RULES}


def test_codes_are_different_and_in_order():
    codes = [rule.code for rule in RULES]
    assert codes == sorted(set(codes))
    assert WAIVER_CODE not in codes


def test_the_table_of_properties_names_every_kind_of_node():
    assert set(TRAITS) == set(KINDS)
    assert set(COMBINED) == set(BLOCKS)


def test_findings_say_where_and_what_to_try(lint):
    (finding,) = lint(f"format: 1\ntree: t\nroot:\n  sequence:\n    - {WORK}\n").findings
    assert str(finding).endswith(
        "t.yaml:4:3: L106 block with one child: t: one child; try the child in its place"
    )


@pytest.mark.parametrize(
    "waived",
    [
        "root:\n  # lint: allow L106 because it will grow\n  sequence:\n    - {}\n",
        "root:\n  sequence:  # lint: allow L106 because it will grow\n    - {}\n",
        "root:\n  # lint: allow L301, L106 because it will grow\n  # x\n\n  sequence:\n    - {}\n",
    ],
)
def test_a_waiver_with_a_reason_lets_a_finding_stand(lint, waived):
    report = lint("format: 1\ntree: t\n" + waived.replace("{}", WORK))
    assert [(one.code, reason) for one, reason in report.waived] == [("L106", "it will grow")]
    assert [one.message for one in report.findings] == [
        "L301 (acting skill without stop) is not found here; drop it"
    ] * ("L301" in waived)


@pytest.mark.parametrize(
    ("comment", "message"),
    [
        ("# lint: allow L106", "expected `# lint: allow CODE because REASON`"),
        ("# lint: allow L106 because", "expected `# lint: allow CODE because REASON`"),
        ("# lint: off", "expected `# lint: allow CODE because REASON`"),
        ("# lint: allow L999 because of me", "no rule has the code 'L999'"),
        ("# lint: allow L104 because of me", "L104 (acting again in every tick) is not found"),
    ],
)
def test_a_waiver_without_reason_or_effect_is_found(lint, comment, message):
    report = lint(f"format: 1\ntree: t\nroot:\n  {comment}\n  sequence:\n    - {WORK}\n")
    assert [one.code for one in report.findings] == [WAIVER_CODE, "L106"]
    assert message in report.findings[0].message
    assert report.findings[0].line == 4


def test_a_waiver_counts_for_its_own_line_only(lint):
    inner = seq(WORK)
    text = (
        f"root:\n  sequence:\n    - {WORK}\n    # lint: allow L106 because of me\n    - {inner}\n"
    )
    report = lint(f"format: 1\ntree: t\n{text}")
    assert (len(report.waived), report.findings) == (1, ())


def test_words_in_a_text_are_no_waiver(lint):
    root = '{sequence: {about: "# lint: allow L106 because x", children: [' + WORK + "]}}"
    assert [one.code for one in lint(f"format: 1\ntree: t\nroot: {root}\n").findings] == ["L106"]


def test_a_waiver_of_what_only_missions_show_is_no_finding_without_one(lint, tmp_path):
    body = (
        f"  # lint: allow L111 because of tests\n  timeout:\n    seconds: 61\n    child: {WORK}\n"
    )
    slow = f"format: 1\ntree: slow\nroot:\n{body}"
    lint(slow.replace("tree: slow", "tree: t"))
    report = lint(slow.replace("tree: slow", "tree: t"))
    assert report.findings == ()
    (tmp_path / "slow.yaml").write_text(slow)
    (tmp_path / "m.yaml").write_text(
        "format: 1\nmission: m\ncell: c\ntimeout_s: 60.0\nroot: {subtree: slow}\n"
    )
    files = [tmp_path / "m.yaml", tmp_path / "slow.yaml"]
    both = lint_files(files, skills=skills(), types=toy_types())
    assert both.findings == ()
    assert [finding.code for finding, _ in both.waived] == ["L111"]


def test_who_can_halt_each_leaf(lint):
    text = """\
format: 1
tree: t
in: {a: {type: bool}}
root:
  timeout:
    seconds: 20
    child:
      reactive_sequence:
        - {when: a, name: safe}
        - parallel:
            children:
              - {subtree: acting, while: not a}
              - {wait: 3}
"""
    halts = {one.node: one.by for one in lint(text).halts()["t"]}
    block = "t/reactive_sequence"
    around_it = ("t: timeout after 20 s", f"{block}: safe, asked in every tick")
    assert halts == {
        f"{block}/parallel/acting": (
            *around_it,
            f"{block}/parallel: wait, which may decide it",
            f"{block}/parallel/acting: while not a",
        ),
        f"{block}/parallel/wait": (
            *around_it,
            f"{block}/parallel: acting, which may decide it",
        ),
    }
    mission = lint(f"format: 1\nmission: t\ncell: c\ntimeout_s: 60.0\nroot: {WORK}\n")
    assert [one.by for one in mission.halts()["t"]] == [("the mission after 60 s",)]


def test_a_skill_without_reasons_may_fail_where_a_mission_goes_on_after_errors(lint):
    root = f"root: {{selector: [{FIND}, {WORK}]}}\n"
    mission = "format: 1\nmission: t\ncell: c\ntimeout_s: 60.0\n"
    ends, goes_on = lint(mission + root), lint(f"{mission}on_error: fail\n{root}")
    assert "L101" in [one.code for one in ends.findings]
    assert "L101" not in [one.code for one in goes_on.findings]
