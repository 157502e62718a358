"""Pictures in and out of files. The only user of OpenImageIO.

    picture = read("in.tif")
    unit = to_unit(picture)                                  # float32 [H, W, C] in 0..1
    again = from_unit(unit, picture.channels, picture.pixels.dtype, picture.sample_range, picture.metadata)
    write(again, "out.png")

Pictures that need not fit into memory come and go in parts, and may be larger than `read` takes:

    with open_source("in.tif") as source, open_sink("out.tif", source.width, 512, "rgb", "uint8") as sink:
        sink.write_rows(0, source.read(0, 1000, source.width, 512).pixels)

docs/pictures.md says what happens to each kind of input. Names load on first use; OpenImageIO does with the first
file that needs it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sgicodec.image.header import MAX_SAMPLES, Probe
    from sgicodec.image.opened import Alpha
    from sgicodec.image.reader import probe, read
    from sgicodec.image.sink import Sink, open_sink
    from sgicodec.image.source import Source, open_source
    from sgicodec.image.writer import write

__all__ = ["MAX_SAMPLES", "Alpha", "Probe", "Sink", "Source", "open_sink", "open_source", "probe", "read", "write"]

_HOMES = {
    "MAX_SAMPLES": "header",
    "Alpha": "opened",
    "Probe": "header",
    "Sink": "sink",
    "Source": "source",
    "open_sink": "sink",
    "open_source": "source",
    "probe": "reader",
    "read": "reader",
    "write": "writer",
}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f"sgicodec.image.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'sgicodec.image' has no attribute {name!r}")
