"""`encode`, `decode` and what else `import sgicodec` has: arguments, errors, warnings."""

from __future__ import annotations

import io
import mmap
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from data_files import DATA
from PIL import Image

import sgicodec
from sgicodec import errors
from sgicodec.decoder.view import MAX_OUTPUT_SAMPLES
from sgicodec.errors import StreamError

PHOTO = DATA / "kodim23.png"


def test_arrays_images_and_paths_make_equal_streams(pixels: np.ndarray, data: bytes, tmp_path: Path) -> None:
    Image.fromarray(pixels).save(tmp_path / "a.png")
    settings = {"quality": 60, "steps": 20, "tile": 48}
    for image in (Image.fromarray(pixels), str(tmp_path / "a.png"), sgicodec.read(tmp_path / "a.png")):
        assert sgicodec.encode(image, **settings) == data
    sgicodec.imwrite(tmp_path / "a.sgi", pixels, **settings)
    assert (tmp_path / "a.sgi").read_bytes() == data
    np.testing.assert_array_equal(sgicodec.imread(tmp_path / "a.sgi"), sgicodec.decode(data))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_gray_stays_of_two_axes_and_of_its_type(pixels: np.ndarray, dtype: type) -> None:
    gray = pixels[..., 1].astype(dtype) * (257 if dtype is np.uint16 else 1)
    decoded = sgicodec.decode(sgicodec.encode(gray, steps=10))
    assert (decoded.shape, decoded.dtype) == (gray.shape, dtype)
    assert np.abs(decoded / float(gray.max()) - gray / float(gray.max())).mean() < 0.1


def test_bytes_of_every_kind(data: bytes, whole: np.ndarray, tmp_path: Path) -> None:
    path = tmp_path / "a.sgi"
    path.write_bytes(data)
    with path.open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as mapped:
        kinds = [bytearray(data), memoryview(data), np.frombuffer(data, np.uint8), mapped, io.BytesIO(data), file]
        for kind in kinds:
            np.testing.assert_array_equal(sgicodec.decode(kind), whole)


ARGUMENTS: dict[str, Callable[[bytes, np.ndarray], Any]] = {
    "decode of a path": lambda data, _: sgicodec.decode("a.sgi"),
    "no stream": lambda data, _: sgicodec.open(None),
    "missing file": lambda data, _: sgicodec.open("missing.sgi"),
    "a folder": lambda data, _: sgicodec.open("."),
    "a path with a null": lambda data, _: sgicodec.open("a\0b"),
    "a file of text": lambda *_: sgicodec.open(io.StringIO("text")),
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
    "negative seed": lambda _, pixels: sgicodec.encode(pixels, seed=-1),
    "empty network": lambda _, pixels: sgicodec.encode(pixels, network=b""),
    "network of text": lambda _, pixels: sgicodec.encode(pixels, network="x"),
    "profile in a list": lambda _, pixels: sgicodec.encode(pixels, profile=["default"]),
    "tune of a number": lambda _, pixels: sgicodec.encode(pixels, tune=1),
    "unknown tune": lambda _, pixels: sgicodec.encode(pixels, tune="loud"),
    "two targets": lambda _, pixels: sgicodec.encode(pixels, quality=3, size=4),
    "endless size": lambda _, pixels: sgicodec.encode(pixels, size=float("inf")),
    "size of half a byte": lambda _, pixels: sgicodec.encode(pixels, size=0.5),
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


def test_what_an_encode_notes_is_a_warning(pixels: np.ndarray) -> None:
    hidden = np.dstack([pixels, np.zeros(pixels.shape[:2], np.uint8)])
    with pytest.warns(UserWarning, match="alpha is 0 everywhere") as found:
        data = sgicodec.encode(hidden, steps=4)
    assert found[0].filename == __file__
    assert sgicodec.decode(data).shape[2] == 3


@pytest.mark.parametrize("kind", [kind for name, kind in vars(errors).items() if name.endswith("Error")])
def test_errors_come_back_from_other_processes(kind: type[errors.SgiError]) -> None:
    error = kind(3, "why") if kind is errors.TileFailedError else kind("why")
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), str(again), vars(again)) == (kind, str(error), vars(error))
