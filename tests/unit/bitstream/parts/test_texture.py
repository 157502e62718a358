"""Texture against a reader that was written from docs/format.md, and what is refused of it."""

from __future__ import annotations

import hashlib
from importlib.resources import files
from typing import Any

import numpy as np
import pytest
from data_files import ROOT
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_decoder import Bits
from symbols import SymbolReader, SymbolWriter
from texture_forger import spelled
from texture_reader import LOGISTIC, TextureReader
from textures import assert_same, payload_of, random_symbols, read_back, read_texture

from sgicodec import read
from sgicodec.device import ONE_THREAD
from sgicodec.errors import CorruptStreamError
from sgicodec.model.texture_symbols import SAME_COLOURS, TextureGrid, TextureIndices, TextureSymbols
from sgicodec.rdoq.texture import TextureSearch

MOST = 16390


def read_from_the_page(payload: bytes, size: tuple[int, int], channels: int) -> TextureSymbols:
    """What the independent reader finds."""
    reader = TextureReader(Bits(payload), size, channels)
    reader.read()
    assert reader.bits.ends_well()
    assert reader.steps is not None
    rows, columns = -(-reader.size[1] // 32), -(-reader.size[0] // 32)
    symbols = np.zeros((channels, 32 * rows, 32 * columns), np.int16)
    log_size, contrast = np.zeros((4 * rows, 4 * columns), np.uint8), np.zeros((rows, columns), np.int8)
    for (x, y), value in reader.contrast.items():
        contrast[y // 32, x // 32] = value
    for leaf in reader.leaves:
        x, y, side = leaf
        log_size[y // 8 : (y + side) // 8, x // 8 : (x + side) // 8] = side.bit_length() - 1
        for channel in range(channels):
            symbols[channel, y : y + side, x : x + side] = reader.symbols[channel, leaf]
    read = reader.steps
    (luma, chroma), (one, two, more) = read["slopes"], read["excess"]
    steps = TextureIndices(
        read["step"][0],
        tuple(read["ratios"]),
        (luma, chroma),
        (one, two, more),
        bool(read["contrasts"][0]),
        (*read.get("shares", SAME_COLOURS[:2]), *read.get("turn", SAME_COLOURS[2:])),
    )
    grid = TextureGrid(bool(read["separate"][0]), *read.get("before", (0, 0)))
    return TextureSymbols(size, steps, log_size, contrast, symbols, grid)


layers = st.builds(
    random_symbols,
    st.integers(1, 4),
    st.integers(1, 90),
    st.integers(33, 70),
    st.integers(0, 2**32),
    st.sampled_from([1, 5, 40, MOST]),
)


@settings(max_examples=examples(40))
@given(layers)
def test_round_trip(layer: TextureSymbols) -> None:
    payload = payload_of(layer, layer.size, len(layer.symbols))
    assert_same(read_back(payload, layer.size, len(layer.symbols)), layer)


@settings(max_examples=examples(20))
@given(layers)
def test_the_page_reads_the_same(layer: TextureSymbols) -> None:
    payload = payload_of(layer, layer.size, len(layer.symbols))
    assert_same(read_from_the_page(payload, layer.size, len(layer.symbols)), layer)


@pytest.fixture(scope="module")
def found() -> TextureSymbols:
    """What the search finds in a crop of a photograph whose sides are no multiples of 32."""
    pixels = read(ROOT / "tests" / "data" / "kodim13.png").pixels[300:377, 100:245].astype(np.float32) / 255
    planes = np.ascontiguousarray(pixels.transpose(2, 0, 1))
    search = TextureSearch(planes - planes.mean(axis=(1, 2), keepdims=True), ONE_THREAD)
    layer = search.at(TextureIndices(350, (18, 18), (2, 3)), 0.11)
    assert (layer.symbols != 0).sum() > 1000
    return layer


def test_the_page_reads_a_photograph(found: TextureSymbols) -> None:
    payload = payload_of(found, found.size, 3)
    assert_same(read_back(payload, found.size, 3), found)
    assert_same(read_from_the_page(payload, found.size, 3), found)


def test_the_page_names_the_models() -> None:
    data = files("sgicodec.bitstream.parts").joinpath("texture.bin").read_bytes()
    assert hashlib.sha256(data).hexdigest() in (ROOT / "docs" / "format.md").read_text()


def test_the_table_can_be_computed_anywhere() -> None:
    """The page's claim: no value that is rounded lies near a half."""
    logistic = 65536 / (1 + np.exp(-np.arange(-3072, 3072) / 256))
    assert np.abs(logistic - np.floor(logistic) - 0.5).min() > 1e-5
    np.testing.assert_array_equal(np.clip(np.rint(logistic), 16, 65519), LOGISTIC)


def coloured(colours: tuple[int, int, int]) -> bytes:
    """The beginning of a layer of three channels of models 3 in these colours."""
    writer = SymbolWriter()
    for value, bits in ((1, 1), (3, 4), (300, 9)):
        writer.code_int(value, bits)
    for values, bits in (((16, 16), 5), ((0, 0), 5), ((8, 8, 8), 4)):
        writer.code_bits(values, bits)
    writer.code_bits((0, 0), 1)  # no contrasts, cells that lap over
    writer.code_bits(colours[:2], 6)
    writer.code_int(colours[2], 4)
    return writer.finish()


def test_colours_that_say_nothing_are_refused() -> None:
    with pytest.raises(CorruptStreamError, match="texture: colours that are no others"):
        read_back(coloured(SAME_COLOURS), (64, 64), 3)
    with pytest.raises(CorruptStreamError, match="texture: the payload does not decode"):
        read_back(coloured((32, 33, 8)), (64, 64), 3)


CHANGES: dict[str, list[tuple[str, Any, int]]] = {
    "no symbols": [("symbols", np.s_[0, 3, 2], 0)],
    "no cells": [("symbols", np.s_[:], 0), ("log_size", np.s_[:], 0)],
    "symbols beside": [("symbols", np.s_[0, 3, 20], 1)],
    "too large": [("symbols", np.s_[0, 3, 2], -MOST - 1)],
    "least number": [("symbols", np.s_[0, 3, 2:5], -(2**15))],
    "contrast of nothing": [("contrast", np.s_[1, 0], 1)],
    "contrast beyond": [("contrast", np.s_[0, 0], 16)],
    "beyond the tile": [("log_size", np.s_[6:, :2], 4), ("symbols", np.s_[0, 50, 3], 1)],
    "half a cell": [("log_size", np.s_[0, 1], 0)],
    "unknown size": [("log_size", np.s_[7, 7], 2)],
}
"""Fields of a layer, places in them, and what stands there instead."""


@pytest.mark.parametrize("changes", CHANGES.values(), ids=CHANGES)
def test_layers_that_no_reader_would_find_are_not_written(changes: list[tuple[str, Any, int]]) -> None:
    """Of 64×40 pixels, with a leaf of 16 in the first root and of 32 in the second."""
    log_size, symbols = np.zeros((8, 8), np.uint8), np.zeros((2, 64, 64), np.int16)
    log_size[:2, :2], log_size[:4, 4:] = 4, 5
    symbols[0, 3, 2], symbols[1, 0, 40] = 5, -1
    layer = TextureSymbols((64, 40), TextureIndices(300, (16,)), log_size, np.zeros((2, 2), np.int8), symbols)
    assert_same(read_back(payload_of(layer, layer.size, 2), layer.size, 2), layer)
    for field, place, value in changes:
        getattr(layer, field)[place] = value
    with pytest.raises(ValueError, match=r"a layer has cells|contrasts must be|cells must fill|log_size must be"):
        payload_of(layer, layer.size, 2)


ONE = "10" + "0"  # a symbol 1

SPELLINGS = {
    "a leaf": ("10" + "000001" + ONE, False, True),
    "a layer without leaves": ("0", False, False),
    "a leaf without symbols": ("10" + "000000", False, False),
    "a split node without leaves": ("11" + "0000", False, False),
    "a split node below one": ("11" + "11" + "0000" + "10" + "00001" + ONE, False, False),
    "a leaf below": ("11" + "10" + "00001" + ONE, False, True),
    "an extent of two": ("10" + "000010" + ONE + "0" + ONE, False, True),
    "an extent beyond the symbols": ("10" + "000010" + ONE + "00", False, False),
    "the largest magnitude": ("10" + "000001" + "1" * 8 + "1" * 13 + "0" + "1" * 13 + "0", False, True),
    "a larger one": ("10" + "000001" + "1" * 8 + "1" * 14 + "0" + "0" * 14 + "0", False, False),
    "ones without end": ("10" + "000001" + "1" * 3000, False, False),
    "the largest contrast": ("10" + "10" + "1" * 14 + "0" + "000001" + ONE, True, True),
    "a larger contrast": ("10" + "10" + "1" * 15 + "0" + "000001" + ONE, True, False),
    "the least contrast": ("10" + "11" + "1" * 14 + "0" + "000001" + ONE, True, True),
    "a smaller contrast": ("10" + "11" + "1" * 29 + "000001" + ONE, True, False),
}


@pytest.mark.parametrize("name", SPELLINGS)
def test_every_layer_has_one_spelling(name: str) -> None:
    bits, has_contrast, legal = SPELLINGS[name]
    payload = spelled(bits, has_contrast)
    if legal:
        layer = read_back(payload, (32, 32), 1)
        assert layer is not None
        assert payload_of(layer, (32, 32), 1) == payload
        assert_same(read_from_the_page(payload, (32, 32), 1), layer)
    else:
        with pytest.raises(CorruptStreamError, match="texture: the payload does not decode"):
            read_back(payload, (32, 32), 1)


@settings(max_examples=examples(200))
@given(st.sampled_from([0x94, 0x9C]), st.binary(max_size=300), *(st.integers(1, most) for most in (4, 200, 100)))
def test_any_bytes_are_a_layer_or_refused(first: int, payload: bytes, channels: int, width: int, height: int) -> None:
    """What is accepted can be written. `first`: there is texture, of models 2 or 3."""
    reader = SymbolReader(bytes([first]) + payload.rstrip(b"\0"))
    try:
        layer = read_texture(reader, (width, height), channels)
    except CorruptStreamError:
        return
    assert_same(read_back(payload_of(layer, layer.size, channels), layer.size, channels), layer)
