"""The caps hold whatever an encoder may be asked for, and a header returns what it was given."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from sgicodec.bitstream.limits import check_model
from sgicodec.errors import LimitError
from sgicodec.image.header import MAX_SAMPLES
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec

SPECS = {
    "default": default_spec(3),
    "paper": paper_spec(3),
    "default at its largest": default_spec(64),
    "paper at its largest": paper_spec(64, 64, 512),
    "paper at its smallest": paper_spec(1, 1, 1),
}

every_spec = pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)


@every_spec
def test_what_an_encoder_may_be_asked_for_is_allowed(spec: ModelSpec) -> None:
    """Pictures of as many samples as are read."""
    side = math.isqrt(MAX_SAMPLES // spec.channels)
    for width, height in ((1, 1), (side, side), (200_000, 100), (3, 200_000)):
        check_model(spec, width, height)


@pytest.mark.parametrize(
    ("width", "height", "what"), [(2**15, 2**15, "samples"), (2**24, 65, "samples"), (2**24, 1, "base layer")]
)
def test_pictures_beyond(width: int, height: int, what: str) -> None:
    with pytest.raises(LimitError, match=what):
        check_model(replace(default_spec(3), base_cell=32), width, height)
