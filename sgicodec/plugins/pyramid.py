"""Streams as pyramids in tiled TIFF: OME-TIFF, or the picture and its reductions one after the other. By tifffile."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from sgicodec.decoder.bands import Bands
from sgicodec.decoder.levels import levels_of
from sgicodec.decoder.stream import Stream
from sgicodec.errors import PictureError, require
from sgicodec.files.whole import whole_file
from sgicodec.metadata import geo
from sgicodec.metadata.georeference import resolution
from sgicodec.metadata.layouts import alpha_index
from sgicodec.metadata.slides import magnification
from sgicodec.metadata.tiff import DESCRIPTION, XMP, described
from sgicodec.plugins.compression import DEFLATE, Compression
from sgicodec.plugins.ome_name import is_ome_name
from sgicodec.remote.upload import local_file

__all__ = ["TILE", "microns_of", "strips", "write_levels", "write_pyramid"]

TILE = 256
"""Side of tiles, in pixels."""

_MAX_CLASSIC = 7 << 28
"""Bytes of the picture's samples from which on, with reductions, the file is a BigTIFF."""

_BATCH_BYTES = 1 << 26
"""Of tiles that are compressed at a time."""

_BYTE = 1
_NAME = "Image0"
_UUID = re.compile(r' UUID="[^"]*"')
"""Of tifffile, made of the time and the address of the machine; equal pictures are to make equal files."""


def write_pyramid(
    stream: Stream,
    path: str | Path,
    *,
    ome: bool | None = None,
    compression: Compression = DEFLATE,
    done: Callable[[int], None] = lambda rows: None,
    **view: Any,
) -> None:
    """Writes a stream, or a part of it, and its half, its quarter … to a file or URL, where it appears whole or not at
    all.

    ome: whether it is OME-TIFF; by default if it is called `.ome.tif` or `.ome.tiff`. compression: of the tiles. view:
    region, scale, size, dtype and boundless, as of `Stream.read`. done: called with the rows of the first level that
    are rendered. Every level is rendered by itself, in bands of rows. Raises StreamError, PictureError,
    MissingExtraError.
    """
    ome = is_ome_name(str(path)) if ome is None else ome
    try:
        with local_file(path, PictureError) as local, whole_file(local) as file:
            write_levels(stream, file, ome, view, done, compression)
    except OSError as error:
        raise PictureError(f"{path}: {error.strerror or error}") from error


def write_levels(
    stream: Stream,
    file: IO[bytes],
    ome: bool,
    view: Mapping[str, Any],
    done: Callable[[int], None],
    compression: Compression = DEFLATE,
) -> None:
    """The same into a binary file that can seek."""
    require("tifffile", "writing pyramids", "tiff")
    import tifffile

    dtype = np.dtype(view.get("dtype") or stream.dtype)
    compression.check(stream.header.channels, dtype, stream.nodata)
    bands = stream.bands(**view)
    sizes = levels_of(bands.width, bands.height)
    big = bands.row_bytes * bands.height > _MAX_CLASSIC
    same = {"region": view.get("region"), "dtype": view.get("dtype"), "boundless": view.get("boundless", False)}
    with tifffile.TiffWriter(file, bigtiff=big, byteorder="<", shaped=False) as writer:
        for number, level in enumerate(sizes):
            if number:
                bands = stream.bands(**same, size=(level.width, level.height))
                first = {"subfiletype": 1}
            else:
                first = _first_page(stream, bands, ome, view) | ({"subifds": len(sizes) - 1} if ome else {})
            tiles = _tiles(bands, lambda rows: None if number else done(rows))  # noqa: B023 (consumed at once)
            writer.write(tiles, **(_layout(stream, bands, dtype) | compression.for_tifffile(dtype) | first))


def _layout(stream: Stream, bands: Bands, dtype: np.dtype[Any]) -> dict[str, Any]:
    """What all levels share: how samples lie."""
    header = stream.header
    count = header.spec.channels
    colour = "rgb" if header.channels in ("rgb", "rgba") else "minisblack"
    extra = {} if alpha_index(header.channels) is None else {"extrasamples": ["unassalpha"]}
    return extra | {
        "shape": (bands.height, bands.width, *((count,) if count > 1 else ())),
        "dtype": dtype,
        "photometric": colour,
        "planarconfig": "contig" if count > 1 else None,
        "tile": (TILE, TILE),
        "metadata": None,
        "software": False,
        "buffersize": _BATCH_BYTES,
        "iccprofile": stream.metadata.icc,
    }


def _first_page(stream: Stream, bands: Bands, ome: bool, view: Mapping[str, Any]) -> dict[str, Any]:
    """Metadata, which the first directory alone has."""
    found = bands.metadata
    tags = described(found.exif) | {tag: entry for tag, entry in geo.load(found.geo).items()}
    x, y, unit = (tags.pop(tag, None) for tag in sorted(geo.RESOLUTION))
    keep = [
        (tag, entry.kind, None, entry.data, True) for tag, entry in tags.items() if not (ome and tag == DESCRIPTION)
    ]
    if found.xmp is not None:
        keep.append((XMP, _BYTE, None, found.xmp, True))
    page: dict[str, Any] = {"extratags": keep}
    if x is not None and y is not None:
        pair = tuple(tuple(np.frombuffer(entry.data, "<u4", 2).tolist()) for entry in (x, y))
        page |= {"resolution": pair, "resolutionunit": 2 if unit is None else unit.short}
    if ome:
        microns = microns_of(stream, bands, view)
        page["description"] = _ome_xml(stream, bands, np.dtype(view.get("dtype") or stream.dtype), microns)
        if microns is not None:
            page |= {"resolution": tuple(10000 / size for size in microns), "resolutionunit": 3}
    return page


def _ome_xml(stream: Stream, bands: Bands, dtype: np.dtype[Any], microns: tuple[float, float] | None) -> bytes:
    """What OME has as the description of a picture: its size, that of a pixel, the objective."""
    import tifffile

    count = stream.header.spec.channels
    facts: dict[str, str | float] = {}
    if microns is not None:
        facts = {f"PhysicalSize{axis}": size for axis, size in zip("XY", microns, strict=True)}
        facts |= {"PhysicalSizeXUnit": "µm", "PhysicalSizeYUnit": "µm"}
    shape = (bands.height, bands.width, *((count,) if count > 1 else ()))
    document = tifffile.OmeXml()
    stored = (1, 1, 1, bands.height, bands.width, count)
    document.addimage(dtype, shape, stored, axes="YXS"[: len(shape)], Name=_NAME, **facts)
    text = _UUID.sub("", document.tostring(declaration=True), count=1)
    description = described(stream.metadata.exif).get(DESCRIPTION)
    power = None if description is None else magnification(description.data)
    return (text if power is None else _with_objective(text, power)).encode()


def _with_objective(text: str, power: str) -> str:
    """OME's document of one image with the magnification of its objective, which tifffile has no words for."""
    objective = (
        f'<Instrument ID="Instrument:0"><Objective ID="Objective:0" NominalMagnification="{power}"/></Instrument>'
    )
    used = '<InstrumentRef ID="Instrument:0"/><ObjectiveSettings ID="Objective:0"/>'
    return text.replace("<Image ", objective + "<Image ", 1).replace("<Pixels ", used + "<Pixels ", 1)


def microns_of(stream: Stream, bands: Bands, view: Mapping[str, Any]) -> tuple[float, float] | None:
    """Size of a pixel of a view, in micrometres in x and y, if the stream states that of its own."""
    stated = resolution(stream.metadata.geo, stream.metadata.exif)
    if stated is None:
        return None
    _, _, width, height = view.get("region") or (0, 0, stream.width, stream.height)
    return stated.microns[0] * (width / bands.width), stated.microns[1] * (height / bands.height)


def _tiles(bands: Bands, done: Callable[[int], None]) -> Iterator[NDArray[Any]]:
    """Tiles [h, w] or [h, w, C] of a level, row by row of tiles; those at its edges are smaller."""
    for _, rows in strips(bands, TILE, done):
        for y in range(0, len(rows), TILE):
            for x in range(0, bands.width, TILE):
                yield np.ascontiguousarray(rows[y : y + TILE, x : x + TILE])


def strips(bands: Bands, step: int, done: Callable[[int], None]) -> Iterator[tuple[int, NDArray[Any]]]:
    """The first row, and rows [h, W] or [h, W, C] of a level, so many that they end at multiples of `step` or with it.

    done: called with the rows that are rendered.
    """
    rest: NDArray[Any] | None = None
    for top, picture in bands:
        done(top + picture.height)
        rows = picture.pixels[..., 0] if picture.pixels.shape[2] == 1 else picture.pixels
        rows = rows if rest is None else np.concatenate([rest, rows])
        end = top + picture.height
        whole = len(rows) if end == bands.height else len(rows) - len(rows) % step
        if whole:
            yield end - len(rows), rows[:whole]
        rest = rows[whole:].copy()
