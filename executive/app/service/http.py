"""A cell over HTTP: an OpenAPI of missions and of the cell, and its ticks over a websocket."""

import asyncio
import contextlib
from importlib.metadata import version
from typing import Annotated, Any

from fastapi import FastAPI, Path, Query, Request, WebSocket, WebSocketDisconnect
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, Response
from starlette.exceptions import HTTPException

from executive.app.service.cell_service import BusyError, CellService, UnknownMissionError
from executive.app.service.guard import Guard
from executive.app.service.messages import (
    CellState,
    MissionRequest,
    MissionView,
    Refusal,
    TickView,
)
from executive.core.errors import CellwrightError, InputError
from executive.core.json_files import faults_in_words

MOST_LISTENERS = 32
POLL_S = 0.1
MOST_TICKS = 500

Id = Annotated[int, Path(ge=1, lt=2**53)]
_REFUSALS: dict[int | str, dict[str, Any]] = {
    400: {"model": Refusal, "description": "It cannot be done as it was asked."},
    404: {"model": Refusal, "description": "There is no such mission."},
    409: {"model": Refusal, "description": "The cell cannot do that now."},
    422: {"model": Refusal, "description": "The request is not of the form that is asked for."},
}


def application(service: CellService, *, token: str | None = None) -> FastAPI:
    """Return the application of one cell.

    Args:
        service: The cell.
        token: What a client must know; None where only this machine can connect.
    """
    app = FastAPI(
        title="Cellwright: a cell",
        version=version("cellwright"),
        docs_url=None,  # its page loads scripts from elsewhere
        redoc_url=None,
        responses=_REFUSALS,
    )
    app.add_middleware(Guard, token=token)
    app.add_exception_handler(CellwrightError, _refused)
    app.add_exception_handler(RequestValidationError, _malformed)
    app.add_exception_handler(HTTPException, _out_of_place)
    _missions(app, service)
    _cell(app, service)
    _ticks(app, service)
    return app


def _missions(app: FastAPI, service: CellService) -> None:
    @app.post("/missions", status_code=202)
    def submit(request: MissionRequest) -> MissionView:
        """Queue a mission."""
        return service.submit(request)

    @app.get("/missions")
    def missions() -> list[MissionView]:
        """Tell the missions that are known, the oldest first."""
        return service.missions()

    @app.get("/missions/{number}")
    def mission(number: Id) -> MissionView:
        """Tell how far a mission is."""
        return service.mission(number)

    @app.delete("/missions/{number}")
    def withdraw(number: Id) -> MissionView:
        """Take a mission from the queue, or stop it; the next one begins."""
        return service.withdraw(number)

    @app.post("/missions/{number}/resume", status_code=202)
    def resume(number: Id) -> MissionView:
        """Queue what goes on with a mission that was lost or stopped."""
        return service.resume(number)


def _cell(app: FastAPI, service: CellService) -> None:
    @app.get("/cell")
    def state() -> CellState:
        """Tell what the cell does now."""
        return service.state()

    @app.post("/cell/pause")
    def pause() -> CellState:
        """Pause the mission that runs; its arms come to rest."""
        return service.pause()

    @app.post("/cell/resume")
    def go_on() -> CellState:
        """Let a paused mission go on, or the queue of a cell that is held."""
        return service.go_on()

    @app.post("/cell/stop")
    def stop() -> CellState:
        """Stop the mission that runs, in order, and hold the cell."""
        return service.stop()

    @app.post("/cell/emergency-stop")
    def emergency_stop() -> CellState:
        """Stop the arms at once, and hold the cell. No substitute for a safety circuit."""
        return service.emergency_stop()


def _ticks(app: FastAPI, service: CellService) -> None:
    listeners = asyncio.Semaphore(MOST_LISTENERS)

    @app.get("/ticks")
    def ticks(
        after: Annotated[int, Query(ge=-1, lt=2**53)] = -1,
        most: Annotated[int, Query(ge=1, le=MOST_TICKS)] = 100,
    ) -> list[TickView]:
        """Tell ticks of the mission that runs, or ran last, after one of them."""
        return [*service.ticks(after, most)]

    @app.websocket("/ticks/live")
    async def live(socket: WebSocket) -> None:
        """Send every tick of every mission as it comes."""
        if listeners.locked():
            await socket.close(1013, f"{MOST_LISTENERS} listen already; try again later")
            return
        async with listeners:
            await socket.accept()
            gone = asyncio.create_task(_until_gone(socket))
            try:
                await _tell(socket, service, gone)
            except (WebSocketDisconnect, RuntimeError):  # it has vanished
                return
            finally:
                gone.cancel()


async def _tell(socket: WebSocket, service: CellService, gone: "asyncio.Task[None]") -> None:
    mission, last = service.state().mission, -1
    while not gone.done():
        new = service.ticks(last, MOST_TICKS, mission)
        for tick in new:
            await socket.send_text(tick.model_dump_json())
            last = tick.tick
        if not new:
            now = service.state().mission
            if now != mission and now is not None:
                mission, last = now, -1
                continue
            await asyncio.wait([gone], timeout=POLL_S)


async def _until_gone(socket: WebSocket) -> None:
    """Return when the client has closed the connection; what it sends is not looked at."""
    with contextlib.suppress(WebSocketDisconnect, RuntimeError):
        while True:
            await socket.receive()


async def _refused(_: Request, error: Exception) -> Response:
    codes: dict[type[Exception], int] = {UnknownMissionError: 404, BusyError: 409}
    code = codes.get(type(error), 400 if isinstance(error, InputError) else 500)
    return JSONResponse({"error": str(error)}, code)


async def _out_of_place(request: Request, error: Exception) -> Response:
    """Say in our form what the framework refuses: addresses, methods, bodies that are no text."""
    assert isinstance(error, HTTPException)
    asked = f"{request.method} {request.url.path}"
    told = f"{error.detail}: {asked}; GET /openapi.json tells what there is"
    return JSONResponse({"error": told}, error.status_code, error.headers)


async def _malformed(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    told = faults_in_words(error.errors())
    if request.method == "POST" and "json" not in request.headers.get("content-type", ""):
        told += "; try the header content-type: application/json"
    return JSONResponse({"error": told}, 422)
