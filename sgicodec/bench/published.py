"""Curves that were published and are not measured here: PSNR of Cool-Chic 5 on the Kodak pictures."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path

from sgicodec.bench.rows import Row

_KODAK_SIZE = {768, 512}
_UNKNOWN = ("luma_psnr", "ssim", "ms_ssim", "encode_seconds", "decode_seconds")


@dataclass(frozen=True)
class PublishedCurves:
    """PSNR over bits per pixel of one codec on the Kodak pictures, which are known by their names and size."""

    name: str
    path: Path

    def rows(self, picture: str, crc: str, width: int, height: int) -> list[Row]:
        """The points of a picture, none for one that is not of the set. What was not published is NaN or None."""
        points = json.loads(self.path.read_text("utf-8"))["points"]
        own = points.get(Path(picture).stem, []) if {width, height} == _KODAK_SIZE else []
        return [self._row(picture, crc, width, height, bpp, psnr) for bpp, psnr in own]

    def _row(self, picture: str, crc: str, width: int, height: int, bpp: float, psnr: float) -> Row:
        return Row(
            self.name,
            "published",
            f"bpp={bpp:g}",
            picture,
            crc,
            width=width,
            height=height,
            quality=bpp,
            bytes=round(bpp * width * height / 8),
            bpp=bpp,
            psnr=psnr,
            memory_mib=None,
            **dict.fromkeys(_UNKNOWN, math.nan),
        )


PUBLISHED = {"coolchic5": PublishedCurves("coolchic5", Path(__file__).with_name("coolchic5_kodak.json"))}
"""By the name on the command line."""
