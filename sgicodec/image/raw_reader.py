"""Raw files of cameras, developed by LibRaw."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy.typing as npt

from sgicodec.errors import PictureError, require
from sgicodec.image.decoded_picture import DecodedPicture
from sgicodec.image.pages import check_page
from sgicodec.image.silence import without_libraw

_SRGB_CURVE = (2.4, 12.92)
_TURNS = {0: 1, 3: 3, 5: 8, 6: 6}
"""Orientations by LibRaw's turns."""
_SIDEWAYS = 4
"""Of LibRaw's turns: rows become columns."""


class RawReader(DecodedPicture):
    """An open file, developed plainly: the camera's white balance, sRGB, 16 bits, no automatic brightness."""

    kind = "raw by libraw"
    in_library = 4

    def __init__(self, path: Path, page: int | None = None) -> None:
        """Raises PictureError for what LibRaw does not read, UsageError for another page than 1, MissingExtraError
        without LibRaw.
        """
        check_page(page, 1)
        require("rawpy", "reading it", "raw")
        import rawpy

        try:
            with without_libraw(path):
                self._raw = rawpy.imread(str(path))
        except rawpy.LibRawError as error:
            raise PictureError(self._damage(error)) from error
        self._path = path
        self.turned = _TURNS.get(self._raw.sizes.flip)

    def _shape(self) -> tuple[int, int, int, str]:
        sizes = self._raw.sizes
        width, height = sizes.iwidth, sizes.iheight
        return *((height, width) if sizes.flip & _SIDEWAYS else (width, height)), 3, "uint16"

    def _decoded(self) -> npt.NDArray[Any]:
        with without_libraw(self._path):
            return self._raw.postprocess(use_camera_wb=True, no_auto_bright=True, output_bps=16, gamma=_SRGB_CURVE)

    def close(self) -> None:
        """Close the file."""
        self._raw.close()
