"""What the native stream draws is the model's parts, drawn by the references in Python and added up."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.device import ONE_THREAD
from sgicodec.model.base import base_colours, render_base
from sgicodec.model.gaussians import colour_matrix, gaussians_from_seeds
from sgicodec.model.luma_space import from_luma_space
from sgicodec.raster import NativeRasterizer, scaled

GOLDEN = Path(__file__).parents[2] / "conformance" / "golden"
ONE_TILE = sorted(path.stem for path in GOLDEN.glob("*.sgi") if "tiles" not in path.stem)
RESTORED = {
    "rgb8-restored",
    "rgb8-restored-psnr",
    "rgb8-adapted",
    "rgb8-any-adapted",
    "gray16-restored",
}
"""Compared with the page in tests/system/test_restoration.py."""


def reference(stream: Stream, columns: int, rows: int) -> np.ndarray:
    """The picture [h, w, C] drawn to so many pixels: Gaussians, base layer and texture, each on its own."""
    spec, model, size = stream.header.spec, stream.model, (columns, rows)
    scale = columns / stream.width, rows / stream.height
    mix = from_luma_space(spec.channels) if spec.luma_space else np.eye(spec.channels)
    decoders = {name: np.ldexp(part.astype(np.float32), -model.decoder_shift) for name, part in model.decoders.items()}
    values, opponent = model.decoded_values.astype(np.float32), np.array(colour_matrix(spec.channels), np.float32)
    layout = model.layout
    means, covariances, colours = gaussians_from_seeds(spec, values, layout.centre, layout.cell, decoders, opponent, np)
    gaussians = scaled(*map(np.ascontiguousarray, (means, covariances, (colours @ mix.T).astype(np.float32))), scale)
    image = NativeRasterizer(ONE_THREAD).forward(*gaussians, *size)
    if spec.base_cell:
        grid = np.tensordot(mix, base_colours(model.base, model.base_step), axes=1)
        x, y = ((np.arange(count) + 0.5) / along for count, along in zip(size, scale, strict=True))
        image = image + render_base(grid, spec.base_cell, x, y)
    if model.texture is not None:
        image = image + model.texture.layer().draw(scale=scale, size=size, luma_space=spec.luma_space)
    return image.transpose(1, 2, 0)


@pytest.mark.parametrize("name", sorted(set(ONE_TILE) - RESTORED))
@pytest.mark.parametrize("scale", [1.0, 0.6, 1.7])
def test_parts_add_up(name: str, scale: float) -> None:
    with open_stream(GOLDEN / f"{name}.sgi") as stream:
        stream.exact = True
        found = stream.render(scale=scale)
        expected = reference(stream, found.shape[1], found.shape[0])
    # Rounding also decides whether a Gaussian reaches a pixel at its very end: 0.0022 of its amplitude.
    np.testing.assert_allclose(found, expected, atol=1.1e-3)
    assert np.mean(np.abs(found - expected) > 2e-5) < 1e-4
    assert found.size < 10 or found.std() > 0.01


def test_a_reduced_picture_is_the_same_in_bands(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tiles of one are drawn at once, and parts of them taken; others are drawn part by part."""
    with open_stream(GOLDEN / "rgb8-tiles-texture.sgi") as stream:
        stream.exact = True
        whole = stream.picture(scale=0.43).pixels
        monkeypatch.setattr("sgicodec.decoder.bands.BAND_SAMPLES", 3)
        monkeypatch.setattr("sgicodec.decoder.bands.MIN_BAND_ROWS", 7)
        bands = [band.pixels for _, band in stream.bands(scale=0.43)]
    assert len(bands) > 3
    np.testing.assert_array_equal(np.concatenate(bands), whole)
