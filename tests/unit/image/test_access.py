"""What reading in parts holds in memory, and the caps on it."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import create_autospec

import numpy as np
import numpy.typing as npt
import pytest
from image_files import noise, save, window_rows

from sgicodec import open_source, read, write
from sgicodec.errors import PictureError
from sgicodec.image.opened import Opened
from sgicodec.picture import Picture


@pytest.mark.parametrize("extension", ["png", "tif"])
def test_memory_stays_below_what_is_promised(tmp_path: Path, extension: str) -> None:
    path = tmp_path / f"x.{extension}"
    write(Picture(noise(3000, 1600, 3, "uint8"), "rgb", (0.0, 255.0)), path)
    with open_source(path) as source:
        assert type(source._access).__name__ == {"png": "Rows", "tif": "Tiles"}[extension]
        tracemalloc.start()
        try:
            for window in window_rows(1600, 3000, 400, 8):
                source.read(*window)
            peak = tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
        assert peak < source.memory(416, 416) < 3000 * 1600 * 3


def test_the_cap_is_on_what_is_held(tmp_path: Path) -> None:
    pixels = noise(2000, 1000, 3, "uint8")
    tiles = save(tmp_path / "x.tif", pixels, tile=(64, 64))
    turned = save(tmp_path / "y.tif", pixels, Orientation=6)
    with pytest.raises(PictureError, match=r"x\.tif: .* more than the cap"):
        read(tiles, max_samples=300_000)
    with open_source(tiles, max_samples=300_000) as source:
        np.testing.assert_array_equal(source.read(500, 700, 100, 100).pixels, pixels[700:800, 500:600])
        with pytest.raises(PictureError, match=r"x\.tif: a window of 300 × 300 pixels .* more than the cap of 300000"):
            source.read(0, 0, 300, 300)
    with pytest.raises(PictureError, match=r"y\.tif: 1000 × 2000 pixels of 3 channels are more than the cap"):
        open_source(turned, max_samples=300_000)


def test_rows_that_are_kept_are_decoded_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pixels = noise(301, 200, 3, "uint8")
    path = save(tmp_path / "x.png", pixels)
    samples = create_autospec(Opened.samples, side_effect=Opened.samples)
    monkeypatch.setattr(Opened, "samples", samples)
    with open_source(path, keeps=True) as source:
        for x, y in ((0, 40), (50, 150), (100, 0), (7, 240), (0, 40)):
            np.testing.assert_array_equal(source.read(x, y, 60, 61).pixels, pixels[y : y + 61, x : x + 60])
    assert sum(call.args[2] for call in samples.mock_calls) == 301


def test_rows_are_read_again_after_damage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pixels = noise(400, 300, 3, "uint8")
    samples, damage = Opened.samples, [PictureError("damaged")]

    def damaged(opened: Opened, method: Callable[..., Any], count: int, *where: int) -> npt.NDArray[Any]:
        if where[0] > 0 and damage:
            raise damage.pop()
        return samples(opened, method, count, *where)

    monkeypatch.setattr(Opened, "samples", damaged)
    with open_source(save(tmp_path / "x.png", pixels), keeps=True) as source:
        np.testing.assert_array_equal(source.read(0, 0, 300, 100).pixels, pixels[:100])
        with pytest.raises(PictureError, match=r"x\.png: damaged"):
            source.read(0, 300, 300, 100)
        np.testing.assert_array_equal(source.read(0, 50, 300, 60).pixels, pixels[50:110])
        np.testing.assert_array_equal(source.read(0, 300, 300, 100).pixels, pixels[300:])
