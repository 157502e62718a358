"""The header chunk, read as docs/format.md says: what the native reader is compared with."""

from __future__ import annotations

import struct
from dataclasses import replace
from typing import Any

import numpy as np
from page_varint import decode_varint
from restoration_reader import network_of

from sgicodec.bitstream.header import Header, Masked
from sgicodec.errors import CorruptStreamError, LimitError, UnsupportedStreamError
from sgicodec.metadata.layouts import SampleRange, band_ranges
from sgicodec.model.spec import ContextSpec, ModelSpec

FORMAT_VERSION = 1
MAX_SIDE, MAX_CHANNELS, MAX_TILES, MIN_TILE, MAX_APRON = 1 << 24, 64, 1 << 20, 32, 256
LAYOUT_NAMES = ("multi", "gray", "gray+alpha", "rgb", "rgba")
SAMPLE_TYPES = ("uint8", "uint16", "float32")
MAX_FEATURES, MAX_HIDDEN, MAX_HASH_LEVELS, MAX_HASH_RESOLUTION = 1 << 13, 1 << 12, 32, 1 << 14
_LAYOUTS, _PROFILES = ("adaptive", "uniform"), ("default", "paper")
_TILED, _TEXTURE, _LUMA = 1, 8, 16
_RESTORATION, _RANGES, _BAND_MASKS, _EXACT, _NETWORK = 32, 64, 128, 256, 512
_ALL_FLAGS = 1023
_MASKED: dict[Masked | None, int] = {None: 0, "transparent": 2, "nodata": 4}


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

    def unpack(self, what: str, layout: str) -> tuple[Any, ...]:
        start, self.at = self.at, self.at + struct.calcsize(layout)
        if self.at > len(self.data):
            raise CorruptStreamError(f"header: ends before {what}")
        return struct.unpack_from(layout, self.data, start)


def decode_header(payload: bytes) -> Header:
    """Reads chunk H. Raises UnsupportedStreamError for another version, LimitError for a field beyond its cap and
    CorruptStreamError for fields that contradict each other.
    """
    fields = _Fields(payload)
    version = fields.take("the format version", 0, 1 << 20)
    if version != FORMAT_VERSION:
        raise UnsupportedStreamError(
            f"header: format version {version}; this program reads version {FORMAT_VERSION} alone"
        )
    width, height = fields.take("the width", 1, MAX_SIDE), fields.take("the height", 1, MAX_SIDE)
    channels = fields.take("the number of channels", 1, MAX_CHANNELS)
    layout_name = LAYOUT_NAMES[fields.take("the channel layout", 0, len(LAYOUT_NAMES) - 1)]
    sample_type = SAMPLE_TYPES[fields.take("the sample type", 0, len(SAMPLE_TYPES) - 1)]
    profile = _PROFILES[fields.take("the profile", 0, len(_PROFILES) - 1)]
    flags, masked, spec, colour_step, family = _model(fields, channels)
    tile = fields.take("the tile size", MIN_TILE, MAX_SIDE) if flags & _TILED else 0
    apron = fields.take("the apron", 0, min(tile // 4, MAX_APRON)) if flags & _TILED else 0
    colours = channels - (layout_name in ("gray+alpha", "rgba"))
    sample_range = _ranges(fields, sample_type, colours, bool(flags & _RANGES))
    nodata = fields.unpack("the nodata value", "<d")[0] if masked == "nodata" else 0.0
    band_masks, exact = bool(flags & _BAND_MASKS), bool(flags & _EXACT)
    network = b""
    if flags & _NETWORK:
        what = "the network of restoration"
        (network,) = fields.unpack(what, f"{fields.take(what, 1, 1 << 14)}s")
    if fields.at != len(payload):
        raise CorruptStreamError("header: longer than its fields")
    header = Header(
        *(width, height, layout_name, sample_type, sample_range, profile, spec, colour_step, family),
        *(tile, apron, masked, nodata, band_masks, exact, network),
    )
    _check_model(header)
    _check_samples(header)
    _check_tiles(header)
    if network and not header.spec.restoration:
        raise CorruptStreamError("header: a network of restoration that no tile can name")
    if network and not _is_network(network):
        raise CorruptStreamError("header: a network of restoration that cannot be")
    return header


def _is_network(file: bytes) -> bool:
    """Whether the file of a network is sound, and no sum can reach 2³¹ for inputs up to 32767."""
    try:
        network = network_of(file)
    except (AssertionError, IndexError, ValueError):
        return False
    outputs = [len(weights) for weights in network.weights]
    inputs = [weights.shape[1] for weights in network.weights]
    sums = (
        np.abs(weights).sum(axis=(1, 2, 3)) * 32767 + 64 * np.abs(biases)
        for weights, biases in zip(network.weights, network.biases, strict=True)
    )
    return (
        2 <= len(outputs) <= 6
        and inputs == [3, *outputs[:-1]]
        and outputs[-1] == 3
        and all(count % 4 == 0 and 0 < count <= 64 for count in outputs[:-1])
        and max(network.k, *network.shifts) < 31
        and all(most.max() < 2**31 for most in sums)
    )


def _check_model(header: Header) -> None:
    spec, channels = header.spec, header.spec.channels
    context = spec.context
    if spec.layout == "adaptive":
        sound = (spec.per_seed, spec.features, spec.hidden, context.hash_resolutions) == (1, channels + 3, 0, ())
    else:
        sound = spec.hidden > 0 and not context.neighbours
    if not sound:
        raise CorruptStreamError("header: settings that contradict each other")
    if spec.luma_space and (header.channels not in ("rgb", "rgba") or spec.layout != "adaptive"):
        raise CorruptStreamError(f"header: {header.channels} has no luma space")
    expected = {"multi": channels, "gray": 1, "gray+alpha": 2, "rgb": 3, "rgba": 4}[header.channels]
    if expected != channels:
        raise CorruptStreamError(f"header: {channels} channels cannot be {header.channels}")


def _check_samples(header: Header) -> None:
    for low, high in band_ranges(header.sample_range, header.colours):
        _check_range(low, high, header.sample_type)
    if header.masked == "transparent" and header.channels not in ("gray+alpha", "rgba"):
        raise CorruptStreamError(f"header: {header.channels} has no transparent pixels")
    if header.has_band_masks and (header.masked != "nodata" or header.colours < 2):
        raise CorruptStreamError("header: masks of bands without nodata, or of a single band")
    if header.masked == "nodata" and not _is_sample(header.nodata, header.sample_type):
        raise CorruptStreamError(f"header: no sample of {header.sample_type} is {header.nodata:g}")


def _model(fields: _Fields, channels: int) -> tuple[int, Masked | None, ModelSpec, int, int]:
    """From the seed layout to the hash entries: flags, masked, spec, index of the base colour step, family."""
    layout = _LAYOUTS[fields.take("the seed layout", 0, 1)]
    flags = fields.take("the flags", 0, _ALL_FLAGS)
    masked = _masked(flags)
    per_seed = fields.take("K", 1, 64)
    features = fields.take("D", 1, MAX_FEATURES)
    hidden = fields.take("the decoders' width", 0, MAX_HIDDEN)
    base_cell = fields.take("the base cell", 0, 1 << 12)
    colour_step, family = fields.take("the base step", 0, 255), fields.take("the table family", 0, 1)
    prior = fields.take("the prior", 0, 255)
    context_hidden = fields.take("the context model's width", 1, MAX_HIDDEN)
    neighbours = fields.take("the neighbours", 0, 6)
    levels = fields.take("the hash levels", 0, MAX_HASH_LEVELS)
    resolutions = tuple(fields.take("a hash resolution", 1, MAX_HASH_RESOLUTION) for _ in range(levels))
    hash_features = fields.take("the hash features", 1, 64) if levels else ContextSpec.hash_features
    hash_entries = fields.take("the hash entries", 1, 20) if levels else ContextSpec.hash_log2_entries
    context = ContextSpec(prior, (), context_hidden, neighbours, resolutions, hash_features, hash_entries)
    spec = ModelSpec(channels, layout, per_seed, features, hidden, base_cell, context)  # type: ignore[arg-type]
    names = tuple(group.name for group in spec.groups)
    steps = tuple((name,) for name in names) if layout == "adaptive" else (names,)
    context = replace(context, steps=steps)
    textured, luma_space = bool(flags & _TEXTURE), bool(flags & _LUMA)
    spec = replace(spec, context=context, texture=textured, luma_space=luma_space)
    spec = replace(spec, restoration=bool(flags & _RESTORATION))
    return flags, masked, spec, colour_step, family


def _check_tiles(header: Header) -> None:
    if header.tile and header.grid.count == 1:
        raise CorruptStreamError(f"header: a picture of one tile states a tile size of {header.tile}")
    if header.grid.count > MAX_TILES:
        raise LimitError(f"header: {header.grid.count} tiles; this version takes at most {MAX_TILES}")


def _masked(flags: int) -> Masked | None:
    for masked, flag in _MASKED.items():
        if flags & (_MASKED["transparent"] | _MASKED["nodata"]) == flag:
            return masked
    raise CorruptStreamError("header: pixels are either transparent or without data")


def _is_sample(value: float, sample_type: str) -> bool:
    largest = {"uint8": 255, "uint16": 65535}.get(sample_type)
    return largest is None or (0 <= value <= largest and value == int(value))


def _ranges(fields: _Fields, sample_type: str, colours: int, stated: bool) -> SampleRange:
    whole = {"uint8": 255.0, "uint16": 65535.0}.get(sample_type)
    if whole is not None and not stated:
        return 0.0, whole
    count = fields.take("the sample ranges", 1, colours) if stated else 1
    if count not in (1, colours):
        raise CorruptStreamError("header: sample ranges of another number of channels")
    if count == 1 and stated and whole is None:
        raise CorruptStreamError("header: a flag for one sample range of floats")
    lows, highs = zip(*(fields.unpack("the sample range", "<2f") for _ in range(count)), strict=True)
    one = len(set(zip(lows, highs, strict=True))) == 1
    return (lows[0], highs[0]) if one else (lows, highs)


def _check_range(low: float, high: float, sample_type: str) -> None:
    sound = abs(low) <= 1e38 and abs(high) <= 1e38 and low < high
    if not (sound and _is_sample(low, sample_type) and _is_sample(high, sample_type)):
        raise CorruptStreamError(f"header: a sample range of {low:g} to {high:g}")
