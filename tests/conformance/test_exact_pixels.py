"""Decoders draw what docs/format.md says, bit for bit: the reference of tests/support/exact_pixels.py."""

from __future__ import annotations

import numpy as np
import pytest
from data_files import GOLDEN
from exact_pixels import View, drawn_tile, restored, samples_of

from sgicodec.decoder.stream import open_stream

STREAMS = sorted(path.stem for path in GOLDEN.glob("*.sgi") if "tiles" not in path.stem)
QUICK = {"gray16-texture", "gray8-alpha", "multi16-bands", "one-pixel", "paper-rgb8", "rgb8-any-colours", "rgb8-luma"}


@pytest.mark.parametrize("scale", [1.0, 0.5, 2.5])
@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in STREAMS]
)
def test_a_picture(name: str, scale: float) -> None:
    with open_stream(GOLDEN / f"{name}.sgi") as stream:
        stream.exact = stream.lossy = True
        columns, rows = (max(1, round(side * scale)) for side in (stream.width, stream.height))
        found = stream.render(size=(columns, rows)).transpose(2, 0, 1)
        across, down = View(0.0, columns / stream.width, columns), View(0.0, rows / stream.height, rows)
        header, model = stream.header, stream.model
    expected = drawn_tile(header, model, across, down)
    if model.restoration is not None:
        if scale > 1:
            pytest.skip("tests/system/test_restoration.py has the correction of enlarged pictures")
        expected = restored(header, model, expected) if scale == 1 else expected
    np.testing.assert_array_equal(found, samples_of(header, expected))
