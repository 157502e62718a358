"""The public functions as a program calls them: encode, decode, imread, imwrite, open."""

from __future__ import annotations

import builtins
import io
import mmap
import pickle
import struct
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import dask.array as da
import numpy as np
import pytest
from PIL import Image

import sgicodec
from sgicodec.decoder.view import MAX_OUTPUT_SAMPLES
from sgicodec.errors import RegionError, StreamError, UsageError
from sgicodec.picture import Metadata, equal_samples

PHOTO = Path(__file__).parents[1] / "data" / "kodim23.png"


@pytest.fixture(scope="module")
def pixels() -> np.ndarray:
    """A piece of a photograph [64, 96, 3]."""
    return np.asarray(Image.open(PHOTO))[200:264, 100:196]


@pytest.fixture(scope="module")
def data(pixels: np.ndarray) -> bytes:
    """Its stream, of four tiles."""
    return sgicodec.encode(pixels, quality=60, steps=20, tile=48)


@pytest.fixture(scope="module")
def whole(data: bytes) -> np.ndarray:
    """What it decodes to."""
    return sgicodec.decode(data)


def test_arrays_images_and_paths_make_equal_streams(pixels: np.ndarray, data: bytes, tmp_path: Path) -> None:
    Image.fromarray(pixels).save(tmp_path / "a.png")
    settings = {"quality": 60, "steps": 20, "tile": 48}
    for image in (Image.fromarray(pixels), str(tmp_path / "a.png"), sgicodec.read(tmp_path / "a.png")):
        assert sgicodec.encode(image, **settings) == data
    sgicodec.imwrite(tmp_path / "a.sgi", pixels, **settings)
    assert (tmp_path / "a.sgi").read_bytes() == data
    np.testing.assert_array_equal(sgicodec.imread(tmp_path / "a.sgi"), sgicodec.decode(data))


def test_round_trip(pixels: np.ndarray, whole: np.ndarray) -> None:
    assert (whole.shape, whole.dtype) == (pixels.shape, np.uint8)
    assert np.abs(whole.astype(int) - pixels).mean() < 12


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_gray_stays_of_two_axes_and_of_its_type(pixels: np.ndarray, dtype: type) -> None:
    gray = pixels[..., 1].astype(dtype) * (257 if dtype is np.uint16 else 1)
    decoded = sgicodec.decode(sgicodec.encode(gray, steps=10))
    assert (decoded.shape, decoded.dtype) == (gray.shape, dtype)
    assert np.abs(decoded / float(gray.max()) - gray / float(gray.max())).mean() < 0.1


def test_targets(pixels: np.ndarray) -> None:
    assert len(sgicodec.encode(pixels, size=900, steps=20)) <= 900
    with pytest.raises(sgicodec.errors.TargetMissedError):
        sgicodec.encode(pixels, size=20, steps=4)


def test_bytes_of_every_kind(data: bytes, whole: np.ndarray, tmp_path: Path) -> None:
    path = tmp_path / "a.sgi"
    path.write_bytes(data)
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as mapped:
        kinds = [bytearray(data), memoryview(data), np.frombuffer(data, np.uint8), mapped, io.BytesIO(data), file]
        for kind in kinds:
            np.testing.assert_array_equal(sgicodec.decode(kind), whole)


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


def test_an_index_decodes_only_the_tiles_that_it_touches(data: bytes) -> None:
    with sgicodec.open(data) as stream:
        assert stream.grid.count == 4
        _ = stream[:8, :8]
        assert stream._open_native().tiles()[0] == 1


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


def test_outside_is_nodata_or_transparent(pixels: np.ndarray) -> None:
    rgba = np.dstack([pixels, np.full(pixels.shape[:2], 255, np.uint8)])
    rgba[0, 0, 3] = 0
    with sgicodec.open(sgicodec.encode(rgba, steps=4)) as stream:
        assert (stream.read((90, 60, 20, 20), boundless=True)[5:, 8:] == 0).all()
        inside = stream.read()[60:, 90:]
        np.testing.assert_array_equal(stream.read((90, 60, 20, 20), boundless=True)[:4, :6], inside)
        assert (inside[..., 3] > 240).all()


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


def test_regions_of_levels(pixels: np.ndarray) -> None:
    """As OpenSlide has them: a location in the picture, a size in pixels of the level."""
    with sgicodec.open(sgicodec.encode(np.tile(pixels[..., 1], (5, 4)), steps=4)) as stream:
        assert stream.levels == ((384, 320, 1.0), (192, 160, 2.0))
        whole, half = stream.read(), stream.read(scale=0.5)
        found = stream.read_region((370, 300), 0, (40, 40))
        np.testing.assert_array_equal(found[:20, :14], whole[300:, 370:])
        assert not found[20:].any()
        assert not found[:, 14:].any()
        part = stream.read_region((100, 60), 1, (30, 20)).astype(int)
        np.testing.assert_allclose(part, half[30:50, 50:80], atol=1)
        assert stream.read_region((-8, 0), 1, (4, 4)).tolist() == [[0] * 4] * 4


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


def test_dask_takes_a_stream(data: bytes, whole: np.ndarray) -> None:
    with sgicodec.open(data) as stream:
        array = da.from_array(stream, chunks=(30, 50, 3))
        assert (array.shape, array.dtype) == (whole.shape, whole.dtype)
        np.testing.assert_array_equal(array.compute(scheduler="threads"), whole)


def test_names(data: bytes, pixels: np.ndarray, tmp_path: Path) -> None:
    assert dir(sgicodec) == sorted(sgicodec.__all__)
    for name in sgicodec.__all__:
        assert getattr(sgicodec, name) is not None
    (tmp_path / "a.sgi").write_bytes(data)
    size = f"{len(data):,}"
    with sgicodec.open(tmp_path / "a.sgi") as stream:
        assert repr(stream) == f"<sgicodec.Stream {str(tmp_path / 'a.sgi')!r} 96×64 rgb uint8, {size} bytes>"
    assert repr(sgicodec.open(data)) == f"<sgicodec.Stream 96×64 rgb uint8, {size} bytes>"
    assert repr(sgicodec.Picture(pixels, "rgb", (0, 255))) == "<sgicodec.Picture 96×64 rgb uint8, 0 to 255>"
    assert "data=" not in repr(sgicodec.Encoded(data, {}, 1, 1, 0.1))


ARGUMENTS: dict[str, Callable[[bytes, np.ndarray], Any]] = {
    "decode of a path": lambda data, _: sgicodec.decode("a.sgi"),
    "no stream": lambda data, _: sgicodec.open(None),
    "missing file": lambda data, _: sgicodec.open("missing.sgi"),
    "a folder": lambda data, _: sgicodec.open("."),
    "a path with a null": lambda data, _: sgicodec.open("a\0b"),
    "device": lambda data, _: sgicodec.open(data, device=3),
    "threads": lambda data, _: sgicodec.Device(threads="2"),
    "instruction set": lambda data, _: sgicodec.Device(isa="mmx"),
    "region of strings": lambda data, _: sgicodec.decode(data, region="1234"),
    "region of three": lambda data, _: sgicodec.decode(data, region=(1, 2, 3)),
    "empty region": lambda data, _: sgicodec.decode(data, region=(0, 0, 0, 5)),
    "region outside": lambda data, _: sgicodec.decode(data, region=(90, 0, 20, 5)),
    "scale": lambda data, _: sgicodec.decode(data, scale="2"),
    "scale 0": lambda data, _: sgicodec.decode(data, scale=0),
    "scale beyond limits": lambda data, _: sgicodec.decode(data, scale=MAX_OUTPUT_SAMPLES),
    "size of one": lambda data, _: sgicodec.decode(data, size=5),
    "size of nothing": lambda data, _: sgicodec.decode(data, size=(None, None)),
    "size 0": lambda data, _: sgicodec.decode(data, size=(0, 3)),
    "fractional size": lambda data, _: sgicodec.decode(data, size=(2.5, 3)),
    "scale and size": lambda data, _: sgicodec.decode(data, scale=1, size=(1, 1)),
    "int8": lambda data, _: sgicodec.decode(data, dtype="int8"),
    "no dtype": lambda data, _: sgicodec.decode(data, dtype="rgb"),
    "level": lambda data, _: sgicodec.open(data).read_region((0, 0), 9, (3, 3)),
    "location": lambda data, _: sgicodec.open(data).read_region(0, 0, (3, 3)),
    "unknown setting": lambda _, pixels: sgicodec.encode(pixels, qualty=3),
    "two targets": lambda _, pixels: sgicodec.encode(pixels, quality=3, size=4),
    "quality": lambda _, pixels: sgicodec.encode(pixels, quality="high"),
    "effort": lambda _, pixels: sgicodec.encode(pixels, effort=2.5),
    "no path": lambda _, pixels: sgicodec.imwrite(3, pixels),
    "no folder": lambda _, pixels: sgicodec.imwrite("/nowhere/a.sgi", pixels, steps=1),
    "no picture": lambda data, _: sgicodec.encode(data),
    "no picture file": lambda *_: sgicodec.read(7),
    "no source": lambda *_: sgicodec.open_source(None),
    "kind of alpha": lambda *_: sgicodec.read(PHOTO, alpha="bands"),
    "an array to write": lambda _, pixels: sgicodec.write(pixels, "a.png"),
    "an array to encode_picture": lambda _, pixels: sgicodec.encode_picture(pixels),
    "settings": lambda *_: sgicodec.encode_picture(sgicodec.read(PHOTO), 7),
    "pixels": lambda *_: sgicodec.Picture(3, "rgb", (0, 255)),
    "device of an encode": lambda _, pixels: sgicodec.encode(pixels, steps=1, device=2),
    "device of a file": lambda *_: sgicodec.imread("a.sgi", device=2),
    "workers": lambda *_: sgicodec.ProcessExecutor(-1),
    "checkpoint": lambda *_: sgicodec.Checkpoint(3),
}


@pytest.mark.parametrize("case", ARGUMENTS)
def test_bad_arguments(case: str, data: bytes, pixels: np.ndarray) -> None:
    with pytest.raises(sgicodec.SgiError) as found:
        ARGUMENTS[case](data, pixels)
    assert "\n" not in str(found.value)
    assert isinstance(found.value, StreamError) == (case in ("missing file", "a folder", "a path with a null"))


def test_samples_that_are_no_numbers() -> None:
    samples = np.zeros((4, 4), np.float32)
    samples[2, 1] = np.nan
    for stated in (None, (0.0, 1.0)):
        with pytest.raises(sgicodec.SgiError, match="not a number"):
            sgicodec.encode(samples, steps=1, sample_range=stated)


def test_open_does_not_hide_the_builtin() -> None:
    assert sgicodec.open is not builtins.open
    assert Path(sgicodec.__file__).read_bytes()


def test_what_an_encode_notes_is_a_warning(pixels: np.ndarray) -> None:
    hidden = np.dstack([pixels, np.zeros(pixels.shape[:2], np.uint8)])
    with pytest.warns(UserWarning, match="alpha is 0 everywhere") as found:
        data = sgicodec.encode(hidden, steps=4)
    assert found[0].filename == __file__
    assert sgicodec.decode(data).shape[2] == 3


STATE = """
import signal, sys, warnings
import numpy as np, OpenImageIO as oiio, PIL.Image as pillow

def state():
    pillow.init()
    names = ("threads", "exr_threads", "limits:imagesize_MB", "limits:channels", "try_all_readers", "use_tbb")
    return (
        np.geterr(), np.get_printoptions(), np.random.get_state()[1].tolist(), list(warnings.filters),
        [oiio.get_int_attribute(name, -1) for name in names], oiio.get_string_attribute("plugin_searchpath"),
        pillow.MAX_IMAGE_PIXELS, sorted(pillow.OPEN), sys.getrecursionlimit(), signal.getsignal(signal.SIGINT),
        signal.getsignal(signal.SIGPIPE), sys.getswitchinterval(), sys.excepthook,
    )

import sgicodec
before = state()
data = sgicodec.encode(sys.argv[1], effort=1, steps=3)
sgicodec.decode(data, scale=0.5)
sgicodec.write(sgicodec.open(data).picture(), sys.argv[2])
sgicodec.read(sys.argv[2])
after = state()
assert before == after, [pair for pair in zip(before, after) if pair[0] != pair[1]]
"""


def test_nothing_of_other_libraries_is_changed(pixels: np.ndarray, tmp_path: Path) -> None:
    Image.fromarray(pixels).save(tmp_path / "a.tif")
    command = [sys.executable, "-c", STATE, tmp_path / "a.tif", tmp_path / "b.jpg"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
