"""What a view asks for: its size, and how fine the model has to be."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sgicodec.bitstream.header import Header
from sgicodec.errors import LimitError, UsageError
from sgicodec.model.layout import ROOT_LOG
from sgicodec.model.spec import default_spec, paper_spec
from sgicodec.view import BASE_ALONE, View, finest_cells, view_of

TILED = Header(4096, 3000, "rgb", "uint8", (0, 255), "default", default_spec(3), 40, 0, tile=1024, apron=8)


@pytest.mark.parametrize(
    ("region", "scale", "size", "expected"),
    [
        (None, None, None, View(0, 0, 1, 1, 4096, 3000)),
        ((10, 20, 100, 50), 0.5, None, View(10, 20, 0.5, 0.5, 50, 25)),
        ((10, 20, 100, 50), None, (50, 100), View(10, 20, 0.5, 2, 50, 100)),
        (None, 1e-9, None, View(0, 0, 1 / 4096, 1 / 3000, 1, 1)),
    ],
)
def test_views(
    region: tuple[int, int, int, int] | None, scale: float | None, size: tuple[int, int] | None, expected: View
) -> None:
    assert view_of(TILED, region, scale, size) == expected


def test_views_of_nothing_and_of_too_much() -> None:
    for region in ((0, 0, 4097, 1), (-1, 0, 5, 5), (0, 0, 0, 5), (0, 2999, 1, 2)):
        with pytest.raises(UsageError, match="not inside the picture of 4096×3000"):
            view_of(TILED, region, None, None)
    for scale, size in ((0.0, None), (float("nan"), None), (None, (0, 3)), (2.0, (3, 3))):
        with pytest.raises(UsageError, match=r"scale|size"):
            view_of(TILED, None, scale, size)
    with pytest.raises(LimitError, match="too many for one call"):
        view_of(TILED, None, 30.0, None)
    assert view_of(TILED, None, 30.0, None, most=None).columns == 122880


def test_the_base_layer_alone_is_for_tiny_views_of_several_tiles() -> None:
    def finest(header: Header, columns: int, rows: int) -> int:
        return finest_cells(header, view_of(header, None, None, (columns, rows)))

    assert BASE_ALONE > ROOT_LOG
    cell = TILED.spec.base_cell
    assert finest(TILED, 4096 * 3 // (2 * cell), 3000 * 3 // (2 * cell)) == BASE_ALONE
    assert finest(TILED, 4096 * 8 // (5 * cell), 3000 * 8 // (5 * cell)) == 0
    assert finest(TILED, 4096 // cell, 3000) == 0
    assert finest(replace(TILED, tile=0, apron=0), 20, 15) == 0
    assert finest(replace(TILED, spec=paper_spec(3)), 20, 15) == 0
