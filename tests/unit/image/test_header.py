"""What headers say of samples: their types, bits, scales and channels; what of it is told, and what is refused."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np
import pytest
import tifffile
from image_files import by_tifffile, notes_of, save

from sgicodec import open_source, read
from sgicodec.errors import PictureError


@pytest.mark.parametrize("dtype", ["int8", "int16", "int32", "uint32", "float16", "float32", "float64"])
def test_white_is_zero_in_other_types(tmp_path: Path, dtype: str) -> None:
    tifffile.imwrite(tmp_path / "x.tif", np.ones((4, 4), dtype), photometric="miniswhite")
    with pytest.raises(PictureError, match=r"x\.tif: 0 is white in its \w+ samples, .* invert it first"):
        read(tmp_path / "x.tif")


@pytest.mark.parametrize("dtype", ["uint8", "uint16"])
@pytest.mark.parametrize("layout", [{}, {"planarconfig": "separate"}, {"tile": (16, 16)}])
@pytest.mark.parametrize("extra", ["unassalpha", "assocalpha", "unspecified"])
def test_where_white_is_zero_other_samples_stay(
    tmp_path: Path, dtype: str, layout: dict[str, object], extra: str
) -> None:
    most = np.iinfo(dtype).max
    ink, other = np.full((16, 32), most // 16, dtype), np.full((16, 32), most // 2, dtype)
    samples = np.stack([ink, other], axis=0 if "planarconfig" in layout else -1)
    options: dict[str, object] = {"planarconfig": "contig", "extrasamples": [extra], **layout}
    tifffile.imwrite(tmp_path / "x.tif", samples, photometric="miniswhite", **options)
    picture = read(tmp_path / "x.tif")
    ink_alone = most // 16 * most / (most // 2) if extra == "assocalpha" else most // 16
    assert picture.channels == ("multi" if extra == "unspecified" else "gray+alpha")
    np.testing.assert_allclose(picture.pixels[..., 0], most - ink_alone, atol=1)
    np.testing.assert_array_equal(picture.pixels[..., 1], other)
    with open_source(tmp_path / "x.tif") as source:
        np.testing.assert_array_equal(source.read(3, 4, 20, 9).pixels, picture.pixels[4:13, 3:23])


@pytest.mark.parametrize("name", ["int16", "int8", "double", "half"])
def test_other_sample_types_become_float(tmp_path: Path, name: str) -> None:
    stored = np.array([[-3, 0], [5, 100]], {"double": "f8", "half": "f2"}.get(name, name))[..., None]
    picture = read(save(tmp_path / "x.tif", stored, tiff__half=1))
    assert picture.pixels.dtype == np.float32
    assert picture.pixels.ravel().tolist() == [-3.0, 0.0, 5.0, 100.0]
    assert picture.sample_range == (-3.0, 100.0)


def fits(stored: np.ndarray, **cards: object) -> bytes:
    """A FITS file of integers [H, W]."""
    sizes = {"NAXIS": 2, "NAXIS1": stored.shape[1], "NAXIS2": stored.shape[0]}
    cards = {"SIMPLE": "T", "BITPIX": 8 * stored.itemsize, **sizes, **cards}
    header = "".join(f"{name:8}= {value:>20}".ljust(80) for name, value in cards.items()) + "END"
    samples = stored.astype(stored.dtype.newbyteorder(">")).tobytes()
    return header.ljust(2880).encode() + samples.ljust(-(-len(samples) // 2880) * 2880, b"\0")


@pytest.mark.parametrize("zero", [32768, "3.2768E4"])
def test_unsigned_integers_of_fits(zero: object) -> None:
    numbers = np.array([[0, 1, 32767], [32768, 40000, 65535]], np.uint16)
    file = fits((numbers ^ 32768).view(np.int16), BZERO=zero, BSCALE=1)
    np.testing.assert_array_equal(read(file).pixels[::-1, :, 0], numbers)  # the first row is the lowest
    with open_source(file) as source:
        assert (source.dtype, source.notes) == (np.uint16, ())


def test_four_planes_of_fits_are_bands() -> None:
    """OpenImageIO takes the last for alpha."""
    planes = np.arange(4 * 5 * 6, dtype=np.uint8).reshape(4, 5, 6)
    picture = read(fits(planes.reshape(20, 6), NAXIS=3, NAXIS2=5, NAXIS3=4))
    assert picture.channels == "multi"
    np.testing.assert_array_equal(picture.pixels[::-1], np.moveaxis(planes, 0, -1))


@pytest.mark.parametrize(
    ("dtype", "zero", "scale"), [("i2", 273.15, 0.01), ("i2", 0, 2), ("i4", 1 << 31, 1), ("u1", -128, 1)]
)
def test_fits_in_other_scales(dtype: str, zero: float, scale: float) -> None:
    with pytest.raises(PictureError, match=re.escape(f"BSCALE {scale:.7g} and BZERO {zero:.7g} of")):
        read(fits(np.ones((2, 2), dtype), BZERO=zero, BSCALE=scale))


@pytest.mark.parametrize(
    ("name", "bits", "notes"),
    [
        ("x.tif", 2, ("samples v of its 2 bits become 8 bits, v · 85",)),
        ("x.tif", 10, ("samples v of its 10 bits become 16 bits, v · 65535 / 1023 rounded down",)),
        ("x.tif", 16, ()),
        ("x.png", 4, ()),
    ],
)
def test_that_few_bits_are_stretched_is_said(tmp_path: Path, name: str, bits: int, notes: tuple[str, ...]) -> None:
    """But of formats whose samples are levels of a screen."""
    pixels = np.zeros((4, 4, 1), np.uint8 if bits <= 8 else np.uint16)
    assert notes_of(save(tmp_path / name, pixels, oiio__BitsPerSample=bits)) == notes


@pytest.mark.parametrize(("largest", "factor"), [(1000, "65535 / 1000 rounded down"), (257, "255"), (65535, None)])
def test_that_a_pnm_is_stretched_is_said(largest: int, factor: str | None) -> None:
    data = b"P5\n# 9 9\n4 1 # more\n%d\n" % largest + np.array([0, 1, 200, largest], ">u2").tobytes()
    few = largest.bit_length()
    assert notes_of(data) == ((f"samples v of its {few} bits become 16 bits, v · {factor}",) if factor else ())
    expected = np.array([0, 1, 200, largest], np.int64) * 65535 // largest
    np.testing.assert_array_equal(read(data).pixels.ravel(), expected)


@pytest.mark.parametrize(
    ("dtype", "said"),
    [("bool", "of its 1 bit become 8 bits, 255 − v · 255"), ("uint8", "become 255 − v"), ("u2", "become 65535 − v")],
)
def test_that_white_is_turned_over_is_said(dtype: str, said: str) -> None:
    data = by_tifffile(np.zeros((4, 4), dtype), photometric="miniswhite", metadata=None)
    assert notes_of(data) == (f"samples v {said}",)


def test_that_cineon_is_logarithmic_is_said() -> None:
    """Of 4×2 pixels of 10 bits, three to a word."""
    channels = b"".join(struct.pack(">BBBxII4f", 0, band, 10, 4, 2, 0, 0, 1023, 2) for band in (1, 2, 3))
    general = struct.pack(">6I8s", 0x802A5FD7, 2048, 1024, 1024, 0, 2080, b"V4.5").ljust(192, b"\0")
    image = struct.pack(">BBxx", 0, 3) + channels.ljust(224, b"\0") + struct.pack(">8f", *[np.inf] * 8) + bytes(228)
    file = (general + image + struct.pack(">BB30x", 0, 5)).ljust(2048, b"\xff")
    notes = notes_of(file + struct.pack(">8I", *[500 << 22 | 400 << 12 | 300 << 2] * 8))
    assert notes[1:] == ("not kept: colour space (KodakLog)",)


def test_luminance_and_differences_are_refused(tmp_path: Path) -> None:
    path = save(tmp_path / "x.exr", np.zeros((4, 8, 3), np.float32), channels=("Y", "RY", "BY"))
    with pytest.raises(PictureError, match="save it as RGB"):
        read(path)


@pytest.mark.parametrize(
    ("dtype", "what"), [("int64", "integers"), ("uint64", "integers"), ("complex64", "complex numbers")]
)
def test_samples_that_are_not_supported(dtype: str, what: str, tmp_path: Path) -> None:
    tifffile.imwrite(tmp_path / "x.tif", np.ones((4, 4), dtype), metadata=None)
    with pytest.raises(PictureError, match=f"its samples are {what} of 64 bits, which are not supported"):
        read(tmp_path / "x.tif")


@pytest.mark.parametrize(
    ("dtype", "note"),
    [
        ("uint8", None),
        ("uint16", None),
        ("float32", None),
        ("int16", "samples of int16 become 32-bit floats"),
        ("uint32", "samples of uint32 become 32-bit floats, rounded to 24 bits"),
        ("float64", "samples of float64 become 32-bit floats, rounded to 24 bits"),
    ],
)
def test_that_types_change_is_said(dtype: str, note: str | None) -> None:
    data = by_tifffile(np.arange(120).reshape(10, 12).astype(dtype))
    assert notes_of(data) == ((note,) if note else ())


FLOATS = np.random.default_rng(0).random((6, 8, 3), np.float32)


@pytest.mark.parametrize(
    ("name", "how", "said"),
    [
        ("a.exr", {}, ()),
        ("a.exr", {"PixelAspectRatio": 1.0, "Software": "x", "oiio__ColorSpace": "x"}, ()),
        ("a.exr", {"Exif__FNumber": 4.0, "arnold__x": "y"}, ("not kept: Exif:FNumber, arnold:x",)),
        ("a.exr", {"Artist": "x", "PixelAspectRatio": 2.0}, ("not kept: Artist, PixelAspectRatio",)),
        (
            "a.exr",
            {f"own{i}": "x" for i in range(8)},
            (f"not kept: {', '.join(f'own{i}' for i in range(6))}, 2 more attributes",),
        ),
        ("a.exr", {"at": (3, -2)}, ("not kept: its place at 3, -2 in a window of 8×6 pixels",)),
        ("a.exr", {"PixelAspectRatio": "square", "chromaticities": 1}, ("not kept: chromaticities",)),
        ("a.hdr", {}, ()),
        ("a.dpx", {}, ()),
        ("a.dpx", {"oiio__ColorSpace": "KodakLog"}, ("not kept: colour space (Logarithmic)",)),
        ("a.tga", {"ImageDescription": "x"}, ("not kept: ImageDescription",)),
        ("a.tif", {"Artist": "x"}, ()),
    ],
)
def test_what_a_header_says_is_named(name: str, how: dict[str, object], said: tuple[str, ...], tmp_path: Path) -> None:
    pixels = (FLOATS * 255).astype(np.uint8) if name.endswith(("tga", "tif")) else FLOATS
    path = save(tmp_path / name, pixels, **how)  # type: ignore[arg-type]
    assert notes_of(path) == said


def test_names_of_channels_are_not_kept(tmp_path: Path) -> None:
    path = save(tmp_path / "a.exr", FLOATS, channels=("N.x", "N.y", "N.z"))
    assert notes_of(path) == ("not kept: names of channels",)
