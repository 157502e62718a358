"""OpenImageIO, loaded where it can be (where memory is short, its first lines end the process), and what it says."""

from __future__ import annotations

import sys
from typing import Any

from sgicodec.device import check_room
from sgicodec.errors import require

_ROOM_MIB = 60


def load_openimageio(what: str) -> None:
    """Raises MissingExtraError if OpenImageIO, which `what` needs, is missing; MemoryError if it has no room."""
    require("OpenImageIO", what)
    if "OpenImageIO" not in sys.modules:
        check_room(_ROOM_MIB, "OpenImageIO")


def first_line(speaker: Any) -> str:
    """The first line of the complaints that an OpenImageIO object, or the module, has gathered; they are
    cleared.
    """
    try:
        text = str(speaker.geterror())
    except UnicodeDecodeError:
        text = "the file is damaged"
    return next(filter(None, map(str.strip, text.splitlines())), "")
