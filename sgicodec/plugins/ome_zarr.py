"""Streams as OME-Zarr (NGFF 0.4, in Zarr 2): the picture and its half, its quarter … as arrays in a folder. By zarr."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from sgicodec.decoder.bands import Bands
from sgicodec.decoder.levels import levels_of
from sgicodec.decoder.stream import Stream
from sgicodec.errors import PictureError, UsageError, require
from sgicodec.files.scratch import scratch_folder
from sgicodec.files.whole import keep_access
from sgicodec.metadata.gdal_items import band_facts
from sgicodec.plugins.pyramid import microns_of, strips

_CHUNK = 512
"""Side of chunks, in pixels."""

_DESCRIPTORS = 10
"""Files that must open at a time: three of zarr's event loop, and those by which a folder of chunks is removed."""

_NAMES = {"gray": ("Gray",), "gray+alpha": ("Gray", "Alpha"), "rgb": ("Red", "Green", "Blue")}
_NAMES["rgba"] = (*_NAMES["rgb"], "Alpha")
_COLOURS = {"Red": "FF0000", "Green": "00FF00", "Blue": "0000FF"}
_CYCLE = ("0000FF", "00FF00", "FF0000", "FFFF00", "FF00FF", "00FFFF", "FFFFFF")


def write_ome_zarr(
    stream: Stream, path: str | Path, *, done: Callable[[int], None] = lambda rows: None, **view: Any
) -> None:
    """Writes a stream, or a part of it, as OME-Zarr to a folder, which appears whole or not at all and replaces one of
    Zarr.

    view: region, scale, size, dtype and boundless, as of `Stream.picture`. done: called with the rows of the picture
    that are rendered. Levels are rendered by the decoder and compressed without loss; the size of a pixel, the range of
    samples, colours and names of bands are stated. Raises StreamError, PictureError, MissingExtraError, UsageError for
    a folder that is none of Zarr.
    """
    require("zarr", "writing OME-Zarr", "zarr")
    target = Path(os.path.realpath(path))
    try:
        with scratch_folder(target.parent) as folder:
            _check_descriptors()
            try:
                _write(stream, folder / "new", view, done)
            except BaseException:
                _await_writers()
                raise
            _replace(target, folder)
    except OSError as error:
        raise PictureError(f"{path}: {error.strerror or error}") from error


def _check_descriptors() -> None:
    """Raises OSError where there are too few: zarr's event loop would print traces."""
    with ExitStack() as stack:
        for _ in range(_DESCRIPTORS):
            stack.enter_context(open(os.devnull, "rb"))


def _await_writers() -> None:
    """Lets zarr finish the chunks beside one that failed: they would be written into a folder that is removed, and end
    in traces.
    """
    from zarr.core.sync import sync

    async def others_end() -> None:
        while tasks := asyncio.all_tasks() - {asyncio.current_task()}:
            await asyncio.wait(tasks)

    sync(others_end())


def _replace(target: Path, folder: Path) -> None:
    """Puts what is new in the place of what was there, which goes with the folder."""
    from sgicodec.image.zarr_reader import is_zarr

    new, old = folder / "new", folder / "old"
    try:
        if target.exists():
            if not is_zarr(target):
                raise UsageError(f"{target} is no folder of Zarr, and is not replaced by one")
            keep_access(target, new)
            target.rename(old)
        new.rename(target)
    except BaseException:
        if old.exists() and not target.exists():
            old.rename(target)
        raise


def _write(stream: Stream, folder: Path, view: dict[str, Any], done: Callable[[int], None]) -> None:
    import zarr

    bands = stream.bands(**view)
    sizes = levels_of(bands.width, bands.height)
    group = zarr.open_group(folder, mode="w", zarr_format=2)
    group.attrs.update(_attributes(stream, bands, view))
    same = {"region": view.get("region"), "dtype": view.get("dtype"), "boundless": view.get("boundless", False)}
    for number, level in enumerate(sizes):
        if number:
            bands = stream.bands(**same, size=(level.width, level.height))
        count = stream.header.spec.channels
        array = group.create_array(
            str(number),
            shape=(count, level.height, level.width),
            chunks=(1, min(_CHUNK, level.height), min(_CHUNK, level.width)),
            dtype=np.dtype(view.get("dtype") or stream.dtype),
            chunk_key_encoding={"name": "v2", "separator": "/"},
        )
        for top, rows in strips(bands, _CHUNK, lambda rows: None if number else done(rows)):  # noqa: B023 (at once)
            array[:, top : top + len(rows)] = np.moveaxis(rows.reshape(*rows.shape[:2], count), -1, 0)


def _attributes(stream: Stream, bands: Bands, view: dict[str, Any]) -> dict[str, Any]:
    """NGFF's metadata of the image, and those of its channels in the words of OMERO."""
    sizes = levels_of(bands.width, bands.height)
    microns = microns_of(stream, bands, view)
    unit = {} if microns is None else {"unit": "micrometer"}
    across, down = microns or (1.0, 1.0)
    datasets = [
        {
            "path": str(number),
            "coordinateTransformations": [
                {
                    "type": "scale",
                    "scale": [1.0, down * sizes[0].height / size.height, across * sizes[0].width / size.width],
                }
            ],
        }
        for number, size in enumerate(sizes)
    ]
    axes = [{"name": "c", "type": "channel"}, *({"name": name, "type": "space"} | unit for name in "yx")]
    multiscale = {"version": "0.4", "name": "", "axes": axes, "datasets": datasets}
    omero = {"channels": _channels(stream), "rdefs": {"model": "color"}}
    return {"multiscales": [multiscale], "omero": omero}


def _channels(stream: Stream) -> list[dict[str, Any]]:
    header = stream.header
    names = [facts.description for facts in band_facts(stream.metadata.geo, header.spec.channels)]
    names = names if header.channels == "gray" and names[0] else list(_NAMES.get(header.channels, names))
    low, high = (np.broadcast_to(ends, len(names)).tolist() for ends in header.sample_range)
    found = []
    for band, name in enumerate(names):
        colour = "FFFFFF" if len(names) < 3 else _COLOURS.get(name or "", _CYCLE[band % len(_CYCLE)])
        window = {"min": low[band], "max": high[band], "start": low[band], "end": high[band]}
        found.append({"active": True, "color": colour, "window": window} | ({"label": name} if name else {}))
    return found
