"""Inks with further samples."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import tifffile

import sgicodec
from sgicodec import open_source, read

INKS = np.random.default_rng(5).integers(0, 256, (20, 30, 4)).astype(np.uint8)
OTHER = np.random.default_rng(6).integers(1, 256, (20, 30, 1)).astype(np.uint8)


def shown(inks: np.ndarray) -> np.ndarray:
    """Colours of inks in 0..1, in 0..1."""
    return (1 - inks[..., :3].astype(float)) * (1 - inks[..., 3:4])


def save(path: Path, samples: np.ndarray, extra: list[str], **options: object) -> Path:
    tifffile.imwrite(path, samples, photometric="separated", extrasamples=extra, metadata=None, **options)
    return path


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float32"])
@pytest.mark.parametrize("extra", ["unassalpha", "unspecified"])
@pytest.mark.parametrize("options", [{}, {"tile": (16, 16)}, {"planarconfig": "separate"}])
def test_a_fifth_sample(tmp_path: Path, dtype: str, extra: str, options: dict[str, object]) -> None:
    largest = 1.0 if dtype == "float32" else float(np.iinfo(dtype).max)
    samples = (np.dstack([INKS, OTHER]) / 255 * largest).astype(dtype)
    stored = np.moveaxis(samples, -1, 0) if "planarconfig" in options else samples
    path = save(tmp_path / "x.tif", stored, [extra], **({"planarconfig": "contig"} | options))
    picture = read(path)
    assert picture.channels == ("rgba" if extra == "unassalpha" else "rgb")
    expected = shown(samples[..., :4] / largest) * largest
    tolerance = 1e-6 if dtype == "float32" else 0.51
    np.testing.assert_allclose(picture.pixels[..., :3], expected, atol=tolerance)
    np.testing.assert_array_equal(picture.pixels[..., 3:], samples[..., 4:] if extra == "unassalpha" else 0)
    with open_source(path) as source:
        np.testing.assert_array_equal(source.read(5, 3, 21, 11).pixels, picture.pixels[3:14, 5:26])


@pytest.mark.parametrize(("extra", "left_out"), [(["unassalpha"], 0), (["unspecified"], 1), ([0, 2, 0], 2)])
def test_what_is_left_out_is_said(tmp_path: Path, extra: list[str], left_out: int) -> None:
    path = save(tmp_path / "x.tif", np.dstack([INKS, *[OTHER] * len(extra)]), extra)
    with open_source(path) as source:
        notes = [f"{left_out} of its samples, beside four inks, are left out"] if left_out else []
        notes.append("not kept: inks (RGB instead)")
        assert list(source.notes) == notes
    with pytest.warns() as caught:
        sgicodec.encode(path, steps=1)
    assert [str(warning.message) for warning in caught] == notes
