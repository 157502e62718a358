"""Seeds of one pixel against a reader written from docs/format.md, "Pixels"."""

from __future__ import annotations

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from symbols import Seeds, SymbolReader, SymbolWriter, write_positions, write_weights

from sgicodec.errors import CorruptStreamError, LimitError
from sgicodec.model.morton import canonical_order

Size = tuple[int, int]


def seeds_of(pixels: list[tuple[int, int]]) -> Seeds:
    return np.array(pixels, np.int32).reshape(-1, 2), np.zeros(len(pixels), np.int8)


def payload_of(size: Size, seeds: Seeds) -> bytes:
    writer = SymbolWriter()
    write_positions(writer, size, seeds)
    return writer.finish()


@st.composite
def some(draw: st.DrawFn) -> tuple[Size, Seeds]:
    """Seeds that crowd in places, some or a pixel each."""
    width, height = draw(st.integers(1, 70)), draw(st.integers(1, 5000))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    count = draw(st.one_of(st.integers(0, 5), st.integers(0, 300), st.just(width * min(height, 50))))
    places = np.unique((width * height * rng.random(count) ** draw(st.integers(1, 4))).astype(int))
    return (width, height), seeds_of([(int(place) % width, int(place) // width) for place in places])


def read_from_the_page(payload: bytes, size: Size) -> list[tuple[int, int]]:
    reader = SymbolReader(payload)
    count, pixels, pixel = int(reader.read_bits(32, 1)[0]), [], -1
    if count:
        k = int(reader.read_bits(4, 1)[0])
        lower = reader.read_bits(k, count).tolist()
        for low, z in zip(lower, reader.read_weights(count).tolist(), strict=True):
            pixel += 1 + (2 * z if z >= 0 else -2 * z - 1) * 2**k + low
            pixels.append((pixel % size[0], pixel // size[0]))
    reader.finish()
    return pixels


@settings(max_examples=examples(100))
@given(some())
def test_round_trip_in_canonical_order(seeds: tuple[Size, Seeds]) -> None:
    size, (corner, log_size) = seeds
    payload = payload_of(size, (corner, log_size))
    reader = SymbolReader(payload)
    found = reader.read_positions(size, len(corner))
    reader.finish()
    np.testing.assert_array_equal(found[0], corner[canonical_order(corner, log_size)])
    np.testing.assert_array_equal(found[1], log_size)
    assert (found[0].dtype, found[1].dtype) == (np.int32, np.int8)
    assert sorted(read_from_the_page(payload, size)) == sorted(map(tuple, corner.tolist()))


def test_more_seeds_than_allowed_are_refused() -> None:
    payload = payload_of((20, 13), seeds_of([(x, 2) for x in range(8)]))
    with pytest.raises(LimitError, match="more than 7 seeds"):
        SymbolReader(payload).read_positions((20, 13), 7)


@pytest.mark.parametrize(("last", "sound"), [(59, True), (60, False), (1 << 20, False)])
def test_a_seed_beyond_the_tile_is_corrupt(last: int, sound: bool) -> None:
    writer = SymbolWriter()
    writer.code_int(1, 32)
    writer.code_int(0, 4)
    write_weights(writer, np.array([last // 2 if last % 2 == 0 else -(last + 1) // 2]))
    reader = SymbolReader(writer.finish())
    if sound:
        assert reader.read_positions((10, 6), 9)[0].tolist() == [[9, 5]]
    else:
        with pytest.raises(CorruptStreamError, match="beyond the tile"):
            reader.read_positions((10, 6), 9)
