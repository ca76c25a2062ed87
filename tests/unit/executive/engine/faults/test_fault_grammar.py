"""Faults as text: what each form means, and what is said of a form that means nothing."""

import math

import pytest

from executive.core.errors import InputError
from executive.engine.faults.grammar import Kind, parse_injection, parse_injection_file


@pytest.mark.parametrize(
    ("text", "target", "kind", "numbers"),
    [
        ("grasp_*: fail@3", "grasp_*", Kind.FAIL, [3]),
        ("grasp:fail", "grasp", Kind.FAIL, [1, 2, 3, 4]),
        ("a/b: hang@2+", "a/b", Kind.HANG, [2, 3, 4]),
        ("  look: raise @1 ", "look", Kind.RAISE, [1]),
        ("key frame: stale@2", "frame", Kind.STALE, [2]),
        ("key m/look:frame: drop@1", "m/look:frame", Kind.DROP, [1]),
    ],
)
def test_what_is_meant(text, target, kind, numbers):
    injection = parse_injection(text)
    assert (injection.target, injection.kind, injection.text) == (target, kind, text.strip())
    assert [number for number in range(1, 5) if injection.is_for(number)] == numbers


def test_arguments():
    assert parse_injection("look: delay 2.5@2").seconds == 2.5
    assert parse_injection("look: fail 0.25@2+").probability == 0.25
    assert parse_injection('key a: value "x@3: {}"@2').value == "x@3: {}"
    assert parse_injection('key a: value {"end": [1, null]}').value == {"end": [1, None]}
    nan = parse_injection("key a: value NaN").value
    assert isinstance(nan, float)
    assert math.isnan(nan)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "expected NODES: KIND"),
        ("grasp fail", "expected NODES: KIND"),
        ("grasp: fial", "did you mean 'fail'?"),
        ("grasp: stale", "try key NAME: KIND"),
        ("key frame: hang", "try NODES: KIND"),
        ("key frame: stael", "did you mean 'stale'?"),
        ("grasp: fail@", "expected KIND, KIND@3 or KIND@3+"),
        ("grasp: fail@x", "expected KIND, KIND@3 or KIND@3+"),
        ("grasp: fail@0", "the first is @1"),
        ("grasp: fail 1.5", "expected a probability"),
        ("grasp: fail often", "expected a probability"),
        ("grasp: delay", "delay: got nothing; expected seconds above 0"),
        ("grasp: delay -1", "expected seconds above 0"),
        ("grasp: delay inf", "expected seconds above 0"),
        ("key frame: stale@1", "try stale@2"),
        ("key end: value", "expected JSON or nan"),
        ("key end: value edge", "texts need quotes"),
    ],
)
def test_what_means_nothing(text, said):
    with pytest.raises(InputError) as error:
        parse_injection(text)
    assert said in str(error.value)
    assert repr(text) in str(error.value)


def test_files_have_comments_and_lines():
    text = "# first\n\ngrasp: fail@2  # twice\nkey end: drop\n"
    assert [one.text for one in parse_injection_file(text)] == ["grasp: fail@2", "key end: drop"]
    with pytest.raises(InputError, match="line 3: fault 'grasp: fial'"):
        parse_injection_file("\n\ngrasp: fial")
