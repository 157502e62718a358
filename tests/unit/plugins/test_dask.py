"""Streams as arrays of Dask."""

from __future__ import annotations

from pathlib import Path
from unittest.mock import create_autospec

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
    read_level = create_autospec(sgicodec.Stream.read_level, side_effect=sgicodec.Stream.read_level)
    monkeypatch.setattr(sgicodec.Stream, "read_level", read_level)
    levels(pyramid, chunks=(100, 100, 3))[1][110:120, 20:30].compute()
    assert [call.args[1] for call in read_level.mock_calls] == [1]
