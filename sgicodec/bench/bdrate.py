"""Bjøntegaard deltas: the mean difference of two rate–distortion curves, in rate or in quality.

Source: Bjøntegaard, "Calculation of average PSNR differences between RD-curves", VCEG-M33, 2001, with the
piecewise cubic of later JVET practice (PCHIP) in place of one cubic through all points, which may swing between them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PchipInterpolator

from sgicodec.errors import UsageError


@dataclass(frozen=True)
class Delta:
    """A mean difference `value` over the common range `low..high`, or NaN and the `reason` for it."""

    value: float
    low: float = math.nan
    high: float = math.nan
    reason: str | None = None


class Curve:
    """Points of one codec on one picture: rates (any unit, positive) against qualities (dB, more is better).

    Keeps only points that are better than every cheaper one, so that rate and quality rise together and
    either can be read as a function of the other. Points of infinite quality (lossless) are dropped. Raises
    UsageError for unequal lengths or a rate that is not positive.
    """

    def __init__(self, rates: Sequence[float], qualities: Sequence[float]) -> None:
        if len(rates) != len(qualities):
            raise UsageError(f"a curve needs as many qualities as rates, not {len(qualities)} for {len(rates)}")
        if not all(rate > 0 for rate in rates):
            raise UsageError("a curve needs positive rates")
        kept: list[tuple[float, float]] = []
        for rate, quality in sorted(zip(rates, qualities, strict=True), key=lambda point: (point[0], -point[1])):
            if math.isfinite(quality) and (not kept or (rate > kept[-1][0] and quality > kept[-1][1])):
                kept.append((rate, quality))
        self.log_rates: npt.NDArray[np.float64] = np.log([rate for rate, _ in kept])
        self.qualities: npt.NDArray[np.float64] = np.array([quality for _, quality in kept], np.float64)

    def quality_at(self, rate: float) -> float:
        """Quality at a rate, interpolated over the logarithm of the rate; NaN outside of the curve."""
        if len(self.log_rates) < 2:
            return math.nan
        return float(PchipInterpolator(self.log_rates, self.qualities, extrapolate=False)(math.log(rate)))

    def rate_at(self, quality: float) -> float:
        """The least rate at which a quality is reached: the first point's where that is better, NaN where none is."""
        if not len(self.qualities) or quality > self.qualities[-1]:
            return math.nan
        if quality <= self.qualities[0]:
            return math.exp(self.log_rates[0])
        return math.exp(PchipInterpolator(self.qualities, self.log_rates)(quality))


def bd_rate(anchor: Curve, test: Curve, within: tuple[float, float] = (-math.inf, math.inf)) -> Delta:
    """Mean difference in rate of `test` against `anchor` at equal quality, in percent; negative is smaller.

    The mean of the difference of log-rates over the common range of qualities (`low..high` of the result), as far as
    it lies `within` a range.
    """
    delta = _mean_difference(anchor.qualities, anchor.log_rates, test.qualities, test.log_rates, "quality", within)
    return Delta(100.0 * math.expm1(delta.value), delta.low, delta.high, delta.reason)


def bd_quality(anchor: Curve, test: Curve) -> Delta:
    """Mean difference in quality of `test` against `anchor` at equal rate (BD-PSNR for PSNR curves), in dB.

    The mean over the common range of log-rates; `low..high` of the result are rates.
    """
    delta = _mean_difference(anchor.log_rates, anchor.qualities, test.log_rates, test.qualities, "rate")
    return Delta(delta.value, math.exp(delta.low), math.exp(delta.high), delta.reason)


def _mean_difference(
    x0: npt.NDArray[np.float64],
    y0: npt.NDArray[np.float64],
    x1: npt.NDArray[np.float64],
    y1: npt.NDArray[np.float64],
    what: str,
    within: tuple[float, float] = (-math.inf, math.inf),
) -> Delta:
    if min(len(x0), len(x1)) < 2:
        return Delta(math.nan, reason="a curve has fewer than two usable points")
    low, high = float(max(x0[0], x1[0], within[0])), float(min(x0[-1], x1[-1], within[1]))
    if not low < high:
        return Delta(math.nan, reason=f"the curves share no range of {what}")
    difference = PchipInterpolator(x1, y1).integrate(low, high) - PchipInterpolator(x0, y0).integrate(low, high)
    return Delta(float(difference) / (high - low), low, high)
