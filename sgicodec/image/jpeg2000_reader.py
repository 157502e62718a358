"""JPEG 2000 whose samples are signed, or deeper than 16 bits, by the OpenJPEG of imagecodecs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from sgicodec.errors import MissingExtraError, PictureError, require
from sgicodec.image.decoded_picture import DecodedPicture

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

__all__ = ["Jpeg2000Reader"]

_PROGRAM = "convert it first, as with gdal_translate IN a.tif"


class Jpeg2000Reader(DecodedPicture):
    """An open file: its samples as they are, one or three channels as gray or RGB, others as bands."""

    kind = "jpeg 2000 by openjpeg"
    in_library = 5

    def __init__(self, path: Path, header: ImageSpec) -> None:
        """header: OpenImageIO's, which shortens such samples. Raises PictureError without imagecodecs."""
        try:
            require("imagecodecs", "reading it", "avif")
        except MissingExtraError as error:
            text = f"its samples are signed or have more than 16 bits; {error}, or {_PROGRAM}"
            raise PictureError(text) from None
        self._path, self._header = path, header

    def _shape(self) -> tuple[int, int, int, str]:
        return self._header.width, self._header.height, self._header.nchannels, "float32"

    def spec(self) -> ImageSpec:
        """OpenImageIO's header, for floats and without alpha, which no signed samples are."""
        import OpenImageIO as oiio

        spec = oiio.ImageSpec(self._header)
        spec.set_format(oiio.TypeDesc("float"))
        spec.alpha_channel = -1
        if spec.nchannels not in (1, 3):
            spec.channelnames = tuple(f"band{band}" for band in range(spec.nchannels))
        return spec

    def _decoded(self) -> npt.NDArray[Any]:
        import imagecodecs

        return imagecodecs.jpeg2k_decode(self._path.read_bytes())
