"""What curves are compared by: each measure as a quality that rises, with its scale and its range."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from sgicodec.bench.rows import Row


@dataclass(frozen=True)
class Measure:
    """A measure of a row.

    `quality` is what curves are drawn over and BD-rates are taken at: more is better; NaN where the row has none.
    BD-rates see no quality outside of `within`. `shown` makes a mean quality a value as people write it.
    """

    title: str
    axis: str
    quality: Callable[[Row], float]
    within: tuple[float, float] = (-math.inf, math.inf)
    shown: Callable[[float], float] = float


def _decibels(error: float | None) -> float:
    """An error, whose ratios count, in decibels: infinite for none at all, NaN where it is unknown."""
    if error is None or math.isnan(error):
        return math.nan
    return -10 * math.log10(error) if error > 0 else math.inf


def _undone(decibels: float) -> float:
    """The error that `_decibels` made this of."""
    return float(10 ** (-decibels / 10))


MEASURES = {
    "psnr": Measure("PSNR in dB", "PSNR (dB)", lambda row: row.psnr),
    "luma_psnr": Measure("luma PSNR in dB", "luma PSNR (dB)", lambda row: row.luma_psnr),
    # MS-SSIM in decibels, because its differences near 1 are what counts.
    "ms_ssim": Measure(
        "MS-SSIM",
        "MS-SSIM (dB)",
        lambda row: _decibels(1 - row.ms_ssim),
        shown=lambda quality: 1 - _undone(quality),
    ),
    # Below 20 nobody would use a picture, above 85 nobody sees a difference.
    "ssimulacra2": Measure(
        "SSIMULACRA 2",
        "SSIMULACRA 2",
        lambda row: math.nan if row.ssimulacra2 is None else row.ssimulacra2,
        within=(20.0, 85.0),
    ),
    # A distance, in decibels: its logarithm is nearly straight over that of the rate, so that no part of the range
    # outweighs the rest.
    "butteraugli": Measure(
        "Butteraugli (3-norm, less is better)",
        "Butteraugli, 3-norm (-dB)",
        lambda row: _decibels(row.butteraugli),
        shown=_undone,
    ),
    "flip": Measure("FLIP (less is better)", "FLIP (-dB)", lambda row: _decibels(row.flip), shown=_undone),
    "cvvdp": Measure("ColorVideoVDP", "ColorVideoVDP", lambda row: math.nan if row.cvvdp is None else row.cvvdp),
    "lpips": Measure("LPIPS (less is better)", "LPIPS (-dB)", lambda row: _decibels(row.lpips), shown=_undone),
    "dists": Measure("DISTS (less is better)", "DISTS (-dB)", lambda row: _decibels(row.dists), shown=_undone),
}
"""By the name in results and summaries."""
