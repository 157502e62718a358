"""Contact sheets show the right places of the right pictures, twice as large."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sgicodec.bench.peers import Jpeg, WebP
from sgicodec.bench.run import Sample
from sgicodec.bench.sheets import draw_sheet, write_sheets
from sgicodec.bench.sized import Sized

Image = pytest.importorskip("PIL.Image")

WIDTH, HEIGHT = 160, 128  # of a detail


def noise(height: int = 200, width: int = 400) -> np.ndarray:
    return np.random.default_rng(2).integers(0, 256, (height, width, 3), np.uint8)


def doubled(pixels: np.ndarray, x: int, y: int) -> np.ndarray:
    return np.kron(pixels[y : y + HEIGHT, x : x + WIDTH], np.ones((2, 2, 1), np.uint8))


def holds(sheet: np.ndarray, detail: np.ndarray) -> list[tuple[int, int]]:
    """The places of a detail in a sheet, by its first row of pixels and then by all of them."""
    height, width = detail.shape[:2]
    corners = np.argwhere((sheet[:-height, :-width] == detail[0, 0]).all(axis=2))
    return [(y, x) for y, x in corners if np.array_equal(sheet[y : y + height, x : x + width], detail)]


def test_panels_are_the_same_places_of_all_pictures() -> None:
    """Busy at the left, and one of the codecs bad at the right."""
    original = noise(HEIGHT) // 4
    original[:, :WIDTH] *= 3
    bad = original + np.uint8(1)
    bad[:, 240:] += 60
    versions = [Sized("fine", 9000, original // 2 * 2), Sized("poor", 9001, bad)]
    sheet = np.asarray(draw_sheet(Sample("p.png", "0f", original), versions, "title"))
    busy = [holds(sheet, doubled(pixels, 0, 0)) for pixels in (original, versions[0].pixels, bad)]
    different = [holds(sheet, doubled(pixels, 240, 0)) for pixels in (original, versions[0].pixels, bad)]
    found = [place for places in (*busy, *different) for place in places]
    assert len(found) == 6
    rows = [y for y, _ in found]
    assert rows[:3] == [rows[0]] * 3
    assert rows[3:] == [rows[3]] * 3
    assert rows[0] < rows[3]
    assert [x for _, x in found[:3]] == [x for _, x in found[3:]] == sorted(x for _, x in found[:3])


def test_a_file_for_each_picture_and_rate(tmp_path: Path) -> None:
    for name in ("a.png", "b.png"):
        Image.fromarray(np.sort(noise(), axis=1)).save(tmp_path / name)
    lines: list[str] = []
    pictures = [tmp_path / "a.png", tmp_path / "b.png"]
    paths = write_sheets(pictures, [Jpeg(), WebP()], [0.5, 1.25], tmp_path / "sheets", report=lines.append)
    stems = [(path.name.split("-")[0], path.name.split("-")[2]) for path in paths]
    assert stems == [("a", "0.5bpp.png"), ("a", "1.25bpp.png"), ("b", "0.5bpp.png"), ("b", "1.25bpp.png")]
    assert all(Image.open(path).width > 3 * 2 * WIDTH for path in paths)
    assert lines[1].startswith(f"{paths[1].name}: {int(1.25 * 200 * 400 / 8)} bytes; jpeg ")
