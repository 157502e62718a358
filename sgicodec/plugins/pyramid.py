"""Streams as pyramids in tiled TIFF: OME-TIFF, or the picture and its reductions one after the other. By tifffile."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

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
from sgicodec.metadata.tiff import DESCRIPTION, XMP, described
from sgicodec.plugins.compression import DEFLATE, Compression
from sgicodec.plugins.content_mask import ContentMask
from sgicodec.plugins.ome_name import is_ome_name
from sgicodec.plugins.ome_xml import has_planes, ome_xml

if TYPE_CHECKING:
    from tifffile import TiffWriter

TILE = 256
"""Side of tiles, in pixels."""

_MAX_CLASSIC = 7 << 28
"""Bytes of the picture's samples from which on, with reductions, the file is a BigTIFF."""

_BATCH_BYTES = 1 << 26
"""Of tiles that are compressed at a time."""

_BYTE = 1
_MASK = 4


def write_pyramid(
    stream: Stream,
    path: str | Path,
    *,
    ome: bool | None = None,
    compression: Compression = DEFLATE,
    done: Callable[[int], None] = lambda rows: None,
    **view: Any,
) -> None:
    """Writes a stream, or a part of it, and its half, its quarter … to a file, which appears whole or not at all.

    ome: whether it is OME-TIFF; by default if it is called `.ome.tif` or `.ome.tiff`. compression: of the tiles. view:
    region, scale, size, dtype and boundless, as of `Stream.picture`. done: called with the rows of the first level that
    are rendered. Every level is rendered by itself, in bands of rows. Raises StreamError, PictureError,
    MissingExtraError.
    """
    ome = is_ome_name(str(path)) if ome is None else ome
    try:
        with whole_file(Path(path)) as file:
            masked = not ome and is_masked(stream, compression, view)
            write_levels(stream, file, ome, view, done, compression, masked)
    except OSError as error:
        raise PictureError(f"{path}: {error.strerror or error}") from error


def is_masked(stream: Stream, compression: Compression, view: Mapping[str, Any]) -> bool:
    """Whether a TIFF for GDAL needs a mask instead of the nodata value, which a view in other samples has not."""
    same = np.dtype(view.get("dtype") or stream.dtype) == stream.dtype
    return same and compression.needs_mask(stream.header.channels, stream.nodata)


def write_levels(
    stream: Stream,
    file: IO[bytes],
    ome: bool,
    view: Mapping[str, Any],
    done: Callable[[int], None],
    compression: Compression = DEFLATE,
    masked: bool = False,
) -> None:
    """The same into a binary file that can seek. masked: whether a mask for each level stands for the nodata value."""
    require("tifffile", "writing pyramids", "tiff")
    import tifffile

    dtype = np.dtype(view.get("dtype") or stream.dtype)
    planes: Sequence[int | None] = range(stream.header.spec.channels) if ome and has_planes(stream) else (None,)
    nodata = None if masked else stream.nodata
    compression.check("gray" if planes[0] == 0 else stream.header.channels, dtype, nodata)
    bands = stream.bands(**view)
    big = bands.row_bytes * bands.height > _MAX_CLASSIC
    with tifffile.TiffWriter(file, bigtiff=big, byteorder="<", shaped=False) as writer:
        for number, plane in enumerate(planes):

            def told(rows: int, before: int = number * bands.height) -> None:
                done((before + rows) // len(planes))

            for tiles, layout in _levels(stream, ome, view, plane, told):
                layout |= compression.for_tifffile(dtype)
                if masked and stream.nodata is not None:
                    _write_masked(writer, tiles, layout, stream.nodata)
                else:
                    writer.write(tiles, **layout)


def _write_masked(writer: TiffWriter, tiles: Iterator[NDArray[Any]], layout: dict[str, Any], nodata: float) -> None:
    """A level without the tag of nodata, and its mask."""
    mask = ContentMask(nodata)
    tags = [tag for tag in layout.get("extratags", ()) if tag[0] != geo.GDAL_NODATA]
    writer.write(mask.passing(tiles), **(layout | {"extratags": tags}))
    same = {name: layout[name] for name in ("tile", "metadata", "software", "buffersize")}
    kind = {"dtype": bool, "photometric": "mask", "subfiletype": _MASK | layout.get("subfiletype", 0)}
    shape = layout["shape"][:2]
    writer.write(mask.tiles(), shape=shape, compression="adobe_deflate", **kind, **same)


def _levels(
    stream: Stream, ome: bool, view: Mapping[str, Any], plane: int | None, done: Callable[[int], None]
) -> Iterator[tuple[Iterator[NDArray[Any]], dict[str, Any]]]:
    """Tiles and layout of each level of all channels, or of one."""
    dtype = np.dtype(view.get("dtype") or stream.dtype)
    bands = stream.bands(**view)
    sizes = levels_of(bands.width, bands.height)
    first = {} if plane else _first_page(stream, bands, ome, view)
    yield (
        _tiles(bands, done, plane),
        _layout(stream, bands, dtype, plane) | first | ({"subifds": len(sizes) - 1} if ome else {}),
    )
    same = {"region": view.get("region"), "dtype": view.get("dtype"), "boundless": view.get("boundless", False)}
    for level in sizes[1:]:
        bands = stream.bands(**same, size=(level.width, level.height))
        yield _tiles(bands, lambda rows: None, plane), _layout(stream, bands, dtype, plane) | {"subfiletype": 1}


def _layout(stream: Stream, bands: Bands, dtype: np.dtype[Any], plane: int | None) -> dict[str, Any]:
    """What all levels share: how samples lie."""
    header = stream.header
    count = header.spec.channels if plane is None else 1
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
        dtype = np.dtype(view.get("dtype") or stream.dtype)
        page["description"] = ome_xml(stream, bands.width, bands.height, dtype, microns)
        if microns is not None:
            page |= {"resolution": tuple(10000 / size for size in microns), "resolutionunit": 3}
    return page


def microns_of(stream: Stream, bands: Bands, view: Mapping[str, Any]) -> tuple[float, float] | None:
    """Size of a pixel of a view, in micrometres in x and y, if the stream states that of its own."""
    stated = resolution(stream.metadata.geo, stream.metadata.exif)
    if stated is None:
        return None
    _, _, width, height = view.get("region") or (0, 0, stream.width, stream.height)
    return stated.microns[0] * (width / bands.width), stated.microns[1] * (height / bands.height)


def _tiles(bands: Bands, done: Callable[[int], None], plane: int | None) -> Iterator[NDArray[Any]]:
    """Tiles [h, w] or [h, w, C] of a level, or of one channel, row by row of tiles; those at its edges are smaller."""
    for _, rows in strips(bands, TILE, done):
        for y in range(0, len(rows), TILE):
            for x in range(0, bands.width, TILE):
                yield np.ascontiguousarray(
                    rows[y : y + TILE, x : x + TILE, ...] if plane is None else rows[y : y + TILE, x : x + TILE, plane]
                )


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
