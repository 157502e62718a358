"""A tile of a reduced view is drawn at once: the same samples as part by part."""

from pathlib import Path

import numpy as np
import pytest
from textures import random_layer

from sgicodec.decoder import tile_renderer
from sgicodec.decoder.compositor import sample_mapping
from sgicodec.decoder.stream import open_stream
from sgicodec.decoder.tile_renderer import TileRenderer
from sgicodec.decoder.view import View, view_of
from sgicodec.device import ONE_THREAD
from sgicodec.raster import Mapping

GOLDEN = Path(__file__).parents[2] / "conformance" / "golden"


def parts(tile: TileRenderer, view: View, mapping: Mapping | None, dtype: type[np.generic], whole: bool) -> np.ndarray:
    """The view in four uneven parts."""
    out: np.ndarray = np.zeros((view.rows, view.columns, tile.header.spec.channels), dtype)
    draw = tile.draw if whole else tile._draw
    for rows in (slice(0, 7), slice(7, None)):
        for columns in (slice(0, 11), slice(11, None)):
            draw(view, (columns.start, rows.start), out[rows, columns], mapping, ONE_THREAD)
    return out


@pytest.mark.parametrize("name", ["rgb8-predicted-seeds", "gray16", "float", "multi8"])
@pytest.mark.parametrize("scale", [0.31, 0.9])
@pytest.mark.parametrize("inset", [0, 3])
def test_whole_or_in_parts(name: str, scale: float, inset: int) -> None:
    with open_stream(GOLDEN / f"{name}.sgi") as stream:
        header = stream.header
        region = inset, inset, header.width - 2 * inset, header.height - 2 * inset
        tile, view = stream.tile(0), view_of(header, region, scale, None)
        mapping, dtype = sample_mapping(stream.header), np.dtype(stream.header.sample_type).type
    expected = parts(tile, view, mapping, dtype, whole=False)
    assert tile._whole is None
    before = tile.memory
    np.testing.assert_array_equal(parts(tile, view, mapping, dtype, whole=True), expected)
    assert tile._whole is not None
    assert tile.memory >= before + tile._whole.samples.nbytes
    assert expected.std() > 0
    np.testing.assert_array_equal(
        parts(tile, view, None, np.float32, whole=True), parts(tile, view, None, np.float32, whole=False)
    )


@pytest.mark.parametrize("name", ["rgb8", "gray16"])
@pytest.mark.parametrize("scale", [None, 0.4, 1.7])
def test_texture_is_added(name: str, scale: float | None, monkeypatch: pytest.MonkeyPatch) -> None:
    with open_stream(GOLDEN / f"{name}.sgi") as stream:
        tile, header = stream.tile(0), stream.header
        view = view_of(header, None, scale, None)
    layer = random_layer(header.spec.channels, header.width, header.height)
    size = view.columns, view.rows
    planes = layer.draw(scale=(view.sx, view.sy), size=size)
    expected = parts(tile, view, None, np.float32, whole=False) + planes.transpose(1, 2, 0)
    memory = tile.memory
    tile._texture = layer
    assert tile.memory == memory + layer.memory
    drawn = parts(tile, view, None, np.float32, whole=False)
    assert planes.std() > 0.02
    np.testing.assert_allclose(drawn, expected, atol=1e-6)
    monkeypatch.setattr(tile_renderer, "TEXTURED_SAMPLES", 2000)
    np.testing.assert_array_equal(parts(tile, view, None, np.float32, whole=False), drawn)


def test_full_size_is_drawn_as_it_is_asked_for() -> None:
    with open_stream(GOLDEN / "rgb8.sgi") as stream:
        tile, view = stream.tile(0), view_of(stream.header, None, None, None)
    parts(tile, view, None, np.float32, whole=True)
    assert tile._whole is None
