"""JPEG 2000 that OpenImageIO does not read, or not rightly, by the OpenJPEG of imagecodecs: samples that are signed or
have more than 16 bits, two bands or more than four, code streams without boxes.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from sgicodec.errors import MissingExtraError, PictureError, require
from sgicodec.image.decoded_picture import DecodedPicture
from sgicodec.metadata.jp2 import Components

if TYPE_CHECKING:
    from OpenImageIO import ImageSpec

_PROGRAM = "convert it first, as with gdal_translate IN a.tif"


class Jpeg2000Reader(DecodedPicture):
    """An open file: its samples as they are; one or three channels are gray or RGB, two gray and alpha if they are
    declared so, others bands.
    """

    kind = "jpeg 2000 by openjpeg"
    in_library = 5

    def __init__(self, path: Path, found: Components, header: ImageSpec | None = None) -> None:
        """header: OpenImageIO's, if it has one. Raises PictureError without imagecodecs."""
        try:
            require("imagecodecs", "reading it", "avif")
        except MissingExtraError as error:
            what = (
                "its samples are signed or have more than 16 bits"
                if found.is_deep
                else f"it has {len(found.depths)} bands"
            )
            raise PictureError(f"{what}; {error}, or {_PROGRAM}") from None
        self._path, self._found, self._header = path, found, header

    def _shape(self) -> tuple[int, int, int, str]:
        found = self._found
        return found.width, found.height, len(found.depths), found.sample

    def spec(self) -> ImageSpec:
        """The header; its last channel is alpha only beside gray, and where no samples are signed."""
        import OpenImageIO as oiio

        width, height, count, sample = self._shape()
        stored = oiio.TypeDesc(sample.removesuffix("32"))
        spec = oiio.ImageSpec(width, height, count, stored)
        if self._header is not None:
            spec = oiio.ImageSpec(self._header)
            spec.set_format(stored)
        spec.alpha_channel = 1 if count == 2 and self._found.has_alpha and not self._found.is_deep else -1
        if count not in (1, 3):
            spec.channelnames = tuple(f"band{band}" for band in range(count))
        return spec

    def _decoded(self) -> npt.NDArray[Any]:
        import imagecodecs

        return imagecodecs.jpeg2k_decode(self._path.read_bytes())
