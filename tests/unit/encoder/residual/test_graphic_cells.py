"""Cells of text and line art: which are found, which colours are merged, and what tiles show instead."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from sgicodec import EncodeSettings, Picture
from sgicodec.bitstream.header import Header
from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.residual.graphic_cells import CELL, CellSurvey, ColourCounts, ColourSurvey, cell_means
from sgicodec.encoder.residual.graphic_windows import with_fewer_colours, without_cells

SIDE = 12 * CELL
HALF = np.s_[:, : SIDE // 2]


def header_of(pixels: NDArray[np.uint8]) -> Header:
    return stream_plan(Shape.of(picture_of(pixels)), EncodeSettings()).header


def picture_of(pixels: NDArray[np.uint8]) -> Picture:
    return Picture(pixels, "rgb", (0.0, 255.0))


def noise() -> NDArray[np.uint8]:
    return np.random.default_rng(2).integers(90, 160, (SIDE, SIDE, 3)).astype(np.uint8)


def bars(ink: int = 20, ground: int = 250) -> NDArray[np.uint8]:
    """Short strokes, every fourth row, with soft ends of many shades."""
    rng = np.random.default_rng(3)
    pixels = np.full((SIDE, SIDE, 3), ground, np.uint8)
    for y in range(2, SIDE, 4):
        for x in range(3, SIDE - 8, 11):
            pixels[y, x : x + 6] = ink
            pixels[y, [x, x + 5]] = rng.integers(min(ink, ground), max(ink, ground), 2)[:, None]
    return pixels


def found_in(pixels: NDArray[np.uint8]) -> NDArray[np.bool_]:
    survey = CellSurvey(header_of(pixels))
    survey.see((0, 0, SIDE, SIDE), pixels)
    return survey.graphic()


def counted(pixels: NDArray[np.uint8], cells: NDArray[np.bool_]) -> ColourCounts:
    survey = ColourSurvey(header_of(pixels))
    survey.see(pixels, cells)
    return survey.counts


def calm() -> NDArray[np.uint8]:
    """Many colours that change slowly, each of two by two pixels: as few novel pixels as text."""
    levels = np.random.default_rng(7).integers(60, 65, (SIDE // 2, SIDE // 2, 3)) + np.arange(SIDE // 2)[:, None] // 3
    return levels.repeat(2, axis=0).repeat(2, axis=1).astype(np.uint8)


@pytest.mark.parametrize(("text", "beside"), [(bars(), noise()), (bars(188, 200), noise()), (bars(188, 200), calm())])
def test_text_is_found_and_what_lies_beside_it_is_not(text: NDArray[np.uint8], beside: NDArray[np.uint8]) -> None:
    """Faint text, too."""
    assert not found_in(beside).any()
    mixed = beside.copy()
    mixed[HALF] = text[HALF]
    np.testing.assert_array_equal(found_in(mixed), np.repeat([[True] * 6 + [False] * 6], 12, axis=0))


def test_few_colours_without_a_ground_are_none() -> None:
    """Dark places of a photograph in gray, next to some with more colours."""
    mixed, levels = calm(), np.random.default_rng(8).integers(8, 23, (SIDE // 2, SIDE // 2, 1))
    mixed[HALF] = levels.repeat(2, axis=0).repeat(2, axis=1)[HALF]
    assert not found_in(mixed).any()


def test_a_clipped_sky_is_none() -> None:
    """White, and the rarer the darker: as few colours as faint text, but no ink."""
    dark = np.minimum(np.random.default_rng(5).geometric(0.6, (SIDE, SIDE, 1)) - 1, 12)
    assert len(np.unique(dark)) > 8
    assert not found_in(np.repeat(255 - dark, 3, axis=2).astype(np.uint8)).any()


def test_a_ramp_is_none() -> None:
    y, x = np.mgrid[:SIDE, :SIDE]
    assert not found_in(np.repeat(((x + y) // 2)[..., None], 3, axis=2).astype(np.uint8)).any()


def test_a_few_cells_alone_are_none() -> None:
    pixels = noise()
    pixels[: 3 * CELL, : 3 * CELL] = bars()[: 3 * CELL, : 3 * CELL]
    assert not found_in(pixels).any()


def test_a_dense_cell_amid_text_belongs_to_it() -> None:
    pixels = bars()
    part = np.s_[5 * CELL : 6 * CELL, 5 * CELL : 6 * CELL]
    pixels[part] = np.where(np.random.default_rng(1).random((CELL, CELL, 1)) < 0.5, 20, 250)
    assert found_in(pixels).all()


def test_areas_may_wind() -> None:
    """One path through a picture of noise, two cells wide, counts as one area."""
    path = np.zeros((12, 12), bool)
    path[:2], path[:, 10:], path[10:], path[4:, :2], path[4:6, :8] = True, True, True, True, True
    pixels = np.where(path.repeat(CELL, 0).repeat(CELL, 1)[..., None], bars(), noise())
    np.testing.assert_array_equal(found_in(pixels), path)


@pytest.mark.parametrize("max_error", [0, 5, 15])
def test_colours_at_edges_are_merged(max_error: int) -> None:
    pixels = bars()
    pixels[: 4 * CELL, HALF[1]] = np.where(pixels[: 4 * CELL, HALF[1]] == 250, 246, pixels[: 4 * CELL, HALF[1]])
    cells = np.ones((12, 12), bool)
    counts = counted(pixels, cells)
    windows, off = with_fewer_colours(windows_of(picture_of(pixels)), cells, counts, max_error)
    found = windows.read(0, 0, SIDE, SIDE).pixels
    assert np.abs(found.astype(int) - pixels).max() == off <= max_error
    assert (off > 0) == (max_error > 0)
    for ground in (246, 250):  # nobody sees 4 levels, but they are no edge
        np.testing.assert_array_equal(found[pixels == ground], ground)
    shades = [len(np.unique(some)) for some in (pixels, found)]
    assert shades[1] <= shades[0] / (1 + max_error / 4)


def test_classes_of_a_map_stay() -> None:
    """Numbers that lie next to each other, in lines one pixel wide."""
    numbers = np.repeat(np.random.default_rng(4).integers(0, 60, (SIDE, SIDE // 8)), 8, axis=1).astype(np.uint8)
    pixels = np.repeat(numbers[..., None] * 4, 3, axis=2)
    cells = np.ones((12, 12), bool)
    counts = counted(pixels, cells)
    windows, off = with_fewer_colours(windows_of(picture_of(pixels)), cells, counts, 7)
    assert off == 0
    np.testing.assert_array_equal(windows.read(0, 0, SIDE, SIDE).pixels, pixels)


def test_cells_are_filled_from_around() -> None:
    pixels = noise()
    pixels[:, SIDE // 2 :] //= 4
    cells = np.zeros((12, 12), bool)
    cells[3:7, 2:11] = True
    windows = without_cells(windows_of(picture_of(pixels)), cells, cell_means(pixels))
    found = windows.read(0, 0, SIDE, SIDE).pixels
    inside = cells.repeat(CELL, 0).repeat(CELL, 1)
    np.testing.assert_array_equal(found[~inside], pixels[~inside])
    for side, mean in ((np.s_[:, : 4 * CELL], 125), (np.s_[:, 8 * CELL :], 31)):
        assert abs(found[side][inside[side]].mean() - mean) < 20
    assert np.abs(np.diff(found.astype(int), axis=1)[inside[:, 1:] & inside[:, :-1]]).max() < 12
    np.testing.assert_array_equal(windows.read(37, 50, 60, 30).pixels, found[50:80, 37:97])
