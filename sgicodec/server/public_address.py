"""The address under which others reach the server, where a proxy stands before it."""

from __future__ import annotations

from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

from sgicodec.errors import UsageError

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Receive, Scope, Send


def checked_address(url: str) -> str:
    """The same without a slash at the end. Raises UsageError for what is no address of a server."""
    try:
        parts = urlsplit(url)
        port_is_right = parts.port is None or parts.port > 0
    except ValueError:
        port_is_right = False
    if not port_is_right or parts.scheme not in ("http", "https") or not parts.hostname or set("?# ") & set(url):
        raise UsageError(f"{url!r} is no address of a server; it looks like https://example.org/pictures")
    return url.rstrip("/")


class PublicAddress:
    """Middleware that makes requests what they were before a proxy: to the scheme, host and path of `address`. Whether
    the proxy takes that path away or passes it on does not matter, unless it begins with a name of `own`.

    own: the first parts of the paths that the server answers.
    """

    def __init__(self, app: ASGIApp, address: str, own: frozenset[str]) -> None:
        self._app, self._own, parts = app, own, urlsplit(address)
        self._scheme, self._host, self._root = parts.scheme, parts.netloc.encode(), unquote(parts.path)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Called by the server for every request."""
        if scope["type"] == "http":
            headers = [(b"host", self._host), *(pair for pair in scope["headers"] if pair[0] != b"host")]
            paths = {"root_path": self._root, "path": self._root + self._bare(scope["path"])}
            scope = {**scope, "scheme": self._scheme, "headers": headers, **paths}
        await self._app(scope, receive, send)

    def _bare(self, path: str) -> str:
        """The path without that of the address."""
        if path.removeprefix("/").partition("/")[0] in self._own:
            return path
        return (path.removeprefix(self._root) or "/") if f"{path}/".startswith(f"{self._root}/") else path
