"""Files of several pictures: which are pages, and what each of them reads as."""

from __future__ import annotations

import io
import struct
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import pytest
import tifffile
from image_files import SRGB, by_pillow, by_tifffile
from PIL import Image

from sgicodec import open_source, read
from sgicodec.errors import PictureError, UsageError
from sgicodec.metadata.pages import tiff_pages

STACK = np.random.default_rng(2).integers(0, 256, (3, 24, 32), np.uint8)
COLOURS = np.random.default_rng(3).integers(0, 256, (3, 24, 32, 3), np.uint8)


def tiff(pages: list[np.ndarray], **options: Any) -> bytes:
    file = io.BytesIO()
    with tifffile.TiffWriter(file, **options) as writer:
        for page in pages:
            writer.write(page, metadata=None, photometric="rgb" if page.ndim == 3 else "minisblack")
    return file.getvalue()


def stack(**options: Any) -> bytes:
    return by_tifffile(STACK, photometric="minisblack", **options)


def animation(name: str, **options: Any) -> bytes:
    first, *others = [Image.fromarray(frame) for frame in COLOURS]
    return by_pillow(first, name, save_all=True, append_images=others, **options)


@pytest.mark.parametrize(
    "data",
    [
        tiff(list(STACK)),
        tiff(list(STACK), byteorder=">"),
        tiff(list(STACK), bigtiff=True),
        tiff([STACK[0], STACK[1, :5, :9], STACK[2, :12, :16]]),
        stack(imagej=True, metadata={"axes": "ZYX"}),
        stack(ome=True, metadata={"axes": "ZYX"}),
    ],
    ids=["little", "big", "bigtiff", "sizes", "imagej", "ome"],
)
def test_pages_of_tiff(data: bytes) -> None:
    with open_source(data) as source, tifffile.TiffFile(io.BytesIO(data)) as file:
        assert source.pages == 3
        np.testing.assert_array_equal(source.read(0, 0, 32, 24).pixels[..., 0], STACK[0])
        for number, page in enumerate(file.pages, 1):
            np.testing.assert_array_equal(read(data, page=number).pixels[..., 0], page.asarray())
            with open_source(data, page=number) as one:
                np.testing.assert_array_equal(one.read(3, 2, 5, 3).pixels[..., 0], page.asarray()[2:5, 3:8])


@pytest.mark.parametrize("name", ["GIF", "WEBP", "PNG", "AVIF"])
def test_frames_of_an_animation(name: str) -> None:
    data = animation(name, **({"lossless": True} if name == "WEBP" else {}))
    with Image.open(io.BytesIO(data)) as image, open_source(data) as source:
        assert source.pages == image.n_frames == 3
        for number in (1, 3, 2):
            image.seek(number - 1)
            picture = read(data, page=number)
            expected = np.asarray(image.convert("RGBA" if picture.channels == "rgba" else "RGB"))
            np.testing.assert_array_equal(picture.pixels, expected)


def test_a_still_picture_and_one_frame() -> None:
    still, frame = (Image.new("RGB", (16, 12), colour) for colour in ("red", "blue"))
    data = by_pillow(still, "PNG", save_all=True, append_images=[frame], default_image=True)
    with open_source(data) as source:
        assert source.pages == 2
    assert [read(data, page=page).pixels[3, 3].tolist() for page in (1, 2)] == [[255, 0, 0], [0, 0, 255]]


@pytest.mark.parametrize("options", [{"format": "GIF"}, {"format": "WEBP", "lossless": True}])
def test_frames_that_hold_changes_alone(options: dict[str, Any]) -> None:
    """The first of WebP shows a part of the canvas, the others what moved."""
    ground = (90, 90, 90, 255) if options["format"] == "GIF" else (0, 0, 0, 0)
    frames = [Image.new("RGBA", (32, 24), ground) for _ in range(3)]
    for number, frame in enumerate(frames):
        frame.paste((255, 0, 20, 255), (4 + 3 * number, 5, 14 + 3 * number, 15))
    data = by_pillow(frames[0], save_all=True, append_images=frames[1:], icc_profile=SRGB, **options)
    for number, frame in enumerate(frames, 1):
        picture = read(data, page=number)
        expected = np.asarray(frame)
        np.testing.assert_array_equal(picture.pixels[..., 3], expected[..., 3])
        np.testing.assert_array_equal(picture.pixels[expected[..., 3] > 0], expected[expected[..., 3] > 0])
        assert (picture.metadata.icc is not None) == (options["format"] == "WEBP")


def test_parts_of_exr(tmp_path: Path) -> None:
    specs = tuple(oiio.ImageSpec(8, 4, 1, "float") for _ in range(2))
    image = oiio.ImageOutput.create("x.exr")
    assert image.open(str(tmp_path / "x.exr"), specs)
    assert image.write_image(np.full((4, 8, 1), 0.5, np.float32))
    assert image.open(str(tmp_path / "x.exr"), specs[1], "AppendSubimage")
    assert image.write_image(np.full((4, 8, 1), 2.0, np.float32))
    image.close()
    assert [float(read(tmp_path / "x.exr", page=page).pixels[0, 0, 0]) for page in (None, 1, 2)] == [0.5, 0.5, 2.0]


def test_reductions_and_masks_are_no_pages() -> None:
    file = io.BytesIO()
    with tifffile.TiffWriter(file) as writer:
        for page, kind in (
            (STACK[0, ::2, ::2], 1),
            (STACK[0], 0),
            (STACK[0, ::4, ::4], 1),
            (STACK[1] > 9, 4),
            (STACK[2], 2),
        ):
            writer.write(page, subfiletype=kind, metadata=None, photometric="minisblack")
    with open_source(file.getvalue()) as source:
        assert source.pages == 2
    np.testing.assert_array_equal(read(file.getvalue()).pixels[..., 0], STACK[0])
    np.testing.assert_array_equal(read(file.getvalue(), page=2).pixels[..., 0], STACK[2])


def test_levels_are_no_pages(tmp_path: Path) -> None:
    large = np.repeat(np.repeat(STACK[0], 4, 0), 4, 1)
    for name, description in (("slide", "Aperio Image Library\r\n128x96"), ("pyramid", None)):
        with tifffile.TiffWriter(tmp_path / name) as writer:
            for step in (1, 2, 4):
                options: Any = {"tile": (16, 16), "metadata": None, "photometric": "minisblack"}
                writer.write(large[::step, ::step], description=description if step == 1 else None, **options)
            if description:
                writer.write(STACK[1, :20, :20], metadata=None, photometric="minisblack")
    texture = oiio.ImageBuf(oiio.ImageSpec(64, 48, 3, "uint8"))
    assert oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, texture, str(tmp_path / "texture.tif"))
    for name in ("slide", "pyramid", "texture.tif"):
        with open_source(tmp_path / name) as source:
            assert source.pages == 1


@pytest.mark.parametrize("page", [0, -1, 4])
@pytest.mark.parametrize("data", [tiff(list(STACK)), animation("GIF"), animation("PNG"), animation("AVIF")])
def test_a_page_that_is_not_there(data: bytes, page: int) -> None:
    with pytest.raises(UsageError, match=f"no page {page}; the picture has 3 pages, counted from 1"):
        read(data, page=page)


def test_images_without_a_directory(tmp_path: Path) -> None:
    """ImageJ writes large stacks so: one directory, and all images behind each other."""
    tifffile.imwrite(tmp_path / "x.tif", STACK[0], description="ImageJ=1.53\nimages=7\nslices=7\n", metadata=None)
    with open_source(tmp_path / "x.tif") as source:
        assert source.pages == 7
    with pytest.raises(PictureError, match="its page 2 has no directory of its own"):
        read(tmp_path / "x.tif", page=2)
    with pytest.raises(UsageError, match="no page 8"):
        read(tmp_path / "x.tif", page=8)


def test_a_chain_that_is_damaged_ends_there() -> None:
    data = bytearray(tiff(list(STACK)))
    first, second, third = (page.offset for page in tiff_pages(bytes(data)))
    count = struct.unpack("<H", data[second : second + 2])[0]
    place = slice(second + 2 + 12 * count, second + 6 + 12 * count)
    for wrong in (first, second, len(data) + 9):
        data[place] = struct.pack("<I", wrong)
        assert [page.offset for page in tiff_pages(bytes(data))][:2] == [first, second]
    data[place] = struct.pack("<I", third)
    assert len(tiff_pages(bytes(data))) == 3
    assert tiff_pages(b"II*\0" + bytes(3)) == []
    assert tiff_pages(b"no TIFF") == []
