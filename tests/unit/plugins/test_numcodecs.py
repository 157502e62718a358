"""The codec of numcodecs, by its entry point, and as a compressor of Zarr 2."""

from __future__ import annotations

import numcodecs
import numpy as np
import pytest
import zarr
from zarr.storage import MemoryStore

import sgicodec
from sgicodec.plugins.numcodecs import Sgi

Y, X = np.mgrid[:32, :40]
PIXELS = np.stack([4 * X, 5 * Y, 2 * (X + Y)], axis=2).astype(np.uint8)


def test_the_registry_finds_it() -> None:
    codec = numcodecs.get_codec({"id": "sgicodec", "quality": 80, "steps": 20})
    assert isinstance(codec, Sgi)
    assert codec.get_config() == {"id": "sgicodec", "quality": 80, "steps": 20}
    assert repr(codec) == "Sgi(quality=80, steps=20)"
    assert codec == Sgi(quality=80, steps=20)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_chunks_come_back(dtype: type) -> None:
    codec = Sgi(quality=80, steps=20)
    chunk = PIXELS.astype(dtype)
    if dtype == np.uint16:
        chunk *= 257
    data = codec.encode(chunk)
    again = codec.decode(data)
    assert (again.shape, again.dtype) == (chunk.shape, chunk.dtype)
    assert np.abs(again.astype(float) - chunk).mean() < 0.02 * chunk.max()
    out = np.empty_like(chunk)
    assert codec.decode(memoryview(data), out=out) is out
    np.testing.assert_array_equal(out, again)


def test_zarr_2() -> None:
    store = MemoryStore()
    array = zarr.create_array(
        store, shape=(40, 60, 3), chunks=(32, 32, 3), dtype="uint8", zarr_format=2, compressors=Sgi(steps=20)
    )
    whole = np.tile(PIXELS, (2, 2, 1))[:40, :60]
    array[:] = whole
    again = zarr.open_array(store, mode="r")
    assert again.metadata.compressor == Sgi(steps=20)
    stored = sgicodec.decode(store._store_dict["0.0.0"].to_bytes())
    np.testing.assert_array_equal(again[:32, :32], stored)
    assert np.abs(stored.astype(float) - whole[:32, :32]).mean() < 4
