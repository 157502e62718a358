"""One stream of `sgi decode`: opened, rendered, written, reported."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any

import click

from sgicodec.cli.batch import Files
from sgicodec.cli.json_output import print_json
from sgicodec.cli.limits import DecodeLimits
from sgicodec.cli.paths import (
    STANDARD,
    display,
    local_name,
    name_of,
    opened_stream,
    size_of,
    with_extension,
)
from sgicodec.cli.pictures import Output, path_for, write_bands, write_pyramid
from sgicodec.cli.place import losses, lost_outside_tiff
from sgicodec.cli.progress import row_progress
from sgicodec.cli.residual import check_below
from sgicodec.cli.views import ViewOptions
from sgicodec.device import Device, room_left
from sgicodec.errors import PictureError, UsageError
from sgicodec.metadata.blobs import Metadata
from sgicodec.plugins.ome_name import is_zarr_name

if TYPE_CHECKING:
    from sgicodec.cli.pictures import Pyramid
    from sgicodec.decoder.stream import Bands, Stream

_WRITERS = {
    "cog": ("sgicodec.plugins.cog", "rasterio"),
    "zarr": ("sgicodec.plugins.ome_zarr", "zarr"),
    "ome": ("sgicodec.plugins.pyramid", "tifffile"),
    "tiff": ("sgicodec.plugins.pyramid", "tifffile"),
}
"""What writes pyramids, and the library that it takes."""

_DTYPES = {None: None, 8: "uint8", 16: "uint16", 32: "float32"}
"""Samples of so many bits, which are rendered as such."""


@dataclass(frozen=True)
class DecodeJob:
    """What the options say."""

    files: Files
    view: ViewOptions
    limits: DecodeLimits
    output: Output
    device: Device
    format_: str | None
    metadata: bool
    exact: bool
    dither: bool
    lossy: bool

    def extension_of(self, source: str) -> str:
        """That of the picture which a stream becomes, if OUT is not named."""
        with self._opened(source) as stream:
            return self._extension(stream, None)

    @contextlib.contextmanager
    def _opened(self, source: str) -> Iterator[Stream]:
        """The stream, without its metadata unless they are kept."""
        with opened_stream(source, self.device) as stream:
            if not self.metadata:
                stream.metadata = Metadata()
            yield stream

    def run(self, source: str, target: str | None) -> int:
        """Decodes one stream; returns the bytes of the picture."""
        from sgicodec.decoder.levels import levels_of

        files = self.files
        if files.skip_existing and files.is_done(source, target or with_extension(source, self.extension_of(source))):
            return 0
        started = time.monotonic()
        with self._opened(source) as stream:
            extension = self._extension(stream, target)
            target = with_extension(source, extension) if target is None else target
            if self.output.compression is not None and self.output.pyramid_of(target) in (None, "zarr"):
                raise UsageError("--compress is of TIFF: give --cog, --pyramid or an OUT that ends in .ome.tif")
            files.check(source, target, "picture")
            dtype, kind = _DTYPES[self.output.bits], self.output.pyramid_of(target)
            dtype = None if dtype == stream.header.sample_type else dtype
            lost = losses(stream.metadata, stream.nodata, extension, dtype, kind)
            self._load_writer(target, extension)
            view = self.view.of(stream) | {"dtype": dtype}
            with self.limits.held(), path_for(target, extension) as path:
                shown, channels = self._write(stream, view, path, extension, kind), stream.header.channels
                size = size_of(path)
            if stream.has_exact_pixels and not (stream.has_exact_views or self.lossy):
                other = "depth" if dtype else "scale" if _is_scaled(stream, view, shown) else ""
                lost += _lossy_samples(other, has_reductions=kind is not None and len(levels_of(*_size(shown))) > 1)
        for line in () if files.quiet else lost:
            click.echo(f"sgi: {display(target, 'stdout')}: {line}", err=True)
        if files.as_json:
            names = {"input": name_of(source), "output": name_of(target)}
            facts = {"width": shown.width, "height": shown.height, "channels": channels, "format": extension}
            print_json(names | facts | {"bytes": size, "seconds": time.monotonic() - started})
        elif not files.quiet:
            line = f"{display(target, 'stdout')}: {shown.width}×{shown.height} pixels, {channels}, {size:,} bytes"
            click.echo(f"{line}, {time.monotonic() - started:.1f} s", err=target == STANDARD)
        return size

    def _load_writer(self, target: str, extension: str) -> None:
        """Loads what writes OUT: at once where memory is limited, else while the picture is read and rendered."""
        pyramid = self.output.pyramid_of(target)
        if pyramid is not None:
            names = list(_WRITERS[pyramid])
        else:
            names = ["sgicodec.image.sink", *["OpenImageIO"] * (extension != "png")]
        if room_left() is None and self.limits.bound is None:
            with contextlib.suppress(RuntimeError):  # no thread to be had: they load when they are needed
                Thread(target=_load, args=(names,)).start()
            return
        import_module(names[0])
        if "OpenImageIO" in names:
            from sgicodec.image.library import load_openimageio  # takes long to load

            load_openimageio("writing pictures")
        with contextlib.suppress(ImportError):  # told by what writes it
            import_module(names[-1])

    def _write(
        self, stream: Stream, view: dict[str, Any], path: Path, extension: str, pyramid: Pyramid | None
    ) -> Bands:
        if self.lossy:
            check_below(stream)
        stream.exact, stream.dither, stream.lossy = self.exact, self.dither, self.lossy
        from sgicodec.image.formats import find

        bands = stream.bands(**view)
        whole = stream.grid.count == 1 and pyramid is None
        is_exact = not (_is_scaled(stream, view, bands) or self.lossy or stream.max_error is None or view["dtype"])
        output = replace(self.output, is_exact=is_exact)
        rows = bands.height if whole else bands.rows
        if pyramid is None:
            rows += bands.height * find(extension).in_library
        self.limits.check(bands.width, bands.height, bands.row_bytes * rows)
        with row_progress(self.files.mode, None if whole else bands.height) as draw:
            if pyramid is not None:
                write_pyramid(stream, view, path, pyramid, self.output, draw)
            else:
                parts = [(0, stream.picture(**view))] if whole else bands
                write_bands(stream.header, _size(bands), parts, path, extension, output, draw)
        return bands

    def _extension(self, stream: Stream, target: str | None) -> str:
        """Extension of the format to write. Raises UsageError for an unknown format."""
        from sgicodec.image.formats import find

        bits, format_ = self.output.bits, self.format_
        if format_ is None and (target is None or target == STANDARD):
            header = stream.header
            is_float = bits == 32 or (bits is None and header.sample_type == "float32")
            lost = header.channels == "multi" or lost_outside_tiff(stream.metadata.geo, stream.nodata, _DTYPES[bits])
            return "tif" if self.output.pyramid or is_float or lost else "png"
        suffix = "" if target is None else Path(local_name(target)).suffix.removeprefix(".")
        if format_ is None and not suffix:
            raise UsageError(f"{display(target or '')} has no extension that names a format; add one or give --format")
        if format_ is None and suffix.lower() == "sgi":
            text = "a decoded picture ending in .sgi is a Silicon Graphics one; if you mean it, add --format sgi"
            raise UsageError(text)
        if target is not None and is_zarr_name(target):
            if self.output.pyramid or format_ is not None:
                raise UsageError("an OUT that ends in .zarr is OME-Zarr, with neither --format, --pyramid nor --cog")
            return "zarr"
        try:
            extension = find(format_ or suffix).extensions[0]
        except PictureError as error:
            raise UsageError(str(error)) from None
        if extension != "tif" and self.output.pyramid_of(target or ""):
            raise UsageError(f"--pyramid, --cog and .ome.tif write TIFF, not .{extension}")
        if self.output.png_level is not None and extension != "png" and not self.files.are_many:
            raise UsageError(f"--png-level is of PNG, not .{extension}")
        return extension


def _is_scaled(stream: Stream, view: Mapping[str, Any], shown: Bands) -> bool:
    return _size(shown) != (view["region"] or (0, 0, stream.width, stream.height))[2:]


def _size(shown: Bands) -> tuple[int, int]:
    return shown.width, shown.height


def _lossy_samples(other: str, has_reductions: bool) -> list[str]:
    """What to say of samples, or of reductions in a pyramid, that a residual layer does not have. other: what they have
    that it has not.
    """
    which = "samples" if other else "reductions" if has_reductions else ""
    layer = f"its residual layer has the stream's {other or 'scale'} alone"
    return [f"{which} are those of the lossy picture: {layer}"] if which else []


def _load(names: Iterable[str]) -> None:
    with contextlib.suppress(Exception):  # whoever needs them tells
        for name in names:
            import_module(name)
