"""RGBA and BGRA of libsgi, premultiplied or not; drawings in bands of rows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from data_files import GOLDEN_STREAMS
from library import NEEDS_COMPILER, SAMPLES, Handle, Library, LibraryError
from numpy.typing import NDArray

import sgicodec

pytestmark = NEEDS_COMPILER

MULTI, LAYOUTS = 0, {1: [0, 0, 0], 2: [0, 0, 0, 1], 3: [0, 1, 2], 4: [0, 1, 2, 3]}
RGBA, BGRA = 1, 2
OPAQUE = {"uint8": 255, "uint16": 65535, "float32": 1}


def expected(shown: NDArray[Any], layout: int, empty: NDArray[np.bool_], premultiplied: bool) -> NDArray[Any]:
    """RGBA of the picture's own channels."""
    opaque, channels = OPAQUE[shown.dtype.name], LAYOUTS[layout]
    rgba = np.full((*shown.shape[:2], 4), opaque, shown.dtype)
    rgba[..., : len(channels)] = shown[..., channels]
    if premultiplied and shown.dtype == np.float32:
        rgba[..., :3] = np.where(rgba[..., 3:] == 0, 0, rgba[..., :3] * rgba[..., 3:])
    elif premultiplied:
        product = rgba[..., :3].astype(np.int64) * rgba[..., 3:]
        rgba[..., :3] = (2 * product + opaque) // (2 * opaque)
    rgba[empty] = 0
    return rgba


def no_content(handle: Handle, shown: NDArray[Any], **fields: Any) -> NDArray[np.bool_]:
    """Where all colours are nodata in the source's own type."""
    info = handle.info()
    if not info.has_nodata:
        return np.zeros(shown.shape[:2], bool)
    own = handle.draw(**fields)[..., : info.channels - (info.layout in (2, 4))]
    return np.all(np.isnan(own) if np.isnan(info.nodata) else own == info.nodata, axis=2)


@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
@pytest.mark.parametrize("premultiplied", [0, 1])
def test_colours_are_those_of_the_channels(path: Path, premultiplied: int, library: Library) -> None:
    handle = library.open(path.read_bytes())
    info = handle.info()
    if info.layout == MULTI:
        with pytest.raises(LibraryError, match=rf"{info.channels} bands without a meaning have no colours") as caught:
            handle.draw(pixels=RGBA)
        assert caught.value.status == "usage"
        return
    for sample in range(len(SAMPLES)):
        for size in ({}, {"columns": info.width * 2, "rows": (info.height + 1) // 2}):
            shown = handle.draw(sample=sample, **size)
            rgba = expected(shown, info.layout, no_content(handle, shown, **size), bool(premultiplied))
            view = {"sample": sample, "premultiplied": premultiplied, **size}
            np.testing.assert_array_equal(handle.draw(padding=5, pixels=RGBA, **view), rgba)
            np.testing.assert_array_equal(handle.draw(padding=1, pixels=BGRA, **view), rgba[..., [2, 1, 0, 3]])


@pytest.mark.parametrize("name", ["rgb8", "gray8-alpha", "float-near", "rgba8-tiles-luma"])
def test_what_lies_outside_is_transparent(name: str, library: Library) -> None:
    handle = library.open(next(path for path in GOLDEN_STREAMS if path.stem == name).read_bytes())
    info = handle.info()
    size = {"x": -7, "y": -3, "width": info.width + 9, "height": info.height + 8, "boundless": 1, "sample": 0}
    found = handle.draw(pixels=RGBA, **size)
    inside = found[3 : 3 + info.height, 7 : 7 + info.width]
    np.testing.assert_array_equal(inside, handle.draw(pixels=RGBA, sample=0))
    assert inside[..., 3].any()
    inside[:] = 0
    assert not found.any()


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_pixels_without_content_are_transparent(dtype: type, library: Library) -> None:
    """Also in other types, and where valid samples are 0."""
    picture = np.random.default_rng(2).integers(0, 200, (40, 60, 1)).repeat(3, axis=2).astype(dtype)
    picture[:10, :30], picture[20:, 40:] = 7, 0
    handle = library.open(sgicodec.encode(picture, steps=2, nodata=7, max_error=0, rdoq=False))
    empty = (picture == 7).all(axis=2)
    for sample in range(len(SAMPLES)):
        alpha = handle.draw(sample=sample, pixels=RGBA)[..., 3]
        np.testing.assert_array_equal(alpha, np.where(empty, 0, OPAQUE[SAMPLES[sample]]).astype(SAMPLES[sample]))


@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
def test_bands_of_rows_make_the_whole(path: Path, library: Library) -> None:
    handle = library.open(path.read_bytes())
    info = handle.info()
    for pixels in (0, RGBA) if info.layout != MULTI else (0,):
        size = {"columns": max(1, info.width * 2 // 3), "rows": info.height * 3 // 2 + 1, "pixels": pixels}
        whole = handle.draw(**size)
        bands = [
            handle.draw(first_row=first, row_count=min(17, len(whole) - first), **size)
            for first in range(0, len(whole), 17)
        ]
        np.testing.assert_array_equal(np.concatenate(bands), whole)
        np.testing.assert_array_equal(handle.draw(first_row=len(whole) - 1, **size), whole[-1:])
