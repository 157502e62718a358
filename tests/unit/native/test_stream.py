"""The native stream draws what the decoder in Python draws, bit by bit where no network decodes features."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sgicodec import _native
from sgicodec.decoder.stream import open_stream
from sgicodec.decoder.view import view_of

GOLDEN = sorted((Path(__file__).parents[2] / "conformance" / "golden").glob("*.sgi"))


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
@pytest.mark.parametrize("scale", [None, 0.37, 1.6])
def test_pixels(path: Path, scale: float | None) -> None:
    usual, stream = open_stream(path), _native.Stream(path.read_bytes(), 0, "auto", 1 << 28)
    view = view_of(usual.header, None, scale, None)
    shape = view.rows, view.columns, usual.header.spec.channels
    for mapped, dtype in ((False, np.dtype(np.float32)), (True, usual.dtype)):
        expected = usual.picture(scale=scale).pixels if mapped else usual.render(scale=scale)
        found = np.empty(shape, dtype)
        stream.draw(view, 0, found, mapped, False, True)
        if usual.header.spec.hidden:
            np.testing.assert_allclose(found, expected, atol=1 if mapped else 1 / 65535)
        else:
            np.testing.assert_array_equal(found, expected)
    assert stream.survey()[3] == usual.symbol_crc
