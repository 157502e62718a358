"""Pixels per unit of length, as JFIF and PNG state them (JFIF 1.02; PNG 3, §11.3.4.3) and as the tags of TIFF do."""

from __future__ import annotations

import struct
from typing import NamedTuple

from sgicodec.metadata import geo, ifd

_X, _Y, _UNIT = 282, 283, 296
_NONE, _INCH, _CENTIMETRE = 1, 2, 3
_PER_METRE = {_INCH: 1 / 0.0254, _CENTIMETRE: 100.0}
_RATIONAL, _SHORT = 5, 3

_DEFAULT, _DEFAULT_PER_CENTIMETRE = 72.0 / 0.0254, 28
"""What programs and cameras write where they know nothing, in pixels per metre, and in whole ones per centimetre."""


class Density(NamedTuple):
    """Pixels per unit across and down, as fractions; the unit as in TIFF: 1 none, 2 inch, 3 centimetre."""

    across: tuple[int, int]
    down: tuple[int, int]
    unit: int

    def per(self, unit: int) -> tuple[float, float]:
        """Pixels per another unit of length, or of the own one."""
        factor = _PER_METRE[self.unit] / _PER_METRE[unit] if unit != self.unit else 1.0
        return self.across[0] / self.across[1] * factor, self.down[0] / self.down[1] * factor

    @property
    def dpi(self) -> tuple[float, float] | None:
        """Pixels per inch; None without a unit."""
        return None if self.unit == _NONE else self.per(_INCH)

    @property
    def says_nothing(self) -> bool:
        """Whether it is what is written for want of a measurement."""
        across, down = self.per(self.unit)
        if self.unit == _NONE or (self.unit, across) == (_CENTIMETRE, _DEFAULT_PER_CENTIMETRE):
            return across == down
        return across == down and abs(across * _PER_METRE[self.unit] / _DEFAULT - 1) < 1e-3

    def tags(self) -> dict[int, ifd.Entry]:
        """The tags of TIFF that state it."""
        pairs = ((_X, self.across), (_Y, self.down))
        entries = {tag: ifd.Entry(_RATIONAL, struct.pack("<II", *pair)) for tag, pair in pairs}
        return {**entries, _UNIT: ifd.Entry(_SHORT, struct.pack("<H", self.unit))}


def density(metadata_geo: bytes | None, exif: bytes | None) -> Density | None:
    """What the blobs of a picture state, `geo` first; None where they say nothing."""
    found = (of_tags(tags) for tags in (geo.load(metadata_geo), ifd.entries(exif, geo.RESOLUTION)))
    return next((each for each in found if each is not None and not each.says_nothing), None)


def of_tags(entries: dict[int, ifd.Entry]) -> Density | None:
    """What these tags state, None where they do not."""
    pair = [entries.get(tag) for tag in (_X, _Y)]
    ratios = [struct.unpack("<II", e.data) for e in pair if e is not None and (e.kind, len(e.data)) == (_RATIONAL, 8)]
    unit = entries.get(_UNIT)
    kind = _INCH if unit is None else unit.short
    if len(ratios) < 2 or kind not in (_NONE, *_PER_METRE) or not all(map(all, ratios)):
        return None
    return Density(ratios[0], ratios[1], kind)


def per_inch(pair: object) -> Density | None:
    """That of two numbers of pixels per inch, as Pillow has them; None of anything else."""
    from fractions import Fraction  # takes long to load

    try:
        across, down = (Fraction(float(value)).limit_denominator(1 << 16) for value in pair)  # type: ignore[attr-defined]
    except (TypeError, ValueError, OverflowError, ZeroDivisionError):
        return None
    is_sound = all(0 < ratio < 1 << 16 for ratio in (across, down))
    return Density(across.as_integer_ratio(), down.as_integer_ratio(), _INCH) if is_sound else None


def tags(found: Density | None, exif: bytes | None) -> bytes | None:
    """The `geo` blob of a picture whose file states this beside its EXIF; None where that has a resolution, or where it
    says nothing.
    """
    if found is None or found.says_nothing or density(None, exif) is not None:
        return None
    return geo.pack(found.tags())
