"""The codec of Zarr 3, by its entry point, and what it reads of a chunk; that of numcodecs, which Zarr 2 takes."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numcodecs
import numpy as np
import pytest
import zarr
from zarr.storage import LocalStore, MemoryStore, WrapperStore

import sgicodec
from sgicodec.plugins.numcodecs import Sgi
from sgicodec.plugins.zarr import SgiCodec

SETTINGS = {"quality": 95, "steps": 2, "tile": 64, "rdoq": False}


class Counting(WrapperStore):
    """Counts the bytes of chunks that are read."""

    requests: int = 0
    bytes: int = 0

    async def get(self, key: str, prototype: Any, byte_range: Any = None) -> Any:
        found = await super().get(key, prototype, byte_range)
        if found is not None and "/" in key:
            self.requests += 1
            self.bytes += len(found)
        return found


@pytest.fixture(scope="module")
def pixels() -> np.ndarray:
    return np.random.default_rng(7).integers(0, 256, (192, 256, 3), np.uint8)


@pytest.fixture(scope="module")
def store(pixels: np.ndarray) -> MemoryStore:
    """One chunk of 12 tiles of noise, and one that is not there."""
    store = MemoryStore()
    array = zarr.create_array(
        store,
        shape=(384, 256, 3),
        chunks=(192, 256, 3),
        dtype="uint8",
        serializer=SgiCodec(**SETTINGS),
        compressors=None,
    )
    array[:192] = pixels
    return store


def chunk_of(store: MemoryStore) -> bytes:
    return bytes(store._store_dict["c/0/0/0"].to_bytes())


def test_another_program_opens_the_array(tmp_path: Path) -> None:
    """By the entry point alone."""
    array = zarr.create_array(
        LocalStore(tmp_path / "a.zarr"),
        shape=(30, 40),
        chunks=(16, 40),
        dtype="uint16",
        serializer=SgiCodec(quality=70, steps=9),
        compressors=None,
    )
    array[:] = np.arange(1200, dtype=np.uint16).reshape(30, 40) * 50
    metadata = json.loads((tmp_path / "a.zarr" / "zarr.json").read_text())
    assert metadata["codecs"] == [{"name": "sgicodec", "configuration": {"quality": 70, "steps": 9}}]
    code = f"import zarr; print(zarr.open_array({str(tmp_path / 'a.zarr')!r})[:].astype(int).sum())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(done.stdout) == int(array[:].astype(int).sum())
    np.testing.assert_array_equal(array[:16], sgicodec.imread(tmp_path / "a.zarr" / "c" / "0" / "0"))


def test_samples_mean_the_same_when_it_is_opened_again(tmp_path: Path) -> None:
    """Ranges of bands, and not-a-number, by the array's metadata."""
    codec = SgiCodec(steps=3, nodata=float("nan"), sample_range=((0.0, 100.0), (1.0, 900.0)))
    options = {"shape": (32, 40, 2), "chunks": (16, 40, 2), "dtype": "float32", "fill_value": float("nan")}
    array = zarr.create_array(LocalStore(tmp_path), serializer=codec, compressors=None, **options)
    again = zarr.open_array(tmp_path)
    assert again.serializer == codec
    y, x = np.mgrid[:32, :40]
    values = np.stack([x / 40, 100 + 20 * y], axis=2).astype(np.float32)
    values[:5, :, 1] = values[20:, 30:, 0] = np.nan
    again[:] = values
    np.testing.assert_array_equal(np.isnan(array[:]), np.isnan(values))
    assert (np.nanmax(np.abs(array[:] - values), axis=(0, 1)) < [0.2, 160]).all()
    with sgicodec.open(tmp_path / "c" / "1" / "0" / "0") as stream:
        assert stream.header.sample_range == ((0, 100), (1, 900))


def test_a_part_costs_its_tiles(store: MemoryStore) -> None:
    whole = sgicodec.decode(chunk_of(store))
    counting = Counting(store)
    array = zarr.open_array(counting, mode="r")
    np.testing.assert_array_equal(array[100:120, 70:90], whole[100:120, 70:90])
    assert counting.bytes <= len(chunk_of(store)) // 2
    assert counting.requests <= 5
    counting.bytes = 0
    np.testing.assert_array_equal(array[5, ::40, 1], whole[5, ::40, 1])
    np.testing.assert_array_equal(array.oindex[[3, 150], 4:6, [0, 2]], whole[[3, 150]][:, 4:6][..., [0, 2]])
    np.testing.assert_array_equal(array[:192], whole)


Y, X = np.mgrid[:32, :40]
CHUNK = np.stack([4 * X, 5 * Y, 2 * (X + Y)], axis=2).astype(np.uint8)


def test_the_registry_finds_it() -> None:
    codec = numcodecs.get_codec({"id": "sgicodec", "quality": 80, "steps": 20})
    assert isinstance(codec, Sgi)
    assert codec.get_config() == {"id": "sgicodec", "quality": 80, "steps": 20}
    assert repr(codec) == "Sgi(quality=80, steps=20)"
    assert codec == Sgi(quality=80, steps=20)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_chunks_come_back(dtype: type) -> None:
    codec = Sgi(quality=80, steps=20)
    chunk = CHUNK.astype(dtype)
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
    whole = np.tile(CHUNK, (2, 2, 1))[:40, :60]
    array[:] = whole
    again = zarr.open_array(store, mode="r")
    assert again.metadata.compressor == Sgi(steps=20)
    stored = sgicodec.decode(store._store_dict["0.0.0"].to_bytes())
    np.testing.assert_array_equal(again[:32, :32], stored)
    assert np.abs(stored.astype(float) - whole[:32, :32]).mean() < 4
