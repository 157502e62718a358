"""The codecs that sgi is measured against, each at its strongest reasonable setting for PSNR.

JPEG, WebP, AVIF and JPEG 2000 come with pillow, JPEG XL with imagecodecs; both belong to the extra `bench`.
The ladders span about 0.1 to 1.2 bits per pixel on photographs of the size of the Kodak set.
"""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from sgicodec.bench.codec import Codec, Pixels8, RoundTrip, timed
from sgicodec.errors import PictureError, UsageError, require

__all__ = ["PEERS", "Avif", "Jpeg", "Jpeg2000", "JpegXl", "Peer", "WebP", "find_peers"]


class Peer(ABC):
    """A codec that runs in this process, on arrays."""

    name: ClassVar[str]
    ladder: tuple[float, ...]

    @abstractmethod
    def version(self) -> str: ...

    @abstractmethod
    def settings(self, quality: float) -> str: ...

    @abstractmethod
    def encode(self, pixels: Pixels8, quality: float) -> bytes: ...

    @abstractmethod
    def decode(self, data: bytes) -> Pixels8: ...

    def round_trip(self, pixels: Pixels8, quality: float) -> RoundTrip:
        """Encode and decode in memory. Raises PictureError if the codec refuses the picture."""
        try:
            data, encode_seconds = timed(lambda: self.encode(pixels, quality))
            decoded, decode_seconds = timed(lambda: self.decode(data))
        except (OSError, ValueError, RuntimeError) as error:
            size = f"{pixels.shape[1]}x{pixels.shape[0]}"
            raise PictureError(f"{self.name} cannot code a picture of {size} pixels: {error}") from error
        return RoundTrip(data, decoded, encode_seconds, decode_seconds)


@dataclass(frozen=True)
class Jpeg(Peer):
    """Baseline JPEG's progressive form by libjpeg-turbo: 4:2:0, optimised Huffman tables."""

    name: ClassVar[str] = "jpeg"
    ladder: tuple[float, ...] = (4, 7, 11, 18, 30, 48, 70, 88)

    def version(self) -> str:
        return _pillow_version(self.name, "libjpeg_turbo", "libjpeg-turbo")

    def settings(self, quality: float) -> str:
        return f"quality={round(quality)} 4:2:0 optimise progressive"

    def encode(self, pixels: Pixels8, quality: float) -> bytes:
        options = {"subsampling": "4:2:0", "optimize": True, "progressive": True}
        return _pillow_encode(pixels, "JPEG", quality=round(quality), **options)

    def decode(self, data: bytes) -> Pixels8:
        return _pillow_decode(data)


@dataclass(frozen=True)
class WebP(Peer):
    """Lossy WebP by libwebp at its slowest method; the format is 4:2:0 only."""

    name: ClassVar[str] = "webp"
    ladder: tuple[float, ...] = (0, 4, 12, 25, 45, 68, 82, 92)

    def version(self) -> str:
        return _pillow_version(self.name, "webp", "libwebp")

    def settings(self, quality: float) -> str:
        return f"quality={round(quality)} method=6"

    def encode(self, pixels: Pixels8, quality: float) -> bytes:
        return _pillow_encode(pixels, "WEBP", quality=round(quality), method=6)

    def decode(self, data: bytes) -> Pixels8:
        return _pillow_decode(data)


@dataclass(frozen=True)
class Avif(Peer):
    """AVIF by libaom at speed 6, 4:4:4.

    One tile, or with `tiled` as many as libavif finds right for the size.

    Tuned for PSNR, because libavif's default since libaom 3.12 tunes for an image-quality model and would
    enter a comparison by PSNR with a handicap. Decodes with dav1d, whose thread count pillow does not
    offer.
    """

    name: ClassVar[str] = "avif"
    ladder: tuple[float, ...] = (2, 8, 16, 26, 38, 52, 68, 85)
    threads: int = 1
    tiled: bool = False

    def version(self) -> str:
        libavif = _pillow_version(self.name, "avif", "libavif")
        from PIL import _avif

        if not _avif.encoder_codec_available("aom"):
            raise UsageError("avif needs a pillow that encodes with libaom: pip install 'sgicodec[bench]'")
        return f"{libavif}, {_avif.codec_versions()}"

    def settings(self, quality: float) -> str:
        tiles = "auto" if self.tiled else "1"
        return f"quality={round(quality)} 4:4:4 aom speed=6 tune=psnr tiles={tiles} threads={self.threads}"

    def encode(self, pixels: Pixels8, quality: float) -> bytes:
        options: dict[str, Any] = {"subsampling": "4:4:4", "codec": "aom", "speed": 6, "autotiling": self.tiled}
        options |= {"advanced": {"tune": "psnr"}, "max_threads": self.threads}
        return _pillow_encode(pixels, "AVIF", quality=round(quality), **options)

    def decode(self, data: bytes) -> Pixels8:
        return _pillow_decode(data)


@dataclass(frozen=True)
class Jpeg2000(Peer):
    """JPEG 2000 by OpenJPEG: a bare codestream, 9/7 wavelet. Its quality is the target rate in bpp."""

    name: ClassVar[str] = "jpeg2000"
    ladder: tuple[float, ...] = (0.1, 0.15, 0.22, 0.33, 0.5, 0.7, 0.95, 1.3)

    def version(self) -> str:
        return _pillow_version(self.name, "jpg_2000", "openjpeg")

    def settings(self, quality: float) -> str:
        return f"bpp={quality:g} irreversible colour-transform"

    def encode(self, pixels: Pixels8, quality: float) -> bytes:
        options = {"irreversible": True, "mct": 1, "no_jp2": True}
        return _pillow_encode(pixels, "JPEG2000", quality_mode="rates", quality_layers=[24 / quality], **options)

    def decode(self, data: bytes) -> Pixels8:
        return _pillow_decode(data)


@dataclass(frozen=True)
class JpegXl(Peer):
    """JPEG XL by libjxl at effort 7. Its quality is the Butteraugli distance: less is better."""

    name: ClassVar[str] = "jxl"
    ladder: tuple[float, ...] = (25, 15, 9, 6, 4, 2.5, 1.6, 1.0)
    threads: int = 1

    def version(self) -> str:
        require("imagecodecs", self.name, "bench")
        import imagecodecs

        if not imagecodecs.JPEGXL.available:
            raise UsageError("jxl needs an imagecodecs that holds libjxl: pip install 'sgicodec[bench]'")
        return str(imagecodecs.jpegxl_version())

    def settings(self, quality: float) -> str:
        return f"distance={quality:g} effort=7 threads={self.threads}"

    def encode(self, pixels: Pixels8, quality: float) -> bytes:
        import imagecodecs

        return bytes(imagecodecs.jpegxl_encode(pixels, distance=quality, effort=7, numthreads=self.threads))

    def decode(self, data: bytes) -> Pixels8:
        import imagecodecs

        return np.asarray(imagecodecs.jpegxl_decode(data, numthreads=self.threads), np.uint8)


# In the order of their age, which is also the order of tables.
PEERS: dict[str, Callable[[int], Codec]] = {
    "jpeg": lambda threads: Jpeg(),
    "jpeg2000": lambda threads: Jpeg2000(),
    "webp": lambda threads: WebP(),
    "jxl": lambda threads: JpegXl(threads=threads),
    "avif": lambda threads: Avif(threads=threads),
}


def find_peers(names: Iterable[str], threads: int = 1) -> tuple[list[Codec], dict[str, str]]:
    """The named peers that can run here, and for each of the others the reason and the extra to install.

    Raises UsageError for a name that is none of `PEERS`.
    """
    found: list[Codec] = []
    missing: dict[str, str] = {}
    for name in names:
        if name not in PEERS:
            raise UsageError(f"no codec is called {name!r}; there are {', '.join(PEERS)}")
        peer = PEERS[name](threads)
        try:
            peer.version()
        except UsageError as error:
            missing[name] = str(error)
        else:
            found.append(peer)
    return found, missing


def _pillow_version(name: str, feature: str, library: str) -> str:
    require("PIL", name, "bench")
    import PIL
    from PIL import features

    if not features.check(feature):
        raise UsageError(f"{name} needs a pillow that holds {library}: pip install 'sgicodec[bench]'")
    return f"{library} {features.version(feature)} in pillow {PIL.__version__}"


def _pillow_encode(pixels: Pixels8, container: str, **options: Any) -> bytes:
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(pixels).save(buffer, container, **options)
    return buffer.getvalue()


def _pillow_decode(data: bytes) -> Pixels8:
    from PIL import Image

    try:
        with Image.open(io.BytesIO(data)) as picture:
            return np.asarray(picture.convert("RGB"))
    except Image.DecompressionBombError as error:
        raise ValueError(f"pillow refuses to open it: {error}") from error
