"""How the tiles of a TIFF pyramid are compressed: without loss, or by JPEG, WebP or LERC with a stated loss."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from sgicodec.errors import PictureError, UsageError, require

if TYPE_CHECKING:
    import numpy as np


class _Method(NamedTuple):
    """tiff: its name to tifffile; unit: what its number is, from low to high, of which `usual` is the default;
    layouts: of channels that it holds, in 8 bits; None for all in any depth.
    """

    tiff: str
    unit: str | None = None
    usual: float = 0
    low: float = 0
    high: float = 0
    layouts: tuple[str, ...] | None = None


METHODS: Mapping[str, _Method] = MappingProxyType(
    {
        "deflate": _Method("adobe_deflate"),
        "zstd": _Method("zstd"),
        "jpeg": _Method("jpeg", "quality", 85, 1, 100, ("gray", "rgb")),
        "webp": _Method("webp", "quality", 80, 1, 100, ("rgb", "rgba")),
        "lerc": _Method("lerc", "largest error", 0, 0, math.inf),
    }
)
"""By the names that people write."""

_PREDICTED = ("deflate", "zstd")


@dataclass(frozen=True)
class Compression:
    """A method of METHODS and its number: a quality from 1 to 100, or LERC's largest error in levels (of floats in
    their own unit); None where it has none.
    """

    name: str = "deflate"
    number: float | None = None

    @classmethod
    def parse(cls, text: str) -> Compression:
        """What `deflate`, `jpeg` or `jpeg:85` says. Raises UsageError."""
        name, colon, number = text.lower().partition(":")
        method = METHODS.get(name)
        if method is None:
            raise UsageError(f"compression {text!r}; it is one of {', '.join(METHODS)}, as in jpeg:85")
        if method.unit is None:
            if colon:
                raise UsageError(f"compression {text!r}; {name} is without loss and takes no number")
            return cls(name)
        if not colon:
            return cls(name, method.usual)
        value = _number(number)
        if not (method.low <= value <= method.high and value < math.inf):
            upto = f" to {method.high:g}" if method.high < math.inf else " on"
            raise UsageError(f"compression {text!r}; the {method.unit} of {name} is a number from {method.low:g}{upto}")
        return cls(name, value)

    @property
    def is_lossy(self) -> bool:
        """Whether samples change."""
        return METHODS[self.name].layouts is not None or bool(self.number)

    def needs_mask(self, channels: str, nodata: float | None) -> bool:
        """Whether a mask must stand for the nodata value, which loss would give to other samples and take from some.
        Of bands without a meaning each may end elsewhere, and alpha is a mask itself.
        """
        return self.is_lossy and nodata is not None and channels in ("gray", "rgb")

    def check(self, channels: str, dtype: np.dtype[Any], nodata: float | None) -> None:
        """Raises PictureError for samples that it does not hold, MissingExtraError without what compresses.

        nodata: a value that samples must keep.
        """
        layouts = METHODS[self.name].layouts
        other = "; zstd and deflate do, without loss"
        if layouts is not None and dtype != "uint8":
            bits = "floats" if dtype.kind == "f" else f"{8 * dtype.itemsize} bits"
            raise PictureError(f"{self.name} in TIFF holds 8 bits per sample, not {bits}{other}, lerc:ERROR with loss")
        if layouts is not None and channels not in layouts:
            named = "bands without a meaning" if channels == "multi" else channels
            raise PictureError(f"{self.name} in TIFF holds {' and '.join(layouts)}, not {named}{other}")
        if self.is_lossy and nodata is not None:
            raise PictureError(
                f"{self.name} with loss changes which samples are nodata ({nodata:g}); zstd and deflate do not"
            )
        if self.name != "deflate":
            require("imagecodecs", f"compressing TIFF by {self.name}", "tiff")

    def for_tifffile(self, dtype: np.dtype[Any]) -> dict[str, Any]:
        """Arguments of `TiffWriter.write`."""
        number = self.number if self.name == "lerc" or self.number is None else round(self.number)
        arguments: dict[str, Any] = {} if number is None else {"level": number}
        if self.name == "webp":
            arguments["lossless"] = False  # else a level is the effort of a coding without loss
        return {
            "compression": METHODS[self.name].tiff,
            "compressionargs": arguments,
            "predictor": self.name in _PREDICTED and dtype.kind == "u",
        }

    def for_gdal(self) -> dict[str, str]:
        """Creation options of the driver COG."""
        options = {"COMPRESS": self.name.upper()}
        if self.name in _PREDICTED:
            options["PREDICTOR"] = "YES"
        elif self.name == "lerc":
            options["MAX_Z_ERROR"] = f"{self.number:.17g}"
        else:
            options["QUALITY"] = options["OVERVIEW_QUALITY"] = f"{round(self.number or 0)}"
        return options


DEFLATE = Compression()
"""The default, which every reader of TIFF knows."""


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
