"""Opened streams: arrays, regions, levels, threads, pickles."""

from __future__ import annotations

import io
import os
import pickle
import struct
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from children import HANGS

import sgicodec
from sgicodec.errors import RegionError, UsageError
from sgicodec.picture import Metadata, equal_samples


def test_parts_and_types(data: bytes, whole: np.ndarray) -> None:
    np.testing.assert_array_equal(sgicodec.decode(data, region=(5, 6, 20, 10)), whole[6:16, 5:25])
    assert sgicodec.decode(data, size=(None, 32)).shape == (32, 48, 3)
    assert sgicodec.decode(data, scale=2).shape == (128, 192, 3)
    with sgicodec.open(data) as stream:
        unit = stream.render().clip(0, 1)
    for dtype, most in ((np.uint16, 65535), (np.float32, 1)):
        deep = sgicodec.decode(data, dtype=dtype)
        assert deep.dtype == dtype
        np.testing.assert_allclose(deep / most, unit, atol=0.51 / 65535)
    assert len(np.unique(sgicodec.decode(data, dtype="uint16") % 257)) > 200, "not eight bits, multiplied"


def test_a_stream_is_an_array(data: bytes, whole: np.ndarray) -> None:
    with sgicodec.open(data) as stream:
        assert (stream.shape, stream.ndim, stream.dtype) == ((64, 96, 3), 3, np.uint8)
        np.testing.assert_array_equal(np.asarray(stream), whole)
        assert np.asarray(stream, np.float64).dtype == np.float64
        for key in (np.s_[3], np.s_[3:9, -5], np.s_[10:40:3, ::-2, 1], np.s_[..., 2], np.s_[5:5]):
            np.testing.assert_array_equal(stream[key], whole[key])
        with pytest.raises(UsageError, match="copy=False"):
            np.asarray(stream, copy=False)


def test_regions_may_reach_over_the_picture(data: bytes, whole: np.ndarray) -> None:
    with sgicodec.open(data) as stream:
        found = stream.read((-10, -5, 40, 80), boundless=True)
        np.testing.assert_array_equal(found[5:69, 10:], whole[:, :30])
        assert not found[:5].any()
        assert not found[69:].any()
        assert not found[:, :10].any()
        bands = np.concatenate([band.pixels for _, band in stream.bands((-10, -5, 40, 80), boundless=True)])
        np.testing.assert_array_equal(bands, found)
        assert not stream.read((-50, 0, 20, 20), boundless=True).any()
        small = stream.read((-32, 0, 160, 64), scale=0.5, boundless=True)
        np.testing.assert_array_equal(small[:, 16:64], stream.read(scale=0.5))
        with pytest.raises(RegionError, match="not inside"):
            stream.read((-10, -5, 40, 30))


@pytest.mark.parametrize(("nodata", "dtype"), [(7.0, "uint8"), (-9999.0, "float32"), (float("nan"), "float32")])
def test_nodata_goes_along(pixels: np.ndarray, nodata: float, dtype: str, tmp_path: Path) -> None:
    """As it is, around the picture, and in another type as a value that no other pixel has."""
    samples = pixels[..., 1].astype(dtype)
    samples[:, :40] = nodata
    tag = f"{nodata:g}".encode() + b"\0" * 8
    geo = b"II*\0\x08\0\0\0\1\0" + struct.pack("<HHII", 42113, 2, len(tag), 26) + bytes(4) + tag
    picture = sgicodec.Picture(samples[..., None], "gray", (0.0, 255.0), Metadata(geo=geo))
    with sgicodec.open(sgicodec.encode(picture, steps=10)) as stream:
        assert np.array_equal(stream.nodata, nodata, equal_nan=True)  # type: ignore[arg-type]
        around = stream.read((-5, 0, 60, 64), boundless=True)
        np.testing.assert_array_equal(around[:, :45], np.full((64, 45), nodata, dtype))
        for other in ("uint8", "uint16", "float32"):
            shown = stream.picture((-5, 0, 60, 64), dtype=other, boundless=True)
            value = shown.nodata
            assert value is not None
            alike = equal_samples(shown.pixels[..., 0], value)
            assert alike[:, :45].all()
            assert not alike[:, 45:].any()


def test_closed(data: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.sgi"
    path.write_bytes(data)
    stream = sgicodec.open(path)
    stream.read((0, 0, 4, 4))
    stream.close()
    stream.close()
    assert stream.closed
    for use in (stream.read, stream.survey, lambda: stream[0], lambda: stream.overview, lambda: stream.payload(0)):
        with pytest.raises(UsageError, match="the stream is closed"):
            use()
    assert stream.shape == (64, 96, 3)


@pytest.mark.parametrize("tile", [0, 32])
def test_numbers_of_tiles_are_checked(pixels: np.ndarray, tile: int) -> None:
    with sgicodec.open(sgicodec.encode(pixels, steps=1, tile=tile)) as stream:
        last = stream.grid.count - 1
        assert isinstance(stream.payload(np.int64(last)), bytes)
        for use in (stream.payload, stream.tile_model):
            for number in (-1, last + 1):
                with pytest.raises(RegionError, match=f"tile {number}; there are tiles 0 to {last}"):
                    use(number)
            with pytest.raises(UsageError, match=r"tile 0\.5; tiles have numbers"):
                use(0.5)  # type: ignore[arg-type]


def test_several_threads_may_use_a_stream_at_once(
    pixels: np.ndarray, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of six tiles four are kept, so that all threads read the file and change the cache again and again."""
    path = tmp_path / "a.sgi"
    sgicodec.imwrite(path, pixels, steps=1, tile=32)
    whole = sgicodec.imread(path)
    monkeypatch.setattr("sgicodec.decoder.stream.CACHE_BYTES", 0)
    rng, interval = np.random.default_rng(0), sys.getswitchinterval()
    corners = [(int(x), int(y)) for x, y in zip(rng.integers(0, 56, 60), rng.integers(0, 30, 60), strict=True)]
    sys.setswitchinterval(1e-6)
    try:
        with sgicodec.open(path, sgicodec.Device(threads=2)) as stream, ThreadPoolExecutor(8) as pool:
            parts = list(pool.map(lambda corner: stream.read((*corner, 40, 34)), corners))
    finally:
        sys.setswitchinterval(interval)
    for (x, y), part in zip(corners, parts, strict=True):
        np.testing.assert_array_equal(part, whole[y : y + 34, x : x + 40])


FORKS = """
import os, signal, sys
import sgicodec
def decoded(threads):
    return sgicodec.imread(sys.argv[1], device=sgicodec.Device(threads=threads)).tobytes()
whole = decoded(2)
if os.fork() == 0:
    signal.alarm(int(sys.argv[2]))
    os._exit(any(decoded(threads) != whole for threads in range(3, 9)))
sys.exit(os.waitstatus_to_exitcode(os.wait()[1]))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes do not fork here")
def test_a_forked_process_decodes_with_more_threads(data: bytes, tmp_path: Path) -> None:
    """Threads that the first decode started are not there."""
    (tmp_path / "a.sgi").write_bytes(data)
    assert subprocess.run([sys.executable, "-c", FORKS, tmp_path / "a.sgi", str(HANGS)], check=False).returncode == 0


def test_streams_are_pickled_by_path_or_bytes(
    data: bytes, whole: np.ndarray, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.sgi").write_bytes(data)
    with sgicodec.open("a.sgi", sgicodec.Device(threads=1)) as stream:
        stream.exact = True
        blob = pickle.dumps(stream)
    assert len(blob) < len(data)
    monkeypatch.chdir("/")
    with pickle.loads(blob) as again, pickle.loads(pickle.dumps(sgicodec.open(data))) as copy:
        assert (again.exact, again.device, copy.exact) == (True, sgicodec.Device(threads=1), False)
        np.testing.assert_array_equal(again[:], whole)
        np.testing.assert_array_equal(copy[:], whole)
    with pytest.raises(UsageError, match="cannot be pickled"):
        pickle.dumps(sgicodec.open(io.BytesIO(data)))
