"""The range of samples that a picture uses, found part by part: what 0 and 1 of a model are to stand for.

A few dead or hot pixels do not stretch it: they lie outside, and are kept exactly. A value far from all others that
many samples have (a border of 0, a blank of 1.70141e38) is taken for nodata. A range that nearly fills a usual one,
such as 0 to 4095, is that one, so that quality means the same as for the same picture in eight bits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.errors import PictureError, UsageError
from sgicodec.metadata.layouts import SampleRange, alpha_index
from sgicodec.picture import MAX_SAMPLE, check_range, equal_samples, full_range

RangeChoice = Literal["used", "type"] | SampleRange
"""Which samples stand for 0 and 1: those of the range in use, of the type, or stated ones. Where nothing is chosen,
that is the type of eight bits, and else the range in use.
"""

_BINS = 1 << 16
_FEW, _SHARE_OF_FEW, _SHARE_OF_OUTLIERS = 12, 200, 20_000
"""Samples that may be outliers: so many but at most one in 200, or one in 20,000 where these are more
(why a gap decides, not a share: docs/notes/2026-11-sample-ranges.md)."""
_APART = 0.12
"""Of the span of all but these: how far an outlier lies from the next sample."""
_GAP = 4
"""Spans of all other samples between them and a value that is taken for nodata."""
_MANY = 16
"""Samples that such a value must have at least."""
_LABELS = 16
"""Values of integers that there must be besides: fewer are no measurements."""
_FARTHEST = 1e30
"""Samples beyond it are blanks or outliers, whatever the others are."""
_MAX_EXACT = 50
"""One sample in so many may be kept exactly."""
_CROWDS = ((4, 3, 100, "3 of 4 samples lie"), (2, 1, 1000, "half of the samples lie"))
"""Of so many samples how many lie in an interval, and how many times as wide as that a range is that is told."""
_LEVELS, _FIRST, _ROUNDING = 256, 2048, 2.0**-22
"""Values of eight bits; samples that are looked at first for more; what floats are rounded by, in parts of a sample."""
_NEARLY = 0.1
"""What may be missing of a usual range (docs/notes/2026-11-sample-ranges.md)."""
_USUAL = (1.0, 100.0, 255.0, 1000.0, 1023.0, 4095.0, 10000.0, 16383.0, 65535.0)
_SHIFTED = (1020.0, 4080.0, 16320.0, 65280.0)
"""The largest samples of eight bits that were shifted."""


@dataclass(frozen=True)
class SampleUse:
    """sample_range, blank, exact, eight_bits: as in `Picture`. remark: what the owner of the picture should know.
    opacity: whether alpha can be what it is called, as far as is known.
    """

    sample_range: SampleRange
    blank: float | None = None
    exact: bool = False
    eight_bits: bool = False
    remark: str | None = None
    opacity: bool = True


def stated_use(choice: RangeChoice | None, dtype: np.dtype[Any], colours: int) -> SampleUse | None:
    """What follows from a choice without a look at samples, None where they must be looked at. Raises UsageError."""
    if choice == "used" or (choice is None and dtype != np.uint8):
        return None
    if isinstance(choice, str) and choice != "type":
        raise UsageError(f"sample range {choice!r}; it is used, type, or two numbers")
    sample_range = full_range(dtype) if choice is None or isinstance(choice, str) else choice
    check_range(sample_range, colours, dtype)
    return SampleUse(sample_range, blank=float("nan") if dtype.kind == "f" else None)


class _Bins(NamedTuple):
    """The lowest and highest value of each bin that holds any, ascending, and how many it holds."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    times: NDArray[np.int64]

    def at(self, which: slice | NDArray[np.bool_]) -> _Bins:
        return _Bins(self.low[which], self.high[which], self.times[which])


class UsedRange:
    """The samples of the pixels added so far. nodata: the value that is declared as such."""

    def __init__(self, channels: str, colours: int, dtype: np.dtype[Any], nodata: float | None) -> None:
        self._alpha, self._dtype, self._nodata = alpha_index(channels), dtype, nodata
        self._groups = colours if channels == "multi" else 1
        self._count = np.zeros((self._groups, _BINS), np.int64)
        self._nans = 0
        self._alpha_low, self._alpha_high = 0.0, 0.0
        self._distinct: NDArray[Any] | None = np.zeros(0, dtype)
        """All values that floats have, None for too many."""
        if dtype.kind == "f":
            self._low = np.full((self._groups, _BINS), np.inf, np.float32)
            self._high = np.full((self._groups, _BINS), -np.inf, np.float32)

    def add(self, pixels: NDArray[Any]) -> None:
        """Look at pixels [H, W, C]."""
        colours = pixels[..., : self._alpha]
        if self._alpha is not None:
            alpha = pixels[..., self._alpha]
            self._alpha_low = min(self._alpha_low, float(alpha.min()))
            self._alpha_high = max(self._alpha_high, np.inf if np.isnan(alpha.max()) else float(alpha.max()))
        for group in range(self._groups):
            samples = (colours if self._groups == 1 else colours[..., group]).ravel()
            if self._nodata is not None:
                samples = samples[~equal_samples(samples, self._nodata)]
            if self._dtype.kind == "f":
                self._add_floats(group, samples)
            else:
                self._count[group] += np.bincount(samples, minlength=_BINS)

    def _add_floats(self, group: int, samples: NDArray[np.float32]) -> None:
        numbers = samples[~np.isnan(samples)]
        self._nans += samples.size - numbers.size
        self._add_distinct(numbers)
        bits = numbers.view(np.uint32)
        keys = np.where(bits >> 31, ~bits, bits | np.uint32(1 << 31)) >> 16  # ascend with the numbers
        self._count[group] += np.bincount(keys, minlength=_BINS)
        np.minimum.at(self._low[group], keys, numbers)
        np.maximum.at(self._high[group], keys, numbers)

    def _add_distinct(self, numbers: NDArray[np.float32]) -> None:
        for part in (numbers[:_FIRST], numbers):
            if self._distinct is not None:
                found = np.union1d(self._distinct, part)
                self._distinct = found if len(found) <= _LEVELS * self._groups + _FEW else None

    def found(self) -> SampleUse:
        """What the samples are. Raises PictureError for samples that no range does justice to."""
        blank, remark = None, None
        if self._nans and self._nodata is None:
            blank = float("nan")
        elif self._nodata is None:
            blank, times = self._blank()
            remark = None if blank is None else _REMARK.format(blank=blank, times=times)
        groups = [_without(self._bins(group), blank) for group in range(self._groups)]
        chosen = [self._range(bins) for bins in groups]
        ranges = [sample_range for sample_range, _ in chosen]
        outside = [_outside(bins, *found) for bins, found in zip(groups, ranges, strict=True)]
        for bins, out in zip(groups, outside, strict=True):
            if out > max(_few(bins), int(bins.times.sum()) // _MAX_EXACT):
                raise PictureError(_TOO_FAR.format(low=bins.low[0], high=bins.high[-1]))
        if any(abs(level) > MAX_SAMPLE for found in ranges for level in found):
            raise PictureError(f"its samples are beyond {MAX_SAMPLE:g}; state a sample range to clip them to")
        crowded = next(filter(None, map(_crowded, groups, ranges)), None)
        remark = "; ".join(filter(None, (remark, crowded))) or None
        exact = any(outside) or (self._nans > 0 and self._nodata is not None and not np.isnan(self._nodata))
        low, high = (tuple(levels) for levels in zip(*ranges, strict=True))
        sample_range = (low, high) if len(set(ranges)) > 1 else ranges[0]
        return SampleUse(sample_range, blank, exact, all(found for _, found in chosen), remark, self._is_opacity)

    def _range(self, bins: _Bins) -> tuple[tuple[float, float], bool]:
        """What stands for 0 and 1, and whether samples are those of eight bits."""
        ranges = _ranges(bins, self._dtype)
        if self._dtype != np.uint8:
            for sample_range in ranges:
                if self._is_stretched(bins, sample_range):
                    return sample_range, True
        return ranges[0], False

    def _is_stretched(self, bins: _Bins, sample_range: tuple[float, float]) -> bool:
        """Whether the samples in a range are those of eight bits, stretched to it and rounded."""
        (low, high), values = sample_range, bins.low
        if self._dtype.kind == "f":
            if self._distinct is None:
                return False
            values = self._distinct.astype(np.float64)
        values = values[(values >= low) & (values <= high)]
        expected = low + np.rint((values - low) * (255 / (high - low))) * ((high - low) / 255)
        if high - low >= 255 and (values % 1 == 0).all():
            return bool((np.rint(expected) == values).all())
        return self._dtype.kind == "f" and bool(
            (np.abs(expected - values) <= _ROUNDING * max(abs(low), abs(high))).all()
        )

    @property
    def _is_opacity(self) -> bool:
        """Whether alpha is opaque somewhere, or 0 everywhere, and nowhere more: other bands are declared so, too."""
        return self._alpha_low == 0 and self._alpha_high in (0.0, full_range(self._dtype)[1])

    def _bins(self, group: int) -> _Bins:
        (used,) = np.nonzero(self._count[group])
        count = self._count[group, used]
        if self._dtype.kind == "f":
            return _Bins(self._low[group, used].astype(np.float64), self._high[group, used].astype(np.float64), count)
        return _Bins(used.astype(np.float64), used.astype(np.float64), count)

    def _blank(self) -> tuple[float | None, int]:
        """A value that is far from all others and that many samples have, and how many."""
        best: tuple[float | None, int] = None, 0
        for group in range(self._groups):
            bins = self._bins(group)
            for end, rest in ((0, bins.at(slice(1, None))), (-1, bins.at(slice(0, -1)))):
                if len(rest.low) < (2 if self._dtype.kind == "f" else _LABELS):
                    continue
                value, times = float(bins.low[end]), int(bins.times[end])
                if value != bins.high[end] or times <= max(best[1], _few(bins), _MANY - 1):
                    continue
                low, high = _inner(_without_far(rest))
                gap = low - value if end == 0 else value - high
                if high > low and gap >= _GAP * (high - low):
                    best = value, times
        return best


_REMARK = "{blank:g}, which {times:,} samples have, is far from all others: it is taken for nodata and kept exactly"
_TOO_FAR = (
    "its samples run from {low:g} to {high:g}, and too many of them lie far from the others to be kept exactly; state "
    "a sample range to clip them to (--range LOW,HIGH)"
)


_CROWDED = (
    "{share} between {inner_low:g} and {inner_high:g}, in a {part:,.0f}th of {low:g} to {high:g}, "
    "which errors are parts of; --range LOW,HIGH makes them finer, and clips what lies outside"
)


def _crowded(bins: _Bins, sample_range: tuple[float, float]) -> str | None:
    """What to say where most samples lie in a hundredth of the range that quality spans, or in less: the shortest
    interval counts, as values that stand for nothing may lie at both ends.
    """
    behind, (low, high) = np.cumsum(bins.times), sample_range
    for whole, part, wide, share in _CROWDS if len(behind) else ():
        needed = behind - bins.times + -(-part * int(behind[-1]) // whole)  # by the last bin of the interval from each
        starts = int(np.searchsorted(needed, behind[-1], side="right"))
        ends = np.searchsorted(behind, needed[:starts])
        widths = bins.high[ends] - bins.low[:starts]
        at = int(np.argmin(widths))
        if 0 < widths[at] * wide < high - low:
            inner = {"inner_low": bins.low[at], "inner_high": bins.high[ends[at]]}
            return _CROWDED.format(share=share, part=(high - low) / widths[at], low=low, high=high, **inner)
    return None


def _few(bins: _Bins) -> int:
    """How many samples may be outliers."""
    total = int(bins.times.sum())
    return max(min(_FEW, total // _SHARE_OF_FEW), total // _SHARE_OF_OUTLIERS)


def _without(bins: _Bins, blank: float | None) -> _Bins:
    if blank is None or np.isnan(blank):
        return bins
    return bins.at((bins.low != blank) | (bins.high != blank))


def _without_far(bins: _Bins) -> _Bins:
    """Those that a range can hold, if there are any."""
    keep = (np.abs(bins.low) < _FARTHEST) & (np.abs(bins.high) < _FARTHEST)
    return bins.at(keep) if keep.any() else bins


def _inner(bins: _Bins) -> tuple[float, float]:
    """The lowest and the highest sample but for outliers: few at an end, with nothing between them and the others, or
    as many as can be kept exactly, where they are spans of all others away.
    """
    total = int(bins.times.sum())
    ends = _within(bins, total, _few(bins), _APART), _within(bins, total, total // _MAX_EXACT // 2, _GAP)
    return max(low for low, _ in ends), min(high for _, high in ends)


def _within(bins: _Bins, total: int, most: int, apart: float) -> tuple[float, float]:
    """The same where outliers are `most` at an end, and so many spans of all others away from them."""
    behind = np.cumsum(bins.times)
    first = int(np.searchsorted(behind, most, side="right"))
    last = int(np.searchsorted(behind, total - most, side="left"))
    gap = max(apart * float(bins.high[last] - bins.low[first]), float(np.finfo(np.float32).tiny))
    (gaps,) = np.nonzero(bins.low[1:] - bins.high[:-1] >= gap)  # behind these bins
    below, above = gaps[gaps < first], gaps[gaps >= last]
    return (
        float(bins.low[below[-1] + 1 if len(below) else 0]),
        float(bins.high[above[0] if len(above) else -1]),
    )


def _ranges(bins: _Bins, dtype: np.dtype[Any]) -> list[tuple[float, float]]:
    """What may stand for 0 and 1, the best guess first."""
    if not len(bins.low):
        return [full_range(dtype)]
    finite = _without_far(bins)
    if np.isinf(finite.low).any():
        raise PictureError("its samples are infinite; state a sample range to clip them to")
    low, high = _inner(finite)
    return [_apart(low, dtype)] if low == high else _usual(low, high, dtype)


def _apart(value: float, dtype: np.dtype[Any]) -> tuple[float, float]:
    """The range of a single value, so narrow that whatever lies in its lower half is rounded to that value."""
    if dtype.kind == "u":
        return (value, value + 1) if value < full_range(dtype)[1] else (value - 1, value)
    return value, float(np.nextafter(np.float32(value), np.float32(np.inf)))


def _usual(low: float, high: float, dtype: np.dtype[Any]) -> list[tuple[float, float]]:
    """The usual ranges that these samples nearly fill, then theirs, from 0 on where they nearly reach it."""
    most = full_range(dtype)[1] if dtype.kind == "u" else np.inf
    if 0 <= low <= _NEARLY * high:
        filled = [(0.0, top) for top in _USUAL + _SHIFTED if (1 - _NEARLY) * top <= high <= top <= most]
        return [*filled, (0.0, high)]
    filled = []
    for top in _USUAL:
        for start, stop in ((-top, top), (-(top + 1) / 2, (top - 1) / 2), (-top / 2, top / 2)):
            slack = _NEARLY * (stop - start)
            if low < 0 < high and start <= low <= start + slack and stop - slack <= high <= stop:
                filled.append((start, stop))
    return [*filled, (low, high)]


def _outside(bins: _Bins, low: float, high: float) -> int:
    """How many samples lie outside a range."""
    return int(bins.times[(bins.low < low) | (bins.high > high)].sum())
