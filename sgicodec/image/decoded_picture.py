"""Pictures that other libraries than OpenImageIO read, behind the interface of an `ImageInput`."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import PictureError
from sgicodec.metadata import exif
from sgicodec.picture import Metadata

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

_NAMES = {1: ("Y",), 2: ("Y", "A"), 3: ("R", "G", "B"), 4: ("R", "G", "B", "A")}


class Reader(ABC):
    """An open picture that another library reads."""

    kind: str
    """What stands for a format's name in OpenImageIO."""
    in_library = 0
    """How many times the size of all samples the library holds."""
    layout: str | None = None
    """That of a picture, where it does not follow from the header."""

    @abstractmethod
    def spec(self) -> ImageSpec:
        """The header in OpenImageIO's terms."""

    def metadata(self) -> Metadata:
        """That of the upright picture, as far as it is not found in the bytes of the file."""
        return Metadata()

    def left_behind(self) -> list[str]:
        """What is not kept, as far as it is not found in the bytes of the file."""
        return []

    def format_name(self) -> str:
        """As `kind`."""
        return self.kind

    def geterror(self) -> str:
        """Nothing: errors are raised."""
        return ""

    def close(self) -> None:  # noqa: B027
        """Close the file, if it is open."""


class DecodedPicture(Reader):
    """A picture whose pixels are decoded on first use, upright, and then kept."""

    pages: int = 1
    """How many pictures the file holds."""
    turned: int | None = None
    """The orientation that its library applied, if that is known."""
    bits: int = 0
    """Of stored samples, where that is known."""

    _pixels: npt.NDArray[Any] | None = None

    @abstractmethod
    def _shape(self) -> tuple[int, int, int, str]:
        """Width, height, number of channels, and the type of samples."""

    @abstractmethod
    def _decoded(self) -> npt.NDArray[Any]:
        """All samples [H, W, C] or, of gray, [H, W]. May raise what the library raises."""

    @property
    def associated(self) -> bool:
        """Whether colours come multiplied by alpha."""
        return False

    def spec(self) -> ImageSpec:
        """The header in OpenImageIO's terms."""
        import OpenImageIO as oiio

        width, height, channels, sample = self._shape()
        names = _NAMES[channels]
        spec = oiio.ImageSpec(width, height, channels, oiio.TypeDesc(sample))
        spec.channelnames = names
        spec.alpha_channel = names.index("A") if "A" in names else -1
        if self.bits:
            spec.attribute("oiio:BitsPerSample", self.bits)
        return spec

    def read_scanlines(self, _: int, __: int, top: int, bottom: int, *___: Any) -> npt.NDArray[Any]:
        """Rows [bottom − top, W, C]. Raises PictureError."""
        if self._pixels is None:
            width, height, channels, sample = self._shape()
            try:
                self._pixels = np.asarray(self._decoded(), sample).reshape(height, width, channels)
            except (MemoryError, PictureError):
                raise
            except Exception as error:  # readers raise what they like
                raise PictureError(self._damage(error)) from error
        return self._pixels[top:bottom]

    @staticmethod
    def _damage(error: Exception) -> str:
        text = error.args[0] if error.args else type(error).__name__
        said = text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text)
        return " ".join(f"the file is damaged or cut off: {said}".split())


def stretched(pixels: npt.NDArray[Any], bits: int) -> npt.NDArray[Any]:
    """Samples of so many bits; those between 8 and 16 as uint16, their largest value 65535."""
    if bits in (8, 16):
        return pixels
    return (pixels.astype(np.uint32) * 65535 // ((1 << bits) - 1)).astype(np.uint16)


def stated_metadata(info: Mapping[Any, Any]) -> Metadata:
    """ICC profile, EXIF and XMP by their names in Pillow."""
    blob, xmp = info.get("exif"), info.get("xmp")
    return Metadata(icc=info.get("icc_profile") or None, exif=exif.plain(blob) if blob else None, xmp=xmp or None)
