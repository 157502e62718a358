"""The closed set of errors that a user can meet, and the exit code of each.

Anything else that escapes is a defect of this package and ends the command with exit code 1.
"""

from __future__ import annotations

from typing import Any


class SgiError(Exception):
    """Base of every error that is the input's or the caller's, never this package's. Its text is one line."""

    exit_code = 1


class UsageError(SgiError, ValueError):
    """A setting or argument that makes no sense (exit 2)."""

    exit_code = 2


class RegionError(UsageError, IndexError):
    """A region, level or index that does not lie inside the picture (exit 2)."""


class MissingExtraError(UsageError):
    """Something that takes a library of an optional extra, which is not installed (exit 2)."""


class NoDeviceError(UsageError):
    """A GPU that was asked for and is not there, or has no driver (exit 2)."""


def has_library(library: str) -> bool:
    """Whether a library is installed; it is not loaded."""
    from importlib.util import find_spec  # takes long to load

    try:
        return find_spec(library) is not None
    except (ImportError, ValueError):  # blocked: its place in sys.modules is None
        return False


def require(library: str, what: str, extra: str | None = None) -> None:
    """Raises MissingExtraError if `what` cannot have its library, which comes with an extra or with the package."""
    if not has_library(library):
        name = _PACKAGES.get(library, library)
        package = f"'sgicodec[{extra}]'" if extra else name
        raise MissingExtraError(f"{what} needs {name}: pip install {package}")


_PACKAGES = {"PIL": "pillow", "pillow_heif": "pillow-heif", "distributed": "Dask"}
"""What libraries are called where it is not the name of their module."""


class PictureError(SgiError):
    """A picture that cannot be read, or a picture or stream that cannot be written (exit 3)."""

    exit_code = 3


class StreamError(SgiError):
    """A stream that cannot be decoded (exit 4)."""

    exit_code = 4


class CorruptStreamError(StreamError):
    """The bytes are not what an encoder wrote: cut, flipped, foreign or lying."""


class UnsupportedStreamError(StreamError):
    """A sound stream that needs another version of this package."""


class LimitError(StreamError):
    """A stream that asks for more than the format's or the caller's caps; refused before memory is taken."""


class TargetMissedError(SgiError):
    """A rate or quality that was asked for and not reached (exit 5). `nearest` is the best that was found, if any."""

    exit_code = 5

    def __init__(self, message: str, nearest: Any = None) -> None:
        super().__init__(message)
        self.nearest = nearest


class TileFailedError(SgiError):
    """A tile of a large picture that could not be encoded (exit 1): `tile` is its number."""

    def __init__(self, tile: int, reason: str) -> None:
        super().__init__(f"tile {tile}: {reason}")
        self.tile, self._reason = tile, reason

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled as it is made: programs have encodes in processes of their own."""
        return type(self), (self.tile, self._reason)


class BatchError(SgiError):
    """Some of many files failed; each was reported (exit 1)."""


class ReportError(SgiError):
    """The report cannot be written, as stdout is full (exit 1). The work is kept."""


class OutputExistsError(SgiError):
    """The output file exists and overwriting was not asked for (exit 6)."""

    exit_code = 6


class OutputLockedError(OutputExistsError):
    """The output is being written by another encode (exit 6); overwriting does not help."""
