"""Slides that OpenImageIO reads wrongly or not at all, by OpenSlide."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import PictureError, require
from sgicodec.image.decoded_picture import Reader
from sgicodec.metadata import geo, ifd
from sgicodec.metadata.filebytes import FileBytes
from sgicodec.metadata.stacks import resolution_tags
from sgicodec.metadata.tiff import DESCRIPTION
from sgicodec.picture import Metadata

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

_SUFFIXES = (".ndpi", ".scn", ".bif", ".mrxs", ".vms", ".vmu", ".svslide", ".czi")
"""Files that seem to be something else: of many the first picture is a small one, or the label."""

_OTHERS = {".vms": b"[", ".vmu": b"[", ".czi": b"ZISRAWFILE"}
"""How those begin that are no TIFF."""

_COMPRESSION, _JPEG_2000 = 259, (33003, 33005)
"""Of Aperio's files, which OpenImageIO reads otherwise."""

_TILE = 512
_ASCII = 2


def is_slide(path: Path) -> bool:
    """Whether a file is one that OpenSlide should read, by its name and how it begins; an Aperio file by how it is
    compressed.
    """
    suffix = path.suffix.lower()
    if suffix not in (*_SUFFIXES, ".svs"):
        return False
    with path.open("rb") as file:
        data = FileBytes(file)
        if suffix == ".mrxs":
            return path.with_suffix("").is_dir()  # the slide; the file is a JPEG
        if suffix in _OTHERS:
            return bytes(data[: len(_OTHERS[suffix])]) == _OTHERS[suffix]
        if suffix != ".svs":
            return ifd.layout(data) is not None
        entry = ifd.entries(data, {_COMPRESSION}).get(_COMPRESSION)
    return entry is not None and entry.short in _JPEG_2000


class SlideReader(Reader):
    """An open slide: its largest level in RGB, on white or the slide's own background, as far as it was scanned."""

    kind = "openslide"

    def __init__(self, path: Path) -> None:
        """Raises PictureError for what OpenSlide does not read."""
        self._slide = _opened(path)
        properties = self._slide.properties
        names = [f"openslide.bounds-{name}" for name in ("x", "y", "width", "height")]
        bounds: tuple[int, ...] = (0, 0, *self._slide.dimensions)
        if all(name in properties for name in names):
            bounds = tuple(int(properties[name]) for name in names)
        self._x, self._y, self._width, self._height = bounds
        self._background = "#" + properties.get("openslide.background-color", "ffffff")

    def metadata(self) -> Metadata:
        """Size of a pixel, magnification of the objective, vendor, and the ICC profile. Label, macro and texts stay
        behind: they may name the patient.
        """
        properties = self._slide.properties
        sizes = [properties.get(f"openslide.mpp-{axis}") for axis in "xy"]
        profile = self._slide.color_profile
        icc = None if profile is None else profile.tobytes()
        return Metadata(icc=icc, exif=_description(properties), geo=geo.pack(resolution_tags(sizes)))

    def left_behind(self) -> list[str]:
        """Pictures beside the slide: its label, macro and thumbnail."""
        return sorted(self._slide.associated_images)

    def spec(self) -> ImageSpec:
        """The header in OpenImageIO's terms."""
        import OpenImageIO as oiio

        spec = oiio.ImageSpec(self._width, self._height, 3, oiio.TypeDesc("uint8"))
        spec.tile_width = spec.tile_height = _TILE
        return spec

    def read_tiles(self, _: int, __: int, *where: Any) -> npt.NDArray[np.uint8]:
        """Pixels [h, w, 3] from column where[0] to where[1], row where[2] to where[3]. Raises PictureError."""
        import openslide

        left, right, top, bottom = where[:4]
        size = (right - left, bottom - top)
        try:
            region = self._slide.read_region((self._x + left, self._y + top), 0, size)
        except openslide.OpenSlideError as error:
            raise PictureError(_reason(error)) from error
        return _on(region, self._background)

    def close(self) -> None:
        """Close the file."""
        self._slide.close()


def _opened(path: Path) -> Any:
    """An `OpenSlide`."""
    require("openslide", "reading this slide", "slides")
    import openslide

    try:
        return openslide.OpenSlide(path)
    except openslide.OpenSlideUnsupportedFormatError:
        raise PictureError(f"{path}: it is no slide that OpenSlide reads") from None
    except openslide.OpenSlideError as error:
        raise PictureError(f"{path}: {_reason(error)}") from error


def _on(image: Any, background: str) -> npt.NDArray[np.uint8]:
    """Pixels [h, w, 3] of an image of Pillow with alpha, on a colour."""
    from PIL import Image

    ground = Image.new("RGB", image.size, background)
    ground.paste(image, None, image)
    return np.asarray(ground)


def _description(properties: Mapping[str, str]) -> bytes | None:
    """An EXIF blob whose description states the magnification as Aperio's does, or None where it is not known."""
    power = properties.get("openslide.objective-power", "")
    if not re.fullmatch(r"[0-9]{1,4}(\.[0-9]{1,4})?", power):
        return None
    vendor = re.sub(r"[^a-z0-9-]", "", properties.get("openslide.vendor", ""))[:40]
    text = f"{vendor}|AppMag = {power}".encode() + b"\0"
    return b"II*\0\x08\0\0\0" + ifd.dump({DESCRIPTION: ifd.Entry(_ASCII, text)}, 8)


def _reason(error: Exception) -> str:
    return " ".join(f"OpenSlide cannot read it: {error}".split())
