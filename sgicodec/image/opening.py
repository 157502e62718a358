"""Opening a picture file: by OpenImageIO, or by the library that reads what it cannot."""

from __future__ import annotations

import re
import struct
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sgicodec.errors import PictureError
from sgicodec.image.channels import Channels
from sgicodec.image.decoded_picture import DecodedPicture, Reader
from sgicodec.image.inks import Inks, extra_samples
from sgicodec.image.jpeg2000_reader import Jpeg2000Reader
from sgicodec.image.jpegxl_reader import JpegXlReader
from sgicodec.image.library import first_line
from sgicodec.image.pages import PageChoice
from sgicodec.image.pillow_reader import PillowReader, is_for_pillow
from sgicodec.image.planes import Planes
from sgicodec.image.silence import without_libpng
from sgicodec.image.tiff_reader import TiffReader, left_to_gdal
from sgicodec.metadata import jp2, png, webp
from sgicodec.metadata.filebytes import FileBytes

if TYPE_CHECKING:
    from OpenImageIO import ImageInput, ImageSpec

_UNKNOWN = "could not find a format reader"
"""What OpenImageIO says of formats that it does not know."""
_SAMPLE_FORMAT = re.compile(r"Invalid sampleformat value \((\d+)\) for (\d+) bits per sample")
_SAMPLE_FORMATS = {1: "integers", 2: "integers", 3: "floats", 5: "complex integers", 6: "complex numbers"}
_SIZE_LIMIT = "limits:imagesize_MB"
_LIFTING = threading.Lock()


@contextmanager
def no_size_limit() -> Iterator[None]:
    """OpenImageIO's own limit of sizes lifted."""
    import OpenImageIO as oiio

    with _LIFTING:
        limit = oiio.get_int_attribute(_SIZE_LIMIT)
        oiio.attribute(_SIZE_LIMIT, 0)
        try:
            yield
        finally:
            oiio.attribute(_SIZE_LIMIT, limit)


def open_image(path: Path, second: bool = False, page: int | None = None) -> ImageInput | DecodedPicture:
    """The opened file. second: by Pillow, which else is asked for what is in no format that OpenImageIO knows."""
    import OpenImageIO as oiio  # takes 30 ms: not for those who only decode to arrays

    with path.open("rb") as file:
        head = file.read(32)
    if second or is_for_pillow(head) or webp.is_animated(head):
        return PillowReader(path, page)
    hints = oiio.ImageSpec()
    hints.attribute("oiio:UnassociatedAlpha", 1)
    with without_libpng(head[:8] == png.SIGNATURE):
        image = oiio.ImageInput.open(str(path.absolute()), hints)  # "tif" alone would be the format of that name
    if image is None:
        said = complaint(oiio, path)
        if jp2.is_jpeg2000(head):
            return _jpeg2000(path)
        if _UNKNOWN in said or head[:2] == b"BM":
            return PillowReader(path, page)
        raise PictureError(_unread(said) or said or "it cannot be opened; the file is damaged or cut off")
    return image


def _jpeg2000(path: Path) -> DecodedPicture:
    """A JPEG 2000 file of two bands, of more than four, or without boxes, which OpenImageIO knows by its name alone."""
    try:
        with path.open("rb") as file:
            found = jp2.components(FileBytes(file))
    except struct.error:
        found = None
    if found is None:
        raise PictureError("it cannot be opened; the file is damaged or cut off")
    has_colours = len(found.depths) in (1, 3, 4) or (len(found.depths) == 2 and found.has_alpha)
    is_plain = has_colours and found.bits <= 8 and not found.is_deep
    return PillowReader(path) if is_plain else Jpeg2000Reader(path, found)


def _unread(said: str) -> str | None:
    """Which samples of a TIFF OpenImageIO does not read, by what it says of them; None if it says something else."""
    found = _SAMPLE_FORMAT.search(said)
    if found is None or int(found[1]) not in _SAMPLE_FORMATS:
        return None
    kind = _SAMPLE_FORMATS[int(found[1])]
    return f"its samples are {kind} of {found[2]} bits, which are not supported; convert them to 32-bit floats first"


def complaint(speaker: Any, path: Path) -> str:
    """What OpenImageIO has to say, without the path, or an empty text."""
    said = first_line(speaker)
    for name in (str(path.absolute()), str(path)):
        said = said.replace(f'("{name}")', "").replace(name, "the file")
    return said.strip()


def by_others(path: Path, data: FileBytes, image: Any, chosen: PageChoice, declared: Channels) -> Any:
    """What reads the samples of the page, where OpenImageIO has opened the file but does not read them rightly."""
    import OpenImageIO as oiio

    if not is_openimageio(image):
        return image
    if declared.deep and (found := jp2.components(data)) is not None:
        return Jpeg2000Reader(path, found, oiio.ImageSpec(image.spec()))
    if declared.frames_bits is not None:
        return JpegXlReader(path, oiio.ImageSpec(image.spec()), declared.frames_bits)
    if chosen.directory is None:
        return image
    image.seek_subimage(chosen.subimage, 0)
    spec = oiio.ImageSpec(image.spec())
    reason = left_to_gdal(data) or unread_floats(spec)
    if chosen.channels:
        return _planes(path, spec, reason, chosen)
    if reason is not None:
        image = TiffReader(path, chosen.subimage, spec, reason)
    extra = extra_samples(data, spec)
    return image if extra is None else Inks(image, spec, extra)


def unread_floats(spec: ImageSpec) -> str | None:
    """Why OpenImageIO does not read 64-bit floats: 3.2 returns garbage for those in tiles and in a single row."""
    if str(spec.format) != "double" or not (spec.tile_width or spec.height == 1):
        return None
    return f"its 64-bit floats are {'in tiles' if spec.tile_width else 'a single row'}"


def _planes(path: Path, spec: ImageSpec, reason: str | None, chosen: PageChoice) -> Planes:
    """Raises PictureError for what OpenImageIO does not read."""
    if reason is not None or spec.nchannels != 1:
        what = reason or f"its planes have {spec.nchannels} samples per pixel"
        raise PictureError(f"its channels are planes of their own, and {what}; save it as TIFF by Deflate")
    return Planes(lambda: open_image(path), spec, chosen.channels, chosen.names)


def is_openimageio(image: Any) -> bool:
    """Whether an opened picture is an `ImageInput` of OpenImageIO itself."""
    return not isinstance(image, Reader)
