"""The server behind the page: every answer comes out of one recording."""

import asyncio
import contextlib
import json
import socket
from collections.abc import Callable
from pathlib import Path

import uvicorn
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from executive.core.errors import CellwrightError, InputError
from executive.engine.running.remote import NotRunningError, send
from executive.inspector.finding import Wish
from executive.inspector.web.access import AccessControl
from executive.inspector.web.session import Session

PAGE = Path(__file__).parent / "page"
POLL_S = 0.2
MOST_COLUMNS = 4000

WriteScene = Callable[[Path, Path], None]
"""Writes a replay of the cell, given the recording and the HTML file."""


def application(
    session: Session, *, token: str | None = None, write_scene: WriteScene | None = None
) -> Starlette:
    """Return the application that serves the page of one recording.

    Args:
        session: The recording.
        token: What a client must know; None where only this machine can connect.
        write_scene: How the 3-D scene is made; None where there is none.
    """
    answers = _Answers(session, write_scene)
    routes = [
        Route("/", _page),
        Route("/api/run", answers.run),
        Route("/api/lanes", answers.lanes),
        Route("/api/tick/{number:int}", answers.tick),
        Route("/api/ask", answers.ask),
        Route("/api/who", answers.who),
        Route("/api/history", answers.history),
        Route("/api/report", answers.report),
        Route("/api/find", answers.find),
        Route("/api/image/{number:int}.png", answers.image),
        Route("/api/command", answers.command, methods=["POST"]),
        Route("/scene", answers.scene),
        WebSocketRoute("/api/live", answers.live),
        Mount("/page", StaticFiles(directory=PAGE)),
    ]
    return Starlette(
        routes=routes,
        middleware=[Middleware(AccessControl, token=token)],
        exception_handlers={CellwrightError: _refused, HTTPException: _refused},
    )


async def _page(_: Request) -> Response:
    return FileResponse(PAGE / "index.html", headers={"cache-control": "no-cache"})


async def _refused(_: Request, error: Exception) -> Response:
    if isinstance(error, HTTPException):
        return JSONResponse({"error": error.detail}, error.status_code)
    code = 409 if isinstance(error, NotRunningError) else 400
    return JSONResponse({"error": str(error)}, code)


class _Answers:
    """One method a route."""

    def __init__(self, session: Session, write_scene: WriteScene | None) -> None:
        self._session, self._write_scene = session, write_scene

    async def run(self, _: Request) -> Response:
        return _json(await run_in_threadpool(self._session.run))

    async def lanes(self, request: Request) -> Response:
        first, last = _whole(request, "from"), _whole(request, "to")
        columns = min(_whole(request, "columns"), MOST_COLUMNS)
        if columns < 1:
            raise InputError(f"columns: got {columns}; expected at least 1")
        codes = await run_in_threadpool(self._session.lanes, first, last, columns)
        shape = {"x-columns": str(codes.shape[1])}
        return Response(codes.tobytes(), headers=shape, media_type="application/octet-stream")

    async def tick(self, request: Request) -> Response:
        return _json(await run_in_threadpool(self._session.tick, request.path_params["number"]))

    async def ask(self, request: Request) -> Response:
        node, tick = request.query_params.get("node", ""), _whole(request, "tick")
        return _json({"answers": await run_in_threadpool(self._session.answers, node, tick)})

    async def who(self, request: Request) -> Response:
        key, tick = request.query_params.get("key", ""), _whole(request, "tick")
        return _json(await run_in_threadpool(self._session.who, key, tick))

    async def history(self, request: Request) -> Response:
        key = request.query_params.get("key", "")
        return _json(await run_in_threadpool(self._session.history, key))

    async def report(self, _: Request) -> Response:
        return _json({"html": await run_in_threadpool(self._session.report)})

    async def find(self, request: Request) -> Response:
        asked = request.query_params
        wish = Wish(
            kind=asked.get("kind", ""),
            start=_whole(request, "from"),
            forward=asked.get("direction", "1") != "-1",
            node=asked.get("node", ""),
            key=asked.get("key", ""),
            where=asked.get("where", ""),
        )
        return _json({"tick": await run_in_threadpool(self._session.find, wish)})

    async def image(self, request: Request) -> Response:
        png = await run_in_threadpool(self._session.image, request.path_params["number"])
        return Response(png, media_type="image/png", headers={"cache-control": "max-age=3600"})

    async def scene(self, _: Request) -> Response:
        if self._write_scene is None:
            raise HTTPException(404, "this cell has no 3-D scene")
        return HTMLResponse(await run_in_threadpool(self._scene_page))

    def _scene_page(self) -> str:
        import tempfile

        if self._write_scene is None:
            return ""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "scene.html"
            self._write_scene(self._session.path, file)
            return file.read_text(encoding="utf-8")

    async def command(self, request: Request) -> Response:
        try:
            message = dict(await request.json())
            command = str(message.pop("command"))
        except (ValueError, KeyError, TypeError):
            raise InputError('expected {"command": NAME, ...}') from None
        answer = await run_in_threadpool(
            lambda: send(self._session.path, command, **{"by": "page", **message})
        )
        return _json({"answer": answer})

    def _progress(self) -> dict[str, object]:
        self._session.refresh()
        return {**self._session.progress(), "state": self._state()}

    def _state(self) -> object:
        """Return what the run's debugger says, None where no process runs it any more."""
        if self._session.ended:
            return None
        try:
            return send(self._session.path, "state")
        except InputError:
            return None

    async def live(self, socket: WebSocket) -> None:
        """Tell a page how far the run is, at once and whenever that has changed."""
        await socket.accept()
        gone = asyncio.create_task(_until_gone(socket))
        told: object = None
        try:
            while not gone.done():
                progress = await run_in_threadpool(self._progress)
                if progress != told:
                    told = progress
                    await socket.send_text(json.dumps(progress))
                if progress["complete"]:
                    break
                await asyncio.wait([gone], timeout=POLL_S)
            if not gone.done():
                await socket.close()
        except (WebSocketDisconnect, RuntimeError):
            return
        finally:
            gone.cancel()


async def _until_gone(socket: WebSocket) -> None:
    """Return when the page has closed the connection; what it sends is not looked at."""
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):
        while True:
            await socket.receive()


def _whole(request: Request, name: str) -> int:
    text = request.query_params.get(name, "")
    try:
        return int(text)
    except ValueError:
        raise InputError(f"{name}: got {text!r}; expected a whole number") from None


def _json(document: object) -> Response:
    return Response(json.dumps(document), media_type="application/json")


class PageServer:
    """Serves an application until it is stopped."""

    def __init__(
        self, app: Starlette, host: str, port: int, *, most_at_once: int | None = None
    ) -> None:
        """Take a port; 0 takes a free one.

        Args:
            app: The application.
            host: Address to listen on.
            port: The port.
            most_at_once: Connections and requests that are served at once; those beyond are
                told to come back.

        Raises:
            InputError: The port cannot be had.
        """
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        self._socket = socket.socket(family, socket.SOCK_STREAM)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            self._socket.bind((host, port))
            self._socket.listen()  # who connects before `serve` waits for it
        except OSError as error:
            self._socket.close()
            raise InputError(f"--port {port}: cannot listen on {host}; got {error}") from None
        config = uvicorn.Config(
            app,
            log_level="warning",
            ws="websockets-sansio",
            lifespan="off",
            limit_concurrency=most_at_once,
        )
        self._server = uvicorn.Server(config)

    @property
    def port(self) -> int:
        """The port that it listens on."""
        port: int = self._socket.getsockname()[1]
        return port

    def serve(self) -> None:
        """Serve until `stop`, or until the user interrupts."""
        self._server.run(sockets=[self._socket])

    def stop(self) -> None:
        """Let `serve` return; may be called from any thread."""
        self._server.should_exit = True
