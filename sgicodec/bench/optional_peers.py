"""Peers whose packages are in no need of sgi's own tests: jpegli and VVenC, from the extra `peers`."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import ClassVar

import numpy as np

from sgicodec.bench.codec import Pixels8
from sgicodec.bench.peer import Peer
from sgicodec.errors import UsageError, require

__all__ = ["Jpegli", "VVenC"]


@dataclass(frozen=True)
class Jpegli(Peer):
    """JPEG by Google's jpegli, as the package pyjpegli offers it: 4:2:0, its own tables, float decoding."""

    name: ClassVar[str] = "jpegli"
    scale: ClassVar[Sequence[float]] = range(1, 101)
    stated: ClassVar[str] = "quality={quality:.0f} 4:2:0"
    ladder: tuple[float, ...] = (1, 5, 10, 18, 30, 45, 62, 78, 90)

    def version(self) -> str:
        require("pyjpegli", self.name, "peers")
        import pyjpegli

        return f"jpegli in pyjpegli {pyjpegli.__version__}"

    def encode(self, pixels: Pixels8, quality: float) -> bytes:
        import pyjpegli

        height, width = pixels.shape[:2]
        return bytes(pyjpegli.encode(np.ascontiguousarray(pixels), width, height, quality=round(quality)))

    def decode(self, data: bytes) -> Pixels8:
        import pyjpegli

        samples, width, height = pyjpegli.decode(data)
        return np.frombuffer(samples, np.uint8).reshape(height, width, 3)


# VVenC knows 4:2:0 of ten bits only. The full range and an exact conversion cost the least by way of YCbCr.
_TO_YUV = "scale=out_color_matrix=bt709:out_range=full:flags=lanczos+accurate_rnd+full_chroma_int,format=yuv420p10le"
_TO_RGB = "scale=in_color_matrix=bt709:in_range=full:flags=lanczos+accurate_rnd+full_chroma_int,format=rgb24"


@dataclass(frozen=True)
class VVenC(Peer):
    """One intra picture of VVC by VVenC in ffmpeg: preset medium, perceptual optimisation off; 4:2:0, ten bits.

    A bare stream, without a container. Its quality is the quantisation parameter: less is better.
    """

    name: ClassVar[str] = "vvenc"
    scale: ClassVar[Sequence[float]] = range(63, -1, -1)
    stated: ClassVar[str] = "qp={quality:.0f} 4:2:0 10-bit preset=medium qpa=0 threads={0.threads}"
    ladder: tuple[float, ...] = (51, 46, 41, 36, 31, 27, 22)
    threads: int = 1

    def version(self) -> str:
        require("imageio_ffmpeg", self.name, "peers")
        if "libvvenc" not in _encoders():
            raise UsageError("vvenc needs an ffmpeg that holds libvvenc: pip install 'sgicodec[peers]'")
        import imageio_ffmpeg

        return f"libvvenc in ffmpeg {imageio_ffmpeg.get_ffmpeg_version()}"

    def encode(self, pixels: Pixels8, quality: float) -> bytes:
        size = f"{pixels.shape[1]}x{pixels.shape[0]}"
        source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-i", "-"]
        coding = ["-c:v", "libvvenc", "-preset", "medium", "-qp", str(round(quality)), "-qpa", "0"]
        threads = ["-threads", str(self.threads)]
        return _ffmpeg(
            [*source, "-vf", _TO_YUV, *coding, *threads, "-frames:v", "1", "-f", "vvc", "-"], pixels.tobytes()
        )

    def decode(self, data: bytes) -> Pixels8:
        options = ["-threads", str(self.threads), "-f", "vvc", "-i", "-", "-vf", _TO_RGB, "-f", "image2pipe"]
        header, size, _, samples = _ffmpeg([*options, "-c:v", "ppm", "-"], data).split(b"\n", 3)
        if header != b"P6":
            raise RuntimeError("ffmpeg gave back no picture")
        width, height = map(int, size.split())
        return np.frombuffer(samples, np.uint8).reshape(height, width, 3)


def _ffmpeg(options: list[str], data: bytes) -> bytes:
    """What ffmpeg writes to its standard output. Raises RuntimeError with its last line of complaint."""
    import imageio_ffmpeg

    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-hide_banner", "-loglevel", "error", *options]
    done = subprocess.run(command, input=data, capture_output=True, check=False)
    if done.returncode:
        complaint = done.stderr.decode("utf-8", "replace").strip().splitlines() or ["it says nothing"]
        raise RuntimeError(f"ffmpeg: {complaint[-1]}")
    return done.stdout


@cache
def _encoders() -> str:
    return _ffmpeg(["-encoders"], b"").decode("utf-8", "replace")
