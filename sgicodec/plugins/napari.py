"""Streams in napari, by its entry point: layers with all levels, which decode what is looked at."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

from sgicodec.bitstream.recognition import looks_like_stream
from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.metadata.gdal_items import band_facts
from sgicodec.metadata.georeference import resolution
from sgicodec.metadata.layouts import band_ranges
from sgicodec.picture import full_range
from sgicodec.plugins.dask import levels

Layer = tuple[Any, dict[str, Any], str]


def get_reader(path: str | list[str]) -> Callable[[str | list[str]], list[Layer]] | None:
    """The function that reads these paths, or None where one is no stream, but a picture of Silicon Graphics."""
    paths = [path] if isinstance(path, str) else path
    return read if paths and all(map(looks_like_stream, paths)) else None


def read(path: str | list[str]) -> list[Layer]:
    """A layer for each stream, of bands without a meaning one for each band. Raises StreamError."""
    return [_layer(open_stream(each)) for each in ([path] if isinstance(path, str) else path)]


def _layer(stream: Stream) -> Layer:
    header = stream.header
    arrays = levels(stream)
    options: dict[str, Any] = {
        "name": os.path.splitext(os.path.basename(stream.name or "stream"))[0],
        "multiscale": len(arrays) > 1,
        "metadata": {"channels": header.channels, "software": stream.software},
    }
    if header.channels in ("rgb", "rgba"):
        options["rgb"] = True
    else:
        ranges = [list(limits) for limits in band_ranges(header.sample_range, header.colours)]
        if stream.ndim == 2:
            options["contrast_limits"] = ranges[0]
        else:
            alpha = [list(full_range(stream.dtype))] * (stream.shape[2] - header.colours)
            options |= {
                "channel_axis": 2,
                "contrast_limits": ranges + alpha,
                "name": _band_names(options["name"], stream),
            }
    scale = resolution(stream.metadata.geo, stream.metadata.exif)
    if scale is not None:
        across, down = scale.microns
        options |= {"scale": (down, across), "units": ("um", "um")}
    return (arrays if len(arrays) > 1 else arrays[0]), options, "image"


def _band_names(name: str, stream: Stream) -> list[str]:
    """Those of the bands' layers, with what the tags call them, else their numbers."""
    bands = band_facts(stream.metadata.geo, stream.shape[2])
    return [f"{name} {band.description or number}" for number, band in enumerate(bands, 1)]
