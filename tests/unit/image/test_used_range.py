from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tags import geo_of, text

from sgicodec import open_source, read, write
from sgicodec.errors import PictureError, UsageError
from sgicodec.image.used_range import SampleUse, UsedRange, stated_use
from sgicodec.metadata import geo
from sgicodec.picture import MAX_SAMPLE, Metadata, Picture, exact_samples, nodata_samples

U16, F32 = np.dtype(np.uint16), np.dtype(np.float32)
RAMP = np.linspace(0, 1, 5000).reshape(50, 100, 1)


def use(pixels: np.ndarray, channels: str = "gray", nodata: float | None = None, parts: int = 3) -> SampleUse:
    found = UsedRange(channels, pixels.shape[2], pixels.dtype, nodata)
    for part in np.array_split(pixels, parts):
        found.add(part)
    return found.found()


@given(
    samples=st.lists(st.floats(-1e6, 1e6, width=32), min_size=2, max_size=20),
    parts=st.integers(1, 5),
    holes=st.sampled_from([None, -9999.0, float("nan")]),
)
def test_all_samples_are_in_the_range_or_kept(samples: list[float], parts: int, holes: float | None) -> None:
    kept = [value for value in samples if value != holes]
    mixed = np.array(kept if holes is None else [*kept, holes, holes], np.float32).reshape(-1, 1, 1)
    found = use(mixed, nodata=holes, parts=parts)
    low, high = found.sample_range
    picture = Picture(mixed, "gray", found.sample_range, blank=holes if found.blank is None else found.blank)
    assert low < high
    assert not found.exact
    inside = (mixed >= low) & (mixed <= high)
    assert (inside | nodata_samples(picture)).all()


@pytest.mark.parametrize(
    ("low", "high", "dtype", "expected"),
    [
        (0, 4095, U16, (0.0, 4095.0)),
        (0, 4080, U16, (0.0, 4095.0)),
        (35, 3760, U16, (0.0, 4095.0)),
        (0, 9900, U16, (0.0, 10000.0)),
        (0, 65300, U16, (0.0, 65535.0)),
        (300, 2900, U16, (300.0, 2900.0)),
        (200, 2900, U16, (0.0, 2900.0)),
        (-2000, 1990, F32, (-2048.0, 2047.0)),
        (-32768, 32767, F32, (-32768.0, 32767.0)),
        (-4.5, 44.25, F32, (-4.5, 44.25)),
        (280, 297, F32, (280.0, 297.0)),
        (0, 0.96, F32, (0.0, 1.0)),
    ],
)
def test_usual_ranges(low: float, high: float, dtype: np.dtype, expected: tuple[float, float]) -> None:
    assert use((low + RAMP * (high - low)).astype(dtype)).sample_range == expected


@pytest.mark.parametrize("dtype", [U16, F32])
@pytest.mark.parametrize(("value", "inside"), [(65535, 3000), (0, 700), (9000, 3000)])
def test_a_few_dead_or_hot_pixels_lie_outside(dtype: np.dtype, value: float, inside: float) -> None:
    pixels = (600 + RAMP * 2400).astype(dtype)
    plain = use(pixels)
    pixels[10, 20:23] = value
    found = use(pixels)
    assert found.sample_range == plain.sample_range
    assert (found.exact, found.blank) == (True, None)
    picture = Picture(pixels, "gray", found.sample_range, exact=True)
    np.testing.assert_array_equal(exact_samples(picture), pixels == value)
    assert inside in range(int(plain.sample_range[0]), int(plain.sample_range[1]) + 1)  # type: ignore[arg-type]


@pytest.mark.parametrize(("dtype", "top", "scale"), [(F32, 1.0, 1e6), (U16, 100.0, 6e4)])
def test_samples_spans_away_from_all_others_lie_outside(dtype: np.dtype, top: float, scale: float) -> None:
    """One in a hundred, as of a ratio of bands whose divisor is nearly 0."""
    pixels = (RAMP * top).astype(dtype)
    far = np.random.default_rng(3).choice(pixels.size, 50, replace=False)
    pixels.ravel()[far] = scale * 10.0 ** np.random.default_rng(4).uniform(-1.5, 0, 50)
    found = use(pixels)
    assert (found.sample_range, found.exact) == ((0.0, top), True)


def test_a_range_that_few_samples_stretch_is_told() -> None:
    pixels = RAMP.astype(np.float32)
    pixels[::10] = np.linspace(2, 1e6, pixels[::10].size).reshape(-1, 100, 1)  # no gap between them
    remark = use(pixels).remark
    assert remark.startswith("3 of 4 samples lie between")
    assert use((RAMP * 1e6).astype(np.float32)).remark is None


@pytest.mark.parametrize(
    ("blanks", "share"),
    [((-9999.0, -8888.0), "3 of 4"), ((-1e6, 1e6), "3 of 4"), ((-1e6,) * 2 + (1e6, 2e6), "half of the")],
)
def test_that_several_values_for_nothing_stretch_a_range_is_told(blanks: tuple[float, ...], share: str) -> None:
    """Two are no nodata value; each stands in a tenth."""
    pixels = RAMP.astype(np.float32)
    for number, value in enumerate(blanks):
        pixels[number::10] = value
    assert use(pixels).remark.startswith(f"{share} samples lie between 0.")


def test_a_blank_and_a_range_that_others_stretch_are_both_told() -> None:
    pixels = RAMP.astype(np.float32)
    pixels[::10] = np.linspace(2, 1e6, pixels[::10].size).reshape(-1, 100, 1)
    pixels[5::10] = -1e9
    assert re.search("taken for nodata and kept exactly; 3 of 4 samples lie", use(pixels).remark)


@pytest.mark.parametrize("value", [-9999.0, 1.70141e38, 3.4028235e38, -3.4028235e38, np.inf, 0.0])
def test_a_value_far_from_all_others_is_nodata(value: float) -> None:
    pixels = (300 + RAMP * 44).astype(np.float32)
    plain = use(pixels)
    pixels[5:15, 5:15] = value
    found = use(pixels)
    assert found.sample_range == plain.sample_range
    assert found.blank == np.float32(value)
    assert f"{np.float32(value):g}" in found.remark


def test_a_border_of_zero_is_nodata_and_zero_in_a_picture_is_not() -> None:
    pixels = (8000 + RAMP * 1500).astype(np.uint16)
    pixels[:, :10] = 0
    assert use(pixels).blank == 0
    pixels = (RAMP * 1500).astype(np.uint16)
    pixels[:, :10] = 0
    assert use(pixels).blank is None
    labels = np.repeat([0, 1000, 1001], 50 * 100).reshape(150, 100, 1).astype(np.uint16)
    assert use(labels).blank is None


def test_not_a_number_is_nodata_where_nothing_else_is() -> None:
    pixels = RAMP.astype(np.float32)
    pixels[3, 4] = np.nan
    found = use(pixels)
    assert np.isnan(found.blank)  # type: ignore[arg-type]
    assert not found.exact
    pixels[5, 5] = -9999
    found = use(pixels, nodata=-9999.0)
    assert (found.blank, found.exact, found.sample_range) == (None, True, (0.0, 1.0))


def test_samples_that_no_range_does_justice_to() -> None:
    pixels = (300 + RAMP * 44).astype(np.float32)
    pixels[:10], pixels[-10:] = -3e38, 3e38
    with pytest.raises(PictureError, match="lie far from the others"):
        use(pixels)
    with pytest.raises(PictureError, match=r"beyond 1e\+38"):
        use(np.full((3, 3, 1), 3e38, np.float32))
    with pytest.raises(UsageError, match=r"up to 1e\+38"):
        Picture(pixels, "gray", (0.0, 2 * MAX_SAMPLE))


@pytest.mark.parametrize("choice", ["uesd", (1.0,), (0.0, 0.5), (-1.0, 5.0), (0.0, 70000.0), ((0.0, 1.0), (5.0, 6.0))])
def test_choices_that_make_no_sense(choice: object) -> None:
    with pytest.raises(UsageError, match="range"):
        stated_use(choice, U16, 3)  # type: ignore[arg-type]


@pytest.mark.parametrize("nodata", [b"-9999", b"nan"])
def test_samples_without_data_are_outside_the_range(tmp_path: Path, nodata: bytes) -> None:
    pixels = np.array([[[float(nodata)], [2.0], [4.0]]], np.float32)
    metadata = Metadata(geo=geo_of({geo.GDAL_NODATA: text(nodata)}))
    write(Picture(pixels, "gray", (2.0, 4.0), metadata), tmp_path / "x.tif")
    for picture in (read(tmp_path / "x.tif"), open_source(tmp_path / "x.tif").read(0, 0, 3, 1)):
        np.testing.assert_array_equal(picture.pixels, pixels)
        assert picture.sample_range == (2.0, 4.0)
    pixels[0, 1] = np.nan
    write(Picture(pixels, "gray", (2.0, 4.0), metadata), tmp_path / "x.tif")
    if nodata == b"-9999":
        assert read(tmp_path / "x.tif").exact
        with pytest.raises(PictureError, match="not a number"):
            read(tmp_path / "x.tif", sample_range=(2.0, 4.0))


def test_alpha_that_is_not_a_number_is_no_alpha() -> None:
    pixels = np.stack([RAMP[..., 0], np.ones((50, 100))], axis=2).astype(np.float32)
    assert use(pixels, "gray+alpha").opacity
    pixels[3, 4, 1] = np.nan
    assert not use(pixels, "gray+alpha").opacity
