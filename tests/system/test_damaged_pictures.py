"""Picture files whose bytes were changed at random: a picture, or an SgiError, and nothing else."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pillow_heif
import pytest
from image_files import by_pillow, by_tifffile, save
from PIL import Image

from sgicodec import SgiError, open_source

PIXELS = np.random.default_rng(4).integers(0, 256, (48, 64, 3)).astype(np.uint8)
TRIES = 400
EXTREMES = (b"\0\0\0\0", b"\xff\xff\xff\xff", b"\0\0\0\1", b"\x7f\xff\xff\xff")


def heif(_: Path) -> bytes:
    file = io.BytesIO()
    pillow_heif.from_pillow(Image.fromarray(PIXELS)).save(file)
    return file.getvalue()


MADE = {
    **{end: lambda path: by_pillow(PIXELS, path.suffix[1:]) for end in ("png", "jpeg", "webp", "avif", "gif", "bmp")},
    **{end: lambda path: save(path, PIXELS).read_bytes() for end in ("jp2", "jxl", "tga", "dpx", "fits", "ppm")},
    **{end: lambda path: save(path, PIXELS.astype(np.float32)).read_bytes() for end in ("exr", "hdr")},
    "heic": heif,
    "tiff": lambda _: by_pillow(PIXELS, "TIFF"),
    "tif": lambda _: by_tifffile(PIXELS, tile=(16, 16), compression="zlib", metadata={"axes": "YXS"}),
}


def changed(data: bytes, rng: np.random.Generator) -> bytes:
    found = bytearray(data)
    for _ in range(rng.integers(1, 6)):
        at = int(rng.integers(min(len(found), rng.choice([64, 400, 10**6]))))
        match rng.integers(4):
            case 0:
                found[at : at + 4] = EXTREMES[rng.integers(len(EXTREMES))]
            case 1:
                del found[at : at + int(rng.integers(1, 50))]
            case _:
                found[at] = rng.integers(256)
        found = found or bytearray(1)
    return bytes(found)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("kind", MADE)
def test_damage_is_an_error_of_ours(kind: str, tmp_path: Path) -> None:
    path, rng = tmp_path / f"a.{kind}", np.random.default_rng(5)
    whole, errors = MADE[kind](path), []
    for _ in range(TRIES):
        path.write_bytes(changed(whole, rng))
        try:
            with open_source(path, max_samples=1 << 24) as source:
                assert isinstance(source.notes, tuple)
                source.read(0, 0, source.width, source.height)
        except SgiError as error:
            errors.append(str(error))
    assert errors
    assert not [said for said in errors if "\n" in said]
