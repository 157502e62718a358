"""A tile: one whole model as one payload, its parts in a fixed order (docs/format.md, "Tile parts").

Native code reads and writes it (native/bitstream/tile.cpp).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.arrays import F64, I64
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.device import ONE_THREAD, Device
from sgicodec.model.context import hash_grid
from sgicodec.model.layout import SeedLayout
from sgicodec.model.network import IntNetwork
from sgicodec.model.quantization import FRACTION_BITS
from sgicodec.model.restoration import Restoration
from sgicodec.model.steps import StepPlan
from sgicodec.model.texture_symbols import TextureGrid, TextureIndices, TextureSymbols

TextureSteps = tuple[
    int, list[int], tuple[int, int], tuple[int, int, int], bool, tuple[int, int, int], tuple[bool, int, int]
]
ReadTexture = tuple[TextureSteps, NDArray[np.uint8], NDArray[np.int8], NDArray[np.int16]]
"""A layer of texture as native code has it."""


@dataclass
class TileModel:
    """A model as the stream holds it. attributes: float by group [N, size], of a model that is to be written; decoded:
    [N, d_A] in units of 2^-24, of one that was read or quantised. base: integer grid [C, rows, columns] in steps of
    index `base_step`. decoders: in units of 2^-decoder_shift, which has 5 bits. texture, restoration: None for none.
    """

    layout: SeedLayout
    plan: StepPlan
    base_step: int
    base: I64
    decoders: dict[str, I64]
    networks: tuple[IntNetwork, ...]
    hash_tables: list[I64]
    attributes: dict[str, F64] | None = None
    decoded: I64 | None = None
    texture: TextureSymbols | None = None
    restoration: Restoration | None = None
    decoder_shift: int = 0

    @property
    def decoded_values(self) -> F64:
        """Decoded attributes [N, d_A] as floats."""
        if self.decoded is None:
            raise ValueError("the tile was not read; `quantise` says what it will decode to")
        return np.multiply(self.decoded, 2.0**-FRACTION_BITS, dtype=np.float64)


def quantise(header: Header, model: TileModel) -> TileModel:
    """The model with its attributes as a stream will hold them, too. Nothing is coded."""
    return replace(model, decoded=_native.quantise(encode_header(header), model))


def write_tile(header: Header, model: TileModel) -> tuple[bytes, dict[str, float]]:
    """A model as the payload of its tile's chunk ends with it, and the information content of its parts, by name.

    Raises LimitError for a model that `read_tile` would refuse, UsageError for one that cannot be coded.
    """
    return _native.write_tile(encode_header(header), model)


def read_tile(header: Header, payload: bytes, device: Device = ONE_THREAD) -> tuple[TileModel, _native.TileModel]:
    """The model of a payload, and the same as the decoder has it, with the bits of every part and the CRC of all
    symbols. Raises CorruptStreamError where the decoded symbols are not those that were written and LimitError, before
    it takes memory, for a model beyond the caps.
    """
    read = _native.read_tile(encode_header(header), payload, device.threads, device.isa)
    counts = hash_grid(header.spec.context, header.width, header.height).counts
    signs = np.split(read.signs.astype(np.int64), np.cumsum(counts)[:-1]) if counts else []
    restoration = None
    if read.restoration is not None:
        network, step = read.restoration
        restoration = Restoration(header.network if network == _native.OWN_NETWORK else network, step)
    model = TileModel(
        SeedLayout(read.corner, read.log_size),
        StepPlan({name: base for name, base, _ in read.plan}, {name: gamma for name, _, gamma in read.plan}),
        read.base_step,
        read.base,
        read.decoders,
        tuple(IntNetwork(*network) for network in read.networks),
        [part.reshape(-1, header.spec.context.hash_features) for part in signs],
        decoded=read.decoded,
        texture=layer_of(read.texture, (header.width, header.height)),
        restoration=restoration,
        decoder_shift=read.decoder_shift,
    )
    return model, read


def layer_of(read: ReadTexture | None, size: tuple[int, int]) -> TextureSymbols | None:
    """The texture of a tile of `size` as native code read it."""
    if read is None:
        return None
    (step, ratios, slopes, excess, has_contrast, colours, grid), log_size, contrast, symbols = read
    steps = TextureIndices(step, tuple(ratios), slopes, excess, has_contrast, colours)
    return TextureSymbols(size, steps, log_size, contrast, symbols, TextureGrid(*grid))
