"""Short streams that stand for much: looking at them takes little memory, whatever they claim (docs/security.md)."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from data_files import ATTACKS, GOLDEN
from little_memory import within
from surgery import frame, join, split

from sgicodec import EncodeSettings, Picture, encode_picture
from sgicodec.bitstream.container import SIGNATURE
from sgicodec.bitstream.header import Header, decode_header, encode_header
from sgicodec.bitstream.parts import mask as masks
from sgicodec.bitstream.parts.tile_chunk import decode_tile_chunk
from sgicodec.bitstream.varint import encode_varint
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import CorruptStreamError, LimitError, PictureError

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")

MASKED = GOLDEN / "rgba8.sgi"
LOOKS = "survey", "region", "scale"


def _header(**fields: int) -> Header:
    """Of a picture in RGBA without texture, whose tiles say which pixels are transparent."""
    header = decode_header(split(MASKED.read_bytes())[0][1])
    spec = replace(header.spec, texture=False)
    return replace(header, spec=spec, masked="transparent", **fields)


def _one_tile(header: Header, payload: bytes) -> bytes:
    return join([("H", encode_header(header)), ("T", payload), ("E", b"")])


def _stripes(side: int) -> np.ndarray:
    """A mask all of whose squares are mixed, and which takes few bytes."""
    stripes = np.zeros((side, side), np.bool_)
    stripes[1::2] = True
    return stripes


@pytest.mark.parametrize("name", ["none_60k", "none_2_17", "tiny_20k", "tiny_60k"])
def test_attacks(name: str) -> None:
    """Streams that took gigabytes: of nothing, and with masks of one corner, without a model behind them."""
    found = within(ATTACKS / f"mask_{name}.sgi", MASKED, *LOOKS)
    if name.startswith("none"):
        assert found == {"survey": 0, "region": [30, 40, 4], "scale": [9, 12, 4]}
    else:
        assert {str(answer).partition(":")[0] for answer in found.values()} <= {"CorruptStreamError", "LimitError"}


def test_masks_of_too_many_squares(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(masks, "max_mixed", lambda payload_bytes: 1 << 30)
    mask = masks.write_mask(_stripes(2560))
    path = tmp_path / "mixed.sgi"
    payload = b"\x02" + encode_varint(len(mask)) + mask + b"\x01"
    path.write_bytes(_one_tile(_header(width=2560, height=2560), payload))
    assert path.stat().st_size < 500
    found = within(path, MASKED, *LOOKS)
    assert all(str(answer).startswith("LimitError: a mask of too many squares") for answer in found.values()), found


def test_a_mask_that_no_reader_would_take_is_not_written(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(masks, "max_mixed", lambda payload_bytes: payload_bytes // 4)
    dots = np.zeros((800, 800), np.bool_)
    dots[::100, ::100] = True
    with pytest.raises(PictureError, match="--tile"):
        masks.write_mask(dots)


def test_the_most_squares_of_a_short_mask(tmp_path: Path) -> None:
    stripes = _stripes(1424)
    mask = masks.write_mask(stripes)
    path, header = tmp_path / "stripes.sgi", _header(width=1424, height=1424)
    payload = b"\x02" + encode_varint(len(mask)) + mask + b"\x01"
    (found,) = decode_tile_chunk(header, payload).masks
    np.testing.assert_array_equal(found.at(np.arange(1424), np.arange(1424)), stripes)
    path.write_bytes(_one_tile(header, payload))
    answers = within(path, MASKED, *LOOKS)
    assert all(str(answer).startswith("CorruptStreamError") for answer in answers.values()), answers


def test_a_million_tiles(tmp_path: Path) -> None:
    """In an index that names the first one 2²⁰ times."""
    header = _header(width=1 << 17, height=1 << 17, tile=128, apron=8)
    assert header.grid.count == 1 << 20
    start = SIGNATURE + frame("H", encode_header(header))
    tile = frame("T", encode_varint(0) + b"\x01")
    place = encode_varint(len(start)) + encode_varint(2)
    at = len(start) + len(tile)
    index = encode_varint(1 << 20) + place * (1 << 20) + at.to_bytes(8, "little")
    path = tmp_path / "tiles.sgi"
    path.write_bytes(start + tile + frame("X", index) + frame("E", b""))
    found = within(path, MASKED, "region", "scale")
    assert found["region"] == [30, 40, 4]
    assert "another tile" in str(found["scale"])


@pytest.mark.parametrize("tile", [0, 64])
def test_samples_take_no_memory_before_tiles_are_sound(tmp_path: Path, tile: int) -> None:
    """The last tile's model ends early, with a checksum that fits; enlarged, the picture has 232 MiB."""
    data = encode_picture(_gray(128, 96), EncodeSettings(steps=1, tile=tile, overview=False)).data
    parts = [(letter, payload[: -1 if letter == "T" else None]) for letter, payload in split(data) if letter != "X"]
    sound = [number for number, (letter, _) in enumerate(parts) if letter == "T"][:-1]
    parts = [split(data)[number] if number in sound else part for number, part in enumerate(parts)]
    path = tmp_path / "short.sgi"
    path.write_bytes(join(parts))
    assert str(within(path, MASKED, "enlarged")["enlarged"]).startswith("CorruptStreamError"), tile


def test_many_tiles_without_an_index(tmp_path: Path) -> None:
    """They are looked for one by one, a stranger's 2²⁰ for 14 seconds."""
    for rows, answer in ((129, "LimitError: there are 33024 tiles and no sound index"), (128, [30, 40, 4])):
        header = _header(width=256 * 128, height=rows * 128, tile=128, apron=8)
        start = SIGNATURE + frame("H", encode_header(header))
        count = header.grid.count if rows == 128 else 1
        tiles = b"".join(frame("T", encode_varint(number) + b"\x01") for number in range(count))
        path = tmp_path / "tiles.sgi"
        path.write_bytes(start + tiles + frame("E", b""))
        with path.open("rb") as file:
            if rows == 128:
                assert open_stream(file).chunk_bytes["T"] == len(tiles)
            else:
                with pytest.raises(LimitError, match="no sound index"):
                    open_stream(file)
        found = within(path, MASKED, "region")["region"]
        assert found == answer or str(found).startswith(str(answer)), found


def test_an_index_that_is_longer_than_any(tmp_path: Path) -> None:
    header = _header(width=64, height=128, tile=64, apron=8)
    start = SIGNATURE + frame("H", encode_header(header))
    tile = frame("T", encode_varint(0) + b"\x01")
    at = len(start) + len(tile)
    path = tmp_path / "index.sgi"
    path.write_bytes(start + tile + frame("X", bytes(100 << 20) + at.to_bytes(8, "little")) + frame("E", b""))
    assert "tile 1 is missing" in str(within(path, MASKED, "region")["region"])


def _with_overview(data: bytes, overview: bytes) -> bytes:
    header, *others = [(letter, payload) for letter, payload in split(data) if letter not in "oX"]
    return join([header, ("o", overview), *others])


def _gray(width: int, height: int) -> Picture:
    return Picture(np.full((height, width, 1), 90, np.uint8), "gray", (0.0, 255.0))


def test_an_overview_in_an_overview_is_passed_over() -> None:
    settings = EncodeSettings(steps=1, tile=32, texture=False)
    data = encode_picture(_gray(640, 512), replace(settings, tile=512, overview=True)).data
    small = encode_picture(_gray(40, 32), replace(settings, overview=False)).data
    smaller = encode_picture(_gray(2, 2), settings).data
    with open_stream(_with_overview(data, _with_overview(small, smaller))) as stream:
        assert stream.has_overview
        assert not stream.overview.has_overview
        assert stream.picture(size=(2, 2)).pixels.shape == (2, 2, 1)


def test_an_overview_that_is_no_smaller() -> None:
    dot = encode_picture(_gray(1, 1), EncodeSettings(steps=1)).data
    with open_stream(_with_overview(dot, dot)) as stream, pytest.raises(CorruptStreamError, match="no smaller"):
        _ = stream.overview


def test_overviews_are_written_without_one() -> None:
    settings = EncodeSettings(steps=1, tile=32, overview=True, texture=False)
    with open_stream(encode_picture(_gray(544, 32), settings).data) as stream:
        assert stream.overview.grid.count > 1
        assert "o" not in stream.overview.chunk_bytes
