"""Maps of classes, labels and masks come back as they are; where they cannot, one line says so."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from tags import TIED, geo_of

from sgicodec import Picture, decode, encode
from sgicodec.decoder.stream import open_stream
from sgicodec.picture import Metadata

RANDOM = np.random.default_rng(8)
AREAS = (np.abs(np.add.outer(np.arange(70) - 30, RANDOM.integers(-3, 4, 90))) // 12).astype(np.uint8)  # 0 to 3
SCATTERED = (RANDOM.random((70, 90)) < 0.1).astype(np.uint8)
NUMBERS = np.kron(RANDOM.integers(0, 60000, (7, 9)), np.ones((10, 10), int))  # of areas, a different one each
PHOTOGRAPH = RANDOM.integers(0, 256, (70, 90, 2), np.uint8)
GRAYS = RANDOM.integers(0, 16, (70, 90), np.uint8)


def coded(pixels: np.ndarray | Picture, **how: Any) -> tuple[np.ndarray, list[str]]:
    """What comes back, and what is said."""
    with warnings.catch_warnings(record=True) as said:
        data = encode(pixels, effort=1, **how)
    pixels = pixels.pixels if isinstance(pixels, Picture) else pixels
    return decode(data).reshape(pixels.shape), [str(one.message) for one in said]


@pytest.mark.parametrize("asked", [{}, {"quality": 5.0}, {"psnr": 30.0}])
@pytest.mark.parametrize(
    ("pixels", "channels", "nodata"),
    [
        (AREAS, "gray", None),
        (SCATTERED, "gray", None),
        (AREAS.astype(np.uint16) * 1000, "gray", None),
        (AREAS.astype(np.float32) - 1, "gray", -1.0),
        (np.where(AREAS, AREAS, np.nan).astype(np.float32), "gray", np.nan),
        (RANDOM.integers(0, 256, (4, 3), np.uint8)[AREAS], "rgb", None),
        (np.dstack([AREAS, AREAS == 1, SCATTERED]), "multi", None),
        (NUMBERS.astype(np.uint16), "gray", None),
        (NUMBERS.astype(np.float32), "gray", float(NUMBERS[0, 0])),
    ],
)
def test_few_values_come_back(pixels: np.ndarray, channels: str, nodata: float | None, asked: dict[str, float]) -> None:
    found, said = coded(pixels, channels=channels, nodata=nodata, **asked)
    np.testing.assert_array_equal(found, pixels)
    assert said == []


@pytest.mark.parametrize("asked", [{}, {"quality": 5.0}, {"psnr": 30.0}, {"tile": 48, "overview": True}])
@pytest.mark.parametrize(
    ("pixels", "bands", "nodata"),
    [
        (np.dstack([PHOTOGRAPH, AREAS]), (3,), None),
        (np.dstack([SCATTERED * 255, PHOTOGRAPH, np.full_like(AREAS, 77), AREAS]), (1, 4, 5), None),
        (np.dstack([AREAS, PHOTOGRAPH]).astype(np.uint16) * 1000, (1,), 0),
        (np.dstack([PHOTOGRAPH / 7, np.where(AREAS, AREAS, np.nan)]).astype(np.float32), (3,), np.nan),
        (np.dstack([PHOTOGRAPH / 7, np.kron(RANDOM.random((7, 9)), np.ones((10, 10)))]).astype(np.float32), (3,), None),
    ],
)
def test_bands_of_few_values_come_back(
    pixels: np.ndarray, bands: tuple[int, ...], nodata: float | None, asked: dict[str, Any]
) -> None:
    found, said = coded(pixels, channels="multi", nodata=nodata, **asked)
    for band in range(pixels.shape[2]):
        assert np.array_equal(found[..., band], pixels[..., band], equal_nan=True) == (band + 1 in bands)
    assert said == []


@pytest.mark.parametrize("beside", [(), (PHOTOGRAPH / 7,)])
def test_of_64_bits_32_come_back(beside: tuple[np.ndarray, ...], tmp_path: Path) -> None:
    pixels = np.dstack([*beside, AREAS / 10 + 1000])
    tifffile.imwrite(
        tmp_path / "a.tif", pixels.squeeze(), photometric="minisblack", planarconfig="contig" if beside else None
    )
    with pytest.warns(UserWarning, match="float64 become 32-bit floats"):
        data = encode(tmp_path / "a.tif", effort=1)
    np.testing.assert_array_equal(decode(data).reshape(pixels.shape)[..., -1], pixels[..., -1].astype(np.float32))


def test_views_of_bands_are_means_of_their_samples() -> None:
    pixels = np.dstack([PHOTOGRAPH, AREAS * 40])
    data = encode(pixels, channels="multi", effort=1)
    with open_stream(data) as stream:
        assert (stream.exact_bands, stream.max_error, stream.has_exact_views) == ((3,), None, True)
        half = stream.picture(size=(45, 35)).pixels[..., 2]
        deep = stream.picture(dtype="uint16").pixels[..., 2]
    np.testing.assert_allclose(half, (AREAS * 40.0).reshape(35, 2, 45, 2).mean(axis=(1, 3)), atol=0.51)
    np.testing.assert_array_equal(deep, AREAS * np.uint16(40) * 257)


def test_what_changes_is_said() -> None:
    assert coded(AREAS, lmbda=0.01)[1] == ["its few values, as of classes, change: use --lossless"]
    assert coded(np.dstack([PHOTOGRAPH, AREAS]), channels="multi", lmbda=0.01)[1] == [
        "few values or runs of equal ones, as of classes and numbered areas, change in band 3: "
        "encode them apart, or use --lossless"
    ]


def on_a_map(pixels: np.ndarray) -> Picture:
    channels = "gray" if pixels.ndim == 2 else "rgb"
    return Picture(np.atleast_3d(pixels), channels, (0, 255), Metadata(geo=geo_of(TIED)))


def test_directions_of_flow_come_back() -> None:
    """Scattered values that lie far apart: on a map, no grays of a scan."""
    directions = (1 << RANDOM.integers(0, 8, (70, 90))).astype(np.uint8)
    for picture, how in ((on_a_map(directions), {}), (directions, {"nodata": 128, "channels": "gray"})):
        found = np.squeeze(decode(encode(picture, effort=1, **how)))
        np.testing.assert_array_equal(found, directions)


def test_classes_that_are_called_colours_come_back() -> None:
    """On a map; else they may be a photograph's."""
    bands = np.dstack([PHOTOGRAPH, SCATTERED])
    found, said = coded(on_a_map(bands))
    np.testing.assert_array_equal(found[..., 2], SCATTERED)
    assert (found[..., :2] != PHOTOGRAPH).any()
    assert said == []
    assert (coded(bands)[0] != bands).any(axis=(0, 1)).all()


def test_numbers_of_areas_among_bands_come_back() -> None:
    photograph = RANDOM.integers(0, 256, (70, 90)).astype(np.uint16)
    areas = np.where(np.kron(RANDOM.integers(0, 2, (7, 9)), np.ones((10, 10), int)), NUMBERS + 1, 0).astype(np.uint16)
    enlarged = np.kron(RANDOM.integers(0, 9000, (14, 18)), np.ones((5, 5), int)).astype(np.uint16)
    pixels = np.dstack([photograph, areas, enlarged, np.full_like(photograph, 777)])
    found, said = coded(pixels, channels="multi")
    assert (found == pixels).all(axis=(0, 1)).tolist() == [False, True, False, True]
    assert said == []


def test_what_an_error_changes_is_said() -> None:
    found, said = coded(AREAS, max_error=1)
    assert np.abs(found.astype(int) - AREAS).max() == 1
    assert said == ["its few values, as of classes, may change by 1: use --lossless"]
    floats = RANDOM.random((70, 90), np.float32)
    assert coded(floats, max_error=2)[1] == [
        "an error of 2 either way spans all samples of band 1: nothing of them need remain"
    ]
    assert coded(floats, max_error=0.1)[1] == []
    assert coded(np.full((70, 90), 5.0, np.float32) + 1, max_error=2, channels="gray")[0].tolist() == [[6.0] * 90] * 70
    bands = np.dstack([floats * 100, floats, np.round(99 * floats)])
    (said_of_bands,) = coded(bands, max_error=1, channels="multi")[1]
    assert said_of_bands.startswith("an error of 1 either way spans all samples of band 2:")


def test_near_classes_are_seen_at_other_scales() -> None:
    """Though with nodata the lossy picture shows these views."""
    classes = np.kron(RANDOM.integers(3, 7, (6, 8), np.uint8), np.ones((16, 16), np.uint8))
    classes[:16, :48] = 255
    data = encode(classes, nodata=255, effort=1)
    np.testing.assert_array_equal(np.squeeze(decode(data)), classes)
    half = np.squeeze(decode(data, scale=0.5, dtype="float32")) * 255
    inner = np.kron(np.ones((6, 8), bool), np.pad(np.ones((4, 4), bool), 2)) & (classes[::2, ::2] != 255)
    assert np.abs(half - classes[::2, ::2])[inner].mean() < 0.4


def test_grays_of_a_scan_and_nothing_are_no_classes() -> None:
    assert (coded(17 * GRAYS)[0] != 17 * GRAYS).any()
    assert not coded(np.zeros((70, 90, 4), np.uint8))[0].any()
