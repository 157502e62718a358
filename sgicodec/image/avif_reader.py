"""AVIF pictures: in 8 bits by Pillow's libavif; in more, which Pillow would round to 8, by that of imagecodecs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import MissingExtraError, PictureError, require
from sgicodec.image.decoded_picture import DecodedPicture, stated_metadata, stretched
from sgicodec.image.pages import check_page
from sgicodec.metadata import avif
from sgicodec.metadata.filebytes import FileBytes
from sgicodec.metadata.orientation import is_sideways, upright
from sgicodec.picture import Metadata


class AvifReader(DecodedPicture):
    """An open file: its primary picture, cropped and turned as the file says; 10 and 12 bits become 16."""

    kind = "avif by libavif"
    in_library = 5

    def __init__(self, path: Path, page: int | None = None) -> None:
        """page: of a sequence, from 1, the first if None.

        Raises PictureError for what libavif does not read, UsageError for a page that is not there, MissingExtraError
        without a library.
        """
        self._path, self._index = path, (page or 1) - 1
        with path.open("rb") as file:
            self._still = avif.still(FileBytes(file))
        self.turned, self.bits = self._still.orientation, self._still.bits
        self._check_libraries()
        from PIL.AvifImagePlugin import AvifImageFile

        try:
            self._image = AvifImageFile(path)  # Image.open would count pixels by its own limit
        except Exception as error:  # Pillow's readers raise what they like
            raise PictureError(self._damage(error)) from error
        if self._image.size != (self._still.width, self._still.height):
            raise PictureError("the file is damaged: it states two sizes of its picture")
        self.pages = self._image.n_frames
        check_page(page, self.pages)
        self._image.seek(self._index)

    def _check_libraries(self) -> None:
        require("PIL", "reading it")
        if self.bits > 8:
            require("imagecodecs", f"reading its {self.bits} bits", "avif")
        from PIL import features

        if not features.check("avif"):
            raise MissingExtraError("reading it needs a pillow that holds libavif: pip install 'pillow>=11.3'")

    def _shape(self) -> tuple[int, int, int, str]:
        width, height = self._still.crop[2:]
        if is_sideways(self._still.orientation):
            width, height = height, width
        return width, height, len(self._channels()), "uint8" if self.bits == 8 else "uint16"

    def _channels(self) -> list[int]:
        """Which of R, G, B and alpha it has; of gray, R alone."""
        has_alpha = self._image.mode.endswith("A")
        return [*([0] if self._still.is_gray else [0, 1, 2]), *([3] if has_alpha else [])]

    def _decoded(self) -> npt.NDArray[Any]:
        """Decoders undo a multiplication by alpha."""
        pixels = np.asarray(self._image) if self.bits == 8 else self._deep()
        pixels = pixels.reshape(self._still.height, self._still.width, -1)
        if pixels.shape[2] > len(self._channels()):  # libavif makes colours of gray where there is alpha
            pixels = pixels[..., self._channels()]
        x, y, width, height = self._still.crop
        return upright(pixels[y : y + height, x : x + width], self._still.orientation)

    def _deep(self) -> npt.NDArray[Any]:
        import imagecodecs

        return stretched(imagecodecs.avif_decode(self._path.read_bytes(), index=self._index), self.bits)

    def metadata(self) -> Metadata:
        """ICC profile, EXIF and XMP. The file's own turns count (ISO/IEC 23000-22), not the orientation in these."""
        return stated_metadata(self._image.info)

    def close(self) -> None:
        """Close the file."""
        self._image.close()
