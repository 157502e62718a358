"""Pictures in and out of files: samples, colour profile, EXIF and XMP. The only user of OpenImageIO.

    picture = read("in.tif")
    unit = to_unit(picture)                                  # float32 [H, W, C] in 0..1
    again = from_unit(unit, picture.channels, picture.pixels.dtype, picture.sample_range, picture.metadata)
    write(again, "out.png")

What happens to each kind of input is told in docs/pictures.md. Importing this package does not import
OpenImageIO.
"""

from __future__ import annotations

from .picture import LAYOUTS, Metadata, Picture, convert, from_unit, full_range, to_unit
from .reader import MAX_SAMPLES, Probe, probe, read
from .writer import write

__all__ = [
    "LAYOUTS",
    "MAX_SAMPLES",
    "Metadata",
    "Picture",
    "Probe",
    "convert",
    "from_unit",
    "full_range",
    "probe",
    "read",
    "to_unit",
    "write",
]
