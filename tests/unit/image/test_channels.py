"""What files declare of their last channel, in files made byte by byte."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import imagecodecs
import numpy as np
import pytest
import rasterio
import tifffile
from PIL import Image

from sgicodec import Picture, open_source, read, write
from sgicodec.errors import PictureError
from sgicodec.image.source import ALPHA_IS_BAND
from sgicodec.metadata import geo, ifd
from sgicodec.metadata.gdal_items import named_bands, with_colours

COLOURS = np.arange(24, dtype=np.uint8).reshape(2, 4, 3) * 10
ALPHA = np.array([0, 255, 128, 7, 1, 254, 200, 30], np.uint8).reshape(2, 4, 1)
BOTH = np.concatenate([COLOURS, ALPHA], axis=2)


def bmp(pixels: np.ndarray, masks: tuple[int, ...] | None, size: int = 40) -> bytes:
    """A BMP of 32-bit pixels [H, W, 4], whose bytes stand as given; without masks it is BI_RGB."""
    height, width, _ = pixels.shape
    compression = 0 if masks is None else 3
    header = struct.pack("<IiiHHIIiiII", size, width, -height, 1, 32, compression, 0, 0, 0, 0, 0)
    header += b"" if masks is None else struct.pack(f"<{len(masks)}I", *masks)
    header = header.ljust(size, b"\0")
    start = 14 + len(header)
    return struct.pack("<2sIHHI", b"BM", start + pixels.size, 0, 0, start) + header + pixels.tobytes()


def targa(
    pixels: np.ndarray, descriptor: int, depth: int, kind: int = 2, extension: int | None = None, packed: bool = False
) -> bytes:
    """A Targa from the top down of pixels whose bytes stand as given."""
    height, width = pixels.shape[:2]
    data = pixels.tobytes()
    if packed:  # rows of raw packets
        data = b"".join(bytes([width - 1]) + row.tobytes() for row in pixels)
    file = struct.pack("<3B5s4H2B", 0, 0, kind, bytes(5), 0, 0, width, height, depth, descriptor | 0x20) + data
    if extension is None:
        return file
    area = struct.pack("<H", 495).ljust(494, b"\0") + bytes([extension])
    return file + area + struct.pack("<II", len(file), 0) + b"TRUEVISION-XFILE.\0"


@pytest.mark.parametrize("order", ["BGRA", "RGBA", "ARGB", "ABGR"])
@pytest.mark.parametrize("has_alpha", [True, False])
def test_a_bmp_has_its_bytes_where_its_masks_say(order: str, has_alpha: bool) -> None:
    planes = dict(zip("RGB", np.moveaxis(COLOURS, 2, 0), strict=True)) | {"A": ALPHA[..., 0]}
    masks = tuple(0xFF << 8 * order.index(name) for name in "RGBA")
    picture = read(
        bmp(np.stack([planes[name] for name in order], axis=2), masks if has_alpha else (*masks[:3], 0), 124)
    )
    expected = BOTH if has_alpha else COLOURS
    assert picture.channels == ("rgba" if has_alpha else "rgb")
    np.testing.assert_array_equal(picture.pixels, expected)


@pytest.mark.parametrize(("extension", "channels"), [(None, "rgba"), (0, "rgb"), (1, "rgb"), (2, "rgba"), (3, "rgba")])
def test_a_targa_has_alpha_unless_its_extension_area_denies_it(extension: int | None, channels: str) -> None:
    picture = read(targa(BOTH[..., [2, 1, 0, 3]], 8, 32, extension=extension))
    assert picture.channels == channels
    np.testing.assert_array_equal(picture.pixels, BOTH[..., : len(channels)])


ASSOCIATED = np.concatenate([np.minimum(COLOURS, ALPHA), ALPHA], axis=2)
UNASSOCIATED = np.concatenate([np.rint(ASSOCIATED[..., :3] * 255.0 / np.maximum(ALPHA, 1)), ALPHA], axis=2)


def test_colours_of_a_targa_may_be_multiplied_by_alpha() -> None:
    picture = read(targa(ASSOCIATED[..., [2, 1, 0, 3]], 8, 32, extension=4))
    np.testing.assert_array_equal(picture.pixels, UNASSOCIATED)


@pytest.mark.parametrize(("gamma", "said"), [((0, 0), None), ((22, 10), None), ((1, 1), "lin"), ((18, 10), "g18")])
def test_the_gamma_of_a_targa_is_said(gamma: tuple[int, int], said: str | None) -> None:
    data = bytearray(targa(COLOURS[..., ::-1], 0, 24, extension=0))
    struct.pack_into("<HH", data, 18 + COLOURS.size + 478, *gamma)
    with open_source(bytes(data)) as source:
        assert source.notes == ((f"not kept: colour space ({said})",) if said else ())


def test_colours_of_a_jpeg_2000_may_be_multiplied_by_alpha(tmp_path: Path) -> None:
    pixels = np.tile(ASSOCIATED, (16, 8, 1))
    Image.fromarray(pixels).save(tmp_path / "a.jp2")
    plain = (tmp_path / "a.jp2").read_bytes()
    multiplied = plain.replace(struct.pack(">HHH", 3, 1, 0), struct.pack(">HHH", 3, 2, 0))
    assert plain != multiplied
    np.testing.assert_array_equal(read(plain).pixels, pixels)
    np.testing.assert_array_equal(read(multiplied).pixels, np.tile(UNASSOCIATED, (16, 8, 1)))


def test_only_declared_alpha_of_a_jpeg_2000_is_alpha(tmp_path: Path) -> None:
    """Four bands of a satellite declare none; what is written does, to others too."""
    pixels = np.tile(BOTH, (16, 8, 1))
    plain = imagecodecs.jpeg2k_encode(pixels, reversible=True, codecformat="jp2")
    assert read(plain).channels == "multi"
    np.testing.assert_array_equal(read(plain).pixels, pixels)
    write(Picture(pixels, "rgba", (0, 255)), tmp_path / "a.jp2")
    assert read(tmp_path / "a.jp2").channels == "rgba"
    with rasterio.open(tmp_path / "a.jp2") as file:
        assert [colour.name for colour in file.colorinterp] == ["red", "green", "blue", "alpha"]
        np.testing.assert_array_equal(np.moveaxis(file.read(), 0, -1), pixels)


@pytest.mark.parametrize(
    ("space", "notes"), [(16, ()), (21, ("not kept: colour space (ROMM-RGB)",)), (14, None), (9, None)]
)
def test_colour_spaces_of_jpeg_2000(space: int, notes: tuple[str, ...] | None, tmp_path: Path) -> None:
    Image.fromarray(np.tile(COLOURS, (16, 8, 1))).save(tmp_path / "a.jp2")
    srgb = b"colr" + struct.pack(">BBBI", 1, 0, 0, 16)
    data = (tmp_path / "a.jp2").read_bytes()
    assert srgb in data
    data = data.replace(srgb, srgb[:-4] + struct.pack(">I", space))
    if notes is None:
        with pytest.raises(PictureError, match=f"JPEG 2000's space {space}, which is not converted"):
            open_source(data)
        return
    with open_source(data) as source:
        assert source.notes == notes


def tiff(bands: np.ndarray, extra: int | None) -> bytes:
    """An uncompressed TIFF of RGB and one more band, with ExtraSamples or without."""
    height, width, count = bands.shape
    tags = [(256, width), (257, height), (258, 8), (259, 1), (262, 2), (273, 0), (277, count), (278, height)]
    tags += [(279, bands.size)] + ([(338, extra)] if extra is not None else [])
    start = 8 + 2 + 12 * len(tags) + 4
    rows = b""
    for tag, value in tags:
        rows += struct.pack("<HHI", tag, 3, count if tag == 258 else 1)
        rows += struct.pack("<I", start if tag == 258 else start + 2 * count if tag == 273 else value)
    head = b"II*\0\x08\0\0\0" + struct.pack("<H", len(tags))
    return head + rows + bytes(4) + struct.pack(f"<{count}H", *[8] * count) + bands.tobytes()


@pytest.mark.parametrize(
    ("extra", "alpha", "channels"),
    [
        *((None, "auto", "multi"), (0, "auto", "multi"), (2, "auto", "rgba")),
        *((extra, "band", "multi") for extra in (None, 0, 1, 2)),
    ],
)
def test_only_declared_alpha_of_a_tiff_is_alpha(extra: int | None, alpha: Any, channels: str) -> None:
    """As a band it keeps stored samples."""
    picture = read(tiff(BOTH, extra), alpha=alpha)
    assert picture.channels == channels
    np.testing.assert_array_equal(picture.pixels, BOTH)


def test_a_volume_in_a_single_page_is_refused(tmp_path: Path) -> None:
    """Of which OpenImageIO gives the first plane."""
    planes = np.zeros((3, 32, 32), np.uint8)
    tifffile.imwrite(tmp_path / "a.tif", planes, volumetric=True, tile=(2, 16, 16), photometric="minisblack")
    with pytest.raises(PictureError, match="it is a volume of 3 planes"):
        open_source(tmp_path / "a.tif")


@pytest.mark.parametrize(("colour", "layout"), [("alpha", "rgba"), ("undefined", "multi")])
def test_gdal_has_the_word_on_the_last_band_of_a_tiff(colour: str, layout: str, tmp_path: Path) -> None:
    """Near infrared that is declared as alpha, which GDAL's metadata call undefined."""
    item = f'<Item name="COLORINTERP" sample="3" role="colorinterp">{colour.title()}</Item>'
    text = f"<GDALMetadata>{item}</GDALMetadata>"
    options = {"photometric": "rgb", "extrasamples": ["unassalpha"], "metadata": None}
    tifffile.imwrite(tmp_path / "a.tif", BOTH, extratags=[(42112, "s", 0, text, True)], **options)
    picture = read(tmp_path / "a.tif")
    assert picture.channels == layout
    np.testing.assert_array_equal(picture.pixels, BOTH)


RGB = ["Red", "Green", "Blue"]


@pytest.mark.parametrize(
    ("photometric", "extra", "alpha", "colours"),
    [
        ("rgb", [0], "auto", RGB),
        ("rgb", [2], "band", RGB),
        ("rgb", [0, 2], "auto", [*RGB, "", "Alpha"]),
        ("minisblack", [0, 2], "auto", ["", "", "Alpha"]),
        ("minisblack", [0, 0, 0], "auto", []),
        ("rgb", [2], "auto", []),
    ],
)
def test_what_bands_show_is_kept(
    photometric: str, extra: list[int], alpha: Any, colours: list[str], tmp_path: Path
) -> None:
    pixels = np.zeros((4, 4, len(extra) + (3 if photometric == "rgb" else 1)), np.uint8)
    options = {"photometric": photometric, "extrasamples": extra, "planarconfig": "contig", "metadata": None}
    tifffile.imwrite(tmp_path / "a.tif", pixels, **options)
    with open_source(tmp_path / "a.tif", alpha=alpha) as source:
        assert source.metadata.geo == with_colours(None, colours)
        assert source.notes == ((ALPHA_IS_BAND,) if "Alpha" in colours else ())


def test_colours_that_gdal_names_stay() -> None:
    blob, other = with_colours(None, RGB), with_colours(None, ["", "Blue"])
    assert with_colours(other, RGB) == other
    assert with_colours(blob, []) == blob
    named = geo.load(geo.pack(named_bands(["B4"])))[geo.GDAL_METADATA].data
    both = geo.load(with_colours(geo.pack(named_bands(["B4"])), RGB))[geo.GDAL_METADATA].data
    assert both.count(b"<Item") == 4
    assert both.startswith(named.partition(b"</GDALMetadata>")[0])
    damaged = geo.pack({geo.GDAL_METADATA: ifd.Entry(2, b"<GDALMetadata\0")})
    assert with_colours(damaged, RGB) == damaged
