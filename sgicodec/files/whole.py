"""Files that appear whole or not at all."""

from __future__ import annotations

import contextlib
import os
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from sgicodec.files.scratch import scratch_folder


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """A file to write to in a folder of its own beside `path`; then it is synced to disk and renamed.

    A link is followed. What is no regular file (a device, a named pipe) is written to directly. Raises OSError, after
    which the old file, if any, is still there and nothing else is. What a kill leaves is removed by the next such write
    in that folder.
    """
    if path.exists() and not path.is_file():  # before links are followed: to a pipe, as /dev/stdout, they have no name
        with path.open("wb") as device:
            yield device
        return
    path = Path(os.path.realpath(path))
    with scratch_folder(path.parent) as folder:
        unfinished = folder / path.name
        with unfinished.open("wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        put_in_place(unfinished, path)


def put_in_place(finished: Path, path: Path) -> None:
    """Renames a file; who may read that which it replaces may read it, and nobody else. Raises OSError."""
    with contextlib.suppress(FileNotFoundError):
        keep_access(path, finished)
    os.replace(finished, path)


def keep_access(path: Path, finished: Path) -> None:
    """Gives what is to replace `path` its group and mode; where the group cannot be given, it gets no access. Raises
    OSError.
    """
    there, mode = path.stat(), stat.S_IMODE(path.stat().st_mode)
    if there.st_gid != finished.stat().st_gid:
        try:
            os.chown(finished, -1, there.st_gid)
        except OSError:
            mode &= ~stat.S_IRWXG
    finished.chmod(mode)
