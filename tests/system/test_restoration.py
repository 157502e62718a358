"""Restored streams: nearer to the picture, the same in every region, as docs/format.md says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from data_files import crop
from restoration_reader import another_network, corrected
from surgery import join

from sgicodec import EncodeSettings, Picture, encode_picture
from sgicodec.bitstream.header import encode_header
from sgicodec.bitstream.parts.tile import write_tile
from sgicodec.bitstream.parts.tile_chunk import encode_tile_chunk
from sgicodec.decoder.stream import Stream, open_stream
from sgicodec.model.colours import to_channels, to_samples
from sgicodec.rdoq.objective import with_values

QUICK = EncodeSettings(quality=45, steps=60, tune="psnr")


@pytest.fixture(scope="module")
def photo() -> Picture:
    return crop("kodim13", np.s_[300:428, 80:280])


@pytest.fixture(scope="module")
def streams(photo: Picture) -> dict[str, bytes]:
    kinds = {
        "psnr": QUICK,
        "visual": replace(QUICK, tune="visual"),
        "tiled": replace(QUICK, tile=100),
        "plain": replace(QUICK, restoration=False),
        "own": replace(QUICK, network=another_network()),
        "own-tiled": replace(QUICK, network=another_network(), tile=100),
    }
    return {name: encode_picture(photo, settings).data for name, settings in kinds.items()}


def unrestored(stream: Stream) -> bytes:
    """The same stream of one tile without restoration."""
    header, model = stream.header, stream.model
    header = replace(header, spec=replace(header.spec, restoration=False), network=b"")
    model = with_values(header.spec, model, model.decoded_values)
    payload, _ = write_tile(header, replace(model, decoded=None, restoration=None))
    tile = encode_tile_chunk(header, 0, None, payload)
    return join([("H", encode_header(header)), ("T", tile), ("E", b"")])


@pytest.mark.parametrize("name", ["psnr", "visual", "own"])
def test_pixels_are_what_the_page_says(streams: dict[str, bytes], name: str) -> None:
    with open_stream(streams[name]) as stream:
        assert stream.header.spec.restoration
        into, back = to_channels(stream.header.spec), to_samples(stream.header.spec)
        restoration = stream.model.restoration
        found = stream.render().transpose(2, 0, 1)
        with open_stream(unrestored(stream)) as plain:
            drawn = plain.render().transpose(2, 0, 1).astype(np.float64)
    assert restoration.network == {"psnr": 1, "visual": 2, "own": another_network()}[name]
    channels = np.tensordot(into, drawn, axes=1)
    added = np.tensordot(back, corrected(channels, restoration.network, restoration.step), axes=1)
    assert np.abs(added).max() > 2 / 255
    # an input that lies near the middle of two integers may be rounded to the other one
    assert np.abs(found - (drawn + added)).max() < 1 / 255
    assert np.mean(np.abs(found - (drawn + added)) > 1e-4) < 0.05


@pytest.mark.parametrize(("max_error", "asked", "restores"), [(0, None, False), (0, True, True), (2, None, True)])
def test_below_exact_samples_it_is_left_out(
    photo: Picture, max_error: float, asked: bool | None, restores: bool
) -> None:
    settings = replace(QUICK, max_error=max_error, restoration=asked)
    with open_stream(encode_picture(photo, settings).data) as stream:
        assert stream.header.spec.restoration == restores
        assert (stream.model.restoration is not None) == restores


def test_it_brings_pixels_nearer(photo: Picture, streams: dict[str, bytes]) -> None:
    restored, plain = (open_stream(streams[name]).picture() for name in ("psnr", "plain"))
    assert len(streams["psnr"]) < 1.01 * len(streams["plain"])
    errors = [np.square(one.pixels.astype(float) - photo.pixels).mean() for one in (restored, plain)]
    assert errors[0] < 0.97 * errors[1]


@pytest.mark.parametrize("name", ["psnr", "visual", "tiled", "own-tiled"])
def test_regions_are_parts_of_the_whole(streams: dict[str, bytes], name: str) -> None:
    with open_stream(streams[name]) as stream:
        whole, large = stream.render(), stream.render(scale=2.5)
        for x, y, width, height in [(0, 0, 1, 1), (37, 21, 90, 70), (199, 127, 1, 1), (96, 60, 8, 9)]:
            part = stream.render(region=(x, y, width, height))
            np.testing.assert_array_equal(part, whole[y : y + height, x : x + width])
        part = stream.render(region=(40, 20, 60, 40), scale=2.5)
        assert np.abs(part - large[50:150, 100:250]).max() < 1 / 255  # Gaussians end elsewhere


def test_a_large_view_interpolates_it(streams: dict[str, bytes]) -> None:
    """At scale 3 the middle pixel of three has the centre of the picture's."""
    with open_stream(streams["psnr"]) as stream, open_stream(unrestored(stream)) as plain:
        own = stream.render() - plain.render()
        large = stream.render(scale=3.0) - plain.render(scale=3.0)
    np.testing.assert_allclose(large[1::3, 1::3], own, atol=1e-5)
