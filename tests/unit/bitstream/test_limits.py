"""The caps hold whatever an encoder may be asked for, and a header returns what it was given."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from page_header import LAYOUT_NAMES, SAMPLE_TYPES

from sgicodec.bitstream.header import Header, decode_header, encode_header
from sgicodec.bitstream.limits import check_model, max_seeds
from sgicodec.errors import LimitError
from sgicodec.image import MAX_SAMPLES
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec

SPECS = {
    "default": default_spec(3),
    "own context": default_spec(1, prior=0),
    "paper": paper_spec(3),
    "default at its largest": default_spec(64, prior=0),
    "paper at its largest": paper_spec(64, 64, 512),
    "paper at its smallest": paper_spec(1, 1, 1),
}

every_spec = pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)


@every_spec
@pytest.mark.parametrize("sample_type", SAMPLE_TYPES)
def test_headers_return(spec: ModelSpec, sample_type: str) -> None:
    reach = {"uint8": (0.0, 255.0), "uint16": (0.0, 65535.0), "float32": (-1.5, 1e9)}[sample_type]
    layout = "multi" if spec.channels > 4 else ("gray", "gray+alpha", "rgb", "rgba")[spec.channels - 1]
    assert layout in LAYOUT_NAMES
    header = Header(2**24, 7, layout, sample_type, reach, "paper", spec, 255, 1)
    returned = decode_header(encode_header(header))
    assert returned == header
    assert returned.spec.groups == spec.groups
    assert returned.spec.context == spec.context


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


@every_spec
def test_seeds_grow_with_the_payload(spec: ModelSpec) -> None:
    assert max_seeds(spec, 1, 1, 0) == 64
    few, many = (max_seeds(spec, 10**5, 10**5, length) for length in (0, 10**7))
    assert few >= 3000
    assert many > 10 * few
    assert max_seeds(spec, 100, 50, 10**9) == 10_000


def test_real_streams_stay_far_below() -> None:
    """Seeds of the default profile take two bytes at least, those of the paper's ten."""
    for spec, least in ((default_spec(3), 2), (paper_spec(3), 10)):
        for length in (10**3, 10**5, 10**7):
            assert max_seeds(spec, 10**5, 10**5, length) > 1.5 * length / least
