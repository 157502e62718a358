"""URLs where a path can stand: what is one, and what the file behind it is called."""

from __future__ import annotations

import re
from urllib.parse import unquote

_URL = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+(::[^/]*)?://")


def is_url(path: str) -> bool:
    """Whether it begins as `https://` or `s3://` do; letters of drives do not."""
    return _URL.match(path) is not None


def file_name(url: str) -> str:
    """The last part of its path, which a file made of it is named after."""
    path = re.split(r"[?#]", url)[0] if url.startswith("http") else url
    return unquote(path.rstrip("/").rpartition("/")[2]).replace("/", "_") or "stream"


def has_stream_name(url: str) -> bool:
    """Whether its name, or that of a path, is a stream's; nothing is fetched."""
    return file_name(url).lower().endswith(".sgi")
