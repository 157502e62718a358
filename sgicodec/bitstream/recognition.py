"""Whether a file is a stream, by its first bytes: pictures of Silicon Graphics are called .sgi, too."""

from __future__ import annotations

import os
from contextlib import suppress
from typing import Any

from sgicodec.bitstream.container import SIGNATURE
from sgicodec.remote.url import has_stream_name, is_url


def is_stream(path: str | os.PathLike[str]) -> bool:
    """Whether a file begins as streams do. Raises OSError."""
    with open(path, "rb") as file:
        return file.read(len(SIGNATURE)) == SIGNATURE


def looks_like_stream(origin: Any) -> bool:
    """The same, False for what cannot be read; of a URL, whether its name ends in .sgi: nothing is fetched."""
    if isinstance(origin, str) and is_url(origin):
        return has_stream_name(origin)
    with suppress(OSError, TypeError, ValueError):
        return is_stream(origin)
    return False
