"""A tile: one whole model as one payload, its parts in a fixed order (docs/format.md, "Tile parts").

Writing is done here, part by part; reading is native (native/bitstream/tile.cpp).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec import _native
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.header import Header, encode_header
from sgicodec.bitstream.limits import check_model, max_seeds
from sgicodec.bitstream.parts.arrays import write_base, write_signs, write_weights
from sgicodec.bitstream.parts.attributes import QuantisedAttributes, quantise_attributes, write_attributes
from sgicodec.bitstream.parts.positions import write_positions, write_tree
from sgicodec.bitstream.parts.restoration import write_restoration
from sgicodec.bitstream.parts.texture import layer_of, write_texture
from sgicodec.device import ONE_THREAD, Device
from sgicodec.errors import LimitError
from sgicodec.model.base import base_shape
from sgicodec.model.context import hash_grid, network_shapes
from sgicodec.model.gaussians import decoder_shapes
from sgicodec.model.layout import SeedLayout
from sgicodec.model.network import IntNetwork
from sgicodec.model.quantization import FRACTION_BITS
from sgicodec.model.restoration import Restoration
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import StepPlan, default_plan, follows_amplitude
from sgicodec.model.texture_symbols import TextureSymbols

__all__ = ["TileModel", "quantise", "read_tile", "write_networks", "write_tile"]

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_SHIFT_BITS, _GAMMA_BITS, _STEP_BITS = 5, 6, 8


@dataclass
class TileModel:
    """A model as the stream holds it. attributes: float by group [N, size], of a model that is to be written; decoded:
    [N, d_A] in units of 2^-24, of one that was read. base: integer grid [C, rows, columns] in steps of index
    `base_step`. decoders: in units of 2^-decoder_shift, which has 5 bits. texture, restoration: None for none.
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


def quantise(header: Header, model: TileModel) -> QuantisedAttributes:
    """The attributes of a model as a stream will hold them. Nothing is coded."""
    if model.attributes is None:
        raise ValueError("the tile has no attributes: it was read, not fitted")
    known = model.layout, model.plan, model.networks, model.hash_tables
    return quantise_attributes(header, *known, model.attributes)


def write_tile(header: Header, model: TileModel) -> tuple[bytes, SymbolWriter]:
    """A model as the payload of its tile's chunk ends with it, and the writer with the bits of every part.

    Raises LimitError for a model that `read_tile` would refuse.
    """
    spec, size = header.spec, (header.width, header.height)
    check_model(spec, *size)
    writer = SymbolWriter()
    with writer.part("steps"):
        _write_plan(writer, spec, header.quality, model.plan)
    if spec.base_cell:
        with writer.part("base"):
            writer.code_int(model.base_step, _STEP_BITS)
            write_base(writer, model.base, (spec.channels, *base_shape(*size, spec.base_cell)))
    with writer.part("positions"):
        write = write_tree if spec.layout == "adaptive" else write_positions
        write(writer, size, (model.layout.corner, model.layout.log_size))
    with writer.part("decoders"):
        if spec.hidden:
            writer.code_int(model.decoder_shift, _SHIFT_BITS)
        for name, shape in decoder_shapes(spec).items():
            write_weights(writer, model.decoders[name], shape)
    with writer.part("hash grid"):
        if counts := hash_grid(spec.context, *size).counts:
            write_signs(writer, np.concatenate([table.reshape(-1) for table in model.hash_tables]), counts)
    with writer.part("context model"):
        write_networks(writer, spec, model.networks)
    write_attributes(writer, quantise(header, model))
    if spec.restoration:
        with writer.part("restoration"):
            write_restoration(writer, model.restoration)
    if spec.texture:
        with writer.part("texture"):
            write_texture(writer, size, spec.channels, model.texture)
    payload = writer.finish()  # ends with the CRC of all symbols
    seeds = len(model.layout)
    if seeds > max_seeds(spec, *size, len(payload)):
        raise LimitError(f"{seeds} seeds in a tile of {len(payload)} bytes; a decoder would refuse it")
    return payload, writer


def read_tile(header: Header, payload: bytes, device: Device = ONE_THREAD) -> tuple[TileModel, _native.TileModel]:
    """The model of a payload, and the same as the decoder has it, with the bits of every part and the CRC of all
    symbols. Raises CorruptStreamError where the decoded symbols are not those that were written and LimitError, before
    it takes memory, for a model beyond the caps.
    """
    read = _native.read_tile(encode_header(header), payload, device.threads, device.isa)
    counts = hash_grid(header.spec.context, header.width, header.height).counts
    signs = np.split(read.signs.astype(np.int64), np.cumsum(counts)[:-1]) if counts else []
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
        restoration=None if read.restoration is None else _restoration(header, *read.restoration),
        decoder_shift=read.decoder_shift,
    )
    return model, read


def _restoration(header: Header, network: int, step: int) -> Restoration:
    return Restoration(header.network if network == _native.OWN_NETWORK else network, step)


def _write_plan(writer: SymbolWriter, spec: ModelSpec, quality: int, plan: StepPlan) -> None:
    for name, index in default_plan(spec, quality).base.items():
        write_weights(writer, plan.base[name] - index, index.shape)
        if follows_amplitude(spec, name):
            writer.code_int(plan.gamma[name], _GAMMA_BITS)


def write_networks(writer: SymbolWriter, spec: ModelSpec, networks: tuple[IntNetwork, ...]) -> None:
    """The weights of MLP_p, nothing where it is shipped."""
    if spec.context.prior:
        return
    for number, network in enumerate(networks):
        writer.code_int(network.shift, _SHIFT_BITS)
        for name, shape in network_shapes(spec, number).items():
            write_weights(writer, getattr(network, name), shape)
