"""Header fields come back as they were; other versions are refused; caps hold whatever an encoder may be asked for."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from data_files import GOLDEN_STREAMS
from surgery import split, with_fields

from sgicodec.bitstream.header import FORMAT_VERSION, decode_header, encode_header
from sgicodec.bitstream.limits import check_model
from sgicodec.errors import CorruptStreamError, LimitError, UnsupportedStreamError
from sgicodec.image.header import MAX_SAMPLES
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.default import default_spec
from sgicodec.profiles.paper import paper_spec


def header_of(path: Path, **changes: int | Callable[[int], int]) -> bytes:
    (_, payload), *_ = split(with_fields(path.read_bytes(), **changes))
    return payload


def named(stem: str) -> Path:
    return next(path for path in GOLDEN_STREAMS if path.stem == stem)


@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
def test_headers_come_back_byte_by_byte(path: Path) -> None:
    payload = header_of(path)
    assert encode_header(decode_header(payload)) == payload


def test_ranges_bands_and_exact_samples_come_back() -> None:
    header = decode_header(header_of(named("gray16")))
    for change in ({"sample_range": (0.0, 4095.0)}, {"has_exact": True}):
        changed = replace(header, **change)
        assert decode_header(encode_header(changed)) == changed
    bands = decode_header(header_of(named("multi8")))
    masked = replace(bands, masked="nodata", has_band_masks=True)
    assert decode_header(encode_header(masked)) == masked
    low, high = tuple(float(band) for band in range(5)), tuple(float(band) for band in range(9, 14))
    assert decode_header(encode_header(replace(bands, sample_range=(low, high)))).sample_range == (low, high)


@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
@pytest.mark.parametrize("what", ["texture", "luma_space", "restoration"])
def test_what_tiles_may_have_comes_back(path: Path, what: str) -> None:
    header = decode_header(header_of(path))
    for has in (False, True):
        changed = replace(header, spec=replace(header.spec, **{what: has}))
        payload = encode_header(changed)
        has_luma_space = header.channels in ("rgb", "rgba") and header.spec.layout == "adaptive"
        if has and what == "luma_space" and not has_luma_space:
            with pytest.raises(CorruptStreamError, match="has no luma space"):
                decode_header(payload)
        elif header.network and not changed.spec.restoration:
            with pytest.raises(CorruptStreamError, match="that no tile can name"):
                decode_header(payload)
        else:
            assert decode_header(payload) == changed


@pytest.mark.parametrize("version", [0, FORMAT_VERSION + 1, 1 << 20])
def test_other_versions_are_refused(version: int) -> None:
    with pytest.raises(UnsupportedStreamError, match=f"format version {version}; this program reads version"):
        decode_header(header_of(GOLDEN_STREAMS[0], version=version))


def test_unknown_flags_are_refused() -> None:
    with pytest.raises(LimitError, match="the flags"):
        decode_header(header_of(GOLDEN_STREAMS[0], flags=lambda flags: flags | 1 << 10))


@pytest.mark.parametrize("fields", [{"per_seed": 2}, {"features": 3}, {"features": 5}, {"hidden": 4}])
def test_an_adaptive_seed_is_one_gaussian(fields: dict[str, int]) -> None:
    header = decode_header(header_of(named("gray16")))
    assert header.spec.plain
    spec = replace(header.spec, **fields)
    with pytest.raises(CorruptStreamError, match="contradict"):
        decode_header(encode_header(replace(header, spec=spec)))


SPECS = {
    "default": default_spec(3),
    "paper": paper_spec(3),
    "default at its largest": default_spec(64),
    "paper at its largest": paper_spec(64, 64, 512),
    "paper at its smallest": paper_spec(1, 1, 1),
}


@pytest.mark.parametrize("spec", SPECS.values(), ids=SPECS)
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
