"""Alpha in a residual layer: alone, with text and line art, and where a picture without loss takes fewer bytes."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command import done, refused
from numpy.typing import NDArray
from text_pages import means, photo, text

from sgicodec import EncodeSettings, Picture, encode_picture, write
from sgicodec.decoder.stream import Stream, open_stream

QUICK = EncodeSettings(effort=1)


def discs(width: int, height: int, high: int = 255, soft: float = 1.0) -> NDArray[np.uint16]:
    """Opacity [h, w, 1]: discs whose edges are so many pixels wide."""
    y, x = np.mgrid[:height, :width]
    distance = np.hypot((x + 13) % 50 - 25, (y + 13) % 50 - 25)
    return np.rint(high * np.clip((20 - distance) / soft + 0.5, 0, 1)).astype(np.uint16)[..., None]


def cut_out(width: int = 200, height: int = 150, soft: float = 1.0) -> Picture:
    alpha = discs(width, height, soft=soft).astype(np.uint8)
    return Picture(np.concatenate([photo(width, height), alpha], axis=2), "rgba", (0.0, 255.0))


def mean_view(planes: NDArray[np.float64], size: tuple[int, int]) -> NDArray[np.float64]:
    """Means over what each pixel of a smaller or larger picture covers."""
    for axis, count in enumerate(size[::-1]):
        side = planes.shape[axis]
        planes = np.moveaxis(means(np.moveaxis(planes, axis, 0), 0.0, side / count, count), 0, axis)
    return planes


def between(planes: NDArray[np.float64], size: tuple[int, int]) -> NDArray[np.float64]:
    """What lies between the centres of pixels, linearly."""
    for axis, count in enumerate(size[::-1]):
        side = planes.shape[axis]
        at = (np.arange(count) + 0.5) * side / count - 0.5
        planes = np.apply_along_axis(partial(np.interp, at, np.arange(side)), axis, planes)
    return planes


def seen_view(pixels: NDArray[Any], size: tuple[int, int]) -> NDArray[np.float64]:
    """`mean_view` of colours weighed by alpha, and of alpha."""
    wide = pixels.astype(np.float64)
    alpha = wide[..., -1:]
    seen, plain = mean_view(alpha, size), mean_view(wide[..., :-1], size)
    colours = np.where(seen > 0, mean_view(wide[..., :-1] * alpha, size) / np.where(seen > 0, seen, 1), plain)
    return np.concatenate([colours, seen], axis=2)


@pytest.mark.parametrize("tile", [0, 64])
@pytest.mark.parametrize("channels", ["rgba", "gray+alpha"])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_sharp_alpha_is_exact_in_every_view(dtype: type, channels: str, tile: int) -> None:
    high = np.iinfo(dtype).max
    colours = photo(200, 150)[..., : 3 if channels == "rgba" else 1].astype(dtype) * (high // 255)
    pixels = np.concatenate([colours, discs(200, 150, high).astype(dtype)], axis=2)
    settings = EncodeSettings(effort=1, tile=tile, overview=False)
    with open_stream(encode_picture(Picture(pixels, channels, (0.0, float(high))), settings).data) as stream:
        assert stream.has_exact_alpha
        assert stream.max_error is None
        whole, part = stream.picture().pixels, stream.picture((31, 20, 50, 60)).pixels
        np.testing.assert_array_equal(whole[..., -1], pixels[..., -1])
        np.testing.assert_array_equal(part, whole[20:80, 31:81])
        shown = pixels[..., -1] > 0
        assert np.abs(whole.astype(float) - pixels)[shown].mean() < 0.06 * high
        alpha = pixels[..., -1:].astype(np.float64)
        for size, expected in (((100, 75), mean_view(alpha, (100, 75))), ((300, 225), between(alpha, (300, 225)))):
            view = stream.picture(size=size).pixels
            assert np.abs(view[..., -1] - expected[..., -1]).max() <= 0.5 + 1e-3 * high / 255
        floats = stream.picture(dtype="float32").pixels
        np.testing.assert_allclose(high * floats[..., -1], pixels[..., -1], rtol=1e-5)


def test_soft_alpha_stays_in_the_model() -> None:
    with open_stream(encode_picture(cut_out(soft=20.0), QUICK).data) as stream:
        assert not stream.has_exact_views


def test_it_cannot_be_left_out(tmp_path: Path) -> None:
    stream, out = tmp_path / "a.sgi", tmp_path / "b.sgi"
    stream.write_bytes(encode_picture(cut_out(), QUICK).data)
    write(cut_out(), tmp_path / "a.png")
    for command in (
        ["strip", stream, out],
        ["refine", tmp_path / "a.png", stream, out],
        ["decode", stream, tmp_path / "b.png", "--lossy"],
    ):
        assert refused(2, *command).endswith("its alpha is in the residual layer alone\n")
    assert not out.exists()
    assert "samples     alpha without loss, in all views" in done("info", stream).stdout


def drawing(width: int, height: int) -> Picture:
    """Text that is opaque on ground that is nearly so, with nothing around it, but colours that nobody sees."""
    pixels = np.concatenate([text(width, height), np.full((height, width, 1), 200, np.uint8)], axis=2)
    pixels[text(width, height)[..., 0] < 200, 3] = 255
    pixels[:12], pixels[:, :12] = (17, 99, 3, 0), (17, 99, 3, 0)
    return Picture(pixels, "rgba", (0.0, 255.0))


def views_are_exact(stream: Stream, pixels: NDArray[Any]) -> None:
    assert stream.has_exact_views
    assert not stream.has_exact_alpha
    np.testing.assert_array_equal(stream.picture().pixels, pixels)
    for size in ((48, 32), (70, 50), (160, 100)):
        found, expected = stream.picture(size=size).pixels, seen_view(pixels, size)
        assert np.abs(found - expected).max() <= 0.5 + 1e-3


def test_text_with_alpha_is_exact_at_every_scale() -> None:
    """Colours count by their alpha, so that no edge of what is seen has the colour of what is not."""
    picture = drawing(96, 64)
    for settings in (EncodeSettings(max_error=0), EncodeSettings(quality=70)):
        pixels = picture.pixels.copy()
        if settings.max_error is None:
            pixels[pixels[..., 3] == 0] = 0
        with open_stream(encode_picture(picture, settings).data) as stream:
            assert stream.max_error == 0
            views_are_exact(stream, pixels)


@pytest.mark.parametrize("tile", [0, 64])
def test_text_with_alpha_beside_a_photograph(tile: int) -> None:
    """A window's picture: text inside, round corners with soft shadows outside."""
    page = np.concatenate([photo(160, 192), text(160, 192)], axis=1)
    y, x = np.mgrid[:192, :320]
    inside = np.minimum(np.minimum(x, 319 - x), np.minimum(y, 191 - y))
    alpha = np.clip(inside * 20, 0, 255).astype(np.uint8)
    pixels = np.dstack([page, alpha])
    settings = EncodeSettings(effort=1, quality=60, tile=tile, overview=False)
    with open_stream(encode_picture(Picture(pixels, "rgba", (0.0, 255.0)), settings).data) as stream:
        assert stream.graphics_error == 0
        found = stream.picture().pixels
    np.testing.assert_array_equal(found[16:176, 176:304], pixels[16:176, 176:304])
    assert np.abs(found[..., 3].astype(int) - alpha).mean() < 3


def test_no_lossy_picture_takes_more_than_one_without_loss() -> None:
    """Of flat colours and hard edges, which are many to a lossy picture."""
    rng = np.random.default_rng(3)
    pixels = rng.integers(0, 256, (10, 14, 3), np.uint8).repeat(12, axis=0).repeat(12, axis=1)
    picture = Picture(pixels, "rgb", (0.0, 255.0))
    exact, best, usual = (
        encode_picture(picture, EncodeSettings(**how)).data
        for how in ({"max_error": 0}, {"quality": 95}, {"quality": 30})
    )
    assert len(best) <= 1.01 * len(exact)
    with open_stream(best) as stream:
        np.testing.assert_array_equal(stream.picture().pixels, pixels)
        np.testing.assert_array_equal(stream.picture(scale=2.0).pixels[::2, ::2], pixels)
    assert len(usual) <= 1.01 * len(exact)
