"""The codecs that sgi is measured against: as people use them, and at their strongest reasonable setting for PSNR.

JPEG, WebP, AVIF and JPEG 2000 come with pillow, JPEG XL with imagecodecs: the extra `bench`. The ladders span about 0.1
to 2.5 bits per pixel on photographs of the size of the Kodak set, and SSIMULACRA 2 from 20 to 85 where the codec can.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sgicodec.bench.codec import Pixels8, RoundTrip, timed
from sgicodec.errors import PictureError, UsageError, require


@dataclass(frozen=True)
class Pillow:
    """A codec of pillow: its name there, the feature that pillow needs for it and the library behind."""

    container: str
    feature: str
    library: str

    def version(self, name: str) -> str:
        """Raises UsageError if it is missing."""
        require("PIL", name, "bench")
        import PIL
        from PIL import features

        if not features.check(self.feature):
            raise UsageError(f"{name} needs a pillow that holds {self.library}: pip install 'sgicodec[bench]'")
        found = f"{self.library} {features.version(self.feature)} in pillow {PIL.__version__}"
        return found + (_avif_codecs(name) if self.container == "AVIF" else "")

    def encode(self, pixels: Pixels8, **options: Any) -> bytes:
        from PIL import Image

        buffer = io.BytesIO()
        Image.fromarray(pixels).save(buffer, self.container, **options)
        return buffer.getvalue()

    def decode(self, data: bytes, threads: int) -> Pixels8:
        """By as many threads as pillow takes."""
        from PIL import Image

        try:
            with Image.open(io.BytesIO(data)) as picture:
                return np.asarray(picture.convert("RGB"))
        except Image.DecompressionBombError as error:
            raise ValueError(f"pillow refuses to open it: {error}") from error


def _avif_codecs(name: str) -> str:
    from PIL import _avif

    if not _avif.encoder_codec_available("aom"):
        raise UsageError(f"{name} needs a pillow that encodes with libaom: pip install 'sgicodec[bench]'")
    return f", {_avif.codec_versions()}"


class LibJxl:
    """The libjxl of imagecodecs."""

    def version(self, name: str) -> str:
        """Raises UsageError if it is missing."""
        require("imagecodecs", name, "bench")
        import imagecodecs

        if not imagecodecs.JPEGXL.available:
            raise UsageError(f"{name} needs an imagecodecs that holds libjxl: pip install 'sgicodec[bench]'")
        return str(imagecodecs.jpegxl_version())

    def encode(self, pixels: Pixels8, **options: Any) -> bytes:
        import imagecodecs

        return bytes(imagecodecs.jpegxl_encode(pixels, **options))

    def decode(self, data: bytes, threads: int) -> Pixels8:
        import imagecodecs

        return np.asarray(imagecodecs.jpegxl_decode(data, numthreads=threads), np.uint8)


@dataclass(frozen=True)
class Peer:
    """A codec that runs in this process, on arrays.

    scale: its qualities by rising rate, for searches. stated: its settings, as a format of `quality` and `threads`.
    options: the same, as its library takes them.
    """

    name: str
    library: Pillow | LibJxl
    scale: Sequence[float]
    ladder: tuple[float, ...]
    stated: str
    options: Callable[[float, int], dict[str, Any]]
    threads: int = 1

    def version(self) -> str:
        """That of its library. Raises UsageError if it is missing."""
        return self.library.version(self.name)

    def settings(self, quality: float) -> str:
        """`stated` for a quality."""
        return self.stated.format(quality=quality, threads=self.threads)

    def encode(self, pixels: Pixels8, quality: float) -> bytes:
        return self.library.encode(pixels, **self.options(quality, self.threads))

    def decode(self, data: bytes) -> Pixels8:
        return self.library.decode(data, self.threads)

    def round_trip(self, pixels: Pixels8, quality: float) -> RoundTrip:
        """Encode and decode in memory. Raises PictureError if the codec refuses the picture."""
        try:
            data, encode_seconds = timed(lambda: self.encode(pixels, quality))
            decoded, decode_seconds = timed(lambda: self.decode(data))
        except (OSError, ValueError, RuntimeError) as error:
            size = f"{pixels.shape[1]}x{pixels.shape[0]}"
            raise PictureError(f"{self.name} cannot code a picture of {size} pixels: {error}") from error
        return RoundTrip(data, decoded, encode_seconds, decode_seconds)


_JPEG_2000 = {"irreversible": True, "mct": 1, "no_jp2": True, "quality_mode": "rates"}
_PSNR_LADDER, _IQ_LADDER = (2, 8, 16, 26, 38, 52, 66, 79, 90), (2, 10, 20, 32, 45, 58, 70, 82, 92)


def _avif(name: str, speed: int, tune: str, ladder: tuple[float, ...]) -> Peer:
    """AVIF by libaom, 4:4:4, as avifenc codes a PNG. Decodes with dav1d, whose thread count pillow does not offer.

    Tuned for PSNR, because libavif's default since libaom 3.12, `iq`, tunes for an image-quality model and would enter
    a comparison by PSNR with a handicap; or for that, as libavif ships it.
    """
    coding = {"subsampling": "4:4:4", "codec": "aom", "speed": speed, "autotiling": False, "advanced": {"tune": tune}}
    stated = f"quality={{quality:.0f}} 4:4:4 aom speed={speed} tune={tune} tiles=1 threads={{threads}}"
    library = Pillow("AVIF", "avif", "libavif")
    return Peer(
        name, library, range(100), ladder, stated, lambda q, n: coding | {"quality": round(q), "max_threads": n}
    )


PEERS = {
    peer.name: peer
    for peer in (
        Peer(
            "jpeg",
            Pillow("JPEG", "libjpeg_turbo", "libjpeg-turbo"),
            range(1, 96),
            (4, 7, 11, 18, 30, 48, 70, 85, 93),
            "quality={quality:.0f} 4:2:0 optimise progressive",
            lambda q, _: {"quality": round(q), "subsampling": "4:2:0", "optimize": True, "progressive": True},
        ),
        Peer(
            "jpeg2000",  # a bare codestream, 9/7 wavelet; its quality is the target rate in bpp
            Pillow("JPEG2000", "jpg_2000", "openjpeg"),
            tuple(0.02 * 1.01**step for step in range(600)),
            (0.1, 0.15, 0.22, 0.33, 0.5, 0.8, 1.3, 2.5),
            "bpp={quality:g} irreversible colour-transform",
            lambda q, _: _JPEG_2000 | {"quality_layers": [24 / q]},
        ),
        Peer(
            "webp",  # lossy at its slowest method; the format is 4:2:0 only
            Pillow("WEBP", "webp", "libwebp"),
            range(101),
            (0, 4, 12, 25, 45, 68, 82, 91, 96),
            "quality={quality:.0f} method=6",
            lambda q, _: {"quality": round(q), "method": 6},
        ),
        Peer(
            "jxl",  # its quality is the Butteraugli distance: less is better
            LibJxl(),
            tuple(round(25 / 1.01**step, 3) for step in range(550)),
            (25, 15, 9, 6, 4, 2.5, 1.6, 1.0, 0.6),
            "distance={quality:g} effort=7 threads={threads}",
            lambda q, n: {"distance": q, "effort": 7, "numthreads": n},
        ),
        _avif("avif-iq", 6, "iq", _IQ_LADDER),
        _avif("avif-iq-s2", 2, "iq", _IQ_LADDER),
        _avif("avif", 6, "psnr", _PSNR_LADDER),
        _avif("avif-s2", 2, "psnr", _PSNR_LADDER),  # what it can do for PSNR when time counts little
    )
}
"""In the order of the formats' age, which is also the order of tables."""


def find_peers(names: Iterable[str], threads: int = 1) -> tuple[list[Peer], dict[str, str]]:
    """The named peers that can run here, and for each of the others the reason and the extra to install.

    Raises UsageError for a name that is none of `PEERS`.
    """
    found: list[Peer] = []
    missing: dict[str, str] = {}
    for name in names:
        if name not in PEERS:
            raise UsageError(f"no codec is called {name!r}; there are {', '.join(PEERS)}")
        peer = replace(PEERS[name], threads=threads)
        try:
            peer.version()
        except UsageError as error:
            missing[name] = str(error)
        else:
            found.append(peer)
    return found, missing
