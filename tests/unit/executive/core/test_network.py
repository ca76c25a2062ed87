"""Names of machines in the headers of requests."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from executive.core.network import host_of_origin, hostname_of, is_loopback


@pytest.mark.parametrize(
    ("host", "name"),
    [
        ("localhost:8710", "localhost"),
        ("127.0.0.1", "127.0.0.1"),
        ("[::1]:80", "::1"),
        ("cell.example:8710", "cell.example"),
        ("[::1", ""),
        ("", ""),
    ],
)
def test_a_host_is_told_without_its_port(host: str, name: str) -> None:
    assert hostname_of(host) == name


def test_an_origin_is_compared_with_its_port() -> None:
    assert host_of_origin("http://127.0.0.1:8710") == "127.0.0.1:8710"
    assert host_of_origin("http://[") == ""
    assert host_of_origin("null") == ""


@given(st.text(max_size=20))
def test_no_header_is_too_odd_to_be_read(text: str) -> None:
    is_loopback(hostname_of(text))
    host_of_origin(text)
