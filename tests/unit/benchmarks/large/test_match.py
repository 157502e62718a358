"""Bytes at one PSNR: the nearest rung, the whole picture after a sample, the region."""

from __future__ import annotations

import pytest

pytest.importorskip("PIL")
pytest.importorskip("imagecodecs")
pytest.importorskip("matplotlib")
from benchmarks.large.match import TOLERANCE, Probes, match, nearest_rung
from benchmarks.large.notes import Trip
from benchmarks.large.sgi import middle_region
from sgicodec.bench.sgi import Run
from sgicodec.model.tile_grid import TileGrid


def trip(psnr: float, size: int = 1000) -> Trip:
    return Trip("", "", size, psnr, Run(1, 1, 1), Run(1, 1, 1))


def curve(base: float) -> Probes:
    """A codec of 0.25 dB and 3 % more bytes with every rung."""
    return Probes(lambda rung: trip(base + 0.25 * rung, round(1e6 * 1.03**rung)))


@pytest.mark.parametrize("target", [0.0, 20.0, 20.1, 27.6, 44.74, 44.75, 99.0])
def test_the_nearest_rung_is_that_of_a_full_search(target: float) -> None:
    ladder = [20 + 0.25 * rung for rung in range(100)]
    found = nearest_rung(ladder.__getitem__, target, 100)
    assert abs(ladder[found] - target) == min(abs(psnr - target) for psnr in ladder)


def test_the_whole_picture_is_brought_to_the_psnr_though_the_sample_differs() -> None:
    sample, whole = curve(20), curve(22.5)
    found = match(33.05, 100, sample, whole)
    assert abs(found.trip.psnr - 33.05) <= TOLERANCE
    assert len(whole.made) == 2
    assert len(sample.made) <= 14


def test_bytes_are_brought_to_the_very_psnr_along_the_curve() -> None:
    probe = curve(20)
    found = match(30.1, 100, probe, probe)
    assert found.trip.psnr == 30.0
    assert found.equal_bytes == pytest.approx(1e6 * 1.03**40.4, rel=1e-4)


def test_a_ladder_that_does_not_reach_ends_at_its_end() -> None:
    probe = curve(20)
    assert match(90.0, 8, probe, probe).trip.psnr == 21.75


@pytest.mark.parametrize(
    ("size", "tile", "expected"),
    [
        ((12288, 12288), 1024, (5632, 5632, 1024, 1024)),
        ((5392, 4848), 1024, (2184, 2396, 1024, 1024)),
        ((3072, 3072), 1024, (512, 512, 1024, 1024)),
        ((3000, 700), 0, (988, 0, 1024, 700)),
        ((90, 70), 32, (0, 0, 90, 70)),
    ],
)
def test_the_region_lies_in_the_picture_around_a_corner_of_tiles(
    size: tuple[int, int], tile: int, expected: tuple[int, int, int, int]
) -> None:
    grid = TileGrid(*size, tile, 8)
    x, y, width, height = middle_region(grid)
    assert (width, height) == (min(1024, size[0]), min(1024, size[1]))
    assert 0 <= x <= x + width <= size[0]
    assert 0 <= y <= y + height <= size[1]
    if tile:
        rects = [grid.rect(number) for number in range(grid.count)]
        met = [x < at + w < x + width + w and y < to + h < y + height + h for at, to, w, h in rects]
        assert sum(met) >= 4
    assert (x, y, width, height) == expected
