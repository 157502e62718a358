"""Files that appear whole or not at all."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

__all__ = ["write_whole"]


def write_whole(path: Path, data: bytes) -> None:
    """Writes `data` to `path`: under a temporary name in the same folder, synced to disk, then renamed.

    A link is followed. What is no regular file (a device, a named pipe) is written to directly. Raises OSError, after
    which the old file, if any, is still there and nothing else is.
    """
    path = Path(os.path.realpath(path))
    if path.exists() and not path.is_file():
        with path.open("wb") as device:
            device.write(data)
        return
    unfinished = path.with_name(f".{os.urandom(4).hex()}.sgi-part")
    try:
        with unfinished.open("xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(unfinished, path)
    except BaseException:
        with contextlib.suppress(FileNotFoundError):
            unfinished.unlink()
        raise
