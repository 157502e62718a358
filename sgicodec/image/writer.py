"""Writing pictures that are in memory."""

from __future__ import annotations

from sgicodec.errors import UsageError
from sgicodec.image.sink import Target, open_sink
from sgicodec.picture import Picture, convert


def write(
    picture: Picture,
    target: Target,
    *,
    format: str | None = None,
    depth: int | None = None,
    png_level: int | None = None,
    threads: int = 0,
) -> None:
    """Write a picture to a file, which appears whole or not at all, or to a stream.

    format: a name or extension; by default the extension of the target.
    depth:  8, 16 or 32 (float) bits per sample to convert to; by default the picture's own.
    png_level, threads: as for `open_sink`.

    Equal pictures make equal bytes. Raises PictureError, one line that names the target, if the format cannot
    hold the depth, the channels or the metadata, or if the file cannot be written; UsageError for another
    depth, or for what is no Picture.
    """
    if not isinstance(picture, Picture):
        raise UsageError(f"{type(picture).__name__} is no Picture; imwrite takes arrays")
    if depth is not None:
        picture = convert(picture, depth)
    bands = picture.pixels.shape[2] if picture.channels == "multi" else None
    with open_sink(
        target,
        picture.width,
        picture.height,
        picture.channels,
        picture.pixels.dtype,
        picture.metadata,
        bands=bands,
        format=format,
        max_samples=picture.pixels.size,
        png_level=png_level,
        threads=threads,
    ) as sink:
        sink.write_rows(0, picture.pixels)
