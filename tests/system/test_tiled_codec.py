"""Pictures in several tiles: no seams, parts that are parts of the whole, reads that are counted."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
from data_files import crop
from surgery import flipped, join, split

from sgicodec import Device, Encoded, EncodeSettings, NullListener, Picture, encode_picture, open_source, write
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import CorruptStreamError, PictureError

SETTINGS = EncodeSettings(steps=60, tile=128)
NEAR = 8


@pytest.fixture(scope="module", params=["kodim23", "kodim13"])
def coded(request: pytest.FixtureRequest) -> tuple[Picture, Encoded]:
    """336×256 pixels of a smooth picture and of texture, in 3×2 tiles."""
    picture = crop(request.param, np.s_[:256, 64:400])
    return picture, encode_picture(picture, SETTINGS)


def near_borders(stream_width: int, stream_height: int, edges: tuple[list[int], list[int]]) -> np.ndarray:
    mask = np.zeros((stream_height, stream_width), bool)
    for x in edges[0]:
        mask[:, x - NEAR : x + NEAR] = True
    for y in edges[1]:
        mask[y - NEAR : y + NEAR] = True
    return mask


@pytest.mark.parametrize(("side", "other", "count"), [(2048, 2048, 1), (2049, 2048, 6), (16384, 9, 1), (16385, 9, 17)])
def test_a_picture_that_is_large_or_long_has_tiles(side: int, other: int, count: int) -> None:
    """One tile of 100,000×16 pixels took more than five minutes."""
    assert EncodeSettings().grid(side, other).count == EncodeSettings().grid(other, side).count == count


def test_no_seam(coded: tuple[Picture, Encoded]) -> None:
    """At most 10 % more error near a border than elsewhere, as it would be without borders there."""
    picture, tiled = coded
    one = encode_picture(picture, replace(SETTINGS, tile=0))
    near = near_borders(336, 256, ([112, 224], [128]))
    ratios = []
    for data in (tiled.data, one.data):
        error = np.square(open_stream(data).picture().pixels.astype(float) - picture.pixels).mean(axis=2)
        ratios.append(np.sqrt(error[near].mean() / error[~near].mean()))
    assert ratios[0] <= 1.1 * max(1, ratios[1])
    steps = np.abs(np.diff(open_stream(tiled.data).picture().pixels.astype(float), axis=1)).mean(axis=(0, 2))
    plain = np.abs(np.diff(open_stream(one.data).picture().pixels.astype(float), axis=1)).mean(axis=(0, 2))
    assert (steps[[111, 223]] < 1.15 * plain[[111, 223]] + 0.2).all()


@pytest.mark.parametrize("scale", [None, 0.5, 1 / 7, 2.0])
def test_bands_are_the_picture(
    coded: tuple[Picture, Encoded], scale: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sgicodec.decoder.bands.BAND_SAMPLES", 48 * 3 * 20)
    stream = open_stream(coded[1].data)
    bands = stream.bands(scale=scale)
    parts = [band.pixels for _, band in bands]
    assert len(parts) > 1
    assert [top for top, _ in bands] == list(range(0, bands.height, bands.rows))
    np.testing.assert_array_equal(np.concatenate(parts), stream.picture(scale=scale).pixels)


def test_scaled_views_agree_with_averages(coded: tuple[Picture, Encoded]) -> None:
    """A half-size view is the mean of 2×2 pixels, borders included, as well as it is elsewhere."""
    stream = open_stream(coded[1].data)
    whole, half = stream.render(), stream.render(scale=0.5)
    means = whole.reshape(128, 2, 168, 2, 3).mean(axis=(1, 3))
    error = np.abs(half - means).mean(axis=2)
    near = near_borders(168, 128, ([56, 112], [64]))
    assert error[near].mean() < 1.3 * error[~near].mean() + 1e-3


def of_tile_4(data: bytes) -> tuple[bytes, bytes]:
    """The payload of its chunk, as it is and with a bit of it changed."""
    payload = next(payload for letter, payload in split(data) if letter == "T" and payload[0] == 4)
    return payload, flipped(payload, 4 * len(payload))


def test_a_damaged_tile_is_named(coded: tuple[Picture, Encoded]) -> None:
    stream = open_stream(coded[1].data.replace(*of_tile_4(coded[1].data)))
    stream.picture((0, 0, 40, 40))
    with pytest.raises(CorruptStreamError, match="CRC"):
        stream.picture()


@pytest.mark.parametrize("threads", [1, 3])
def test_a_tile_of_other_symbols_is_named(coded: tuple[Picture, Encoded], threads: int) -> None:
    """Its chunk is sound, what it holds is not; whoever decodes it, the caller learns of it."""
    sound, changed = of_tile_4(coded[1].data)
    data = join([(letter, changed if payload == sound else payload) for letter, payload in split(coded[1].data)])
    with pytest.raises(CorruptStreamError, match="tile 4: "):
        open_stream(data, Device(threads)).picture()


def test_a_file_that_changes_is_no_picture(tmp_path: Path) -> None:
    """Tiles would be of either; nothing is written."""
    path, out = tmp_path / "a.tif", tmp_path / "a.sgi"
    picture = crop("kodim23", np.s_[:64, :160])
    write(picture, path)
    turned = replace(picture, pixels=picture.pixels[:, ::-1].copy())
    listener = Mock(wraps=NullListener(), tile=lambda _: write(turned, path))
    with open_source(path) as source, pytest.raises(PictureError, match="has changed since it was opened"):
        encode_picture(source, EncodeSettings(steps=10, tile=64), output=out, progress=listener)
    assert not out.exists()
