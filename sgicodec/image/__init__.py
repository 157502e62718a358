"""Pictures in and out of files: samples, colour profile, EXIF and XMP. The only user of OpenImageIO.

    picture = read("in.tif")
    unit = to_unit(picture)                                  # float32 [H, W, C] in 0..1
    again = from_unit(unit, picture.channels, picture.pixels.dtype, picture.sample_range, picture.metadata)
    write(again, "out.png")

Pictures that need not fit into memory come and go in parts, and may be larger than `read` takes:

    with open_source("in.tif") as source, open_sink("out.tif", source.width, 512, "rgb", "uint8") as sink:
        sink.write_rows(0, source.read(0, 1000, source.width, 512).pixels)

What happens to each kind of input is told in docs/pictures.md. Names load on first use; OpenImageIO does with the first
file that needs it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .header import MAX_SAMPLES, Probe
    from .picture import LAYOUTS, Metadata, Picture, comparable, convert, from_unit, full_range, nodata_mask, to_unit
    from .placement import view as geo_view
    from .reader import probe, read
    from .sink import Sink, open_sink
    from .source import Source, open_source
    from .writer import write

__all__ = [
    "LAYOUTS",
    "MAX_SAMPLES",
    "Metadata",
    "Picture",
    "Probe",
    "Sink",
    "Source",
    "comparable",
    "convert",
    "from_unit",
    "full_range",
    "geo_view",
    "nodata_mask",
    "open_sink",
    "open_source",
    "probe",
    "read",
    "to_unit",
    "write",
]

_HOMES = {  # the module of each name, and what it is called there if not the same
    "LAYOUTS": "picture",
    "MAX_SAMPLES": "header",
    "Metadata": "picture",
    "Picture": "picture",
    "Probe": "header",
    "Sink": "sink",
    "Source": "source",
    "comparable": "picture",
    "convert": "picture",
    "from_unit": "picture",
    "full_range": "picture",
    "geo_view": "placement.view",
    "nodata_mask": "picture",
    "open_sink": "sink",
    "open_source": "source",
    "probe": "reader",
    "read": "reader",
    "to_unit": "picture",
    "write": "writer",
}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        home, _, other = _HOMES[name].partition(".")
        return getattr(import_module(f"sgicodec.image.{home}"), other or name)
    raise AttributeError(f"module 'sgicodec.image' has no attribute {name!r}")
