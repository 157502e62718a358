"""A stream decodes on every instruction set to the same symbols, and to pixels within one of 255 levels.

More than rounding differs: wider vectors draw more of a Gaussian beyond where it may end.
"""

from pathlib import Path

import numpy as np
import pytest
from scenes import ISAS

from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device

GOLDEN = sorted(path.stem for path in (Path(__file__).parents[1] / "conformance" / "golden").glob("*.sgi"))


@pytest.mark.parametrize("name", GOLDEN)
def test_symbols_and_pixels(name: str) -> None:
    path = Path(__file__).parents[1] / "conformance" / "golden" / f"{name}.sgi"
    usual = open_stream(path)
    pixels, scaled = usual.picture().pixels, usual.render(scale=0.7)
    level = {"uint8": 1, "uint16": 257, "float32": 1 / 255 * np.ptp(usual.header.sample_range)}[str(pixels.dtype)]
    for isa in ISAS:
        stream = open_stream(path, Device(isa=isa))
        found = stream.picture().pixels
        stated = (found == pixels) | (np.isnan(found) & np.isnan(pixels))
        np.testing.assert_allclose(np.where(stated, 0, found), np.where(stated, 0, pixels.astype(float)), 0, level)
        assert np.abs(stream.render(scale=0.7) - scaled).max() < 1 / 255
        assert np.abs(stream.render(scale=1 / 16) - usual.render(scale=1 / 16)).max() < 1 / 255
        for number in range(stream.grid.count):
            ours, theirs = (one.tile_model(number) for one in (stream, usual))
            assert ours is not None
            assert theirs is not None
            np.testing.assert_array_equal(ours.decoded, theirs.decoded)
        assert stream.symbol_crc == usual.symbol_crc


def test_an_instruction_set_that_is_not_there() -> None:
    with pytest.raises(ValueError, match="unknown instruction set 'mmx'"):
        open_stream(Path(__file__).parents[1] / "conformance" / "golden" / "rgb8.sgi", Device(isa="mmx")).picture()
