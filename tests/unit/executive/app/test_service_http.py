"""A cell over HTTP: what clients can do, and what they cannot break."""

import json
import string

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect
from test_cell_service import ended, serving, under_way, until

from executive.app.service.guard import LONGEST_BODY
from executive.app.service.http import MOST_LISTENERS, application

HERE = "http://127.0.0.1"
LOCAL = {"host": "127.0.0.1"}
LONG = {"mission": "toy", "settings": {"way": "long"}}


@pytest.fixture
def service(toy):
    with serving(toy) as found:
        yield found


@pytest.fixture
def client(service):
    return TestClient(application(service), base_url=HERE, raise_server_exceptions=True)


def test_a_mission_is_asked_for_followed_stopped_and_gone_on_from(client, service):
    asked = client.post("/missions", json=LONG)
    assert (asked.status_code, asked.json()["id"]) == (202, 1)
    client.post("/missions", json={"mission": "toy"})
    under_way(service)
    with client.websocket_connect("/ticks/live", headers=LOCAL) as socket:
        first, second = (json.loads(socket.receive_text()) for _ in range(2))
    assert (first["tick"], second["tick"], first["mission"]) == (0, 1, 1)
    assert client.get("/ticks?after=0&most=1").json() == [second]
    assert client.post("/cell/pause").json()["state"] == "paused"
    assert client.post("/cell/resume").json()["state"] == "running"
    assert client.post("/cell/stop").json()["state"] == "stopping"
    until(lambda: client.get("/cell").json()["state"] == "held", "it stops")
    assert client.get("/missions/1").json()["report"]["outcome"] == "aborted"
    client.post("/cell/resume")
    assert ended(service, 2).report.outcome == "success"
    assert [one["id"] for one in client.get("/missions").json()] == [1, 2]


@pytest.mark.parametrize("body", [b"\xe0\xb1\x91\xff;", b"{", b"", b"[" * 5000, b"\x00"])
def test_a_body_that_is_no_json_is_refused_in_the_same_form(client, body):
    answer = client.post("/missions", content=body, headers={"content-type": "application/json"})
    assert answer.status_code in (400, 422)
    assert answer.json()["error"]
    assert client.put("/missions").json()["error"].startswith("Method Not Allowed: PUT /missions;")


def test_refusals_say_why(client):
    assert client.get("/missions/7").status_code == 404
    paused = client.post("/cell/pause")
    assert (paused.status_code, "no mission is under way" in paused.json()["error"]) == (409, True)
    unknown = client.post("/missions", json={"mission": "tov"})
    assert (unknown.status_code, "unknown mission 'tov'" in unknown.text) == (400, True)
    odd = client.post("/missions", json={"mission": "../toy.yaml", "sead": 1})
    assert (odd.status_code, "sead" in odd.json()["error"]) == (422, True)
    bare = client.post("/missions", content=b'{"mission": "toy"}')
    assert (bare.status_code, "try the header content-type" in bare.json()["error"]) == (422, True)
    assert "GET /openapi.json tells" in client.get("/nowhere").json()["error"]
    huge = client.post("/missions", content=b"x" * (LONGEST_BODY + 1))
    assert (huge.status_code, "too long" in huge.json()["error"]) == (413, True)


def test_pages_elsewhere_and_other_names_are_refused(service):
    client = TestClient(application(service), base_url=HERE)
    assert client.get("/cell", headers={"host": "evil.example"}).status_code == 403
    elsewhere = {"origin": "https://evil.example"}
    assert client.post("/missions", json=LONG, headers=elsewhere).status_code == 403
    with (
        pytest.raises(WebSocketDisconnect) as closed,
        client.websocket_connect("/ticks/live", headers={**LOCAL, **elsewhere}),
    ):
        pass
    assert closed.value.code == 4403
    assert service.missions() == []


def test_off_this_machine_a_token_is_needed(service):
    client = TestClient(application(service, token="k" * 20), base_url="http://cell.example")
    assert client.get("/cell").status_code == 401
    assert client.get("/cell", headers={"authorization": "Bearer no"}).status_code == 401
    assert client.get(f"/cell?token={'k' * 20}").status_code == 401  # addresses end up in logs
    assert client.get("/openapi.json").status_code == 401
    right = {"authorization": f"Bearer {'k' * 20}"}
    assert client.get("/cell", headers=right).status_code == 200
    with client.websocket_connect("/ticks/live", headers={"host": "cell.example", **right}):
        pass


def test_listeners_that_vanish_leave_room_for_others(client, service):
    for _ in range(MOST_LISTENERS + 5):
        with client.websocket_connect("/ticks/live", headers=LOCAL):
            pass
    assert client.get("/cell").status_code == 200


def test_the_openapi_names_every_way(client):
    document = client.get("/openapi.json").json()
    ways = {(path, verb) for path, verbs in document["paths"].items() for verb in verbs}
    assert len(ways) == 11
    assert all(
        "description" in one for verbs in document["paths"].values() for one in verbs.values()
    )


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=20),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3)
    ),
    max_leaves=6,
)
requests = st.fixed_dictionaries(
    {
        "mission": st.sampled_from(["toy", "tov", "toy_cell"])
        | st.text(string.printable, max_size=8)
    },
    optional={
        "seed": st.integers() | anything,
        "settings": st.dictionaries(st.sampled_from(["way", "level", "x.y", "."]), anything),
        "timeout_s": st.floats() | anything,
        "key": st.text(max_size=5),
        "other": anything,
    },
)


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(body=requests | anything)
def test_no_body_breaks_it(client, service, body):
    service.stop()  # nothing is to run: the form alone is tried
    try:
        text = json.dumps(body)
    except ValueError:
        text = "{"
    answer = client.post("/missions", content=text, headers={"content-type": "application/json"})
    assert answer.status_code in (202, 400, 409, 422)
    assert answer.status_code == 202 or answer.json()["error"]
    if answer.status_code == 202 and answer.json()["state"] != "withdrawn":  # the key came before
        assert client.delete(f"/missions/{answer.json()['id']}").json()["state"] == "withdrawn"


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    verb=st.sampled_from(["GET", "POST", "DELETE", "PUT", "OPTIONS"]),
    path=st.text(string.ascii_lowercase + "/%-.?=&0123456789", max_size=20),
    body=st.binary(max_size=50),
)
def test_no_address_breaks_it(client, verb, path, body):
    answer = client.request(verb, f"/{path.lstrip('/')}", content=body)
    assert answer.status_code < 500


def test_it_keeps_no_connection_to_a_name_that_is_none(client):
    for host in ("[", "", "127.0.0.1:x", "\x7f"):
        assert client.get("/cell", headers={"host": host}).status_code in (200, 400, 403)
