"""The header chunk: what picture this is and what kind of model it holds (docs/format.md, "Header fields")."""

from __future__ import annotations

import struct
from dataclasses import dataclass, replace

from sgicodec.bitstream.varint import decode_varint, encode_varint
from sgicodec.errors import CorruptStreamError, LimitError, UnsupportedStreamError
from sgicodec.model.spec import ContextSpec, ModelSpec

__all__ = ["FORMAT_VERSION", "LAYOUT_NAMES", "SAMPLE_TYPES", "Header", "decode_header", "encode_header"]

FORMAT_VERSION = 1

LAYOUT_NAMES = ("multi", "gray", "gray+alpha", "rgb", "rgba")
SAMPLE_TYPES = ("uint8", "uint16", "float32")
_LAYOUTS, _SHAPES = ("adaptive", "uniform"), ("log", "rotation")
_PROFILES = ("default", "paper")

MAX_SIDE = 1 << 24
MAX_CHANNELS = 64
MAX_FEATURES = 1 << 13
MAX_HIDDEN = 1 << 12
MAX_HASH_LEVELS = 32
MAX_HASH_RESOLUTION = 1 << 14

_SKIP, _SEED_SCALES, _GROUPED, _COARSE_FIRST = 1, 2, 4, 8


@dataclass(frozen=True)
class Header:
    """width, height in pixels; channels: the layout's name; sample_type: numpy's name; sample_range: what 0 and 1 of
    the model mean. quality: index of the base colour step; family: of the frequency tables.
    """

    width: int
    height: int
    channels: str
    sample_type: str
    sample_range: tuple[float, float]
    profile: str
    spec: ModelSpec
    quality: int
    family: int


def encode_header(header: Header) -> bytes:
    """The payload of chunk H."""
    spec, context = header.spec, header.spec.context
    flags = _SKIP * spec.skip + _SEED_SCALES * spec.seed_scales + _GROUPED * (len(context.steps) > 1)
    flags += _COARSE_FIRST * context.coarse_first
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
    payload = b"".join(encode_varint(value) for value in fields)
    if header.sample_type == "float32":
        payload += struct.pack("<2f", *header.sample_range)
    return payload


class _Fields:
    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def take(self, what: str, low: int, high: int) -> int:
        if self.at >= len(self.data):
            raise CorruptStreamError(f"header: ends before {what}")
        try:
            value, self.at = decode_varint(self.data, self.at)
        except CorruptStreamError as error:
            raise CorruptStreamError(f"header: {what}: {error}") from error
        if not low <= value <= high:
            raise LimitError(f"header: {what} is {value}; this version takes {low} to {high}")
        return value


def decode_header(payload: bytes) -> Header:
    """Reads chunk H. Raises UnsupportedStreamError for a newer version, LimitError for a field beyond its cap and
    CorruptStreamError for fields that contradict each other.
    """
    fields = _Fields(payload)
    version = fields.take("the format version", 0, 1 << 20)
    if version != FORMAT_VERSION:
        raise UnsupportedStreamError(f"header: format version {version}; this program reads version {FORMAT_VERSION}")
    width, height = fields.take("the width", 1, MAX_SIDE), fields.take("the height", 1, MAX_SIDE)
    channels = fields.take("the number of channels", 1, MAX_CHANNELS)
    layout_name = LAYOUT_NAMES[fields.take("the channel layout", 0, len(LAYOUT_NAMES) - 1)]
    sample_type = SAMPLE_TYPES[fields.take("the sample type", 0, len(SAMPLE_TYPES) - 1)]
    profile = _PROFILES[fields.take("the profile", 0, len(_PROFILES) - 1)]
    layout, shape = _LAYOUTS[fields.take("the seed layout", 0, 1)], _SHAPES[fields.take("the shape", 0, 1)]
    flags = fields.take("the flags", 0, 15)
    per_seed = fields.take("K", 1, 64)
    features = fields.take("D", 1, MAX_FEATURES)
    hidden = fields.take("the decoders' width", 0, MAX_HIDDEN)
    base_cell = fields.take("the base cell", 0, 1 << 12)
    quality, family = fields.take("the base step", 0, 255), fields.take("the table family", 0, 1)
    prior = fields.take("the prior", 0, 255)
    context_hidden = fields.take("the context model's width", 1, MAX_HIDDEN)
    neighbours = fields.take("the neighbours", 0, 6)
    levels = fields.take("the hash levels", 0, MAX_HASH_LEVELS)
    resolutions = tuple(fields.take("a hash resolution", 1, MAX_HASH_RESOLUTION) for _ in range(levels))
    hash_features = fields.take("the hash features", 1, 64) if levels else ContextSpec.hash_features
    hash_entries = fields.take("the hash entries", 1, 20) if levels else ContextSpec.hash_log2_entries
    grouped, skip, seed_scales = bool(flags & _GROUPED), bool(flags & _SKIP), bool(flags & _SEED_SCALES)
    expected = {"multi": channels, "gray": 1, "gray+alpha": 2, "rgb": 3, "rgba": 4}[layout_name]
    if expected != channels:
        raise CorruptStreamError(f"header: {channels} channels cannot be {layout_name}")
    if skip != grouped or (skip and features < per_seed * (channels + 3)) or (neighbours and not skip):
        raise CorruptStreamError("header: settings that contradict each other")
    coarse_first = bool(flags & _COARSE_FIRST)
    if coarse_first and not neighbours:
        raise CorruptStreamError("header: an order of passes without neighbours")
    context = ContextSpec(prior, (), context_hidden, neighbours, resolutions, hash_features, hash_entries, coarse_first)
    spec = ModelSpec(channels, layout, shape, per_seed, features, hidden, skip, seed_scales, base_cell, context)  # type: ignore[arg-type]
    names = tuple(group.name for group in spec.groups)
    steps = tuple((name,) for name in names) if grouped else (names,)
    spec = replace(spec, context=replace(context, steps=steps))
    sample_range = {"uint8": (0.0, 255.0), "uint16": (0.0, 65535.0)}.get(sample_type) or _range(payload, fields)
    if fields.at != len(payload) - (8 if sample_type == "float32" else 0):
        raise CorruptStreamError("header: longer than its fields")
    return Header(width, height, layout_name, sample_type, sample_range, profile, spec, quality, family)


def _range(payload: bytes, fields: _Fields) -> tuple[float, float]:
    if len(payload) != fields.at + 8:
        raise CorruptStreamError("header: ends before the sample range")
    low, high = struct.unpack_from("<2f", payload, fields.at)
    if not (abs(low) < 1e38 and abs(high) < 1e38 and low < high):
        raise CorruptStreamError(f"header: a sample range of {low:g} to {high:g}")
    return low, high
