"""What `sgi --version -v` prints: libraries, instruction set and threads, for a report of a fault."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

__all__ = ["version_lines"]

_LIBRARIES = ("numpy", "constriction", "OpenImageIO", "click", "rich")
_EXTRAS = ("pillow", "scipy", "torch", "dask", "ssimulacra2", "imagecodecs")


def version_lines() -> list[str]:
    """One line each for the interpreter, the libraries, the extras that are installed, and what computes."""
    from sgicodec._native import instruction_set, resolve_threads
    from sgicodec.bitstream.header import FORMAT_VERSION

    extras = [f"{name} {found}" for name in _EXTRAS if (found := _version(name))]
    return [
        f"Python {platform.python_version()}, {platform.system()} {platform.machine()}",
        ", ".join(f"{name} {_version(name) or 'is missing'}" for name in _LIBRARIES),
        f"extras: {', '.join(extras) or 'none'}",
        f"instruction set {instruction_set('auto')}, {resolve_threads(0)} threads",
        f"reads format versions 1 to {FORMAT_VERSION}",
    ]


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
