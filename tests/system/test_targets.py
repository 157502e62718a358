"""Encodes that end at a size, a PSNR or a time: a real crop in few steps, and pictures at the edge."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sgicodec import Encoded, EncodeSettings, Picture, encode_picture, read
from sgicodec.decoder.stream import open_stream
from sgicodec.errors import TargetMissedError, UsageError
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import Metadata, comparable

DATA = Path(__file__).parents[1] / "data"
CROP = (slice(128, 320), slice(96, 352))


@pytest.fixture(scope="module", params=["kodim23.png", "kodim13.png"])
def crop(request: pytest.FixtureRequest) -> Picture:
    picture = read(DATA / request.param)
    return replace(picture, pixels=np.ascontiguousarray(picture.pixels[CROP]))


def quality(picture: Picture, encoded: Encoded) -> float:
    decoded = open_stream(encoded.data).picture()
    assert decoded.pixels.shape == picture.pixels.shape
    return psnr(comparable(picture), comparable(decoded))


def test_size_and_metadata(crop: Picture) -> None:
    """Metadata counts, and is known of from the start: the fit ends near the size, not by the last search alone."""
    with_blob = replace(crop, metadata=Metadata(xmp=b"<x/>" * 1000))
    encoded = encode_picture(with_blob, EncodeSettings(size=7000, steps=150))
    assert 0.97 * 7000 <= len(encoded.data) <= 7000
    lean = encode_picture(with_blob, EncodeSettings(size=3000, metadata=False, steps=150))
    assert 0.97 * 3000 <= len(lean.data) <= 3000
    assert abs(math.log2(encoded.lmbda / lean.lmbda)) < 1.3


@pytest.mark.parametrize(
    ("corner", "asked"), [((0, 400), 28.5), ((0, 400), 33.0), ((400, 600), 28.0), ((400, 600), 33.0)]
)
def test_decibels_of_a_stream_of_hundred_bytes(corner: tuple[int, int], asked: float) -> None:
    """Where a single symbol of texture moves the PSNR up or down by more than the tolerance. The first crop cannot have
    less than 28.3 dB.
    """
    picture, (top, left) = read(DATA / "kodim23.png"), corner
    small = replace(picture, pixels=np.ascontiguousarray(picture.pixels[top : top + 96, left : left + 128]))
    encoded = encode_picture(small, EncodeSettings(psnr=asked, effort=1))
    assert quality(small, encoded) == pytest.approx(asked, abs=0.1)


def test_an_impossible_size_gives_the_nearest_stream(crop: Picture) -> None:
    with pytest.raises(TargetMissedError, match="at most 90 bytes") as caught:
        encode_picture(crop, EncodeSettings(size=90, steps=60))
    nearest = caught.value.nearest
    assert f"the smallest has {len(nearest.data)}" in str(caught.value)
    assert len(nearest.data) < 700
    assert quality(crop, nearest) > 8


def test_an_impossible_psnr_gives_the_nearest_stream() -> None:
    deep = drawn(48, 40, "gray", "uint16", False)
    with pytest.raises(TargetMissedError, match="99 dB") as caught:
        encode_picture(deep, EncodeSettings(psnr=99, steps=40))
    assert quality(deep, caught.value.nearest) > 40


def drawn(height: int, width: int, channels: str, dtype: str, flat: bool) -> Picture:
    """A ramp with noise, or one colour."""
    count = {"gray": 1, "gray+alpha": 2, "rgb": 3, "rgba": 4}[channels]
    y, x = np.mgrid[:height, :width]
    unit = np.stack([(x + (band + 1) * y) / (width + (band + 1) * height) for band in range(count)], axis=2)
    unit = 0.3 + 0 * unit if flat else 0.8 * unit + 0.2 * np.random.default_rng(1).random(unit.shape)
    if dtype == "float32":
        colours = count - (count in (2, 4))
        unit[..., :colours] = unit[..., :colours] * 900 - 100
        return Picture(unit.astype(np.float32), channels, (-100.0, 800.0))
    top = float(np.iinfo(dtype).max)
    return Picture(np.rint(unit * top).astype(dtype), channels, (0.0, top))


PICTURES = {
    "1×1": drawn(1, 1, "rgb", "uint8", True),
    "16×16": drawn(16, 16, "rgb", "uint8", False),
    "flat": drawn(40, 70, "rgb", "uint8", True),
    "gray": drawn(48, 40, "gray", "uint8", False),
    "alpha": drawn(40, 48, "rgba", "uint8", False),
    "gray and alpha of 16 bits": drawn(40, 48, "gray+alpha", "uint16", False),
    "floats": drawn(40, 48, "rgb", "float32", False),
}


@pytest.mark.parametrize("target", [{"psnr": 45.0}, {"size": 500.0}, {"bpp": 0.01}])
@pytest.mark.parametrize("picture", PICTURES.values(), ids=PICTURES)
def test_pictures_at_the_edge(picture: Picture, target: dict[str, float]) -> None:
    """Whatever can be told of them, a stream comes out, and what was not reached is said."""
    settings = replace(EncodeSettings(steps=12), **target)  # type: ignore[arg-type]
    missed = False
    try:
        encoded = encode_picture(picture, settings)
    except TargetMissedError as error:
        missed, encoded = True, error.nearest
    reached = quality(picture, encoded)
    limit = target.get("size", target.get("bpp", math.inf) * picture.width * picture.height / 8)
    assert missed == (len(encoded.data) > limit or reached < target.get("psnr", 0.0) - 0.1)


@pytest.mark.parametrize(
    ("choices", "complaint"),
    [
        ({"psnr": 0.0}, "psnr"),
        ({"psnr": math.nan}, "psnr"),
        ({"psnr": math.inf}, "psnr"),
        ({"ssimulacra2": 100.0}, "ssimulacra2"),
        ({"ssimulacra2": 50.0, "texture": False}, "ssimulacra2 is reached by the step of texture"),
        ({"psnr": 30.0, "texture": False}, "psnr is reached by the step of texture"),
        ({"size": 3000.0, "texture": False}, "size is reached by the step of texture"),
        ({"ssimulacra2": 50.0, "bpp": 1.0}, "ssimulacra2 and bpp exclude"),
        ({"tune": "loud"}, "tune loud"),
        ({"tune": "visual", "profile": "paper"}, "not tuned for the eye"),
        ({"size": 0.5}, "size"),
        ({"size": math.inf}, "size"),
        ({"bpp": 0.0}, "bpp"),
        ({"bpp": math.inf}, "bpp"),
        ({"psnr": 30.0, "bpp": 1.0}, "psnr and bpp exclude"),
        ({"size": 3000.0, "bpp": 1.0}, "size and bpp exclude"),
        ({"size": 3000.0, "lmbda": 1.0}, "lmbda and size exclude"),
        ({"psnr": 30.0, "profile": "paper"}, "default profile"),
    ],
)
def test_settings_that_make_no_sense(choices: dict[str, float], complaint: str) -> None:
    with pytest.raises(UsageError, match=complaint):
        EncodeSettings(**choices)  # type: ignore[arg-type]
