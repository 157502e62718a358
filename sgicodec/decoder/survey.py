"""What all tiles of a stream hold together."""

from __future__ import annotations

from typing import NamedTuple

from sgicodec import _native

_PARTS = (
    *("steps", "base", "positions", "decoders", "hash grid", "context model"),
    *("colour", "shape", "feature", "scales", "offset", "restoration", "texture", "check"),
)
_CELLS = (8, 16, 32)


class Survey(NamedTuple):
    """What all tiles hold together: number of seeds, bytes of each part, checksum of all decoded symbols, and how many
    cells of texture there are, by their side in pixels.
    """

    seeds: int
    part_bytes: dict[str, float]
    symbol_crc: int
    texture_cells: dict[int, int]


def survey_of(native: _native.Stream, has_mask: bool) -> Survey:
    """Decodes all tiles. Raises CorruptStreamError or LimitError."""
    seeds, parts, mask, crc, cells = native.survey()
    part_bytes = {name: size for name, size in zip(_PARTS, parts, strict=True) if size}
    if has_mask:
        part_bytes["mask"] = mask
    return Survey(seeds, part_bytes, crc, dict(zip(_CELLS, cells, strict=True)) if any(cells) else {})
