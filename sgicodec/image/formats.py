"""The picture formats that can be written, and what each can hold without loss of depth or channels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

from sgicodec.errors import PictureError
from sgicodec.metadata.layouts import LAYOUTS

if TYPE_CHECKING:
    from sgicodec.image.header import Probe

_ALL = (*LAYOUTS, "multi")
_NO_ALPHA = ("gray", "rgb")
_DEPTH_NAMES = {"uint8": "8 bits", "uint16": "16 bits", "float32": "32-bit float"}


@dataclass(frozen=True)
class Format:
    """One format: its OpenImageIO name, file name extensions, sample types, layouts, and hints for its
    writer.

    associated: alpha is stored premultiplied, by the format's definition.
    piped: the writer's library fails badly where a file cannot grow, and goes through a pipe: libjpeg ends the process,
    that of WebP never ends.
    positive: samples have no sign, and are finite.
    in_library: how many times the size of all samples OpenImageIO's writer holds in memory; 0 if it needs a few rows.
    min_side: pixels.
    """

    name: str
    extensions: tuple[str, ...]
    dtypes: tuple[str, ...]
    layouts: tuple[str, ...]
    hints: Mapping[str, str | int] = field(default_factory=lambda: MappingProxyType({}))
    associated: bool = False
    in_library: int = 0
    piped: bool = False
    positive: bool = False
    min_side: int = 1

    def check(self, header: Probe) -> None:
        """Raise PictureError if the picture would lose depth or channels, or is too small."""
        if header.channels not in self.layouts:
            held = ", ".join("any bands" if layout == "multi" else layout for layout in self.layouts)
            bands = f"{header.count} bands" if header.channels == "multi" else header.channels
            raise PictureError(f"{self.name} cannot hold {bands}, only {held}; choose another format")
        if header.dtype.name not in self.dtypes:
            held = " or ".join(_DEPTH_NAMES[name] for name in self.dtypes)
            raise PictureError(
                f"{self.name} cannot hold {_DEPTH_NAMES[header.dtype.name]} per sample, only {held}; "
                "ask for that depth or choose another format"
            )
        if min(header.width, header.height) < self.min_side:
            raise PictureError(
                f"{self.name} cannot hold sides of fewer than {self.min_side} pixels; choose another format"
            )


_INTEGERS = ("uint8", "uint16")

FORMATS = (
    Format("png", ("png",), _INTEGERS, tuple(LAYOUTS)),
    Format("tiff", ("tif", "tiff"), (*_INTEGERS, "float32"), _ALL, {"compression": "zip", "tiff:write_exif": 0}),
    Format(
        "jpeg",
        ("jpg", "jpeg", "jpe"),
        ("uint8",),
        _NO_ALPHA,
        {"compression": "jpeg:95", "jpeg:subsampling": "4:4:4"},
        piped=True,
    ),
    Format(
        "webp",
        ("webp",),
        ("uint8",),
        ("rgb", "rgba"),
        {"compression": "lossless:50", "webp:method": 2},
        in_library=10,
        piped=True,
    ),
    Format("jpegxl", ("jxl",), _INTEGERS, ("gray", "rgb", "rgba"), {"compression": "jpegxl:100"}, in_library=11),
    Format("jpeg2000", ("jp2",), _INTEGERS, ("gray", "rgb", "rgba"), in_library=9, min_side=32),
    Format("openexr", ("exr",), ("float32",), _ALL, {"compression": "zip"}, associated=True),
    Format("hdr", ("hdr",), ("float32",), ("rgb",), positive=True),
    Format("pfm", ("pfm",), ("float32",), _NO_ALPHA),
    Format("pnm", ("ppm", "pnm"), _INTEGERS, _NO_ALPHA),
    Format("pgm", ("pgm",), _INTEGERS, ("gray",)),
    Format("targa", ("tga",), ("uint8",), tuple(LAYOUTS), {"compression": "rle"}),
    Format("bmp", ("bmp",), ("uint8",), ("gray", "rgb", "rgba")),
    Format("sgi", ("sgi", "rgb", "rgba", "bw"), _INTEGERS, tuple(LAYOUTS), {"compression": "rle"}, in_library=1),
)


def find(name: str) -> Format:
    """The format of that name or extension, in any case. Raises PictureError if there is none."""
    wanted = name.lower().removeprefix(".")
    for candidate in FORMATS:
        if wanted == candidate.name or wanted in candidate.extensions:
            return candidate
    known = ", ".join(candidate.extensions[0] for candidate in FORMATS)
    raise PictureError(f"{name!r} is no picture format that can be written; choose one of {known}")
