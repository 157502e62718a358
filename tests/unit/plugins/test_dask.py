"""Streams as arrays of Dask."""

from __future__ import annotations

from pathlib import Path

import dask.array
import numpy as np
import pytest

import sgicodec
from sgicodec.plugins.dask import levels


def test_levels_compute_to_those_of_the_stream(pyramid: Path) -> None:
    arrays = levels(pyramid, chunks=(200, 256, 3))
    with sgicodec.open(pyramid) as stream:
        for array, level in zip(arrays, stream.levels, strict=True):
            assert isinstance(array, dask.array.Array)
            assert (array.shape, array.dtype) == ((level.height, level.width, 3), np.uint8)
            whole = stream.read(size=level[:2]).astype(int)
            np.testing.assert_allclose(array.compute().astype(int), whole, atol=1 if level.downsample > 1 else 0)
    assert arrays[0].chunks == ((200, 100), (256, 256, 8), (3,))
    assert arrays[1][::7, 20:200, 1].mean().compute() == pytest.approx(
        np.asarray(arrays[1])[::7, 20:200, 1].mean(), abs=0.1
    )


def test_only_the_chunks_that_are_needed_are_decoded(pyramid: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    regions = []
    original = sgicodec.Stream.read_level

    def noted(self: sgicodec.Stream, level: int, region: tuple[int, int, int, int]) -> np.ndarray:
        regions.append((level, region))
        return original(self, level, region)

    monkeypatch.setattr(sgicodec.Stream, "read_level", noted)
    levels(pyramid, chunks=(100, 100, 3))[1][110:120, 20:30].compute()
    assert len(regions) == 1
    assert regions[0][0] == 1
