"""A cell over OPC UA, as the controller of a line sees it."""

import asyncio
import socket

import pytest
from conftest import toy_in
from test_cell_service import ended, serving, under_way

from executive.app.service.opcua import NAMESPACE, STATE_CODES, OpcUaServer
from executive.core.errors import InputError

asyncua = pytest.importorskip("asyncua")
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning")


@pytest.fixture(scope="module")
def toy(tmp_path_factory):
    with toy_in(tmp_path_factory.mktemp("toy")) as folder:
        yield folder


@pytest.fixture(scope="module")
def service(toy):
    with serving(toy) as found:
        yield found


@pytest.fixture(scope="module")
def server(service):  # to make its thousands of standard nodes takes seconds
    with OpcUaServer(service, "127.0.0.1", 0, token=None) as found:
        yield found


class Controller:
    """A client that reads variables and calls methods by name."""

    def __init__(self, client, space):
        self._client, self._space = client, space

    async def cell(self):
        return await self._client.nodes.objects.get_child(f"{self._space}:Cellwright")

    async def read(self, name):
        return await (await (await self.cell()).get_child(f"{self._space}:{name}")).read_value()

    async def call(self, name, *arguments):
        return await (await self.cell()).call_method(f"{self._space}:{name}", *arguments)

    async def until(self, name, wanted):
        for _ in range(600):
            if await self.read(name) == wanted:
                return
            await asyncio.sleep(0.1)
        raise AssertionError(f"{name} never became {wanted!r}: {await self.read(name)!r}")


def controlled(server, work):
    """Run a coroutine with a client."""

    async def run():
        async with asyncua.Client(server.address, timeout=30) as client:
            return await work(Controller(client, await client.get_namespace_index(NAMESPACE)))

    return asyncio.run(run())


def text(value):
    return asyncua.ua.Variant(value, asyncua.ua.VariantType.String)


def number(value):
    return asyncua.ua.Variant(value, asyncua.ua.VariantType.UInt32)


def start(controller, mission="toy", seed=0, settings="", key=""):
    return controller.call("StartMission", text(mission), number(seed), text(settings), text(key))


def test_a_controller_starts_a_mission_and_reads_what_it_came_to(server):
    async def work(controller):
        assert await controller.read("Cell") == "toy_cell"
        first, error = await start(controller, seed=5, settings='{"level": 0.25}')
        assert error == ""
        await controller.until("LastId", first)
        assert await controller.read("LastMission") == "toy"
        assert await controller.read("LastOutcome") == "success"
        assert await controller.read("LastSuccess") is True
        beat = await controller.read("Heartbeat")
        await asyncio.sleep(1.5)
        assert await controller.read("Heartbeat") > beat
        assert await start(controller, settings='{"way": "fail"}') == [first + 1, ""]
        await controller.until("LastId", first + 1)
        assert await controller.read("LastSuccess") is False
        assert "toy.told_to" in await controller.read("LastReason")

    controlled(server, work)


def test_a_controller_stops_and_goes_on(server, service):
    async def work(controller):
        found, _ = await start(controller, settings='{"way": "long"}')
        await controller.until("StateCode", STATE_CODES["running"])
        assert await controller.read("Mission") == "toy"
        assert await controller.call("Pause") == ""
        await controller.until("State", "paused")
        assert await controller.call("Resume") == ""
        assert await controller.call("Stop") == ""
        await controller.until("State", "held")
        assert "no mission is under way" in await controller.call("Pause")
        assert await controller.call("Resume") == ""
        await controller.until("State", "idle")
        return found

    assert service.mission(controlled(server, work)).report.outcome == "aborted"


def test_requests_that_mean_nothing_are_answered(server, service):
    before = len(service.missions())

    async def work(controller):
        for wrong in (
            {"mission": "tov"},
            {"mission": ""},
            {"mission": None},
            {"settings": "{"},
            {"settings": "[" * 2000},
            {"settings": "[1]"},
            {"settings": '{"wya": 1}'},
            {"settings": '{"../x": 1}'},
            {"key": "k" * 1000},
        ):
            found, error = await start(controller, **wrong)
            assert found == 0
            assert error
        for arguments in ([text("toy")], [number(1), text("x"), number(2), text("")]):
            found, error = await controller.call("StartMission", *arguments)
            assert (found, bool(error)) == (0, True)
        node = await (await controller.cell()).get_child("2:State")
        with pytest.raises(asyncua.ua.UaStatusCodeError):
            await node.write_value("broken")

    controlled(server, work)
    assert len(service.missions()) == before


def test_garbage_on_the_wire_and_clients_that_vanish_do_no_harm(server, service):
    host, port = server.address.removeprefix("opc.tcp://").split(":")
    hello = b"HELF" + (32).to_bytes(4, "little") + bytes(24)
    for data in (
        b"",
        b"\x00" * 500,
        b"GET / HTTP/1.1\r\n\r\n",
        hello,
        hello[:9],
        b"OPNF\xff\xff\xff\x7f" * 9,
    ):
        with socket.create_connection((host, int(port)), timeout=10) as raw:
            raw.sendall(data)

    async def vanish(controller):
        await start(controller, settings='{"way": "long"}')
        controller._client.disconnect = None

    with pytest.raises(TypeError):
        controlled(server, vanish)
    under_way(service)

    async def work(controller):
        await controller.until("State", "running")
        await controller.call("Stop")

    controlled(server, work)
    assert ended(service, service.missions()[-1].id).report.outcome == "aborted"
    service.go_on()


def test_off_this_machine_the_token_is_the_password_and_nothing_is_in_plain(service):
    from asyncua.crypto.security_policies import SecurityPolicyBasic256Sha256

    async def work(address, folder, password):
        client = asyncua.Client(address, timeout=30)
        client.set_user("cellwright")
        client.set_password(password)
        from asyncua.crypto.cert_gen import setup_self_signed_certificate
        from cryptography.x509.oid import ExtendedKeyUsageOID

        key, certificate = folder / "key.pem", folder / "certificate.der"
        uri = "urn:a:controller"
        client.application_uri = uri
        use = [ExtendedKeyUsageOID.CLIENT_AUTH]
        await setup_self_signed_certificate(key, certificate, uri, "localhost", use, {})
        await client.set_security(SecurityPolicyBasic256Sha256, str(certificate), str(key))
        async with client:
            space = await client.get_namespace_index(NAMESPACE)
            return await Controller(client, space).read("State")

    import tempfile
    from pathlib import Path

    with (
        OpcUaServer(service, "127.0.0.1", 0, token="k" * 20) as server,
        tempfile.TemporaryDirectory() as folder,
    ):
        assert asyncio.run(work(server.address, Path(folder), "k" * 20)) in STATE_CODES
        with pytest.raises(asyncua.ua.UaError):
            asyncio.run(work(server.address, Path(folder), "wrong"))
        with pytest.raises((asyncua.ua.UaError, ValueError)):
            controlled(server, lambda controller: controller.read("State"))


def test_a_port_that_is_taken_is_told(server, service):
    port = int(server.address.rpartition(":")[2])
    with pytest.raises(InputError, match=f"--opcua {port}: cannot listen"):
        OpcUaServer(service, "127.0.0.1", port, token=None).__enter__()
