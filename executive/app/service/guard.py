"""Who may talk to a cell over HTTP: this machine, or whoever knows the token.

Without a token only names of this machine are served, and no page of a browser but ours: a page
elsewhere that sends requests here, or points its own name at this machine, is refused.
"""

import hmac
from urllib.parse import parse_qs

from starlette.datastructures import Headers
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from executive.core.network import host_of_origin, hostname_of, is_loopback

LONGEST_BODY = 64 * 1024


class Guard:
    """ASGI middleware that lets in what is allowed and answers the rest with its reason."""

    def __init__(self, app: ASGIApp, *, token: str | None) -> None:
        """Guard an application; without a token only names of this machine are served."""
        self._app, self._token = app, token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass an allowed request on; one whose body is too long is cut off."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        code, refusal = self._refusal(scope, headers)
        if refusal is None:
            await self._app(scope, _limited(receive), send)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 4000 + code, "reason": refusal})
        else:
            await JSONResponse({"error": refusal}, code)(scope, receive, send)

    def _refusal(self, scope: Scope, headers: Headers) -> tuple[int, str | None]:
        host = headers.get("host", "")
        if self._token is None and not is_loopback(hostname_of(host)):
            return 403, f"host {host!r} is not served; expected a name of this machine"
        origin = headers.get("origin")
        if origin is not None and host_of_origin(origin) != host:
            return 403, f"requests of pages of {origin!r} are refused"
        if self._token is not None and not self._knows_token(scope, headers):
            return 401, "a token is needed; expected the header Authorization: Bearer TOKEN"
        if _length(headers) > LONGEST_BODY:
            return 413, f"the body is too long; expected at most {LONGEST_BODY} bytes"
        return 200, None

    def _knows_token(self, scope: Scope, headers: Headers) -> bool:
        given = headers.get("authorization", "").removeprefix("Bearer ")
        if scope["type"] == "websocket" and not given:  # a browser's cannot send headers
            given = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
        return hmac.compare_digest(given.encode(), (self._token or "").encode())


def _length(headers: Headers) -> int:
    text = headers.get("content-length", "0")
    return int(text) if text.isdecimal() else 0


def _limited(receive: Receive) -> Receive:
    """End a body that goes on for longer than it may."""
    left = LONGEST_BODY

    async def receiving() -> Message:
        nonlocal left
        message = await receive()
        left -= len(message.get("body", b""))
        return message if left >= 0 else {"type": "http.disconnect"}

    return receiving
