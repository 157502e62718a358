"""Streams in Pillow, once this module is imported: `Image.open`, `draft`, `thumbnail`, `save(format="SGICODEC")`.

Pillow does not find plug-ins itself. Its own `.sgi`, that of Silicon Graphics, opens and saves as before: files are
told apart by their first bytes; a name that ends in .sgi is saved as a stream only after `register(extension=True)`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import IO, Any

from sgicodec.errors import SgiError, UsageError, require

require("PIL", "the plugin for Pillow")

from PIL import ExifTags, Image, ImageFile  # noqa: E402

from sgicodec.bitstream.container import SIGNATURE  # noqa: E402
from sgicodec.decoder.stream import Stream, open_stream  # noqa: E402
from sgicodec.metadata import embedded, exif  # noqa: E402
from sgicodec.metadata.blobs import Metadata  # noqa: E402
from sgicodec.metadata.density import density  # noqa: E402

FORMAT = "SGICODEC"

_MODES = {"gray": "L", "gray+alpha": "LA", "rgb": "RGB", "rgba": "RGBA"}
_DEEP_MODES = {"uint16": "I;16", "float32": "F"}
"""Modes of gray. Pillow has none for colours of more than 8 bits, which are rendered in 8."""


class SgiImageFile(ImageFile.ImageFile):
    """An opened stream: size, mode and metadata at once, pixels on `load`, in the size that `draft` was asked for."""

    format = FORMAT
    format_description = "sgicodec: structured 2D Gaussians"

    def _open(self) -> None:
        """Raises OSError, as Pillow's own plugins do."""
        self._stream: Stream | None = None
        try:
            stream = open_stream(self.fp)
        except SgiError as error:
            raise OSError(str(error)) from error
        header = stream.header
        if header.channels not in _MODES:
            raise OSError(f"{header.spec.channels} bands without a meaning have no mode in Pillow; use sgicodec.open")
        self._size = (stream.width, stream.height)
        self._dtype = str(stream.dtype) if header.channels == "gray" else "uint8"
        self._mode = _DEEP_MODES.get(self._dtype, _MODES[header.channels])
        metadata = stream.metadata
        blob = metadata.exif and exif.PREFIX + metadata.exif
        stated = density(metadata.geo, metadata.exif)
        dpi = None if stated is None else stated.dpi
        found = {"icc_profile": metadata.icc, "exif": blob, "xmp": metadata.xmp, "dpi": dpi}
        self.info.update({name: blob for name, blob in found.items() if blob is not None})
        self._stream = stream

    def draft(self, mode: str | None, size: tuple[int, int] | None) -> tuple[str, tuple[int, int, float, float]] | None:
        """Sets the size that is decoded to the smallest of the same aspect that `size` fits into; the mode stays."""
        if self._stream is None or size is None:
            return None
        scale = max(wanted / side for wanted, side in zip(size, self.size, strict=True))
        if not 0 < scale < 1:
            return None
        self._size = (max(1, round(self.width * scale)), max(1, round(self.height * scale)))
        return self.mode, (0, 0, *self.size)

    def load(self) -> Any:
        """Decodes the pixels. Raises OSError for a stream that is damaged."""
        if self._stream is not None:
            try:
                pixels = self._stream.read(size=self.size, dtype=self._dtype)
            except SgiError as error:
                raise OSError(str(error)) from error
            self.im = Image.fromarray(pixels).im
            self._stream = None
            if self._exclusive_fp and self.fp is not None:
                self.fp.close()
            self.fp = None
        return Image.Image.load(self)


def _save(image: Image.Image, file: IO[bytes], filename: str | bytes) -> None:
    """Options are the settings of `sgicodec.encode`, and icc_profile, exif, xmp, dpi: by default the image's, b"" for
    none.

    The image is turned upright by the EXIF that is given, else by its own. Raises SgiError.
    """
    from sgicodec.encoder.one_call import encode
    from sgicodec.image.conversion import pillow_picture

    options = dict(image.encoderinfo)
    dpi = options.pop("dpi", None)
    given = {name: _blob(options.pop(name)) for name in ("icc_profile", "exif", "xmp") if name in options}
    own, stated = image.getexif().get(ExifTags.Base.Orientation), exif.orientation(given.get("exif"))
    picture = pillow_picture(image, turn=None if stated == own else stated, dpi=dpi)
    turn = stated or (own if own is not None and own in range(1, 9) else 1)
    found = Metadata(given.get("icc_profile"), given.get("exif"), given.get("xmp"))
    found = embedded.upright(found, turn, *image.size)
    blobs = {name: getattr(found, name) for name in ("icc", "exif", "xmp") if given.keys() & {name, f"{name}_profile"}}
    file.write(encode(replace(picture, metadata=replace(picture.metadata, **blobs)), **options))


def _blob(given: Any) -> bytes | None:
    """Metadata as Pillow takes it: bytes, a text, an `Image.Exif`, or None."""
    blob = given.tobytes() if isinstance(given, Image.Exif) else given
    return (blob.encode() if isinstance(blob, str) else blob or b"").removeprefix(exif.PREFIX) or None


def _save_all(image: Image.Image, file: IO[bytes], filename: str | bytes) -> None:
    raise UsageError("a stream holds one picture; save each frame as a stream of its own, without save_all")


def register(extension: bool = False) -> None:
    """Makes streams known to Pillow, which importing this module does. extension: that `.sgi` is saved as a stream,
    no longer as a picture of Silicon Graphics; both open in either case.
    """
    Image.register_open(FORMAT, SgiImageFile, lambda prefix: prefix.startswith(SIGNATURE))
    Image.register_save(FORMAT, _save)
    Image.register_save_all(FORMAT, _save_all)
    Image.register_mime(FORMAT, "image/x-sgicodec")
    if extension:
        Image.init()  # or Pillow's own plugin would take it back
        Image.register_extension(FORMAT, ".sgi")


register()
