"""Pictures that OpenImageIO cannot read, or not faithfully, by Pillow."""

from __future__ import annotations

import itertools
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import PictureError, UsageError, require
from sgicodec.image.decoded_picture import DecodedPicture
from sgicodec.image.pages import check_page

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

_FORMATS = (
    "WEBP",
    "BMP",
    "DIB",
    "QOI",
    "XBM",
    "XPM",
    "PCX",
    "DCX",
    "ICO",
    "CUR",
    "ICNS",
    "MSP",
    "SUN",
    "TGA",
    "JPEG2000",
)
"""Those that Pillow reads whole and faithfully, in 8 bits. Damage in others is OpenImageIO's to find."""

_SIGNATURES = {
    "QOI": (b"qoif",),
    "XBM": (b"#define",),
    "XPM": (b"/* XPM */",),
    "PCX": (b"\n\0\1", b"\n\2\1", b"\n\3\1", b"\n\5\1"),
    "DCX": (b"\xb1\x68\xde\x3a",),
    "ICO": (b"\0\0\1\0",),
    "ICNS": (b"icns",),
    "MSP": (b"DanM", b"LinS"),
    "SUN": (b"\x59\xa6\x6a\x95",),
}
"""How files begin that are Pillow's whatever they are called. Cursors begin as Targa does."""

_FURTHER = ("GIF", "PNG")
"""Those of which it shows the pages after the first, whose pixels OpenImageIO does not put together."""
_PAGED = ("DCX", "WEBP", *_FURTHER)
"""Those of which it shows more than the first page."""

_COUNTS = {"L": 1, "LA": 2, "RGB": 3, "RGBA": 4}


def is_for_pillow(head: bytes) -> bool:
    """Whether a file that begins so is one for Pillow, which OpenImageIO would take for what its name says."""
    return head.startswith(tuple(itertools.chain.from_iterable(_SIGNATURES.values())))


class PillowReader(DecodedPicture):
    """An open picture in a format that Pillow knows."""

    kind = "pillow"

    def __init__(self, path: Path, page: int | None = None) -> None:
        """page: from 1, the first if None. Raises PictureError for what Pillow does not read either, UsageError for a
        page that is not there.
        """
        require("PIL", "reading this picture")
        from PIL import Image, UnidentifiedImageError

        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", Image.DecompressionBombWarning)
                self._image = Image.open(path, formats=_FORMATS + _FURTHER * ((page or 1) > 1))
            self.pages = getattr(self._image, "n_frames", 1) if self._image.format in _PAGED else 1
            self.in_library = 4 if self.pages > 1 else 2
            check_page(page, self.pages)
            if page is not None:
                self._image.seek(page - 1)
            if self._image.format == "ICNS":
                self._image.load()  # its size counts points before, not pixels
        except UsageError:
            raise
        except UnidentifiedImageError:
            raise PictureError("it is in no picture format that OpenImageIO or Pillow reads") from None
        except Exception as error:  # Pillow's readers raise what they like
            raise PictureError(self._damage(error)) from error
        self._mode = self._mode_of_pixels()

    def _mode_of_pixels(self) -> str:
        """A palette becomes what it shows, and inks become RGB by the formula that OpenImageIO has for them."""
        mode = self._image.mode
        if self._image.format == "GIF":
            return "RGBA"  # as OpenImageIO has its first page
        if mode == "CMYK":
            return "RGB"
        if mode == "P":
            return "RGBA" if "transparency" in self._image.info else "RGB"
        mode = "L" if mode == "1" else mode
        if mode not in _COUNTS:
            raise PictureError(f"its pixels are of Pillow's mode {mode}, which cannot be read")
        return mode

    def _shape(self) -> tuple[int, int, int, str]:
        return self._image.width, self._image.height, _COUNTS[self._mode], "uint8"

    def spec(self) -> ImageSpec:
        """The header, with the ICC profile."""
        spec, icc = super().spec(), self._image.info.get("icc_profile")
        if icc:
            spec.attribute("ICCProfile", f"uint8[{len(icc)}]", np.frombuffer(icc, np.uint8))
        return spec

    def _decoded(self) -> npt.NDArray[Any]:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # of an icon that is larger or smaller than stated
            return np.asarray(self._image if self._image.mode == self._mode else self._image.convert(self._mode))

    def close(self) -> None:
        """Close the file."""
        self._image.close()
