"""Piecewise cubic Hermite interpolation that keeps the shape of the data: no overshoot between monotone
points.

Source: Fritsch and Butland, "A method for constructing local monotone piecewise cubic interpolants", 1984,
with the three-point end slopes of Moler's `pchiptx`; the same curve as MATLAB's `pchip`.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from sgicodec.errors import UsageError

__all__ = ["Pchip"]

Samples = npt.NDArray[np.float64]  # [N]


class Pchip:
    """The interpolant through `(x, y)`, both [N], N at least 2, x strictly increasing; a line for N = 2.

    Raises UsageError for fewer points, unequal lengths, or x that does not increase.
    """

    def __init__(self, x: npt.ArrayLike, y: npt.ArrayLike) -> None:
        self.x: Samples = np.asarray(x, np.float64)
        self.y: Samples = np.asarray(y, np.float64)
        if self.x.ndim != 1 or self.x.shape != self.y.shape or len(self.x) < 2:
            raise UsageError("interpolation needs two points or more, and as many values as positions")
        if not np.all(np.diff(self.x) > 0):
            raise UsageError("interpolation needs strictly increasing positions")
        self.slopes = _slopes(self.x, self.y)

    def __call__(self, at: npt.ArrayLike) -> Samples:
        """Values at `at`; NaN outside of the data, which is not extrapolated."""
        at = np.asarray(at, np.float64)
        piece = self._piece(at)
        value = _horner(self._coefficients(piece), at - self.x[piece])
        return np.where((at >= self.x[0]) & (at <= self.x[-1]), value, np.nan)

    def integral(self, low: float, high: float) -> float:
        """The exact integral over `[low, high]`. Raises UsageError where that leaves the data."""
        if not self.x[0] <= low <= high <= self.x[-1]:
            raise UsageError(f"cannot integrate over {low:g}..{high:g}: data spans {self.x[0]:g}..{self.x[-1]:g}")
        inner = self.x[(self.x > low) & (self.x < high)]
        edges = np.concatenate([[low], inner, [high]])
        piece = self._piece((edges[:-1] + edges[1:]) / 2)
        powers = [c / (k + 1) for k, c in enumerate(self._coefficients(piece))]
        start, stop = edges[:-1] - self.x[piece], edges[1:] - self.x[piece]
        return float(np.sum(_horner(powers, stop) * stop - _horner(powers, start) * start))

    def _piece(self, at: Samples) -> npt.NDArray[np.intp]:
        return np.clip(np.searchsorted(self.x, at, side="right") - 1, 0, len(self.x) - 2)

    def _coefficients(self, piece: npt.NDArray[np.intp]) -> list[Samples]:
        """Of 1, t, t², t³ with t measured from the left end of each piece."""
        step = self.x[piece + 1] - self.x[piece]
        secant = (self.y[piece + 1] - self.y[piece]) / step
        left, right = self.slopes[piece], self.slopes[piece + 1]
        return [
            self.y[piece],
            left,
            (3 * secant - 2 * left - right) / step,
            (left + right - 2 * secant) / step**2,
        ]


def _horner(coefficients: list[Samples], t: Samples) -> Samples:
    total = np.zeros_like(t)
    for coefficient in reversed(coefficients):
        total = total * t + coefficient
    return total


def _slopes(x: Samples, y: Samples) -> Samples:
    step = np.diff(x)
    secant = np.diff(y) / step
    if len(secant) == 1:
        return np.repeat(secant, 2)
    slopes = np.zeros_like(x)
    left, right = secant[:-1], secant[1:]
    inside = left * right > 0
    # Harmonic mean of the neighbouring secants, weighted towards the shorter step; 0 at an extremum.
    near, far = (2 * step[1:] + step[:-1])[inside], (step[1:] + 2 * step[:-1])[inside]
    with np.errstate(over="ignore"):  # the inverse of a vanishing secant: the slope is 0, as it should be
        slopes[1:-1][inside] = (near + far) / (near / left[inside] + far / right[inside])
    slopes[0] = _end_slope(step[0], step[1], secant[0], secant[1])
    slopes[-1] = _end_slope(step[-1], step[-2], secant[-1], secant[-2])
    return slopes


def _end_slope(step: float, next_step: float, secant: float, next_secant: float) -> float:
    slope = ((2 * step + next_step) * secant - step * next_secant) / (step + next_step)
    if slope * secant <= 0:
        return 0.0
    if secant * next_secant < 0 and abs(slope) > 3 * abs(secant):
        return 3 * secant
    return slope
