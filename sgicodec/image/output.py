"""A picture file that OpenImageIO writes from the top down."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sgicodec._native import Drain
from sgicodec.arrays import Samples
from sgicodec.errors import PictureError
from sgicodec.image.alpha import associate
from sgicodec.image.formats import Format
from sgicodec.image.header import Probe
from sgicodec.image.library import first_line, load_openimageio
from sgicodec.metadata.layouts import alpha_index

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec


_CHANNEL_NAMES = {
    "gray": ("Y",),
    "gray+alpha": ("Y", "A"),
    "rgb": ("R", "G", "B"),
    "rgba": ("R", "G", "B", "A"),
}
_HINTS: Mapping[str, str | int] = {"oiio:UnassociatedAlpha": 1, "oiio:dither": 0, "DateTime": ""}
"""For every format: samples as they are, and no time of writing."""

_TILE = 256
_TILED_PIXELS = 1 << 22
"""TIFF with more pixels is tiled, so that others can read parts of it fast."""

_PIPES = Path("/dev/fd")
"""Where a pipe has a name that can be opened; else libraries write files by themselves."""

_CLASSIC_BYTES = 7 << 29
"""TIFF whose samples take more is a BigTIFF: classic files end at 4 GiB."""


class Output:
    """The file at `path`, in the format `holder`, of a picture with this header. Rows come in order.

    Takes memory for the rows that it is given and, in a tiled TIFF, for one row of tiles.
    """

    def __init__(self, path: Path, holder: Format, header: Probe, icc: bytes | None) -> None:
        load_openimageio("writing pictures")
        import OpenImageIO as oiio

        self._header, self._holder = header, holder
        self._associated = holder.associated and alpha_index(header.channels) is not None
        self._tiled = holder.name == "tiff" and header.width * header.height > _TILED_PIXELS
        self._next = 0
        self._tile_row: Samples | None = None
        self._image: Any = oiio.ImageOutput.create(str(path))
        if self._image is None:
            raise PictureError(f"this OpenImageIO cannot write {path.suffix} files")
        spec, self._path = self._spec(holder, icc), path
        self._drain: Drain | None = None
        if holder.piped and _PIPES.exists():
            self._open_piped(spec)
        else:
            self._require(self._image.open(str(path), spec))

    def _open_piped(self, spec: ImageSpec) -> None:
        """Have the library write into a pipe, from which a thread of ours writes the file."""
        source, sink = os.pipe()
        try:
            with self._path.open("wb") as file:
                self._drain = Drain(source, file.fileno())
            self._require(self._image.open(f"{_PIPES}/{sink}", spec))
        finally:
            os.close(sink)

    def _spec(self, holder: Format, icc: bytes | None) -> ImageSpec:
        import OpenImageIO as oiio

        header, hints = self._header, {**_HINTS, **holder.hints}
        size = header.width * header.height * header.count * header.dtype.itemsize
        if holder.name == "tiff" and size > _CLASSIC_BYTES:
            hints["tiff:bigtiff"] = 1
        type_name = header.dtype.name.removesuffix("32")
        spec = oiio.ImageSpec(header.width, header.height, header.count, oiio.TypeDesc(type_name))
        bands = tuple(f"band{band:04d}" for band in range(header.count))
        spec.channelnames = _CHANNEL_NAMES.get(header.channels, bands)
        alpha = alpha_index(header.channels)
        spec.alpha_channel = -1 if alpha is None else alpha
        if self._tiled:
            spec.tile_width = spec.tile_height = _TILE
        for name, value in hints.items():
            spec.attribute(name, value)
        if icc is not None:
            spec.attribute("ICCProfile", oiio.TypeDesc(f"uint8[{len(icc)}]"), np.frombuffer(icc, np.uint8))
        return spec

    @property
    def row(self) -> int:
        """The row that comes next."""
        return self._next

    def write(self, pixels: Samples) -> None:
        """Take the next rows [n, W, C]. Raises PictureError or OSError."""
        if self._holder.positive and not ((pixels >= 0) & (pixels < np.inf)).all():
            raise PictureError(f"{self._holder.name} cannot hold negative, infinite or undefined samples; choose exr")
        if self._associated:
            pixels = associate(pixels)
        pixels = np.ascontiguousarray(pixels)
        if self._drain is not None:
            _check(self._drain.error())
        if not self._tiled:
            self._require(self._image.write_scanlines(self._next, self._next + len(pixels), 0, pixels))
            self._next += len(pixels)
            return
        while len(pixels):
            first, filled = self._next - self._next % _TILE, self._next % _TILE
            last = min(first + _TILE, self._header.height)
            taken = min(last - self._next, len(pixels))
            if taken == last - first:
                self._write_tiles(first, pixels[:taken])
            else:
                if self._tile_row is None:
                    self._tile_row = np.empty((_TILE, *pixels.shape[1:]), pixels.dtype)
                self._tile_row[filled : filled + taken] = pixels[:taken]
                if self._next + taken == last:
                    self._write_tiles(first, self._tile_row[: last - first])
            self._next += taken
            pixels = pixels[taken:]

    def _write_tiles(self, first: int, pixels: Samples) -> None:
        where = (0, self._header.width, first, first + len(pixels), 0, 1)
        self._require(self._image.write_tiles(*where, pixels))

    def close(self) -> None:
        """Finish the file. Raises PictureError or OSError."""
        self._require(self._image.close())
        if self._drain is not None:
            _check(self._drain.join())

    def abandon(self) -> None:
        """Let go of an unfinished file, whatever becomes of it. It cannot be written to any more."""
        self._image = None
        if self._drain is not None:
            self._drain.join()

    def _require(self, done: bool) -> None:
        """Raise PictureError unless all went well; any complaint counts, as some formats report success after a
        failure.
        """
        complaint = first_line(self._image).replace(str(self._path), "the file")
        if complaint or not done or self._image.has_error:
            raise PictureError(complaint or "OpenImageIO cannot write it and does not say why")


def _check(error: int) -> None:
    """Raise the OSError of this number, unless it is 0."""
    if error:
        raise OSError(error, os.strerror(error))
