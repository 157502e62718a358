"""Where a command reads and writes: files, and `-` for the standard streams."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, BinaryIO, Literal

from sgicodec.cli.standard_streams import check_stdout
from sgicodec.device import ALL_CORES, Device
from sgicodec.errors import OutputExistsError, PictureError, StreamError, UsageError
from sgicodec.plugins.ome_name import is_zarr_name
from sgicodec.remote.url import file_name, is_url

if TYPE_CHECKING:
    from pathlib import Path

    from sgicodec.decoder.stream import Stream

STANDARD = "-"


def name_of(path: str, standard: str = "stdin") -> str:
    """What to call an argument in JSON."""
    return standard if path == STANDARD else path


def display(path: str, standard: str = "stdin") -> str:
    """What to call an argument in messages, without what could steer a terminal."""
    text = os.fsencode(name_of(path, standard)).decode("utf-8", "replace")
    return "".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text)


def with_extension(path: str, extension: str) -> str:
    """The default output of an input: its name with another extension, in the working folder if it is a URL, or
    stdout.
    """
    return STANDARD if path == STANDARD else f"{os.path.splitext(local_name(path).rstrip(os.sep))[0]}.{extension}"


def local_name(path: str) -> str:
    """The path, or what a file made of a URL is named after."""
    return file_name(path) if is_url(path) else path


@contextlib.contextmanager
def opened_stream(path: str, device: Device = ALL_CORES) -> Iterator[Stream]:
    """The opened stream. StreamErrors in the block get the file's name; a file that cannot be opened raises one."""
    from sgicodec.decoder.stream import open_stream

    with naming_stream(path), open_stream(sys.stdin.buffer if path == STANDARD else path, device) as stream:
        yield stream


@contextlib.contextmanager
def naming_stream(path: str) -> Iterator[None]:
    """Gives StreamErrors in the block the name of a stream's file; an OSError becomes one."""
    try:
        yield
    except StreamError as error:
        name, text = f"{display(path)}: ", str(error)
        raise type(error)(text if text.startswith(name) else name + text) from error.__cause__
    except BrokenPipeError:
        raise  # of stdout
    except OSError as error:
        raise StreamError(f"{display(path)}: {error.strerror or error}") from error


def is_stream(path: str | Path) -> bool:
    """Whether a file begins as streams do. Raises OSError."""
    from sgicodec.bitstream import recognition  # takes long to load

    return recognition.is_stream(path)


def is_written_directly(target: str) -> bool:
    """Whether OUT takes bytes as they come: stdout, a pipe or a device."""
    is_kept = os.path.isfile(target) or os.path.isdir(target) or not os.path.exists(target)
    return target == STANDARD or not is_kept


def size_of(path: str | Path) -> int:
    """Bytes of a file, or of all files in a folder and its subfolders."""
    if not os.path.isdir(path):
        return os.stat(path).st_size
    return sum(os.stat(os.path.join(folder, name)).st_size for folder, _, names in os.walk(path) for name in names)


def check_output(
    target: str,
    sources: tuple[str, ...],
    force: bool,
    *,
    by_default: bool = False,
    becomes: Literal["stream", "picture", "copy"] | None = None,
) -> None:
    """Refuses, before any work is done, what could not or should not be written at its end.

    sources: all that is read, none of which may be OUT. by_default: whether nobody named OUT. Then it replaces no file,
    but for a stream that becomes a stream. becomes: what OUT is to be where it was not named with -o. Then it may not
    be what IN is: a pattern like *.png gives names by position, and -f must not destroy what came second. A copy of a
    stream may have any name, but replaces no picture.

    Raises UsageError, or OutputExistsError for an existing file that may not be replaced.
    """
    if target == STANDARD:
        check_stdout()
        if sys.stdout.isatty() and not force:
            raise UsageError("stdout is a terminal; name OUT, redirect, or give -f to write to it all the same")
        return
    if is_url(target):
        raise UsageError(f"{target}: a URL can be read, not written; name a file")
    from pathlib import Path  # takes long to load

    path, name = Path(target), display(target)
    try:
        with contextlib.suppress(FileNotFoundError, NotADirectoryError):
            path.stat()
        folder = Path(os.path.realpath(path)).parent
    except OSError as error:  # a name that is too long, a folder that may not be searched or is gone
        raise UsageError(f"{name}: {error.strerror or error}") from error
    is_zarr = is_zarr_name(target) and path.is_dir()
    if path.is_dir() and not is_zarr:
        raise UsageError(f"{name} is a folder; name a file in it, or give --output-dir")
    if not folder.is_dir():
        raise UsageError(f"{name}: the folder {display(str(folder))} does not exist")
    if not (path.is_file() or is_zarr) and path.exists():
        return
    if not os.access(folder, os.W_OK):
        raise UsageError(f"{name}: the folder {display(str(folder))} cannot be written to")
    for written in (path, *_beside(path)):
        for source in sources:
            if source != STANDARD and written.exists() and os.path.exists(source) and written.samefile(source):
                raise UsageError(f"{display(str(written))} is both input and output; name another OUT")
    if becomes == "stream":
        _check_stream(path)
    if becomes == "copy":
        _refuse_picture(path, "name another OUT")
    if path.exists():
        _check_replaced(path, force, by_default, becomes)


def _beside(path: Path) -> list[Path]:
    """What is written beside OUT until it is done."""
    from sgicodec.files.lock import lock_file

    part = path.with_name(f"{path.name}.part")
    return [part, path.with_name(f"{part.name}-journal"), lock_file(path), lock_file(part)]


def _check_replaced(path: Path, force: bool, by_default: bool, becomes: str | None) -> None:
    """Raises UsageError or OutputExistsError for a file that is not to be replaced."""
    name = display(str(path))
    try:
        replaces_stream = is_stream(path)
    except OSError:  # one that may not be read
        replaces_stream = False
    if becomes == "picture" and replaces_stream:
        remedy = "decode many streams with --output-dir DIR, or name OUT with -o"
        raise UsageError(f"{name} would be OUT, but it is a stream; {remedy}")
    if by_default and not (replaces_stream and becomes == "stream"):
        text = "exists, and no default OUT replaces it; name OUT or --output-dir, with -f to replace what is there"
        raise OutputExistsError(f"{name} {text}")
    if not force:
        raise OutputExistsError(f"{name} exists; give -f to overwrite it")


def _check_stream(path: Path) -> None:
    """Raises UsageError for a picture, and for a name that streams do not have."""
    remedy = "encode many pictures with --output-dir DIR, or name OUT with -o"
    if path.suffix.lower() not in ("", ".sgi"):
        raise UsageError(f"{display(str(path))} would be OUT, but does not end in .sgi; {remedy}")
    _refuse_picture(path, remedy)


def _refuse_picture(path: Path, remedy: str) -> None:
    """Raises UsageError for a picture, and for what may be one: a file that cannot be read."""
    from sgicodec.image.reader import is_picture

    try:
        if path.is_file() and is_picture(path):
            raise UsageError(f"{display(str(path))} would be OUT, but it is a picture; {remedy}")
    except OSError as error:
        raise UsageError(f"{display(str(path))} would be OUT, but: {error.strerror or error}") from error


def given(source: str, *, again: bool = False) -> str | bytes:
    """What reads pictures and streams takes: the path, or all that comes from stdin. again: whether it is read more
    than once; then all of a pipe, too. Raises OSError.
    """
    if source == STANDARD:
        return sys.stdin.buffer.read()
    if not again or is_url(source) or os.path.isfile(source) or os.path.isdir(source) or not os.path.exists(source):
        return source
    with open(source, "rb") as file:
        return file.read()


@contextlib.contextmanager
def writing(target: str) -> Iterator[None]:
    """Turns errors of the system in the block into PictureErrors with the output's name, but for BrokenPipeError."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise PictureError(f"{display(target, 'stdout')}: {error.strerror or error}") from error


@contextlib.contextmanager
def output_file(target: str) -> Iterator[BinaryIO]:
    """What is written to: a file that appears whole or not at all, or stdout. Raises PictureError, BrokenPipeError."""
    with writing(target):
        if target == STANDARD:
            yield sys.stdout.buffer
            sys.stdout.buffer.flush()
            return
        from pathlib import Path

        from sgicodec.files.whole import whole_file

        with whole_file(Path(target)) as file:
            yield file
