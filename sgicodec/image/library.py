"""OpenImageIO, loaded where it can be: where memory is short, its first lines end the process."""

from __future__ import annotations

import sys

from sgicodec.device import check_room
from sgicodec.errors import require

__all__ = ["load_openimageio"]

_ROOM_MIB = 60


def load_openimageio(what: str) -> None:
    """Raises MissingExtraError if OpenImageIO, which `what` needs, is missing; MemoryError if it has no room."""
    require("OpenImageIO", what)
    if "OpenImageIO" not in sys.modules:
        check_room(_ROOM_MIB, "OpenImageIO")
