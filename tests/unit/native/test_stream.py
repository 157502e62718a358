"""What the native stream draws is the model's parts, rendered by the references in Python and added up."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sgicodec.decoder.stream import open_stream

GOLDEN = Path(__file__).parents[2] / "conformance" / "golden"


def test_a_reduced_picture_is_the_same_in_bands(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tiles of one are rendered at once, and parts of them taken; others are rendered part by part."""
    with open_stream(GOLDEN / "rgb8-tiles-texture.sgi") as stream:
        stream.exact = True
        whole = stream.picture(scale=0.43).pixels
        monkeypatch.setattr("sgicodec.decoder.bands.BAND_SAMPLES", 3)
        monkeypatch.setattr("sgicodec.decoder.bands.MIN_BAND_ROWS", 7)
        bands = [band.pixels for _, band in stream.bands(scale=0.43)]
    assert len(bands) > 3
    np.testing.assert_array_equal(np.concatenate(bands), whole)
