"""What every answer has: headers for other sites and against misuse, and a line in the log."""

from __future__ import annotations

import logging
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

LOG = logging.getLogger("sgicodec.server")

_PUBLIC = [
    (b"access-control-allow-origin", b"*"),
    (b"access-control-allow-methods", b"GET, HEAD, OPTIONS"),
    (b"access-control-allow-headers", b"Range, If-Range, If-None-Match, If-Modified-Since, Accept"),
    (b"access-control-expose-headers", b"Accept-Ranges, Content-Length, Content-Range, ETag, Last-Modified, Link"),
    (b"access-control-max-age", b"86400"),
    (b"cross-origin-resource-policy", b"cross-origin"),
]
"""Any site may read what is served to all."""

_PRIVATE = [(b"cross-origin-resource-policy", b"same-origin")]

_ALWAYS = [(b"x-content-type-options", b"nosniff")]


class Access:
    """Middleware. public: whether pages of other sites may read the answers; their questions beforehand (OPTIONS) are
    answered here.
    """

    def __init__(self, app: ASGIApp, public: bool) -> None:
        self._app, self._public = app, public
        self._headers = _ALWAYS + (_PUBLIC if public else _PRIVATE)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Called by the server for every request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        status, size, start = 0, 0, time.monotonic()

        async def noted(message: Message) -> None:
            nonlocal status, size
            if message["type"] == "http.response.start":
                status = message["status"]
                message["headers"] = [*message.get("headers", []), *self._headers]
            size += len(message.get("body", b""))
            await send(message)

        try:
            if scope["method"] == "OPTIONS" and self._public:
                await noted({"type": "http.response.start", "status": 204, "headers": []})
                await noted({"type": "http.response.body"})
            else:
                await self._app(scope, receive, noted)
        finally:
            client = (scope.get("client") or ("-",))[0]
            path = scope.get("raw_path", b"").decode("ascii", "backslashreplace")
            seconds = time.monotonic() - start
            LOG.info("%s %s %s %d %d bytes %.3f s", client, scope["method"], path, status, size, seconds)
