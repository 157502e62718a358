"""Text and line art, which a residual layer shows: alone and beside photographs, in every view."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import ISAS
from surgery import split
from text_pages import means, photo, text

from sgicodec import Device, EncodeSettings, Picture, decode, encode_picture
from sgicodec.decoder.stream import open_stream
from sgicodec.metrics.perceptual import ssimulacra2
from sgicodec.metrics.psnr import psnr

LOSSLESS_ALONE = EncodeSettings(max_error=0)
LOSSLESS = EncodeSettings(steps=20, quality=40, tune="psnr", max_error=0)


def test_text_repeats_itself() -> None:
    """Each letter of 48 pixels takes few bits."""
    page = Picture(text(600, 400), "rgb", (0.0, 255.0))
    layer = dict(split(encode_picture(page, EncodeSettings(steps=20, quality=1, tune="psnr", max_error=0)).data))["r"]
    assert 8 * len(layer) < 21 * 100 * 50


@pytest.mark.parametrize("view", [(0.5, 0.5), (1 / 3, 1 / 3), (0.23, 0.41), (2.0, 2.0), (1.6, 0.9)])
@pytest.mark.parametrize("region", [None, (20, 10, 51, 37)])
def test_text_is_exact_at_every_scale(view: tuple[float, float], region: tuple[int, int, int, int] | None) -> None:
    """Each pixel is the mean of what it covers."""
    pixels = text(96, 64)
    x, y, width, height = region or (0, 0, 96, 64)
    data = encode_picture(Picture(pixels, "rgb", (0.0, 255.0)), LOSSLESS_ALONE).data
    with open_stream(data) as stream:
        size = max(1, round(view[0] * width)), max(1, round(view[1] * height))
        found = stream.picture(region, size=size).pixels
        deep = stream.picture(region, size=size, dtype="uint16").pixels
    assert found.shape[:2] == size[::-1]
    wide = np.float64(pixels)
    for axis, (start, side, count) in enumerate(((y, height, size[1]), (x, width, size[0]))):
        wide = np.moveaxis(means(np.moveaxis(wide, axis, 0), start, side / count, count), 0, axis)
    assert np.abs(found - wide).max() <= 0.5 + 1e-4
    assert np.abs(deep - 257 * wide).max() <= 0.5 + 1e-2


@pytest.mark.parametrize(
    ("settings", "max_error"),
    [({}, 0), ({"quality": 45}, 0), ({"lmbda": 0.01}, None), ({"psnr": 25}, 0), ({"max_error": 3}, 3)],
)
def test_text_is_shown_by_the_layer(settings: dict[str, float], max_error: float | None) -> None:
    page = Picture(text(300, 200), "rgb", (0.0, 255.0))
    data = encode_picture(page, EncodeSettings(steps=20, **settings)).data
    with open_stream(data) as stream:
        assert stream.max_error == max_error
        assert (stream.picture().pixels == page.pixels).all() == (max_error is not None)
        assert max_error is None or stream.survey().seeds < 3
    photograph = encode_picture(Picture(photo(96, 64), "rgb", (0.0, 255.0)), EncodeSettings(steps=20)).data
    with open_stream(photograph) as stream:
        assert stream.max_error is None


def test_colours_of_text_are_merged_by_quality() -> None:
    """A lower quality has fewer colours and bytes; the letters' own colour and the ground stay."""
    soft = text(300, 200).astype(int)
    shade = np.random.default_rng(1).integers(0, 24, soft.shape[:2])[..., None]
    soft += shade * ((soft > 10) & (soft < 230))
    page, sizes = Picture(soft.astype(np.uint8), "rgb", (0.0, 255.0)), []
    for quality, expected in ((100, 0), (80, 1), (50, 7), (20, 15)):
        data = encode_picture(page, EncodeSettings(quality=quality)).data
        with open_stream(data) as stream:
            assert stream.max_error == expected
            found = stream.picture().pixels.astype(int)
        assert np.abs(found - soft).max() == expected
        np.testing.assert_array_equal(found[soft == 255], 255)
        sizes.append(len(data))
    assert sizes == sorted(sizes, reverse=True)


@pytest.fixture(scope="module")
def mixed() -> Picture:
    """A photograph, and text to its right and below."""
    pixels = text(624, 560)
    pixels[:400, :288] = np.tile(photo(288, 200), (2, 1, 1))
    return Picture(pixels, "rgb", (0.0, 255.0))


@pytest.fixture(scope="module", params=[0, 256])
def mixed_stream(mixed: Picture, request: pytest.FixtureRequest) -> bytes:
    return encode_picture(mixed, EncodeSettings(steps=20, tile=request.param, effort=1)).data


def test_text_beside_a_photograph(mixed: Picture, mixed_stream: bytes) -> None:
    """Both by their own means: no sample of text is off, in any view; the photograph is as without it."""
    with open_stream(mixed_stream) as stream:
        assert (stream.max_error, stream.graphics_error, stream.has_exact_views) == (None, 0, True)
        found = stream.picture().pixels
        half, twice = stream.picture(scale=0.5).pixels, stream.picture((0, 380, 624, 60), scale=2.0).pixels
        stream.lossy = True
        bare, bare_half = stream.picture().pixels, stream.picture(scale=0.5).pixels
    text_only = np.s_[400:], np.s_[:, 288:]
    for part in text_only:
        np.testing.assert_array_equal(found[part], mixed.pixels[part])
    means_of_two = mixed.pixels.reshape(280, 2, 312, 2, 3).mean(axis=(1, 3))
    assert np.abs(half[200:] - means_of_two[200:]).max() <= 0.5
    np.testing.assert_array_equal(twice[40:], mixed.pixels[400:440].repeat(2, axis=0).repeat(2, axis=1))
    photograph = np.s_[:400, :288]
    np.testing.assert_array_equal(found[photograph], bare[photograph])
    np.testing.assert_array_equal(half[:200, :144], bare_half[:200, :144])
    assert 1 < np.abs(found[photograph].astype(float) - mixed.pixels[photograph]).mean() < 15
    steps = [np.abs(np.diff(pixels[420:].astype(int), axis=1)).mean() for pixels in (bare, mixed.pixels)]
    assert steps[0] < steps[1] / 20


@pytest.mark.parametrize(
    ("target", "tile"), [({"size": 6000}, 0), ({"size": 6000}, 256), ({"psnr": 36}, 256), ({"ssimulacra2": 70}, 0)]
)
def test_text_beside_a_photograph_at_a_target(mixed: Picture, target: dict[str, float], tile: int) -> None:
    """The stream meets it as a whole, with hard letters."""
    pixels = np.ascontiguousarray(mixed.pixels[240:528, 160:480])
    settings = EncodeSettings(steps=20, tile=tile, effort=1, **target)
    encoded = encode_picture(replace(mixed, pixels=pixels), settings, verify=True)
    with open_stream(encoded.data) as stream:
        found = stream.picture().pixels
        assert stream.software.split()[1].startswith(*target)
    np.testing.assert_array_equal(found[160:], pixels[160:])
    measured = psnr(pixels / 255, found / 255)
    has = {"bytes": encoded.size, "psnr": measured, "score": ssimulacra2(pixels, found)}
    rate_target = settings.rate_target(1)
    assert rate_target.is_met(has[rate_target.quantity])
    assert encoded.psnr == pytest.approx(measured)


@pytest.mark.parametrize("isa", ISAS)
def test_regions_of_mixed_pictures(mixed_stream: bytes, isa: str) -> None:
    """Any part, band or number of threads shows what the whole does."""
    with open_stream(mixed_stream, Device(1, isa)) as stream:
        whole, wide = stream.picture().pixels, stream.picture(scale=2.0).pixels
    with open_stream(mixed_stream, Device(3, isa)) as stream:
        for x, y, width, height in ((0, 0, 40, 40), (290, 390, 60, 30), (505, 500, 20, 20), (0, 0, 624, 560)):
            part = np.s_[y : y + height, x : x + width]
            np.testing.assert_array_equal(stream.picture((x, y, width, height)).pixels, whole[part])
            part = np.s_[2 * y : 2 * (y + height), 2 * x : 2 * (x + width)]
            np.testing.assert_array_equal(stream.picture((x, y, width, height), scale=2.0).pixels, wide[part])
        around = stream.picture((-5, -4, 20, 10), boundless=True, scale=2.0).pixels
        np.testing.assert_array_equal(around[8:, 10:], wide[:12, :30])


def test_a_photograph_with_a_flat_frame_is_one() -> None:
    pixels = np.full((300, 400, 3), 255, np.uint8)
    pixels[48:250, 48:348] = photo(300, 202)
    with open_stream(encode_picture(Picture(pixels, "rgb", (0.0, 255.0)), EncodeSettings(steps=20)).data) as stream:
        assert not stream.has_exact_views


def test_faint_text_beside_a_photograph_stays() -> None:
    rng, page = np.random.default_rng(6), np.full((192, 192), 230, np.uint8)
    for y in range(4, 188, 6):
        for x in range(8, 180, 9):  # a stroke with soft edges
            page[y - 1 : y + 3, x : x + 6] = rng.integers(219, 230, (4, 6))
            page[y : y + 2, x + 1 : x + 5] = 218
    pixels = np.concatenate([photo(192, 192), np.repeat(page[..., None], 3, axis=2)], axis=1)
    data = encode_picture(Picture(pixels, "rgb", (0.0, 255.0)), EncodeSettings(effort=1)).data
    found = decode(data)[:, 192:, 0].astype(float)
    ink, ground = found[page == 218].mean(), found[page == 230].mean()
    assert ground - ink > 0.9 * 12
