"""Writing a picture band by band: in its own depth and channels, whole or not at all."""

from __future__ import annotations

import os
import shutil
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
import numpy.typing as npt

from sgicodec.errors import PictureError, UsageError
from sgicodec.files.scratch import scratch_folder
from sgicodec.files.whole import put_in_place
from sgicodec.image import formats
from sgicodec.image.header import MAX_SAMPLES, Probe
from sgicodec.image.origin import is_utf8, naming
from sgicodec.image.png_output import PngOutput
from sgicodec.metadata import embedded
from sgicodec.metadata.layouts import LAYOUTS
from sgicodec.picture import Metadata

if TYPE_CHECKING:
    from sgicodec.image.output import Output

Target = str | Path | BinaryIO

_SPARE_BYTES = 1 << 20


class Sink:
    """A picture that is being written. A context manager: leaving it finishes the file, an exception leaves nothing.

    The file is made in a folder of its own beside the target, whose old contents stay until all is written, and then
    renamed. For streams and devices it is made in the folder for temporary files and copied.
    """

    def __init__(
        self,
        target: Target,
        header: Probe,
        metadata: Metadata,
        format: str | None,
        max_samples: int,
        level: int | None,
        threads: int,
    ) -> None:
        self._target, self._header, self._metadata = target, header, metadata
        with naming(target), ExitStack() as stack:
            self._holder = formats.find(format or _suffix_of(target))
            self._holder.check(header)
            samples = header.width * header.height * header.count
            if self._holder.in_library and samples > max_samples:
                raise PictureError(
                    f"{self._holder.name} is written from memory, and {samples} samples are more than the cap of "
                    f"{max_samples}; choose another format"
                )
            beside = _file_of(target)
            folder = stack.enter_context(scratch_folder(beside and beside.parent))
            self._check_folder(folder, samples * header.dtype.itemsize)
            self._part = folder / f"picture.{self._holder.extensions[0]}"
            self._output: Output | PngOutput
            if self._holder.name == "png":
                self._output = PngOutput(self._part, header, metadata, level, threads)
            else:
                from sgicodec.image.output import Output

                self._output = Output(self._part, self._holder, header, metadata.icc)
            stack.callback(self._output.abandon)
            self._stack = stack.pop_all()

    def _check_folder(self, folder: Path, size: int) -> None:
        if self._holder.name != "png" and not is_utf8(folder):
            raise PictureError("the name of its folder is not UTF-8, and OpenImageIO cannot open it")
        # Better not to begin what a full disk would end.
        needed = size * embedded.copies(self._holder.name) + _SPARE_BYTES
        if shutil.disk_usage(folder).free < needed:
            raise PictureError(f"writing it may need {needed >> 20} MiB of free disk space, and there is less")

    def __enter__(self) -> Sink:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
        else:
            self.abort()

    def write_rows(self, y: int, pixels: npt.NDArray[Any]) -> None:
        """Write rows [n, W, C] of the picture's sample type, which must follow those written before.

        Raises PictureError if they cannot be written, UsageError for rows that are not the next ones.
        """
        header = self._header
        shape, dtype = (header.width, header.count), header.dtype
        if pixels.ndim != 3 or pixels.shape[1:] != shape or pixels.dtype != dtype:
            raise UsageError(f"rows must be {dtype} [n, {shape[0]}, {shape[1]}], not {pixels.dtype} {pixels.shape}")
        if y != self._output.row or y + len(pixels) > header.height:
            raise UsageError(
                f"rows {y} to {y + len(pixels)} do not follow: {self._output.row} of {header.height} are written"
            )
        with naming(self._target):
            self._output.write(pixels)

    def close(self) -> None:
        """Finish the file and put it in place. Raises PictureError, after which nothing is left but what was there;
        UsageError if rows are missing.
        """
        with self._stack, naming(self._target):
            if self._output.row < self._header.height:
                raise UsageError(f"only {self._output.row} of {self._header.height} rows were written")
            self._output.close()
            bands = self._header.count if self._header.channels == "multi" else None
            embedded.embed(self._part, self._holder.name, self._metadata, bands)
            self._deliver()

    def _deliver(self) -> None:
        path = _file_of(self._target)
        with self._part.open("rb") as file:
            if path is not None:
                os.fsync(file.fileno())
                put_in_place(self._part, path)
            elif isinstance(self._target, str | Path):
                with Path(self._target).open("wb") as device:
                    shutil.copyfileobj(file, device)
            else:
                shutil.copyfileobj(file, self._target)

    def abort(self) -> None:
        """Give up; nothing is left but what was there."""
        self._stack.close()


def open_sink(
    target: Target,
    width: int,
    height: int,
    channels: str,
    dtype: npt.DTypeLike,
    metadata: Metadata | None = None,
    *,
    bands: int | None = None,
    format: str | None = None,
    max_samples: int = MAX_SAMPLES,
    png_level: int | None = None,
    threads: int = 0,
) -> Sink:
    """Begin a picture of width × height pixels in a file, which appears whole or not at all, or on a stream.

    channels:    a layout, as in `Picture`; for "multi" `bands` states their number.
    dtype:       uint8, uint16 or float32.
    format:      a name or extension; by default the extension of the target.
    max_samples: cap for formats that are written from memory.
    png_level:   effort of PNG's compression, 0 to 9; `png_output.DEFAULT_LEVEL` if None.
    threads:     that PNG's compression may use, 0 for all cores; they do not change the bytes.

    Equal pictures make equal bytes, however their rows came. Raises PictureError, one line that names the target, if
    the format cannot hold the depth, the channels or the size, or if the file cannot be begun; UsageError for a
    picture that cannot be.
    """
    if (channels == "multi") != (bands is not None) or (bands is None and channels not in LAYOUTS):
        raise UsageError(f"channels must be one of {', '.join(LAYOUTS)}, or multi with a number of bands")
    count = LAYOUTS[channels] if bands is None else bands
    if min(width, height, count) < 1:
        raise UsageError(f"a picture cannot be of {width} × {height} pixels of {count} channels")
    if np.dtype(dtype) not in (np.uint8, np.uint16, np.float32):
        raise UsageError(f"pixels must be uint8, uint16 or float32, not {np.dtype(dtype)}")
    if png_level is not None and not 0 <= png_level <= 9:
        raise UsageError(f"a PNG level of {png_level}; it runs from 0 to 9")
    header = Probe(width, height, channels, count, np.dtype(dtype))
    return Sink(target, header, metadata or Metadata(), format, max_samples, png_level, threads)


def _suffix_of(target: Target) -> str:
    return Path(target).suffix if isinstance(target, str | Path) else ""


def _file_of(target: Target) -> Path | None:
    """The file that will be put in place, its links followed; None for streams and devices."""
    if not isinstance(target, str | Path):
        return None
    if Path(target).exists() and not Path(target).is_file():
        return None
    return Path(os.path.realpath(target))
