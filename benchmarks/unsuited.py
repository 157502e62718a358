"""Pictures that the codec does not suit: text, line art, a screenshot, faint characters, fine texture."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from sgicodec import EncodeSettings, Picture, encode_picture, read
from sgicodec.bench.options import numbers
from sgicodec.decoder.stream import open_stream
from sgicodec.metrics.psnr import largest_difference, psnr

__all__ = ["COLUMNS", "Row", "drawn", "kept_contrast", "main", "measured"]

U8 = NDArray[np.uint8]

COLUMNS = ("picture", "lossless", "quality", "bytes", "psnr", "most", "strokes", "invented")
SIDE = 384
FAINT = 12
"""Levels between faint characters and their ground."""
_WORDS = "Pack my box with five dozen liquor jugs. 0123456789 "


@dataclass(frozen=True)
class Row:
    """One picture at one quality. lossless: bytes of WebP without loss; most: largest difference of any sample, in
    levels; strokes: the contrast that is kept of what is drawn; invented: what deviates from that, over the contrast
    of the original: both of the picture less its blur over a few pixels, 1 and 0 if it is unchanged.
    """

    picture: str
    lossless: int
    quality: float
    bytes: int
    psnr: float
    most: float
    strokes: float
    invented: float

    def line(self) -> str:
        """Tab-separated, in the order of COLUMNS."""
        figures = f"{self.psnr:.1f}\t{self.most:.0f}\t{self.strokes:.2f}\t{self.invented:.2f}"
        return f"{self.picture}\t{self.lossless}\t{self.quality:g}\t{self.bytes}\t{figures}"


def drawn(side: int = SIDE) -> dict[str, U8]:
    """The pictures [side, side, 3]: characters by Pillow's own font, lines and areas by its drawing."""
    return {
        "text": _text(side, 11, 0, 255),
        "line art": _lines(side),
        "screenshot": _screenshot(side),
        "faint text": _text(side, 14, 128, 128 + FAINT),
    }


def _text(side: int, size: int, ink: int, ground: int) -> U8:
    from PIL import Image, ImageDraw, ImageFont

    image = Image.new("RGB", (side, side), (ground,) * 3)
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(size)
    for number, top in enumerate(range(4, side - size, size + 4)):
        shift = 7 * number % len(_WORDS)
        draw.text((6, top), (_WORDS[shift:] + 2 * _WORDS)[: side // (size // 2) - 4], (ink,) * 3, font)
    return np.asarray(image)


def _lines(side: int) -> U8:
    from PIL import Image, ImageDraw

    image = Image.new("RGB", (side, side), (255, 255, 255))
    draw = ImageDraw.Draw(image)
    middle = side / 2
    for number in range(24):
        angle, inset = np.pi * number / 24, number * middle / 24
        across, down = middle * np.cos(angle), middle * np.sin(angle)
        draw.line((middle - across, middle - down, middle + across, middle + down), (0, 0, 0))
        draw.ellipse((inset, inset, side - inset, side - inset), outline=(0, 0, 160))
    return np.asarray(image)


def _screenshot(side: int) -> U8:
    """Windows with text on plain grounds."""
    pixels = np.full((side, side, 3), (58, 110, 165), np.uint8)
    half = side // 2
    for top, left, ground in ((20, 16, 250), (60 + half // 2, half // 2, 236)):
        window = pixels[top : top + half, left : left + half + 60]
        window[:] = ground
        window[:18] = (0, 84, 166)
        page = _text(max(window.shape), 11, 0, 255)[: len(window) - 22, : window.shape[1]]
        window[22:] = np.minimum(window[22:], page)
    return pixels


def kept_contrast(original: U8, decoded: U8) -> tuple[float, float]:
    """Of the detail of two pictures [H, W, C]: the slope of the decoded on the original, and the deviation from it over
    the deviation of the original.
    """
    ours, theirs = (_detail(pixels) for pixels in (original, decoded))
    slope = float((ours * theirs).sum() / (ours * ours).sum())
    return slope, float(np.sqrt(np.square(theirs - slope * ours).sum() / np.square(ours).sum()))


def _detail(pixels: U8) -> NDArray[np.float64]:
    """The mean of the channels less its blur over nine pixels."""
    plane = pixels.mean(axis=2)
    for axis in (0, 1):
        padded = np.pad(plane, [(4, 4) if axis == side else (0, 0) for side in (0, 1)], mode="reflect")
        plane = sum(np.take(padded, range(at, at + plane.shape[axis]), axis) for at in range(9)) / 9  # type: ignore[assignment]
    return np.asarray(pixels.mean(axis=2) - plane)


def measured(name: str, pixels: U8, quality: float, effort: int) -> Row:
    """One encode and decode."""
    from PIL import Image

    lossless = io.BytesIO()
    Image.fromarray(pixels).save(lossless, "WEBP", lossless=True, quality=80)
    data = encode_picture(Picture(pixels, "rgb", (0.0, 255.0)), EncodeSettings(quality=quality, effort=effort)).data
    with open_stream(data) as stream:
        decoded = stream.picture().pixels
    figures = psnr(pixels, decoded), largest_difference(pixels, decoded), *kept_contrast(pixels, decoded)
    return Row(name, len(lossless.getvalue()), quality, len(data), *figures)


@click.command("unsuited")
@click.argument("photographs", nargs=-1, type=click.Path(exists=True, path_type=Path))
@click.option("--qualities", default="50,90", show_default=True, help="Qualities, with commas between.")
@click.option("--effort", default=5, show_default=True)
def main(photographs: tuple[Path, ...], qualities: str, effort: int) -> None:
    """Measure what is left of pictures that the codec does not suit, next to crops of PHOTOGRAPHS."""
    pictures = drawn() | {path.stem: read(path).pixels[:SIDE, :SIDE, :3] for path in photographs}
    click.echo("\t".join(COLUMNS))
    for name, pixels in pictures.items():
        for quality in numbers(qualities, "--qualities"):
            click.echo(measured(name, np.ascontiguousarray(pixels), quality, effort).line())
