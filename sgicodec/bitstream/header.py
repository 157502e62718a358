"""The header chunk: what picture this is and what kind of model it holds (docs/format.md, "Header fields")."""

from __future__ import annotations

import struct
from dataclasses import dataclass, replace
from typing import Any, Literal

from sgicodec import _native
from sgicodec.bitstream.varint import encode_varint
from sgicodec.metadata.layouts import SampleRange, alpha_index, band_ranges
from sgicodec.model.spec import ContextSpec, ModelSpec
from sgicodec.model.tile_grid import TileGrid

__all__ = [
    "COLOURED_LAYOUTS",
    "FORMAT_VERSION",
    "LAYOUT_NAMES",
    "MAX_APRON",
    "MAX_CHANNELS",
    "MAX_SIDE",
    "MAX_TILES",
    "MIN_TILE",
    "SAMPLE_TYPES",
    "Header",
    "Masked",
    "decode_header",
    "encode_header",
]

FORMAT_VERSION = 7
"""The only one that is written and read: until 1.0 the format may change, and then gets another number."""

Masked = Literal["transparent", "nodata"]

LAYOUT_NAMES = ("multi", "gray", "gray+alpha", "rgb", "rgba")
COLOURED_LAYOUTS = ("rgb", "rgba")
"""Those that can be in luma space."""
SAMPLE_TYPES = ("uint8", "uint16", "float32")
_SAMPLE_BYTES = (1, 2, 4)
_LARGEST = {"uint8": 255.0, "uint16": 65535.0}
"""The sample of an integer type that stands for 1 where no range is stated."""
_LAYOUTS, _SHAPES = ("adaptive", "uniform"), ("log", "rotation")
_PROFILES = ("default", "paper")

MAX_SIDE = 1 << 24
MAX_CHANNELS = 64
MAX_TILES = 1 << 20
MIN_TILE, MAX_APRON = 32, 256

_SKIP, _SEED_SCALES, _TILED, _TEXTURE, _LUMA, _RESTORATION, _RANGES, _BAND_MASKS, _EXACT = (
    *(1, 2, 4, 32, 64, 128),
    *(256, 512, 1024),
)
_MASKED: dict[Masked | None, int] = {None: 0, "transparent": 8, "nodata": 16}


@dataclass(frozen=True)
class Header:
    """width, height in pixels; channels: the layout's name; sample_type: numpy's name; sample_range: the colour samples
    that 0 and 1 of the model mean, two numbers, or two tuples with one for each band. quality: index of the base colour
    step; family: of the frequency tables. tile: largest side of a tile without its apron, 0 if there is one; apron: how
    far it reaches over its neighbours. masked: whether tiles say which pixels are "transparent", or "nodata" with the
    value `nodata`; has_band_masks: whether they may say so of each band; has_exact: whether they list samples that
    they state exactly.
    """

    width: int
    height: int
    channels: str
    sample_type: str
    sample_range: SampleRange
    profile: str
    spec: ModelSpec
    quality: int
    family: int
    tile: int = 0
    apron: int = 0
    masked: Masked | None = None
    nodata: float = 0.0
    has_band_masks: bool = False
    has_exact: bool = False

    @property
    def colours(self) -> int:
        """Channels but for alpha."""
        return self.spec.channels - (alpha_index(self.channels) is not None)

    @property
    def blank(self) -> float | None:
        """The sample that means that nothing was measured, None for none."""
        return self.nodata if self.masked == "nodata" else None

    @property
    def grid(self) -> TileGrid:
        """Where the tiles are."""
        return TileGrid(self.width, self.height, self.tile, self.apron)

    @property
    def sample_bytes(self) -> int:
        """Of a sample."""
        return _SAMPLE_BYTES[SAMPLE_TYPES.index(self.sample_type)]

    def of_tile(self, number: int) -> Header:
        """The header that a tile's model would have as a picture of its own."""
        _, _, width, height = self.grid.rect(number)
        return replace(self, width=width, height=height, tile=0, apron=0)


def encode_header(header: Header) -> bytes:
    """The payload of chunk H."""
    spec, context = header.spec, header.spec.context
    flags = _SKIP * spec.skip + _SEED_SCALES * spec.seed_scales + _TILED * bool(header.tile) + _MASKED[header.masked]
    flags += _TEXTURE * spec.texture + _LUMA * spec.luma_space
    flags += _RESTORATION * spec.restoration + _BAND_MASKS * header.has_band_masks + _EXACT * header.has_exact
    ranges = _stated_ranges(header)
    flags += _RANGES * (bool(ranges) and (header.sample_type != "float32" or len(ranges) > 1))
    fields = [
        FORMAT_VERSION,
        header.width,
        header.height,
        spec.channels,
        LAYOUT_NAMES.index(header.channels),
        SAMPLE_TYPES.index(header.sample_type),
        _PROFILES.index(header.profile),
        _LAYOUTS.index(spec.layout),
        _SHAPES.index(spec.shape),
        flags,
        spec.per_seed,
        spec.features,
        spec.hidden,
        spec.base_cell,
        header.quality,
        header.family,
        context.prior,
        context.hidden,
        context.neighbours,
        len(context.hash_resolutions),
        *context.hash_resolutions,
    ]
    if context.hash_resolutions:
        fields += [context.hash_features, context.hash_log2_entries]
    if header.tile:
        fields += [header.tile, header.apron]
    payload = b"".join(encode_varint(value) for value in fields)
    if flags & _RANGES:
        payload += encode_varint(len(ranges))
    for low, high in ranges:
        payload += struct.pack("<2f", low, high)
    if header.masked == "nodata":
        payload += struct.pack("<d", header.nodata)
    return payload


def _stated_ranges(header: Header) -> list[tuple[float, float]]:
    """The ranges that the header states: none of integers that span their type, one where all bands have the same."""
    ranges = band_ranges(header.sample_range, header.colours)
    if len(set(ranges)) == 1:
        ranges = ranges[:1]
    return [] if ranges == [(0.0, _LARGEST.get(header.sample_type))] else ranges


def decode_header(payload: bytes) -> Header:
    """Reads chunk H. Raises UnsupportedStreamError for another version, LimitError for a field beyond its cap and
    CorruptStreamError for fields that contradict each other.
    """
    fields = _native.decode_header(payload)
    channels = LAYOUT_NAMES[fields["channels"]]
    low, high = (tuple(fields.pop(name))[: alpha_index(channels)] for name in ("low", "high"))
    same = len(set(zip(low, high, strict=True))) == 1
    return Header(
        **fields
        | {
            "channels": channels,
            "sample_type": SAMPLE_TYPES[fields["sample_type"]],
            "sample_range": (low[0], high[0]) if same else (low, high),
            "profile": _PROFILES[fields["profile"]],
            "masked": tuple(_MASKED)[fields["masked"]],
            "spec": _spec(fields["spec"]),
        }
    )


def _spec(fields: dict[str, Any]) -> ModelSpec:
    """From the fields as native code gives them: enumerations as numbers."""
    context = fields.pop("context")
    context["hash_resolutions"] = tuple(context["hash_resolutions"])
    fields |= {"layout": _LAYOUTS[fields["layout"]], "shape": _SHAPES[fields["shape"]]}
    spec = ModelSpec(**fields, context=ContextSpec(steps=(), **context))
    names = tuple(group.name for group in spec.groups)
    steps = tuple((name,) for name in names) if spec.skip else (names,)
    return replace(spec, context=replace(spec.context, steps=steps))
