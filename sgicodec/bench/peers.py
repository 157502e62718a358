"""The codecs that sgi is measured against: as people use them, and at their strongest reasonable setting for PSNR.

JPEG, WebP, AVIF and JPEG 2000 come with pillow, JPEG XL with imagecodecs: the extra `bench`. The ladders span about 0.1
to 2.5 bits per pixel on photographs of the size of the Kodak set, and SSIMULACRA 2 from 20 to 85 where the codec can.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from sgicodec.bench.codec import Pixels8
from sgicodec.bench.peer import Peer, PillowPeer
from sgicodec.errors import UsageError, require


@dataclass(frozen=True)
class Jpeg(PillowPeer):
    """Baseline JPEG's progressive form by libjpeg-turbo: 4:2:0, optimised Huffman tables."""

    name: ClassVar[str] = "jpeg"
    container, feature, library = "JPEG", "libjpeg_turbo", "libjpeg-turbo"
    scale: ClassVar[Sequence[float]] = range(1, 96)
    stated: ClassVar[str] = "quality={quality:.0f} 4:2:0 optimise progressive"
    ladder: tuple[float, ...] = (4, 7, 11, 18, 30, 48, 70, 85, 93)

    def options(self, quality: float) -> dict[str, Any]:
        return {"quality": round(quality), "subsampling": "4:2:0", "optimize": True, "progressive": True}


@dataclass(frozen=True)
class WebP(PillowPeer):
    """Lossy WebP by libwebp at its slowest method; the format is 4:2:0 only."""

    name: ClassVar[str] = "webp"
    container, feature, library = "WEBP", "webp", "libwebp"
    scale: ClassVar[Sequence[float]] = range(101)
    stated: ClassVar[str] = "quality={quality:.0f} method=6"
    ladder: tuple[float, ...] = (0, 4, 12, 25, 45, 68, 82, 91, 96)

    def options(self, quality: float) -> dict[str, Any]:
        return {"quality": round(quality), "method": 6}


@dataclass(frozen=True)
class Avif(PillowPeer):
    """AVIF by libaom at speed 6, 4:4:4, as avifenc codes a PNG.

    Tuned for PSNR, because libavif's default since libaom 3.12 tunes for an image-quality model and would
    enter a comparison by PSNR with a handicap. Decodes with dav1d, whose thread count pillow does not
    offer.
    """

    name: ClassVar[str] = "avif"
    container, feature, library = "AVIF", "avif", "libavif"
    scale: ClassVar[Sequence[float]] = range(100)
    speed: ClassVar[int] = 6
    tune: ClassVar[str] = "psnr"
    ladder: tuple[float, ...] = (2, 8, 16, 26, 38, 52, 66, 79, 90)
    threads: int = 1

    def version(self) -> str:
        libavif = super().version()
        from PIL import _avif

        if not _avif.encoder_codec_available("aom"):
            raise UsageError("avif needs a pillow that encodes with libaom: pip install 'sgicodec[bench]'")
        return f"{libavif}, {_avif.codec_versions()}"

    def settings(self, quality: float) -> str:
        chosen = f"speed={self.speed} tune={self.tune} tiles=1"
        return f"quality={round(quality)} 4:4:4 aom {chosen} threads={self.threads}"

    def options(self, quality: float) -> dict[str, Any]:
        coding = {"quality": round(quality), "subsampling": "4:4:4", "codec": "aom", "speed": self.speed}
        return {**coding, "autotiling": False, "advanced": {"tune": self.tune}, "max_threads": self.threads}


@dataclass(frozen=True)
class AvifSlow(Avif):
    """AVIF as above at speed 2: what it can do for PSNR when time counts little."""

    name: ClassVar[str] = "avif-s2"
    speed: ClassVar[int] = 2


@dataclass(frozen=True)
class AvifIq(Avif):
    """AVIF as libavif ships it: speed 6, tuned for its image-quality model, which is its default with libaom."""

    name: ClassVar[str] = "avif-iq"
    tune: ClassVar[str] = "iq"
    ladder: tuple[float, ...] = (2, 10, 20, 32, 45, 58, 70, 82, 92)


@dataclass(frozen=True)
class AvifIqSlow(AvifIq):
    """The same at speed 2."""

    name: ClassVar[str] = "avif-iq-s2"
    speed: ClassVar[int] = 2


@dataclass(frozen=True)
class Jpeg2000(PillowPeer):
    """JPEG 2000 by OpenJPEG: a bare codestream, 9/7 wavelet. Its quality is the target rate in bpp."""

    name: ClassVar[str] = "jpeg2000"
    container, feature, library = "JPEG2000", "jpg_2000", "openjpeg"
    scale: ClassVar[Sequence[float]] = tuple(0.02 * 1.01**step for step in range(600))
    stated: ClassVar[str] = "bpp={quality:g} irreversible colour-transform"
    ladder: tuple[float, ...] = (0.1, 0.15, 0.22, 0.33, 0.5, 0.8, 1.3, 2.5)

    def options(self, quality: float) -> dict[str, Any]:
        coding = {"irreversible": True, "mct": 1, "no_jp2": True}
        return {**coding, "quality_mode": "rates", "quality_layers": [24 / quality]}


@dataclass(frozen=True)
class JpegXl(Peer):
    """JPEG XL by libjxl at effort 7. Its quality is the Butteraugli distance: less is better."""

    name: ClassVar[str] = "jxl"
    scale: ClassVar[Sequence[float]] = tuple(round(25 / 1.01**step, 3) for step in range(550))
    stated: ClassVar[str] = "distance={quality:g} effort=7 threads={0.threads}"
    ladder: tuple[float, ...] = (25, 15, 9, 6, 4, 2.5, 1.6, 1.0, 0.6)
    threads: int = 1

    def version(self) -> str:
        require("imagecodecs", self.name, "bench")
        import imagecodecs

        if not imagecodecs.JPEGXL.available:
            raise UsageError("jxl needs an imagecodecs that holds libjxl: pip install 'sgicodec[bench]'")
        return str(imagecodecs.jpegxl_version())

    def encode(self, pixels: Pixels8, quality: float) -> bytes:
        import imagecodecs

        return bytes(imagecodecs.jpegxl_encode(pixels, distance=quality, effort=7, numthreads=self.threads))

    def decode(self, data: bytes) -> Pixels8:
        import imagecodecs

        return np.asarray(imagecodecs.jpegxl_decode(data, numthreads=self.threads), np.uint8)


# In the order of the formats' age, which is also the order of tables.
PEERS: dict[str, Callable[[int], Peer]] = {
    "jpeg": lambda threads: Jpeg(),
    "jpeg2000": lambda threads: Jpeg2000(),
    "webp": lambda threads: WebP(),
    "jxl": lambda threads: JpegXl(threads=threads),
    "avif-iq": lambda threads: AvifIq(threads=threads),
    "avif-iq-s2": lambda threads: AvifIqSlow(threads=threads),
    "avif": lambda threads: Avif(threads=threads),
    "avif-s2": lambda threads: AvifSlow(threads=threads),
}


def find_peers(names: Iterable[str], threads: int = 1) -> tuple[list[Peer], dict[str, str]]:
    """The named peers that can run here, and for each of the others the reason and the extra to install.

    Raises UsageError for a name that is none of `PEERS`.
    """
    found: list[Peer] = []
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
