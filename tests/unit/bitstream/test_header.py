"""Header fields come back as they were; each version has its flags."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from page_varint import decode_varint
from surgery import HEADER_FIELDS, split, with_fields

from sgicodec.bitstream.header import decode_header, encode_header
from sgicodec.errors import CorruptStreamError, LimitError, UnsupportedStreamError

ALL = sorted((Path(__file__).parents[2] / "conformance" / "golden").glob("*.sgi"))
BARE = [path for path in ALL if path.stem in ("multi16-bands", "float-tiles-exact")]
GOLDEN = [path for path in ALL if path not in BARE]
"""Those whose version follows from their model."""
TEXTURE, LUMA, RESTORATION = 256, 512, 1024


def header_of(path: Path, **changes: int | Callable[[int], int]) -> bytes:
    (_, payload), *_ = split(with_fields(path.read_bytes(), **changes))
    return payload


def flags_of(payload: bytes) -> int:
    at = 0
    for _ in range(HEADER_FIELDS.index("flags") + 1):
        flags, at = decode_varint(payload, at)
    return flags


@pytest.mark.parametrize("path", ALL, ids=lambda path: path.stem)
def test_headers_come_back_byte_by_byte(path: Path) -> None:
    payload = header_of(path)
    header = decode_header(payload)
    assert encode_header(header)[1:] == payload[1:]
    newer = (
        6
        if path in BARE
        else 5
        if header.spec.restoration
        else 4
        if header.spec.luma_space
        else 3
        if header.spec.texture
        else 2
    )
    assert payload[0] == newer or (newer, payload[0]) == (2, 1)
    assert encode_header(header)[0] == newer


def test_there_are_headers_of_each_version() -> None:
    assert {header_of(path)[0] for path in ALL} == {1, 2, 3, 4, 5, 6}


def test_ranges_bands_and_exact_samples_make_it_version_6() -> None:
    header = decode_header(header_of(next(path for path in GOLDEN if path.stem == "gray16")))
    assert encode_header(header)[0] == 2
    for change in ({"sample_range": (0.0, 4095.0)}, {"has_exact": True}):
        changed = replace(header, **change)
        assert encode_header(changed)[0] == 6
        assert decode_header(encode_header(changed)) == changed
    bands = decode_header(header_of(next(path for path in GOLDEN if path.stem == "multi8")))
    masked = replace(bands, masked="nodata", has_band_masks=True)
    assert decode_header(encode_header(masked)) == masked
    low, high = tuple(float(band) for band in range(5)), tuple(float(band) for band in range(9, 14))
    assert decode_header(encode_header(replace(bands, sample_range=(low, high)))).sample_range == (low, high)


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_texture_makes_it_version_3(path: Path) -> None:
    header = decode_header(header_of(path))
    textured = replace(header, spec=replace(header.spec, texture=True, luma_space=False, restoration=False))
    payload = encode_header(textured)
    assert payload == header_of(path, version=3, flags=lambda flags: flags & ~(LUMA | RESTORATION) | TEXTURE)
    assert decode_header(payload) == textured


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_luma_space_makes_it_version_4(path: Path) -> None:
    header = decode_header(header_of(path))
    mixed = replace(header, spec=replace(header.spec, luma_space=True, restoration=False))
    payload = encode_header(mixed)
    assert payload == header_of(path, version=4, flags=lambda flags: flags & ~RESTORATION | LUMA)
    if header.channels in ("rgb", "rgba"):
        assert decode_header(payload) == mixed
    else:
        with pytest.raises(CorruptStreamError, match="has no luma space"):
            decode_header(payload)


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_restoration_makes_it_version_5(path: Path) -> None:
    header = decode_header(header_of(path))
    restored = replace(header, spec=replace(header.spec, restoration=True))
    payload = encode_header(restored)
    assert payload == header_of(path, version=5, flags=lambda flags: flags | RESTORATION)
    assert decode_header(payload) == restored


def test_versions_have_their_flags() -> None:
    path = GOLDEN[0]
    flags = flags_of(header_of(path))
    with pytest.raises(LimitError, match="the flags"):
        decode_header(header_of(path, version=2, flags=flags | TEXTURE))
    with pytest.raises(CorruptStreamError, match="without anything that needs it"):
        decode_header(header_of(path, version=3))
    with pytest.raises(LimitError, match="the flags"):
        decode_header(header_of(path, version=3, flags=flags | LUMA))
    with pytest.raises(CorruptStreamError, match="without anything that needs it"):
        decode_header(header_of(path, version=4, flags=flags | TEXTURE))
    with pytest.raises(LimitError, match="the flags"):
        decode_header(header_of(path, version=4, flags=flags | RESTORATION))
    with pytest.raises(CorruptStreamError, match="without anything that needs it"):
        decode_header(header_of(path, version=5, flags=flags | LUMA))
    with pytest.raises(LimitError, match="the flags"):
        decode_header(header_of(path, version=5, flags=flags | 2 * RESTORATION))
    with pytest.raises(CorruptStreamError, match="without anything that needs it"):
        decode_header(header_of(path, version=6, flags=flags | RESTORATION))
    with pytest.raises(UnsupportedStreamError, match="reads 1 to 6"):
        decode_header(header_of(path, version=7))
