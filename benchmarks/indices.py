"""What coding does to indices that are computed from bands: NDVI and the ratio of infrared to red, beside JPEG 2000."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click
import numpy as np

from sgicodec import EncodeSettings, Picture, encode_picture, read
from sgicodec.arrays import Samples
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import UsageError, require

_CLASSES = (0.2, 0.4, 0.6)
"""NDVI between sparse, some and dense vegetation, as maps divide it."""
_SIDE = 8
"""Pixels along the side of the squares over whose means an index is compared."""


@dataclass(frozen=True)
class Difference:
    """Of two NDVI, [H, W]. rms and bias: of the difference; rms_of_squares: of its means over 8×8 pixels; worst: the
    99th percentile of its absolute value; moved: share of pixels in another class.
    """

    rms: float
    bias: float
    rms_of_squares: float
    worst: float
    moved: float


def ndvi(pixels: Samples, red: int, infrared: int) -> Samples:
    """(infrared − red) / (infrared + red) of samples [H, W, C], bands counted from 0; 0 where both are."""
    near, far = pixels[..., red].astype(np.float64), pixels[..., infrared].astype(np.float64)
    total = near + far
    index: Samples = np.divide(far - near, total, out=np.zeros_like(total), where=total > 0)
    return index


def difference(found: Samples, true: Samples) -> Difference:
    """Of the NDVI of a decoded picture and of its source."""
    error = found - true
    squares = _means(found, _SIDE) - _means(true, _SIDE)
    return Difference(
        float(np.sqrt(np.mean(error**2))),
        float(np.mean(error)),
        float(np.sqrt(np.mean(squares**2))),
        float(np.percentile(np.abs(error), 99)),
        float(np.mean(np.digitize(found, _CLASSES) != np.digitize(true, _CLASSES))),
    )


def _means(values: Samples, side: int) -> Samples:
    """Over squares; what is left at the edges does not count."""
    rows, columns = (size // side for size in values.shape)
    squares: Samples = values[: rows * side, : columns * side].reshape(rows, side, columns, side)
    return np.asarray(squares.mean(axis=(1, 3)))


def _streams(picture: Picture, effort: int) -> Iterator[tuple[str, int, Samples]]:
    """Name, bytes and decoded samples of each setting."""
    settings: dict[str, dict[str, Any]] = {}
    for quality in (30, 50, 70, 90):
        settings[f"-q {quality}"] = {"quality": quality}
        settings[f"-q {quality} --tune psnr"] = {"quality": quality, "tune": "psnr"}
    settings |= {f"--max-error {most}": {"max_error": most} for most in (4, 2, 1)} | {"--lossless": {"max_error": 0}}
    for name, given in settings.items():
        data = encode_picture(picture, EncodeSettings(effort=effort, **given)).data
        with open_stream(data) as stream:
            yield name, len(data), stream.read()


def _jpeg2000(pixels: Samples, size: int) -> tuple[int, Samples]:
    """The best of at most so many bytes, by its PSNR: bands are coded without a transform between them."""
    require("imagecodecs", "JPEG 2000", "bench")
    import imagecodecs

    low, high, best = 15.0, 70.0, b""
    for _ in range(14):
        level: Any = (low + high) / 2  # PSNR; its type says int, and fractions are heeded
        data = imagecodecs.jpeg2k_encode(pixels, level=level, mct=False, reversible=False)
        low, high, best = (level, high, bytes(data)) if len(data) <= size else (low, level, best)
    return len(best), imagecodecs.jpeg2k_decode(best)


def _row(name: str, size: int, pixels: Samples, found: Samples, bands: tuple[int, int]) -> str:
    off = difference(ndvi(found, *bands), ndvi(pixels, *bands))
    bits = 8 * size / (pixels.shape[0] * pixels.shape[1])
    ratio = np.median(np.abs(_ratio(found, *bands) / _ratio(pixels, *bands) - 1))
    return (
        f"| {name} | {size:,} | {bits:.2f} | {off.rms:.4f} | {off.bias:+.4f} | {off.worst:.3f} | "
        f"{off.rms_of_squares:.4f} | {100 * off.moved:.1f} % | {100 * ratio:.2f} % |"
    )


def _ratio(pixels: Samples, red: int, infrared: int) -> Samples:
    return np.maximum(pixels[..., infrared], 1.0) / np.maximum(pixels[..., red], 1.0)


@click.command()
@click.argument("path", type=click.Path(path_type=Path, exists=True))
@click.option("--red", default=1, show_default=True, help="Number of the red band, from 1.")
@click.option("--infrared", default=4, show_default=True, help="Number of the near infrared band.")
@click.option("--effort", default=EncodeSettings.effort, show_default=True, help="Of the encodes.")
def main(path: Path, red: int, infrared: int, effort: int) -> None:
    """Code PATH at several qualities and compare NDVI and infrared / red with those of the source."""
    picture = read(path)
    count = picture.pixels.shape[2]
    if not (1 <= red <= count and 1 <= infrared <= count):
        raise UsageError(f"bands {red} and {infrared}; {path} has {count}, counted from 1")
    bands, pixels = (red - 1, infrared - 1), picture.pixels
    click.echo("| | bytes | bpp | NDVI, rms | bias | 99 % within | rms of 8×8 | other class | ratio, median |")
    click.echo("|---|---|---|---|---|---|---|---|---|")
    for name, size, found in _streams(picture, effort):
        click.echo(_row(f"`{name}`", size, pixels, found, bands))
        if "--max" not in name and "--loss" not in name:
            click.echo(_row("JPEG 2000, no larger", *_swapped(_jpeg2000(pixels, size), pixels), bands))


def _swapped(coded: tuple[int, Samples], pixels: Samples) -> tuple[int, Samples, Samples]:
    return coded[0], pixels, coded[1]
