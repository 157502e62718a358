"""What `sgi --version -v` prints: libraries, instruction set and threads, for a report of a fault."""

from __future__ import annotations

import platform
import re
from importlib.metadata import PackageNotFoundError, requires, version

_LIBRARIES = ("numpy", "OpenImageIO", "pillow", "click", "rich")
_FOR_DEVELOPERS = {"test", "lint", "wheel"}
_REQUIREMENT = re.compile(r"""([\w.-]+).*\bextra == ['"](\w+)""")


def version_lines() -> list[str]:
    """One line each for the interpreter, the libraries, the extras that are installed, and what computes."""
    from sgicodec._native import instruction_set, resolve_threads
    from sgicodec.bitstream.header import FORMAT_VERSION

    extras = [f"{name} {found}" for name in _extras() if (found := _version(name))]
    return [
        f"Python {platform.python_version()}, {platform.system()} {platform.machine()}",
        ", ".join(f"{name} {_version(name) or 'is missing'}" for name in _LIBRARIES),
        f"extras: {', '.join(extras) or 'none'}",
        f"instruction set {instruction_set('auto')}, {resolve_threads(0)} threads",
        f"reads format version {FORMAT_VERSION}",
    ]


def _extras() -> list[str]:
    """The libraries of all extras that users install."""
    found = filter(None, map(_REQUIREMENT.match, requires("sgicodec") or ()))
    return list(dict.fromkeys(one[1] for one in found if one[2] not in _FOR_DEVELOPERS))


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
