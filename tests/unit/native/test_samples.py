"""Dither: means are kept, and the pattern is that of docs, which knows no bands."""

from __future__ import annotations

import numpy as np
import pytest
from data_files import GOLDEN

from sgicodec.decoder.stream import Stream, open_stream


@pytest.fixture(params=["gray16", "gray16-texture", "float"])
def stream(request: pytest.FixtureRequest) -> Stream:
    """Of samples of more than eight bits."""
    return open_stream(GOLDEN / f"{request.param}.sgi")


def threshold(rows: int, columns: int, channels: int) -> np.ndarray:
    """Interleaved gradient noise, a little less than 0 … 1."""
    y, x, c = np.mgrid[:rows, :columns, :channels].astype(np.float64)
    inner = np.modf(0.06711056 * (x + 56 * c) + 0.00583715 * (y + 112 * c))[0]
    return 1e-3 + (1 - 2e-3) * np.modf(52.9829189 * inner)[0]


@pytest.mark.parametrize("scale", [None, 3.0])
def test_samples_are_rounded_at_the_threshold(stream: Stream, scale: float | None) -> None:
    values = np.clip(stream.render(scale=scale) * np.float32(255), 0, 255)
    found = stream.read(scale=scale, dtype=np.uint8).reshape(values.shape)
    expected = np.floor(np.minimum(values + threshold(*values.shape).astype(np.float32), 255))
    np.testing.assert_array_equal(found, expected)
    assert (found != np.rint(values)).mean() > 0.1


def test_bands_have_the_pattern_of_the_whole(stream: Stream, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = stream.picture(scale=2, dtype=np.uint8).pixels
    monkeypatch.setattr("sgicodec.decoder.bands.BAND_SAMPLES", 3)
    bands = [band.pixels for _, band in stream.bands(scale=2, dtype=np.uint8)]
    assert len(bands) > 1
    np.testing.assert_array_equal(np.concatenate(bands), whole)


def test_alpha_is_rounded() -> None:
    """Half a level below a sample and half a level above it, so that dither would show."""
    stream = open_stream(GOLDEN / "rgba8.sgi")
    alpha = stream.picture().pixels[..., 3]
    kept = alpha > 0  # of others a mask says that they are transparent
    assert kept.mean() > 0.9
    rounded = np.rint(np.clip(stream.render()[..., 3], 0, 1) * np.float32(255))
    np.testing.assert_array_equal(alpha[kept], rounded[kept])
