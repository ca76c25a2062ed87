"""Who may talk to the page's server: this machine, or whoever knows the token.

A browser sends requests for any page that is open in it. So a request that changes something,
or a websocket, must come from our own page (its `Origin`), and every request must name a host
that we serve (which a page elsewhere that points its own name at this machine does not).
"""

import hmac
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs

from starlette.datastructures import Headers
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from executive.core.network import host_of_origin, hostname_of, is_loopback

COOKIE = "cellwright_token"


class AccessControl:
    """ASGI middleware that lets in what is allowed and answers the rest with 403."""

    def __init__(self, app: ASGIApp, *, token: str | None) -> None:
        """Guard an application; without a token only names of this machine are served."""
        self._app, self._token = app, token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass an allowed request on."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        refusal = self._refusal(scope)
        if refusal is None:
            await self._app(scope, receive, self._with_cookie(scope, send))
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 4403, "reason": refusal})
        else:
            await PlainTextResponse(refusal, 403)(scope, receive, send)

    def _refusal(self, scope: Scope) -> str | None:
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if self._token is None and not is_loopback(hostname_of(host)):
            return f"host {host!r} is not served; open the page by a name of this machine"
        origin = headers.get("origin")
        changes = scope["type"] == "websocket" or scope["method"] not in ("GET", "HEAD")
        if (origin is not None or changes) and host_of_origin(origin or "") != host:
            return f"requests from {origin or 'no page'} are refused: they are not our page's"
        if self._token is not None and not self._knows_token(scope, headers):
            return "a token is needed; open the address that the command printed"
        return None

    def _knows_token(self, scope: Scope, headers: Headers) -> bool:
        given = [*parse_qs(scope["query_string"].decode("latin-1")).get("token", [])]
        try:
            cookie = SimpleCookie(headers.get("cookie", "")).get(COOKIE)
        except CookieError:
            cookie = None
        given += [cookie.value] if cookie is not None else []
        wanted = (self._token or "").encode()
        return any(hmac.compare_digest(text.encode(), wanted) for text in given)

    def _with_cookie(self, scope: Scope, send: Send) -> Send:
        """Remember the token, so that it need not stand in the address of every request."""
        if self._token is None or scope["type"] != "http":
            return send

        async def sending(message: Message) -> None:
            if message["type"] == "http.response.start":
                cookie = f"{COOKIE}={self._token}; HttpOnly; SameSite=Strict; Path=/"
                message["headers"] = [*message["headers"], (b"set-cookie", cookie.encode())]
            await send(message)

        return sending
