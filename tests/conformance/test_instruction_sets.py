"""A stream decodes on every instruction set to the same symbols and samples."""

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
    for isa in ISAS:
        stream = open_stream(path, Device(isa=isa))
        np.testing.assert_array_equal(stream.picture().pixels, usual.picture().pixels)
        for scale in (None, 0.7, 1 / 16, 2.3):
            np.testing.assert_array_equal(stream.render(scale=scale), usual.render(scale=scale))
        for number in range(stream.grid.count):
            ours, theirs = (one.tile_model(number) for one in (stream, usual))
            assert ours is not None
            assert theirs is not None
            np.testing.assert_array_equal(ours.decoded, theirs.decoded)
        assert stream.symbol_crc == usual.symbol_crc


def test_an_instruction_set_that_is_not_there() -> None:
    with pytest.raises(ValueError, match="unknown instruction set 'mmx'"):
        open_stream(Path(__file__).parents[1] / "conformance" / "golden" / "rgb8.sgi", Device(isa="mmx")).picture()
