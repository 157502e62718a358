"""What a picture is: samples, their layout and range, and the metadata that travels with them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from sgicodec.arrays import Samples
from sgicodec.errors import UsageError
from sgicodec.metadata import geo
from sgicodec.metadata.blobs import Metadata
from sgicodec.metadata.layouts import LAYOUTS, WITHOUT_ALPHA, SampleRange, alpha_index, band_ranges, range_text

__all__ = [
    "Metadata",
    "Picture",
    "check_range",
    "convert",
    "equal_samples",
    "exact_samples",
    "from_unit",
    "full_range",
    "nodata_mask",
    "nodata_samples",
    "opaque_mask",
    "to_rgb8",
    "to_unit",
    "without_opaque_alpha",
]


MAX_SAMPLE = 1e38
"""Of a sample range, either way: floats hold differences of samples."""

_DTYPE_OF_DEPTH: dict[int, np.dtype[Any]] = {
    8: np.dtype(np.uint8),
    16: np.dtype(np.uint16),
    32: np.dtype(np.float32),
}


@dataclass(frozen=True, eq=False)
class Picture:
    """Samples as they are stored, upright, with unassociated (not premultiplied) alpha.

    pixels:       [H, W, C], uint8, uint16 or float32.
    channels:     a name in `LAYOUTS`, or "multi" for bands without a meaning; "gray+alpha" and "rgba" end in
                  alpha.
    sample_range: the values of a colour sample that stand for 0 and 1; of "multi" maybe two tuples with one for each
                  band. Alpha always spans its type: 0 to 255, 65535 or 1.0.
    blank:        the sample value that stands for "nothing was measured here" where the metadata do not say it.
    exact:        whether samples outside the range (dead pixels, not-a-number) are to be kept as they are; else they
                  are clipped.
    eight_bits:   whether colours are those of a picture of eight bits that was stretched to the range and rounded.
    remark:       what its owner should know of how its samples were understood.
    rounding:     by how much pixels are off at most from samples of more bits, which they were made from; infinite
                  where colours brighter than their associated alpha were clipped.

    Raises UsageError when the parts contradict each other.
    """

    pixels: Samples
    channels: str
    sample_range: SampleRange
    metadata: Metadata = field(default_factory=Metadata)
    blank: float | None = None
    exact: bool = False
    eight_bits: bool = False
    remark: str | None = None
    rounding: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.pixels, np.ndarray):
            raise UsageError(f"pixels must be an array of numpy, not {type(self.pixels).__name__}")
        if self.pixels.ndim != 3 or 0 in self.pixels.shape:
            raise UsageError(f"pixels must be [H, W, C] and not empty, not of shape {self.pixels.shape}")
        if self.pixels.dtype not in _DTYPE_OF_DEPTH.values():
            raise UsageError(f"pixels must be uint8, uint16 or float32, not {self.pixels.dtype}")
        if self.channels != "multi" and LAYOUTS.get(self.channels) != self.pixels.shape[2]:
            raise UsageError(f"{self.pixels.shape[2]} channels cannot be {self.channels!r}")
        check_range(self.sample_range, self.pixels.shape[2] - (self.alpha is not None), self.pixels.dtype)

    def __repr__(self) -> str:
        kept = [name for name in ("icc", "exif", "xmp", "geo") if getattr(self.metadata, name) is not None]
        what = f"{self.width}×{self.height} {self.channels} {self.pixels.dtype}, {range_text(self.sample_range)}"
        return f"<sgicodec.Picture {', '.join((what, *kept))}>"

    @property
    def height(self) -> int:
        """Rows."""
        return int(self.pixels.shape[0])

    @property
    def width(self) -> int:
        """Columns."""
        return int(self.pixels.shape[1])

    @property
    def alpha(self) -> int | None:
        """Index of the alpha channel, or None."""
        return alpha_index(self.channels)

    @property
    def nodata(self) -> float | None:
        """The sample value that stands for "nothing was measured here", or None. It may be not-a-number."""
        return geo.nodata(self.metadata.geo, self.pixels.dtype) if self.blank is None else self.blank


def check_range(sample_range: SampleRange, colours: int, dtype: np.dtype[Any]) -> None:
    """Raise UsageError for what is no range of so many colours of a type."""
    try:
        ranges = [(float(low), float(high)) for low, high in band_ranges(sample_range, colours)]
    except (TypeError, ValueError):
        numbers = "two numbers, or two tuples with one number for each band"
        raise UsageError(f"sample_range {sample_range!r}; it must be {numbers}") from None
    for low, high in ranges:
        if not (abs(low) <= MAX_SAMPLE and abs(high) <= MAX_SAMPLE and low < high):
            raise UsageError(
                f"the sample range must be two numbers up to {MAX_SAMPLE:g}, low before high, not {low:g} to {high:g}"
            )
        if dtype.kind == "u" and not (low >= 0 and high <= full_range(dtype)[1] and low % 1 == high % 1 == 0):
            most = f"{full_range(dtype)[1]:g}"
            raise UsageError(f"the range of {dtype} samples is two integers from 0 to {most}, not {low:g} to {high:g}")


def equal_samples(pixels: Samples, value: float) -> npt.NDArray[np.bool_]:
    """Which samples are `value`, of the shape of `pixels`; not-a-number equals itself."""
    return np.isnan(pixels) if np.isnan(value) else pixels == pixels.dtype.type(value)


def nodata_samples(picture: Picture) -> npt.NDArray[np.bool_]:
    """Which colour samples [H, W, colours] were not measured: those that have the nodata value."""
    colours, nodata = picture.pixels[..., : picture.alpha], picture.nodata
    return np.zeros(colours.shape, np.bool_) if nodata is None else equal_samples(colours, nodata)


def nodata_mask(picture: Picture) -> npt.NDArray[np.bool_]:
    """Which pixels [H, W] were not measured: those whose colour samples all have the nodata value."""
    if picture.nodata is None:
        return np.zeros(picture.pixels.shape[:2], np.bool_)
    return np.asarray(nodata_samples(picture).all(axis=-1))


def exact_samples(picture: Picture) -> npt.NDArray[np.bool_]:
    """Which colour samples [H, W, colours] are kept as they are: those outside the range, nodata aside."""
    colours = picture.pixels[..., : picture.alpha]
    if not picture.exact:
        return np.zeros(colours.shape, np.bool_)
    low, high = (np.asarray(level, np.float32) for level in picture.sample_range)
    inside = (colours >= low) & (colours <= high)  # false for not-a-number
    return ~inside & ~nodata_samples(picture)


def full_range(dtype: npt.DTypeLike) -> tuple[float, float]:
    """The values of `dtype` that stand for 0 and 1 when nothing else is stated: 0 to the largest integer, or
    to 1.0.
    """
    dtype = np.dtype(dtype)
    return (0.0, float(np.iinfo(dtype).max)) if dtype.kind == "u" else (0.0, 1.0)


def opaque_mask(picture: Picture) -> npt.NDArray[np.bool_]:
    """Which pixels [H, W] of a picture with alpha are opaque."""
    return np.asarray(picture.pixels[..., picture.alpha] >= full_range(picture.pixels.dtype)[1])


def without_opaque_alpha(picture: Picture) -> Picture:
    """The picture without an alpha that is opaque everywhere, which says nothing; else the picture."""
    if picture.alpha is None or not opaque_mask(picture).all():
        return picture
    return replace(picture, pixels=picture.pixels[..., :-1], channels=WITHOUT_ALPHA[picture.channels])


def to_unit(picture: Picture) -> npt.NDArray[np.float32]:
    """Samples as float32 [H, W, C] in 0..1; what lies outside the sample range is clipped, not-a-number becomes 0."""
    low, span = _affine(picture.channels, picture.pixels.shape[2], picture.pixels.dtype, picture.sample_range)
    unit = picture.pixels.astype(np.float32)
    with np.errstate(over="ignore", invalid="ignore"):
        unit -= low
        unit /= span
        np.clip(unit, 0.0, 1.0, out=unit)
    if picture.pixels.dtype.kind == "f":
        unit[np.isnan(unit)] = 0.0
    if picture.eight_bits:
        colours = unit[..., : picture.alpha]
        np.rint(colours * np.float32(255), out=colours)
        colours /= np.float32(255)
    return unit


def comparable(picture: Picture) -> Samples:
    """What an error is measured on: integers that span their type as they are, others where their range is 0..1."""
    spans_type = picture.pixels.dtype.kind == "u" and picture.sample_range == full_range(picture.pixels.dtype)
    return picture.pixels if spans_type else to_unit(picture)


def to_rgb8(picture: Picture) -> npt.NDArray[np.uint8]:
    """What a screen shows, about: 8-bit RGB [H, W, 3]; gray three times, on black what alpha hides, of more channels
    the first three.
    """
    unit = to_unit(picture)
    if picture.alpha is not None:
        unit = unit[..., : picture.alpha] * unit[..., picture.alpha, None]
    shown = unit[..., :3] if unit.shape[2] >= 3 else unit[..., [0, 0, 0]]
    return np.rint(255 * shown).astype(np.uint8)


def from_unit(
    unit: npt.NDArray[np.floating[Any]],
    channels: str,
    dtype: npt.DTypeLike,
    sample_range: SampleRange | None = None,
    metadata: Metadata | None = None,
) -> Picture:
    """The picture of samples [H, W, C] in 0..1, the inverse of `to_unit`.

    Values are clipped to 0..1, mapped to the sample range (by default the full range of `dtype`) in float32
    and, for integers, rounded to nearest with ties to even.
    """
    dtype = np.dtype(dtype)
    sample_range = sample_range or full_range(dtype)
    low, span = _affine(channels, unit.shape[2], dtype, sample_range)
    samples = np.clip(unit, 0.0, 1.0).astype(np.float32, copy=False)
    samples *= span
    samples += low
    if dtype.kind == "u":
        np.rint(samples, out=samples)
        np.clip(samples, *full_range(dtype), out=samples)
    return Picture(samples.astype(dtype, copy=False), channels, sample_range, metadata or Metadata())


def convert(picture: Picture, depth: int) -> Picture:
    """The picture in 8 or 16-bit integers or 32-bit float, its sample range mapped to the full range of that
    type. So is the nodata value; one outside the sample range is forgotten.

    Raises UsageError for any other depth.
    """
    if depth not in _DTYPE_OF_DEPTH:
        raise UsageError(f"depth must be 8, 16 or 32 bits, not {depth}")
    dtype = _DTYPE_OF_DEPTH[depth]
    if picture.pixels.dtype == dtype:
        return picture

    def mapped(value: float) -> float | None:
        low, high = picture.sample_range
        if isinstance(low, tuple) or isinstance(high, tuple) or picture.nodata is None or not low <= value <= high:
            return None
        sample = Picture(np.full((1, 1, 1), value, picture.pixels.dtype), "gray", picture.sample_range)
        return float(from_unit(to_unit(sample), "gray", dtype).pixels[0, 0, 0])

    metadata = replace(picture.metadata, geo=geo.resampled(picture.metadata.geo, mapped))
    return from_unit(to_unit(picture), picture.channels, dtype, None, metadata)


def _affine(
    channels: str, count: int, dtype: np.dtype[Any], sample_range: SampleRange
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Of each channel [C], or of all [1] where they are alike, which numpy computes faster with: the sample that stands
    for 0, and the distance to the one that stands for 1.
    """
    low, high = np.empty(count, np.float64), np.empty(count, np.float64)
    low[: alpha_index(channels)], high[: alpha_index(channels)] = sample_range
    if (alpha := alpha_index(channels)) is not None:
        low[alpha], high[alpha] = full_range(dtype)
    if (low == low[0]).all() and (high == high[0]).all():
        low, high = low[:1], high[:1]
    return low.astype(np.float32), (high - low).astype(np.float32)
