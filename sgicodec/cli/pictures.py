"""Where a decoded picture goes: to a file or stdout, whole or band by band."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from sgicodec.cli.paths import STANDARD, output_file
from sgicodec.plugins.compression import DEFLATE, Compression
from sgicodec.plugins.ome_name import is_ome_name, is_zarr_name

if TYPE_CHECKING:
    from sgicodec.bitstream.header import Header
    from sgicodec.decoder.bands import Bands
    from sgicodec.decoder.stream import Stream
    from sgicodec.image.sink import Sink
    from sgicodec.picture import Picture

__all__ = ["Output", "write_bands", "write_picture", "write_pyramid"]

Pyramid = Literal["tiff", "ome", "cog", "zarr"]


@dataclass(frozen=True)
class Output:
    """How a picture is written. bits: per sample, None for the stream's own; pyramid: what kind of it was asked
    for; compression: of its tiles, if that was asked for.
    """

    bits: int | None
    png_level: int | None
    threads: int
    pyramid: Pyramid | None = None
    compression: Compression | None = None

    def pyramid_of(self, target: str) -> Pyramid | None:
        """The kind of pyramid that the file is, by its name too."""
        if is_zarr_name(target):
            return "zarr"
        return "ome" if self.pyramid != "cog" and is_ome_name(target) else self.pyramid


def write_picture(picture: Picture, target: str, extension: str, output: Output) -> None:
    """Writes a picture that is in memory."""
    from sgicodec.image.writer import write

    options = {"png_level": output.png_level, "threads": output.threads}
    if target != STANDARD:
        write(picture, target, format=extension, **options)  # type: ignore[arg-type]
        return
    buffer = io.BytesIO()
    write(picture, buffer, format=extension, **options)  # type: ignore[arg-type]
    with output_file(target) as file:
        file.write(buffer.getvalue())


def write_pyramid(
    stream: Stream, view: dict[str, Any], target: str, output: Output, draw: Callable[[int], None]
) -> None:
    """Writes a stream as a tiled TIFF with reductions. draw: as for `write_bands`. Raises SgiError."""
    kind = output.pyramid_of(target) or "tiff"
    options = view | {"done": draw, "compression": output.compression or DEFLATE}
    if target != STANDARD:
        _write_pyramid(stream, Path(target), kind, options)
        return
    with _copied_out("pyramid.tif") as path:
        _write_pyramid(stream, path, kind, options)


def _write_pyramid(stream: Stream, path: Path, kind: Pyramid, options: dict[str, Any]) -> None:
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
    header: Header, bands: Bands, target: str, extension: str, output: Output, draw: Callable[[int], None]
) -> None:
    """Writes a picture band by band: no more than one of them is ever in memory. draw: called with the rows that are
    done. Raises PictureError or StreamError.
    """
    if target != STANDARD:
        _write_bands(header, bands, Path(target), extension, output, draw)
        return
    with _copied_out(f"picture.{extension}") as path:
        _write_bands(header, bands, path, extension, output, draw)


@contextlib.contextmanager
def _copied_out(name: str) -> Iterator[Path]:
    """A file of this name to be written, which goes to stdout after the block."""
    from shutil import copyfileobj  # takes long to load, as does the other

    from sgicodec.files.scratch import scratch_folder

    with scratch_folder() as folder:
        path = folder / name
        yield path
        with path.open("rb") as file, output_file(STANDARD) as stdout:
            copyfileobj(file, stdout)


def _write_bands(
    header: Header, bands: Bands, path: Path, extension: str, output: Output, draw: Callable[[int], None]
) -> None:
    sink: Sink | None = None
    try:
        for top, picture in bands:
            if sink is None:
                sink = _sink(path, header, bands, picture, extension, output)
            sink.write_rows(top, picture.pixels)
            draw(top + picture.height)
    except BaseException:
        if sink is not None:
            sink.abort()
        raise
    if sink is not None:
        sink.close()


def _sink(path: Path, header: Header, bands: Bands, first: Picture, extension: str, output: Output) -> Sink:
    from sgicodec.image.sink import open_sink

    return open_sink(
        path,
        bands.width,
        bands.height,
        header.channels,
        first.pixels.dtype,
        first.metadata,
        bands=header.spec.channels if header.channels == "multi" else None,
        format=extension,
        png_level=output.png_level,
        threads=output.threads,
    )
