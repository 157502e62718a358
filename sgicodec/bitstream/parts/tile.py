"""A tile: one whole model as one payload, its parts in a fixed order (docs/format.md, "Tile parts")."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sgicodec.bitstream.entropy.symbol_coder import SymbolCoder, SymbolReader, SymbolWriter
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.limits import check_model, hash_counts, max_seeds, network_shapes
from sgicodec.bitstream.parts.arrays import code_base, code_signs, code_weights
from sgicodec.bitstream.parts.attributes import AttributeCoder
from sgicodec.bitstream.parts.positions import code_positions
from sgicodec.bitstream.parts.predicted_positions import code_predicted_positions
from sgicodec.bitstream.parts.predicted_tree import TreeContext
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.bitstream.parts.seed_tree import TreeShape
from sgicodec.bitstream.parts.texture import code_texture
from sgicodec.device import ONE_THREAD, Device
from sgicodec.errors import CorruptStreamError, LimitError
from sgicodec.model.base import base_shape
from sgicodec.model.context import output_count
from sgicodec.model.gaussians import decoder_shapes
from sgicodec.model.layout import ROOT_LOG, SeedLayout
from sgicodec.model.network import DIFFERENCE_SHIFT, IntNetwork
from sgicodec.model.quantization import FRACTION_BITS, STEP_COUNT
from sgicodec.model.spec import ModelSpec
from sgicodec.model.steps import StepPlan, default_plan, follows_amplitude
from sgicodec.model.texture_symbols import TextureSymbols

__all__ = ["DECODER_SHIFT", "TileModel", "code_networks", "read_tile", "write_tile"]

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

DECODER_SHIFT = 10
"""The decoders' weights are multiples of 2^-10."""
_SHIFT_BITS, _GAMMA_BITS, _STEP_BITS = 5, 6, 8


@dataclass
class TileModel:
    """A model as the stream holds it. attributes: float by group [N, size] on the way in; decoded: [N, d_A] in units of
    2^-24 on the way out. base: integer grid [C, rows, columns] in steps of index `base_step`. texture: None for none.
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

    @property
    def decoded_values(self) -> F64:
        """Decoded attributes [N, d_A] as floats."""
        if self.decoded is None:
            raise ValueError("the tile has not been coded yet")
        return np.multiply(self.decoded, 2.0**-FRACTION_BITS, dtype=np.float64)


def write_tile(header: Header, model: TileModel) -> tuple[bytes, SymbolCoder]:
    """The payload of chunk T, and the coder with the bits of every part. Sets `model.decoded`.

    Raises LimitError for a model that `read_tile` would refuse.
    """
    spec, size = header.spec, (header.width, header.height)
    check_model(spec, *size)
    coder = SymbolWriter()
    seeds = len(model.layout)
    _code(coder, header, model, seeds)
    payload = coder.finish()  # ends with the CRC of all symbols
    if seeds > max_seeds(spec, *size, len(payload)):
        raise LimitError(f"{seeds} seeds in a tile of {len(payload)} bytes; a decoder would refuse it")
    return payload, coder


def read_tile(header: Header, payload: bytes, device: Device = ONE_THREAD) -> tuple[TileModel, SymbolReader]:
    """The model of a payload. Raises CorruptStreamError where the decoded symbols are not those that were written and
    LimitError, before it takes memory, for a model beyond the caps of `limits`.
    """
    spec, size = header.spec, (header.width, header.height)
    check_model(spec, *size)
    coder = SymbolReader(payload)
    model = _code(coder, header, None, max_seeds(spec, *size, len(payload)), device)
    coder.finish()
    return model, coder


def _code(
    coder: SymbolCoder,
    header: Header,
    model: TileModel | None,
    most_seeds: int,
    device: Device = ONE_THREAD,
) -> TileModel:
    spec, size = header.spec, (header.width, header.height)
    with coder.part("steps"):
        plan = _code_plan(coder, spec, header.quality, None if model is None else model.plan)
    with coder.part("base"):
        base_step, base = _code_base_layer(coder, header, model)
    with coder.part("positions"):
        layout = _code_layout(coder, header, base, None if model is None else model.layout, most_seeds, device)
    with coder.part("decoders"):
        shapes = decoder_shapes(spec)
        decoders = {
            name: code_weights(coder, None if model is None else model.decoders[name], shape).astype(np.int64)
            for name, shape in shapes.items()
        }
    with coder.part("hash grid"):
        hash_tables = _code_hash(coder, header, None if model is None else model.hash_tables)
    with coder.part("context model"):
        networks = code_networks(coder, spec, None if model is None else model.networks)
    attributes = AttributeCoder(spec, layout, size, plan, networks, hash_tables, header.quality, header.family, device)
    decoded = attributes.code(coder, None if model is None else model.attributes)
    texture = None
    if spec.texture:
        with coder.part("texture"):
            texture = code_texture(coder, size, spec.channels, None if model is None else model.texture)
    if model is not None:
        model.decoded = decoded
        return model
    return TileModel(layout, plan, base_step, base, decoders, networks, hash_tables, None, decoded, texture)


def _code_plan(coder: SymbolCoder, spec: ModelSpec, quality: int, plan: StepPlan | None) -> StepPlan:
    expected = default_plan(spec, quality)
    base, gamma = {}, {}
    for name, index in expected.base.items():
        difference = code_weights(coder, None if plan is None else plan.base[name] - index, index.shape)
        base[name] = index + difference
        if base[name].min() < 0 or base[name].max() >= STEP_COUNT:
            raise CorruptStreamError("steps: an index is outside the table of steps")
        gamma[name] = 0
        if follows_amplitude(spec, name):
            gamma[name] = coder.code_int(None if plan is None else plan.gamma[name], _GAMMA_BITS)
    return StepPlan(base, gamma)


def _code_base_layer(coder: SymbolCoder, header: Header, model: TileModel | None) -> tuple[int, I64]:
    cell = header.spec.base_cell
    if not cell:
        return 0, np.zeros((header.spec.channels, 0, 0), np.int64)
    shape = (header.spec.channels, *base_shape(header.width, header.height, cell))
    step = coder.code_int(None if model is None else model.base_step, _STEP_BITS)
    if step >= STEP_COUNT:
        raise CorruptStreamError("base layer: a step outside the table of steps")
    return step, code_base(coder, None if model is None else model.base, shape).astype(np.int64)


def _code_layout(
    coder: SymbolCoder, header: Header, base: I64, layout: SeedLayout | None, most: int, device: Device
) -> SeedLayout:
    least = 0 if header.spec.layout == "uniform" else 1
    tree = TreeShape(header.width, header.height, ROOT_LOG, least)
    seeds = None if layout is None else (layout.corner, layout.log_size)
    if header.spec.predicted_seeds:
        tree_context = TreeContext(base, header.spec.base_cell, header.quality)
        return SeedLayout(*code_predicted_positions(coder, tree, tree_context, seeds, most, device))
    return SeedLayout(*code_positions(coder, tree, seeds, most))


def _code_hash(coder: SymbolCoder, header: Header, tables: list[I64] | None) -> list[I64]:
    counts = hash_counts(header.spec, header.width, header.height)
    if not counts:
        return []
    given = None if tables is None else np.concatenate([table.reshape(-1) for table in tables])
    bits = code_signs(coder, given, counts).astype(np.int64)
    return [part.reshape(-1, header.spec.context.hash_features) for part in np.split(bits, np.cumsum(counts)[:-1])]


def code_networks(
    coder: SymbolCoder, spec: ModelSpec, networks: tuple[IntNetwork, ...] | None
) -> tuple[IntNetwork, ...]:
    if spec.context.prior:
        return _code_differences(coder, load_prior(spec), networks)
    coded = []
    for number, step in enumerate(spec.context.steps):
        units = sum(output_count(spec, name) for name in step)
        given = None if networks is None else networks[number]
        shift = coder.code_int(None if given is None else given.shift, _SHIFT_BITS)
        weights = {
            name: code_weights(coder, None if given is None else getattr(given, name), shape).astype(np.int64)
            for name, shape in network_shapes(spec, number).items()
        }
        coded.append(IntNetwork(**weights, shift=shift, predicted=units))
    return tuple(coded)


def _code_differences(
    coder: SymbolCoder, prior: tuple[IntNetwork, ...], networks: tuple[IntNetwork, ...] | None
) -> tuple[IntNetwork, ...]:
    """The prior, and what the picture changes in it: whether anything, then b1, W2 and b2 of every step."""
    given = None if networks is None else [_differences(p, n) for p, n in zip(prior, networks, strict=True)]
    changed = None if given is None else int(any(part.any() for step in given for part in step.values()))
    if not coder.code_int(changed, 1):
        return prior
    coded = []
    for number, network in enumerate(prior):
        parts = (
            code_weights(coder, None if given is None else given[number][name], getattr(network, name).shape).astype(
                np.int64
            )
            for name in ("b1", "w2", "b2")
        )
        coded.append(network.plus(*parts))
    return tuple(coded)


def _differences(prior: IntNetwork, network: IntNetwork) -> dict[str, I64]:
    """What `network` adds to the prior, by tensor, in the stream's units."""
    unit = prior.shift - DIFFERENCE_SHIFT
    return {name: (getattr(network, name) - getattr(prior, name)) >> unit for name in ("b1", "w2", "b2")}
