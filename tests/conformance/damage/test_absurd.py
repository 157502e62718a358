"""Streams that are sound and mean nonsense draw finite pictures, without a warning and at any scale."""

import numpy as np
import pytest
from absurd import absurd_stream

from sgicodec.decoder.stream import open_stream

pytestmark = pytest.mark.filterwarnings("error")


@pytest.mark.parametrize("seed", range(60))
def test_any_numbers_draw_a_picture(seed: int) -> None:
    with open_stream(absurd_stream(np.random.default_rng(seed))) as stream:
        for size in (None, (33, 20), (300, 500)):
            assert np.isfinite(stream.render(size=size)).all()
            width, height = size or (stream.width, stream.height)
            assert stream.picture(size=size).pixels.shape == (height, width, stream.header.spec.channels)
