"""What a request asks beside its path: conditions and ranges (RFC 9110, sections 13 and 14)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

from starlette.datastructures import Headers
from starlette.requests import Request
from starlette.responses import FileResponse, Response

if TYPE_CHECKING:
    from starlette.types import Receive, Scope, Send

_OF_304 = ("cache-control", "etag", "last-modified", "link", "vary")


def unchanged(request: Request, headers: Mapping[str, str]) -> Response | None:
    """The answer 304 where the client has what these headers of an answer tell of. A date must be the very one: a file
    may be replaced by an older one.
    """
    tags = request.headers.getlist("if-none-match")
    if tags:
        text = ", ".join(tags)
        is_known = text.strip() == "*" or headers["etag"] in re.findall('"[^"]*"', text)  # W/ makes no difference
    else:
        is_known = request.headers.get("if-modified-since") == headers["last-modified"]
    return Response(None, 304, {name: headers[name] for name in _OF_304 if name in headers}) if is_known else None


class RangedFile(FileResponse):
    """A file, or the ranges of it that are asked for. Starlette alone refuses ranges that are to be ignored."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Called by the server."""
        asked = Headers(scope=scope).get("range")
        others = [pair for pair in scope["headers"] if pair[0] != b"range"]
        found = None if asked is None else _satisfiable(asked, int(self.headers["content-length"]))
        ranges = [] if found is None else [(b"range", found.encode())]
        await super().__call__({**scope, "headers": others + ranges}, receive, send)


def _satisfiable(text: str, size: int) -> str | None:
    """A header Range without the parts beyond the end, if any is left; None for one that is to be ignored."""
    unit, _, ranges = text.partition("=")
    parts = [re.fullmatch("[ \t]*([0-9]{0,18})-([0-9]{0,18})[ \t]*", part) for part in ranges.split(",")]
    found = [(part[1], part[2]) for part in parts if part is not None]
    is_wrong = any(not first + last or (first and last and int(first) > int(last)) for first, last in found)
    if unit.strip().lower() != "bytes" or len(found) < len(parts) or is_wrong:
        return None
    inside = [(first, last) for first, last in found if (int(first) < size if first else int(last))]
    return "bytes=" + ",".join(f"{first}-{last}" for first, last in inside or found)
