"""What a view asks for: its size, and what of an overview that is."""

from __future__ import annotations

import pytest

from sgicodec._native import overview_view
from sgicodec.bitstream.header import Header
from sgicodec.decoder.view import Region, View, overview_size, view_of
from sgicodec.profiles.default import default_spec

TILED = Header(4096, 3000, "rgb", "uint8", (0, 255), "default", default_spec(3), 40, 0, tile=1024, apron=8)


def test_a_sixteenth_and_less_is_what_an_overview_shows() -> None:
    """It has 256×188 pixels. Regions may begin between two of them, and round up where they end."""

    def shown(region: Region | None, scale: float | None, size: tuple[int, int] | None = None) -> View | None:
        found = overview_view(view_of(TILED, region, scale, size), TILED.width, TILED.height)
        return None if found is None else View(*found)

    assert view_of(TILED, None, 1e-9, None) == View(0, 0, 1 / 4096, 1 / 3000, 1, 1)
    assert overview_size(4096, 3000) == (256, 188)
    assert overview_size(5, 24) == (1, 2)
    assert shown(None, 1 / 16) == View(0, 0, 1, 1, 256, 188)
    assert shown(None, None, (257, 188)) is None
    assert shown(None, None, (256, 189)) is None
    between = shown((8, 0, 824, 750), 1 / 16)
    assert between is not None
    assert tuple(between) == pytest.approx((0.5, 0, 52 / 51.5, 1, 52, 47))
    assert shown((8, 0, 824, 750), None, (53, 47)) is None
    half = shown((1000, 300, 640, 480), 1 / 32)
    assert half is not None
    assert tuple(half) == pytest.approx((62.5, 18.8, 0.5, 15 / 30.08, 20, 15))
