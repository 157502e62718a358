"""Pictures that OpenImageIO cannot read, or not faithfully, by Pillow, behind the interface of an `ImageInput`."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import PictureError, require

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

__all__ = ["KIND", "SecondReader"]

KIND = "pillow"
"""What stands for a format's name in OpenImageIO."""

_FORMATS = ("BMP", "DIB", "QOI", "XBM", "XPM", "PCX", "DCX", "ICO", "CUR", "ICNS", "MSP", "SUN", "TGA")
"""Those that Pillow reads whole and faithfully, in 8 bits. Damage in others is OpenImageIO's to find."""

_CHANNELS = {"L": ("Y",), "LA": ("Y", "A"), "RGB": ("R", "G", "B"), "RGBA": ("R", "G", "B", "A")}


class SecondReader:
    """An open picture. Its pixels are decoded whole, on first use."""

    def __init__(self, path: Path) -> None:
        """Raises PictureError for what Pillow does not read either."""
        require("PIL", "reading this picture")
        from PIL import Image, UnidentifiedImageError

        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", Image.DecompressionBombWarning)
                self._image = Image.open(path, formats=_FORMATS)
        except UnidentifiedImageError:
            raise PictureError("it is in no picture format that OpenImageIO or Pillow reads") from None
        except Exception as error:  # Pillow's readers raise what they like
            raise PictureError(_reason(error)) from error
        self._mode = self._mode_of_pixels()
        self._pixels: npt.NDArray[np.uint8] | None = None

    def _mode_of_pixels(self) -> str:
        """A palette becomes what it shows."""
        mode = self._image.mode
        if mode == "P":
            return "RGBA" if "transparency" in self._image.info else "RGB"
        mode = "L" if mode == "1" else mode
        if mode not in _CHANNELS:
            raise PictureError(f"its pixels are of Pillow's mode {mode}, which cannot be read")
        return mode

    def spec(self) -> ImageSpec:
        """The header in OpenImageIO's terms."""
        import OpenImageIO as oiio

        names = _CHANNELS[self._mode]
        spec = oiio.ImageSpec(self._image.width, self._image.height, len(names), oiio.TypeDesc("uint8"))
        spec.channelnames = names
        spec.alpha_channel = names.index("A") if "A" in names else -1
        return spec

    def format_name(self) -> str:
        """Which says that it is none of OpenImageIO's."""
        return KIND

    def read_scanlines(self, _: int, __: int, top: int, bottom: int, *___: Any) -> npt.NDArray[np.uint8]:
        """Rows [bottom − top, W, C]. Raises PictureError."""
        if self._pixels is None:
            try:
                image = self._image if self._image.mode == self._mode else self._image.convert(self._mode)
                pixels = np.asarray(image)
            except MemoryError:
                raise
            except Exception as error:
                raise PictureError(_reason(error)) from error
            self._pixels = pixels.reshape(self._image.height, self._image.width, -1)
        return self._pixels[top:bottom]

    def geterror(self) -> str:
        """Nothing: errors are raised."""
        return ""

    def close(self) -> None:
        """Close the file."""
        self._image.close()


def _reason(error: Exception) -> str:
    return " ".join(f"the file is damaged or cut off: {error}".split())
