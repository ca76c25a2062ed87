"""Units that are declared are held together across nodes, trees and expressions."""

import pytest

from executive.core.errors import InputError
from executive.engine.language.expression import parse_expression
from executive.engine.language.units import unit_of

UNITS = {"d": "m", "e": "m", "w": "mm", "t": "s", "parts": "kg"}


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("d", "m"),
        ("-d + 0.1", "m"),
        ("d - e", "m"),
        ("d * 1000", ""),
        ("d / t", ""),
        ("d + other", "m"),
        ("max(d, e, 0.5)", "m"),
        ("abs(w)", "mm"),
        ("round(d, 2)", "m"),
        ("d if t > 1 else e", "m"),
        ("parts[0]", "kg"),
        ("size(parts)", ""),
        ("d > 0.5 and t < 3", ""),
        ("other.d", ""),
        ("3", ""),
    ],
)
def test_units_of_expressions(text, unit):
    assert unit_of(parse_expression(text), UNITS) == unit


@pytest.mark.parametrize(
    "text", ["d + w", "d < w", "max(d, w)", "d if true else w", "0 < d < t", "not (d == w)"]
)
def test_two_units_do_not_go_together(text):
    with pytest.raises(InputError, match="do not go together; try a skill that converts"):
        unit_of(parse_expression(text), UNITS)


FIND = "{skill: find, out: {part: $p, distance: $d}}"
PORTS = "in: {width: {type: float, unit: mm}}"


@pytest.mark.parametrize(
    ("nodes", "fault"),
    [
        (f"{FIND}, {{skill: weigh, in: {{part: $p, factor: $d / 2}}}}", None),
        (
            f"{FIND}, {{skill: weigh, in: {{part: $p, factor: $width + 1}}}}",
            "input 'factor': expected the unit m, but $width + 1 is in mm",
        ),
        (
            f"{FIND}, {{set: {{k: width}}}}, {{skill: weigh, in: {{part: $p, factor: $k}}}}",
            "expected the unit m, but $k is in mm",
        ),
        (f"{FIND}, {{when: d > width}}", "when: 'd > width': d in m and width in mm do not go"),
        (
            f"{FIND}, {{skill: weigh, in: {{part: $p}}, out: {{mass: $d}}}}",
            "t/weigh: $d is in m, this in kg",
        ),
        (f"{FIND}, {{subtree: inner, in: {{length: $width}}}}", "expected the unit m, but $width"),
        (
            "{subtree: inner, in: {length: 1}, out: {half: $h}}, {wait: $h}",
            "wait: expected the unit s, but $h is in m",
        ),
        (
            "{for_each: {item: $w, in: '$[width, 2 * 3]', child: {wait: 1}}}, {timeout: "
            "{seconds: $width, child: {wait: 1}}}",
            "seconds: expected the unit s, but $width is in mm",
        ),
    ],
)
def test_units_are_checked_between_nodes_and_trees(bench, nodes, fault):
    bench.write_root(
        "{set: {half: length / 2 + length}}",
        "in: {length: {type: float, unit: m}}\nout: {half: {type: float, unit: m}}",
        name="inner",
    )
    found = bench.faults(f"sequence: [{nodes}]", PORTS)
    assert found == [] if fault is None else any(fault in one for one in found), found
