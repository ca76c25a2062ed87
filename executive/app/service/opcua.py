"""A cell over OPC UA, for the controller of a line: variables to read, methods to call.

    Objects/Cellwright
        Cell, State, StateCode, Mission, MissionId, Ticks, TimeS, Queued, WhyHeld
        LastId, LastMission, LastOutcome, LastReason, LastSuccess
        Heartbeat                                    counts up twice a second
        StartMission(Mission, Seed, Settings, Key) -> (Id, Error)
        Stop() -> Error, EmergencyStop() -> Error, Pause() -> Error, Resume() -> Error

asyncua is under the LGPL: it is used as it is, from its own package.
"""

import asyncio
import json
import tempfile
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from pydantic import ValidationError

from executive.app.service.cell_service import CellService
from executive.app.service.messages import CellState, MissionRequest, MissionView
from executive.core.errors import CellwrightError, InputError
from executive.core.json_files import first_fault

NAMESPACE = "https://cellwright.org/cell"
USER = "cellwright"
PERIOD_S = 0.5
STATE_CODES = {"idle": 0, "starting": 1, "running": 2, "paused": 3, "stopping": 4, "held": 5}
_LONGEST_SETTINGS = 64 * 1024


class OpcUaServer:
    """Serves a cell in a thread of its own while the block lasts.

    Attributes:
        address: What clients connect to.
    """

    def __init__(self, service: CellService, host: str, port: int, *, token: str | None) -> None:
        """Prepare; nothing is served yet.

        Args:
            service: The cell.
            host: Address to listen on.
            port: Port; 0 takes a free one.
            token: Password of the user `cellwright`, over an encrypted connection; None where
                only this machine can connect.
        """
        self._service, self._host, self._port, self._token = service, host, port, token
        self.address = ""
        self._started: Future[None] = Future()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._end: asyncio.Event | None = None
        self._thread = threading.Thread(target=self._run, name="opcua", daemon=True)

    def __enter__(self) -> Self:
        """Begin.

        Raises:
            InputError: asyncua is not installed, or the port cannot be had.
        """
        self._thread.start()
        self._started.result()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End it."""
        if self._loop is not None and self._end is not None:
            with suppress(RuntimeError):  # it has ended by itself
                self._loop.call_soon_threadsafe(self._end.set)
        self._thread.join()

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except BaseException as error:  # the thread that waits for the start is to know
            if not self._started.done():
                self._started.set_exception(self._refusal(error))

    def _refusal(self, error: BaseException) -> BaseException:
        if isinstance(error, ImportError):
            return InputError(
                "--opcua: asyncua is not installed; try pip install 'cellwright[opcua]'"
            )
        if isinstance(error, OSError):
            return InputError(f"--opcua {self._port}: cannot listen on {self._host}; got {error}")
        return error

    async def _serve(self) -> None:
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        with tempfile.TemporaryDirectory() as folder:
            server = await self._prepared(Path(folder))
            cell = await _Nodes.made(server, self._service)
            async with server:
                port = server.bserver.port if self._port == 0 else self._port
                self.address = f"opc.tcp://{self._host}:{port}"
                self._started.set_result(None)
                while not self._end.is_set():
                    await cell.tell(self._service)
                    with suppress(TimeoutError):
                        await asyncio.wait_for(self._end.wait(), PERIOD_S)

    async def _prepared(self, folder: Path) -> Any:
        from asyncua import Server, ua

        server = Server(user_manager=None if self._token is None else _Password(self._token))
        await server.init()
        server.set_endpoint(f"opc.tcp://{self._host}:{self._port}")
        server.set_server_name("Cellwright")
        if self._token is None:
            server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
            return server
        await _encrypt(server, self._host, folder)
        return server


class _Password:
    """Lets in the user `cellwright` with the token; nobody else."""

    def __init__(self, token: str) -> None:
        self._token = token

    def get_user(
        self,
        iserver: object,
        username: str | None = None,
        password: str | None = None,
        certificate: object = None,
    ) -> Any:
        """Return a user, None for somebody unknown, as asyncua asks."""
        del iserver, certificate
        import hmac

        from asyncua.server.user_managers import User, UserRole

        known = hmac.compare_digest((password or "").encode(), self._token.encode())
        return User(role=UserRole.User, name=USER) if username == USER and known else None


async def _encrypt(server: Any, host: str, folder: Path) -> None:
    """Offer encrypted connections alone, with a certificate of this run."""
    from asyncua import ua
    from asyncua.crypto.cert_gen import setup_self_signed_certificate
    from cryptography.x509.oid import ExtendedKeyUsageOID

    key, certificate, uri = folder / "key.pem", folder / "certificate.der", "urn:cellwright:cell"
    await server.set_application_uri(uri)
    await setup_self_signed_certificate(
        key,
        certificate,
        uri,
        host,
        [ExtendedKeyUsageOID.SERVER_AUTH, ExtendedKeyUsageOID.CLIENT_AUTH],
        {"organizationName": "Cellwright"},
    )
    await server.load_certificate(str(certificate))
    await server.load_private_key(str(key))
    server.set_security_policy([ua.SecurityPolicyType.Basic256Sha256_SignAndEncrypt])
    server.set_identity_tokens([ua.UserNameIdentityToken])


class _Nodes:
    """The nodes of one cell."""

    def __init__(self, variables: dict[str, Any]) -> None:
        self._variables = variables
        self._beats = 0

    @classmethod
    async def made(cls, server: Any, service: CellService) -> "_Nodes":
        """Make them in a server."""
        from asyncua import ua

        space = await server.register_namespace(NAMESPACE)
        cell = await server.nodes.objects.add_object(space, "Cellwright")
        kinds = {**_of_state(service.state()), **_of_last(None), "Heartbeat": 0}
        variables = {}
        for name, value in kinds.items():
            kind = _variant_type(value)
            variables[name] = await cell.add_variable(space, name, value, kind)
        text, number = ua.VariantType.String, ua.VariantType.UInt32
        await cell.add_method(
            space, "StartMission", _starter(service), [text, number, text, text], [number, text]
        )
        for name, act in (
            ("Stop", service.stop),
            ("EmergencyStop", service.emergency_stop),
            ("Pause", service.pause),
            ("Resume", service.go_on),
        ):
            await cell.add_method(space, name, _caller(act), [], [text])
        return cls(variables)

    async def tell(self, service: CellService) -> None:
        """Write what the cell does now."""
        state = service.state()
        last = service.mission(state.last) if state.last is not None else None
        self._beats = (self._beats + 1) % 2**32
        values = {**_of_state(state), **_of_last(last), "Heartbeat": self._beats}
        if state.mission is not None:
            values["Mission"] = service.mission(state.mission).request.mission
        for name, value in values.items():
            await self._variables[name].write_value(value, _variant_type(value))


def _of_state(state: CellState) -> dict[str, Any]:
    return {
        "Cell": state.cell,
        "State": state.state,
        "StateCode": STATE_CODES[state.state],
        "Mission": "",
        "MissionId": state.mission or 0,
        "Ticks": state.ticks,
        "TimeS": state.time_s,
        "Queued": state.queued,
        "WhyHeld": state.why_held,
    }


def _of_last(last: MissionView | None) -> dict[str, Any]:
    report = last.report if last else None
    return {
        "LastId": last.id if last else 0,
        "LastMission": last.request.mission if last else "",
        "LastOutcome": report.outcome if report else (last.state if last else ""),
        "LastReason": report.reason if report else (last.reason if last else ""),
        "LastSuccess": report is not None and report.outcome == "success",
    }


def _variant_type(value: object) -> Any:
    from asyncua import ua

    if isinstance(value, bool):
        return ua.VariantType.Boolean
    if isinstance(value, int):
        return ua.VariantType.UInt32
    return ua.VariantType.Double if isinstance(value, float) else ua.VariantType.String


def _starter(service: CellService) -> Callable[..., Any]:
    async def start(_: object, *given: Any) -> list[Any]:
        from asyncua import ua

        number, error = 0, ""
        try:
            request = _request(*_values(given, ("Mission", "Seed", "Settings", "Key")))
            number = (await asyncio.to_thread(service.submit, request)).id
        except CellwrightError as refused:
            error = str(refused)
        return [
            ua.Variant(number, ua.VariantType.UInt32),
            ua.Variant(error, ua.VariantType.String),
        ]

    return start


def _values(given: Sequence[Any], names: Sequence[str]) -> list[Any]:
    """Return the values of arguments, which asyncua passes on as they come.

    Raises:
        InputError: There are more or fewer than there should be.
    """
    if len(given) != len(names):
        raise InputError(f"got {len(given)} arguments; expected {len(names)}: {', '.join(names)}")
    return [one.Value for one in given]


def _request(mission: Any, seed: Any, settings: Any, key: Any) -> MissionRequest:
    """Return what a controller asks for.

    Raises:
        InputError: It is none; says what is wrong.
    """
    if not isinstance(settings, str | None):
        raise InputError(f"Settings: got {type(settings).__name__}; expected text")
    if len(settings or "") > _LONGEST_SETTINGS:
        raise InputError(f"Settings: is too long; expected at most {_LONGEST_SETTINGS} characters")
    try:
        values = json.loads(settings) if settings else {}
    except (ValueError, RecursionError) as error:
        raise InputError(f'Settings: expected JSON such as {{"level": 0.5}}; got {error}') from None
    try:
        return MissionRequest(mission=mission, seed=seed, settings=values, key=key or "")
    except ValidationError as error:
        raise InputError(f"StartMission: {first_fault(error)}") from None


def _caller(act: Callable[[], CellState]) -> Callable[..., Any]:
    async def call(_: object, *_given: Any) -> list[Any]:
        from asyncua import ua

        error = ""
        try:
            await asyncio.to_thread(act)
        except CellwrightError as refused:
            error = str(refused)
        return [ua.Variant(error, ua.VariantType.String)]

    return call
