"""OpenImageIO, loaded where it can be: where memory is short, its first lines end the process."""

from __future__ import annotations

import ctypes
import sys
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import find_spec
from pathlib import Path
from threading import Thread

from sgicodec.device import check_room
from sgicodec.errors import require

__all__ = ["begin_to_load", "load_openimageio"]

_ROOM_MIB = 60


def load_openimageio(what: str) -> None:
    """Raises MissingExtraError if OpenImageIO, which `what` needs, is missing; MemoryError if it has no room."""
    require("OpenImageIO", what)
    if "OpenImageIO" not in sys.modules:
        check_room(_ROOM_MIB, "OpenImageIO")


def begin_to_load() -> Thread | None:
    """Has the system load the library of OpenImageIO on a thread of its own, so that the import, which comes later,
    finds it there: other modules load meanwhile, for the thread needs no lock of Python's. None where it cannot.
    """
    try:
        spec = None if "OpenImageIO" in sys.modules else find_spec("OpenImageIO")
    except ImportError:
        return None
    folders = [] if spec is None else spec.submodule_search_locations or []
    found = (Path(folder, f"OpenImageIO{suffix}") for folder in folders for suffix in EXTENSION_SUFFIXES)
    library = next(filter(Path.exists, found), None)
    if library is None:
        return None
    thread = Thread(target=_load, args=(library,))
    thread.start()
    return thread


def _load(library: Path) -> None:
    try:
        check_room(_ROOM_MIB, "OpenImageIO")
        ctypes.CDLL(str(library))
    except (MemoryError, OSError):  # the import will say what is wrong
        pass
