"""Layouts and ranges: what the channels and the samples of a picture mean."""

from __future__ import annotations

import math

LAYOUTS = {"gray": 1, "gray+alpha": 2, "rgb": 3, "rgba": 4}
"""Channel count of each layout with a meaning; any other stack of bands is "multi"."""

WITHOUT_ALPHA = {"gray+alpha": "gray", "rgba": "rgb"}
"""What layouts with alpha are without it."""


def alpha_index(channels: str) -> int | None:
    """Index of the alpha channel in a layout, or None."""
    return LAYOUTS[channels] - 1 if channels in WITHOUT_ALPHA else None


Level = float | tuple[float, ...]
"""A sample of all colours, or one for each of them."""

SampleRange = tuple[Level, Level]
"""The colour samples that stand for 0 and 1. Alpha always spans its type."""


def band_ranges(sample_range: SampleRange, colours: int) -> list[tuple[float, float]]:
    """The range of each of so many colours. Raises ValueError for levels of another number of them."""
    low, high = (level if isinstance(level, tuple) else (level,) * colours for level in sample_range)
    if len(low) != colours or len(high) != colours:
        raise ValueError(f"ranges of {len(low)} and {len(high)} bands; there are {colours}")
    return list(zip(low, high, strict=True))


def range_text(sample_range: SampleRange) -> str:
    """A range for people: "0 to 4095", in as many digits as tell its span; of bands each its own."""
    low, high = sample_range
    if isinstance(low, tuple) or isinstance(high, tuple):
        count = len(low if isinstance(low, tuple) else high)  # type: ignore[arg-type]
        return ", ".join(range_text(band) for band in band_ranges(sample_range, count))
    spans = max(abs(low), abs(high)) / abs(high - low) if high != low else 1
    digits = max(6, math.ceil(math.log10(spans)) + 3)
    return f"{low:.{digits}g} to {high:.{digits}g}"
