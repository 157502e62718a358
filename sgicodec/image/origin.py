"""Where a picture comes from: a file, bytes or a stream, brought to a file that OpenImageIO can open."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

from sgicodec.errors import PictureError, UsageError
from sgicodec.files.scratch import scratch_folder
from sgicodec.image.zarr_reader import is_zarr
from sgicodec.remote.url import file_name, is_url

Origin = str | Path | BinaryIO | bytes

_HEAD = 8
_SLIDES = (".ndpi", ".scn", ".bif", ".svs", ".svslide", ".czi")
"""Files of slides, whose copies are known by their names; of one file each."""

_NULL = re.compile(r"\.nul{1,2}(\?|\Z)", re.IGNORECASE)
"""Names for which OpenImageIO does not open a file, but makes up a picture."""

_SUFFIXES = {
    b"\x89PNG": ".png",
    b"\xff\xd8\xff": ".jpg",
    b"II*\0": ".tif",
    b"MM\0*": ".tif",
    b"\x01\xda": ".sgi",
    b"RIFF": ".webp",
    b"\0\0\0\x0cJXL ": ".jxl",
    b"\0\0\0\x0cjP  ": ".jp2",
    b"v/1\x01": ".exr",
}
"""How files of the commonest formats begin. A name with the right extension makes OpenImageIO say what is wrong."""


def display_name(origin: object) -> str:
    """What to call an origin or target in a message."""
    name = origin if isinstance(origin, str | Path) else getattr(origin, "name", None)
    return os.fsencode(name).decode("utf-8", "replace") if isinstance(name, str | Path) else "the picture"


@contextlib.contextmanager
def naming(origin: object) -> Iterator[None]:
    """Give any PictureError raised in the context the name of its origin or target; any OSError becomes one."""
    try:
        yield
    except PictureError as error:
        name, text = f"{display_name(origin)}: ", str(error)
        raise PictureError(text if text.startswith(name) else name + text) from error.__cause__
    except OSError as error:
        raise PictureError(f"{display_name(origin)}: {error.strerror or error}") from error


@contextlib.contextmanager
def on_disk(origin: Origin) -> Iterator[Path]:
    """A path to a regular file with the bytes of `origin`, which may be a URL: itself, or a copy that lasts as long as
    the context. Raises UsageError for what is no origin.

    OpenImageIO has no streams in Python, and takes no file name that is not UTF-8 or that ends in .null.
    """
    with contextlib.ExitStack() as stack:
        suffix = ""
        if isinstance(origin, str) and is_url(origin):
            from sgicodec.remote.remote_file import open_url  # takes long to load

            stream: BinaryIO = stack.enter_context(open_url(origin, PictureError))
            suffix = Path(file_name(origin)).suffix.lower()
        elif isinstance(origin, str | Path):
            if _is_readable(Path(origin)) and is_utf8(origin) and not _NULL.search(str(origin)):
                yield Path(origin)
                return
            stream = stack.enter_context(Path(origin).open("rb"))
        else:
            stream = BytesIO(origin) if isinstance(origin, bytes) else origin
            if not hasattr(stream, "read"):
                kind = type(origin).__name__
                raise UsageError(f"{kind} is no picture file; give a path, bytes or a binary file object")
        head = stream.read(_HEAD)
        suffix = suffix if suffix in _SLIDES else _suffix(head)
        copy = stack.enter_context((stack.enter_context(scratch_folder()) / f"picture{suffix}").open("wb"))
        try:
            copy.write(head)
            shutil.copyfileobj(stream, copy)
            copy.flush()
        except OSError as error:  # a full disk that is not the picture's
            with contextlib.suppress(OSError):  # of what the disk did not take before
                copy.close()
            text = error.strerror or str(error)
            raise PictureError(f"it cannot be copied to {Path(copy.name).parents[1]}: {text}") from error
        yield Path(copy.name)


def _is_readable(path: Path) -> bool:
    """Whether it is a file, or a folder of Zarr, which is read where it lies."""
    return path.is_file() or is_zarr(path)


def has_signature(head: bytes) -> bool:
    """Whether a file with these first bytes is in one of the commonest formats."""
    return bool(_suffix(head))


def _suffix(head: bytes) -> str:
    return next((suffix for start, suffix in _SUFFIXES.items() if head.startswith(start)), "")


def is_utf8(path: str | Path) -> bool:
    """Whether OpenImageIO takes this path."""
    try:
        os.fspath(path).encode("utf-8")
    except UnicodeEncodeError:
        return False
    return True
