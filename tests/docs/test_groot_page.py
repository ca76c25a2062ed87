"""The page about Groot2 against the code: requests, options, limits."""

import inspect
import re
from pathlib import Path

from executive.cli.cmd_groot import groot
from executive.inspector.groot import boards
from executive.inspector.groot.answers import QUIET_S
from executive.inspector.groot.wire import Request

PAGE = (Path(__file__).parents[2] / "docs" / "groot.md").read_text(encoding="utf-8")


def test_every_request_is_told_with_its_byte():
    told = dict(re.findall(r"^\| `([A-Z_]+)` \| `(.)` \|", PAGE, re.MULTILINE))
    assert told == {request.name: chr(request) for request in Request}


def test_every_option_is_told():
    told = re.findall(r"^\| `--([a-z]+)", PAGE, re.MULTILINE)
    assert {*told} == {*inspect.signature(groot).parameters} - {"recording"}


def test_the_limits_are_those_of_the_code():
    assert f"silent for {QUIET_S:g} s" in PAGE
    assert f"more than {boards.MOST_ITEMS} items" in PAGE
    assert str(inspect.signature(groot).parameters["port"].default) in PAGE
