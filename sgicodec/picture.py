"""What a picture is: samples, their layout and range, and the metadata that travels with them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from sgicodec.errors import UsageError
from sgicodec.metadata import geo
from sgicodec.metadata.blobs import Metadata
from sgicodec.metadata.layouts import LAYOUTS, WITHOUT_ALPHA, alpha_index

__all__ = [
    "Metadata",
    "Picture",
    "convert",
    "equal_samples",
    "from_unit",
    "full_range",
    "nodata_mask",
    "opaque_mask",
    "to_rgb8",
    "to_unit",
    "without_opaque_alpha",
]

Samples = npt.NDArray[Any]

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
    sample_range: the values of a colour sample that stand for 0 and 1. Alpha always spans its type: 0 to 255,
                  65535 or 1.0.

    Raises UsageError when the parts contradict each other.
    """

    pixels: Samples
    channels: str
    sample_range: tuple[float, float]
    metadata: Metadata = field(default_factory=Metadata)

    def __post_init__(self) -> None:
        if not isinstance(self.pixels, np.ndarray):
            raise UsageError(f"pixels must be an array of numpy, not {type(self.pixels).__name__}")
        if self.pixels.ndim != 3 or 0 in self.pixels.shape:
            raise UsageError(f"pixels must be [H, W, C] and not empty, not of shape {self.pixels.shape}")
        if self.pixels.dtype not in _DTYPE_OF_DEPTH.values():
            raise UsageError(f"pixels must be uint8, uint16 or float32, not {self.pixels.dtype}")
        if self.channels != "multi" and LAYOUTS.get(self.channels) != self.pixels.shape[2]:
            raise UsageError(f"{self.pixels.shape[2]} channels cannot be {self.channels!r}")
        try:
            low, high = (float(value) for value in self.sample_range)
        except (TypeError, ValueError):
            raise UsageError(f"sample_range {self.sample_range!r}; it must be two numbers") from None
        if not (np.isfinite(low) and np.isfinite(high) and low < high <= low + np.finfo(np.float32).max):
            raise UsageError(f"the sample range must be two finite numbers, low before high, not {low:g} to {high:g}")

    def __repr__(self) -> str:
        low, high = self.sample_range
        kept = [name for name in ("icc", "exif", "xmp", "geo") if getattr(self.metadata, name) is not None]
        what = f"{self.width}×{self.height} {self.channels} {self.pixels.dtype}, {low:g} to {high:g}"
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
        return geo.nodata(self.metadata.geo, self.pixels.dtype)


def equal_samples(pixels: Samples, value: float) -> npt.NDArray[np.bool_]:
    """Which samples are `value`, of the shape of `pixels`; not-a-number equals itself."""
    return np.isnan(pixels) if np.isnan(value) else pixels == pixels.dtype.type(value)


def nodata_mask(picture: Picture) -> npt.NDArray[np.bool_]:
    """Which pixels [H, W] were not measured: those whose samples, but for alpha, all have the nodata value."""
    nodata = picture.nodata
    if nodata is None:
        return np.zeros(picture.pixels.shape[:2], np.bool_)
    return np.asarray(equal_samples(picture.pixels[..., : picture.alpha], nodata).all(axis=-1))


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
    unit -= low
    unit /= span
    np.clip(unit, 0.0, 1.0, out=unit)
    if picture.nodata is not None and np.isnan(picture.nodata):
        unit[np.isnan(unit)] = 0.0
    return unit


def comparable(picture: Picture) -> Samples:
    """What an error is measured on: integers as they are, floats on the scale where their range is 0..1."""
    return picture.pixels if picture.pixels.dtype.kind == "u" else to_unit(picture)


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
    sample_range: tuple[float, float] | None = None,
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
        if picture.nodata is None or not low <= value <= high:
            return None
        sample = Picture(np.full((1, 1, 1), value, picture.pixels.dtype), "gray", picture.sample_range)
        return float(from_unit(to_unit(sample), "gray", dtype).pixels[0, 0, 0])

    metadata = replace(picture.metadata, geo=geo.resampled(picture.metadata.geo, mapped))
    return from_unit(to_unit(picture), picture.channels, dtype, None, metadata)


def _affine(
    channels: str, count: int, dtype: np.dtype[Any], sample_range: tuple[float, float]
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Per channel [C]: the sample that stands for 0, and the distance to the one that stands for 1."""
    low = np.full(count, sample_range[0], np.float64)
    high = np.full(count, sample_range[1], np.float64)
    alpha = alpha_index(channels)
    if alpha is not None:
        low[alpha], high[alpha] = full_range(dtype)
    return low.astype(np.float32), (high - low).astype(np.float32)
