"""Random texture layers, written and read back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from symbols import SymbolReader, SymbolWriter, write_texture

from sgicodec._native import TEXTURE_MIN_LOG as MIN_LOG
from sgicodec._native import TEXTURE_ROOT_LOG
from sgicodec.bitstream.parts.tile import layer_of
from sgicodec.model.texture_symbols import LAPPED, TextureGrid, TextureIndices, TextureSymbols, roots_of


def random_cells(width: int, height: int, seed: int, share: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners and sizes of a random quadtree, `share` of whose leaves hold texture."""
    rng = np.random.default_rng(seed)
    cells: list[tuple[int, int, int]] = []

    def add(x: int, y: int, log_size: int) -> None:
        if x >= width or y >= height:
            return
        if log_size > MIN_LOG and rng.random() < 0.6:
            half = 1 << (log_size - 1)
            for dy in (0, half):
                for dx in (0, half):
                    add(x + dx, y + dy, log_size - 1)
        elif rng.random() < share:
            cells.append((x, y, log_size))

    for y in range(0, height, 32):
        for x in range(0, width, 32):
            add(x, y, TEXTURE_ROOT_LOG)
    found = np.array(cells).reshape(-1, 3)
    return found[:, :2].astype(np.int32), found[:, 2].astype(np.uint8)


def random_symbols(channels: int, width: int, height: int, seed: int = 0, most: int = 5) -> TextureSymbols:
    """A layer that a stream can hold, in cells of all sizes that lap over or are separate, with and without contrasts;
    magnitudes up to `most`.
    """
    rng = np.random.default_rng(seed)
    grid = TextureGrid(True, seed // 2 % 8, seed // 16 % 8) if seed % 2 else LAPPED
    size = width, height
    width, height = grid.layer_size(size)
    columns, rows = roots_of(width, height)
    log_size = np.zeros((4 * rows, 4 * columns), np.uint8)
    symbols = np.zeros((channels, 32 * rows, 32 * columns), np.int16)
    corner, logs = random_cells(width, height, seed, float(rng.choice([0.1, 0.7, 1.0])))
    if not len(logs):
        corner, logs = random_cells(width, height, seed, 1.0)
    for (x, y), log in zip(corner.tolist(), logs.tolist(), strict=True):
        side = 1 << log
        log_size[y // 8 : (y + side) // 8, x // 8 : (x + side) // 8] = log
        diagonal = np.add.outer(np.arange(side), np.arange(side))
        for channel in range(channels):
            cell = rng.integers(-most, most + 1, (side, side)) * (rng.random((side, side)) < rng.random() ** 2)
            symbols[channel, y : y + side, x : x + side] = cell * (diagonal < rng.integers(0, 2 * side))
        if not symbols[:, y : y + side, x : x + side].any():
            symbols[rng.integers(channels), y + rng.integers(side), x + rng.integers(side)] = most
    has_contrast = bool(rng.random() < 0.5)
    contrast = rng.integers(-15, 16, (rows, columns)) * has_contrast
    contrast *= log_size.reshape(rows, 4, columns, 4).any(axis=(1, 3))
    steps = TextureIndices(
        int(rng.integers(512)),
        tuple(rng.integers(0, 32, channels - 1).tolist()),
        (int(rng.integers(32)), int(rng.integers(32))),
        (int(rng.integers(16)), int(rng.integers(16)), int(rng.integers(16))),
        has_contrast,
    )
    if channels >= 3 and rng.random() < 0.7:
        one, two, turn = rng.integers(0, (64, 64, 16)).tolist()
        steps = replace(steps, colours=(one, two, turn))
    return TextureSymbols(size, steps, log_size, contrast.astype(np.int8), symbols, grid)


def read_texture(reader: SymbolReader, size: tuple[int, int], channels: int) -> TextureSymbols | None:
    """The texture of a tile of `size`."""
    return layer_of(reader.read_texture(size, channels), size)


def payload_of(texture: TextureSymbols | None, size: tuple[int, int], channels: int) -> bytes:
    """A payload that holds a layer, or says that there is none, alone."""
    writer = SymbolWriter()
    write_texture(writer, size, channels, texture)
    return writer.finish()


def read_back(payload: bytes, size: tuple[int, int], channels: int) -> TextureSymbols | None:
    """What the native reader finds in it."""
    reader = SymbolReader(payload)
    texture = read_texture(reader, size, channels)
    reader.finish()
    return texture


def assert_same(found: TextureSymbols | None, expected: TextureSymbols) -> None:
    assert found is not None
    assert (found.size, found.steps, found.grid) == (expected.size, expected.steps, expected.grid)
    for ours, theirs in ((found.log_size, expected.log_size), (found.contrast, expected.contrast)):
        np.testing.assert_array_equal(ours, theirs)
    np.testing.assert_array_equal(found.symbols, expected.symbols)
