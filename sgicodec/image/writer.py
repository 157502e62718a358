"""Writing pictures: in their own depth and channels, whole or not at all."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
import numpy.typing as npt

from ..errors import PictureError
from . import embedded, formats
from .alpha import associate
from .formats import Format
from .picture import Picture, convert
from .source import display_name, first_line, is_utf8

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

__all__ = ["write"]

_SPARE_BYTES = 1 << 20
_CHANNEL_NAMES = {
    "gray": ("Y",),
    "gray+alpha": ("Y", "A"),
    "rgb": ("R", "G", "B"),
    "rgba": ("R", "G", "B", "A"),
}
_HINTS: Mapping[str, str | int] = {"oiio:UnassociatedAlpha": 1, "oiio:dither": 0, "DateTime": ""}
"""For every format: samples as they are, and no time of writing."""


def write(
    picture: Picture, target: str | Path | BinaryIO, *, format: str | None = None, depth: int | None = None
) -> None:
    """Write a picture to a file, which appears whole or not at all, or to a stream.

    format: a name or extension; by default the extension of the target.
    depth:  8, 16 or 32 (float) bits per sample to convert to; by default the picture's own.

    Equal pictures make equal bytes. Raises PictureError, one line that names the target, if the format cannot
    hold the depth, the channels or the metadata, or if the file cannot be written; UsageError for another
    depth.
    """
    with _naming(target):
        holder = formats.find(format or (Path(target).suffix if isinstance(target, str | Path) else ""))
        if depth is not None:
            picture = convert(picture, depth)
        holder.check(picture)
        if not isinstance(target, str | Path):
            _write_stream(picture, target, holder)
        elif Path(target).exists() and not Path(target).is_file():
            with Path(target).open("wb") as device:
                _write_stream(picture, device, holder)
        else:
            _write_file(picture, Path(os.path.realpath(target)), holder)


@contextlib.contextmanager
def _naming(target: object) -> Iterator[None]:
    try:
        yield
    except PictureError as error:
        raise PictureError(f"{display_name(target)}: {error}") from None
    except OSError as error:
        raise PictureError(f"{display_name(target)}: {error.strerror or error}") from error


def _write_stream(picture: Picture, stream: BinaryIO, holder: Format) -> None:
    with (
        tempfile.TemporaryDirectory(prefix="sgicodec-") as folder,
        _encoded(picture, Path(folder), holder).open("rb") as file,
    ):
        shutil.copyfileobj(file, stream)


def _write_file(picture: Picture, path: Path, holder: Format) -> None:
    """Encode beside `path`, then rename; a folder of our own hides the unfinished file and takes its
    leftovers along.
    """
    with tempfile.TemporaryDirectory(prefix=".sgicodec-", dir=path.parent) as folder:
        os.replace(_encoded(picture, Path(folder), holder), path)


def _encoded(picture: Picture, folder: Path, holder: Format) -> Path:
    """A file in `folder` with the whole picture in the format `holder`."""
    if not is_utf8(folder):
        raise PictureError("the name of its folder is not UTF-8, and OpenImageIO cannot open it")
    # A full disk ends the process inside libjpeg, and may crash others: better not to begin.
    needed = picture.pixels.nbytes + _SPARE_BYTES
    if shutil.disk_usage(folder).free < needed:
        raise PictureError(f"writing it may need {needed >> 20} MiB of free disk space, and there is less")
    path = folder / f"picture.{holder.extensions[0]}"
    pixels = picture.pixels
    if holder.associated and picture.alpha is not None:
        pixels = associate(pixels)
    _encode(np.ascontiguousarray(pixels), _spec(picture, holder), path)
    embedded.embed(path, holder.name, picture.metadata)
    return path


def _spec(picture: Picture, holder: Format) -> ImageSpec:
    import OpenImageIO as oiio

    height, width, count = picture.pixels.shape
    spec = oiio.ImageSpec(width, height, count, oiio.TypeDesc(picture.pixels.dtype.name.removesuffix("32")))
    spec.channelnames = _CHANNEL_NAMES.get(picture.channels) or tuple(f"band{band:04d}" for band in range(count))
    spec.alpha_channel = -1 if picture.alpha is None else picture.alpha
    for name, value in {**_HINTS, **holder.hints}.items():
        spec.attribute(name, value)
    if picture.metadata.icc is not None:
        icc = np.frombuffer(picture.metadata.icc, np.uint8)
        spec.attribute("ICCProfile", oiio.TypeDesc(f"uint8[{icc.size}]"), icc)
    return spec


def _encode(pixels: npt.NDArray[Any], spec: ImageSpec, path: Path) -> None:
    """Write the file; any complaint counts, as some formats report success after a failure."""
    import OpenImageIO as oiio

    image = oiio.ImageOutput.create(str(path))
    if image is None:
        raise PictureError(f"this OpenImageIO cannot write {path.suffix} files")
    done = image.open(str(path), spec) and image.write_image(pixels)
    complaint = first_line(image)
    if not (image.close() and done) or complaint or image.has_error:
        raise PictureError(complaint or first_line(image) or "OpenImageIO cannot write it and does not say why")
