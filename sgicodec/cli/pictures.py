"""Where a decoded picture goes: to a file, a pipe or stdout, band by band."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from sgicodec.cli.paths import display, is_written_directly, output_file
from sgicodec.errors import PictureError
from sgicodec.plugins.compression import DEFLATE, Compression
from sgicodec.plugins.ome_name import is_ome_name, is_zarr_name

if TYPE_CHECKING:
    from sgicodec.bitstream.header import Header
    from sgicodec.decoder.stream import Stream
    from sgicodec.picture import Picture

Pyramid = Literal["tiff", "ome", "cog", "zarr"]


@dataclass(frozen=True)
class Output:
    """How a picture is written. bits: per sample, None for the stream's own; pyramid: what kind of it was asked
    for; compression: of its tiles, if that was asked for; is_exact: whether samples are the source's.
    """

    bits: int | None
    png_level: int | None
    threads: int
    pyramid: Pyramid | None = None
    compression: Compression | None = None
    is_exact: bool = False

    def pyramid_of(self, target: str) -> Pyramid | None:
        """The kind of pyramid that the file is, by its name too."""
        if is_zarr_name(target):
            return "zarr"
        return "ome" if self.pyramid != "cog" and is_ome_name(target) else self.pyramid


@contextlib.contextmanager
def path_for(target: str, extension: str) -> Iterator[Path]:
    """Where a picture is written: OUT, or a file that goes to stdout, a pipe or a device after the block."""
    if not is_written_directly(target):
        yield Path(target)
        return
    from shutil import copyfileobj  # takes long to load, as does the other

    from sgicodec.files.scratch import scratch_folder

    with scratch_folder() as folder:
        path = folder / f"picture.{extension}"
        try:
            yield path
        except PictureError as error:
            raise PictureError(str(error).replace(str(path), display(target, "stdout"))) from error
        with path.open("rb") as file, output_file(target) as out:
            copyfileobj(file, out)


def write_pyramid(
    stream: Stream, view: dict[str, Any], path: Path, kind: Pyramid, output: Output, draw: Callable[[int], None]
) -> None:
    """Writes a stream with reductions. draw: as for `write_bands`. Raises SgiError."""
    options = view | {"done": draw, "compression": output.compression or DEFLATE}
    if kind == "zarr":
        from sgicodec.plugins.ome_zarr import write_ome_zarr

        del options["compression"]
        write_ome_zarr(stream, path, **options)
        return
    if kind == "cog":
        from sgicodec.plugins.cog import write_cog

        write_cog(stream, path, **options)
        return
    from sgicodec.plugins import pyramid

    pyramid.write_pyramid(stream, path, ome=kind == "ome", **options)


def write_bands(
    header: Header,
    size: tuple[int, int],
    bands: Iterable[tuple[int, Picture]],
    path: Path,
    extension: str,
    output: Output,
    draw: Callable[[int], None],
) -> None:
    """Writes a picture of this size band by band: no more than one of them is ever in memory. draw: called with the
    rows that are done. Raises PictureError or StreamError.
    """
    from sgicodec.image.sink import open_sink

    count = header.spec.channels if header.channels == "multi" else None
    begin = partial(open_sink, bands=count, format=extension, png_level=output.png_level, threads=output.threads)
    with contextlib.ExitStack() as stack:
        for top, picture in bands:
            if top == 0:
                made = begin(path, *size, header.channels, picture.pixels.dtype, metadata=picture.metadata)
                sink = stack.enter_context(made)
            sink.write_rows(top, _as_seen(picture, extension, output).pixels)
            draw(top + picture.height)


def _as_seen(picture: Picture, extension: str, output: Output) -> Picture:
    """The picture, with black where its alpha is 0 if a format would add to others the colours that fill it there."""
    import numpy as np

    from sgicodec.image.formats import find

    if picture.alpha is None or output.is_exact or not find(extension).associated:
        return picture
    return replace(picture, pixels=np.where(picture.pixels[..., -1:] == 0, 0, picture.pixels))
