"""Animated JPEG XL, of which OpenImageIO gives the last frame: the first, by the libjxl of imagecodecs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from sgicodec.errors import MissingExtraError, PictureError, require
from sgicodec.image.decoded_picture import DecodedPicture, stretched

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

_SAMPLES = {"uint8": "uint8", "uint16": "uint16", "half": "float16", "float": "float32"}


class JpegXlReader(DecodedPicture):
    """An open file: its first frame, turned upright."""

    kind = "jpegxl"
    in_library = 6

    def __init__(self, path: Path, header: ImageSpec, bits: int) -> None:
        """header: OpenImageIO's; bits: of a sample, 0 if not known. Raises PictureError without imagecodecs."""
        try:
            require("imagecodecs", "reading its first frame", "avif")
        except MissingExtraError as error:
            raise PictureError(f"it is an animation; {error}") from None
        self._path, self._header = path, header
        self._stored = bits if str(header.format) == "uint16" else 8
        if not 8 <= self._stored <= 16 or str(header.format) not in _SAMPLES:
            raise PictureError("its frames have samples that are not read; save the first as a file")

    def _shape(self) -> tuple[int, int, int, str]:
        header = self._header
        return header.width, header.height, header.nchannels, _SAMPLES[str(header.format)]

    def spec(self) -> ImageSpec:
        """The header."""
        return self._header

    def _decoded(self) -> npt.NDArray[Any]:
        import imagecodecs

        return stretched(imagecodecs.jpegxl_decode(self._path.read_bytes(), index=0), self._stored)

    def left_behind(self) -> list[str]:
        """The other frames."""
        return ["frames after the first"]
