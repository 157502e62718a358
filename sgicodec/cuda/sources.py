"""Where the CUDA sources lie: in the package, or in the tree that it is developed in."""

from __future__ import annotations

import hashlib
import re
from functools import cache
from pathlib import Path

_INCLUDE = re.compile(r'^\s*#\s*include [<"]([^">]+)[">]', re.MULTILINE)


@cache
def root() -> Path:
    """The folder with cuda/ and native/ in it."""
    roots = (Path(__file__).parent / "sources", Path(__file__).parents[2])
    return next(root for root in roots if (root / "cuda" / "kernels.cu").exists())


def digest(text: str) -> str:
    """A hash of the kernels with all that they include, and of `text`."""
    return hashlib.sha256("\0".join([text, *_all_of("cuda/kernels.cu").values()]).encode()).hexdigest()


def constants(path: str) -> dict[str, int]:
    """The integers that a header defines as `constexpr int NAME = NUMBER`, by name."""
    text = (root() / path).read_text("utf-8")
    found: dict[str, int] = {}
    for line in re.findall(r"^constexpr int (.*);", text, re.MULTILINE):
        found |= {name: int(value) for name, value in re.findall(r"(k\w+) = (\d+)(?=,|$)", line)}
    return found


def _all_of(path: str, found: dict[str, str] | None = None) -> dict[str, str]:
    """A file and what it includes, by name, in the order of reading."""
    found = {} if found is None else found
    if path in found:
        return found
    file = next(
        (p for p in (root() / path, root() / "native" / path, root() / "cuda" / "rtc" / path) if p.exists()), None
    )
    if file is not None:
        found[path] = file.read_text("utf-8")
        for name in _INCLUDE.findall(found[path]):
            _all_of(name, found)
    return found
