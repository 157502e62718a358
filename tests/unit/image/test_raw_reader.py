"""Raw files by LibRaw: a DNG of a sensor behind colour filters, made here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from image_files import by_tifffile
from numpy.typing import NDArray
from PIL import Image

from sgicodec import read
from sgicodec.errors import PictureError
from sgicodec.image.reader import probe

BAYER = np.array([[0, 1], [1, 2]])
"""The channel behind each filter."""
NEUTRAL = (0.5, 1.0, 0.625)
"""What the sensor sees of white, which is the camera's white balance."""


def mosaic(red: float, green: float, blue: float) -> NDArray[np.uint16]:
    """What a sensor of 96 × 64 pixels sees of one colour, linear samples in 0..1."""
    seen = np.array([red, green, blue]) * NEUTRAL
    return np.tile(np.rint(60000 * seen[BAYER]).astype(np.uint16), (32, 48))


def dng(sensor: NDArray[np.uint16], turn: int = 1) -> bytes:
    """The file of a camera that sees sRGB's own primaries."""
    srgb_of_xyz = (3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.204, 1.057)
    camera = [value * seen for row, seen in zip(np.reshape(srgb_of_xyz, (3, 3)), NEUTRAL, strict=True) for value in row]

    def ratios(*values: float) -> list[int]:
        return [part for value in values for part in (round(1e4 * value), 10000)]

    tags = [
        *((271, 2, 6, "Maker"), (272, 2, 6, "Model"), (274, 3, 1, turn)),
        *((33421, 3, 2, (2, 2)), (33422, 1, 4, bytes(BAYER.ravel().tolist())), (50706, 1, 4, b"\1\4\0\0")),
        *((50707, 1, 4, b"\1\1\0\0"), (50708, 2, 6, "Model"), (50714, 4, 1, 0), (50717, 4, 1, 60000)),
        *((50721, 10, 9, ratios(*camera)), (50728, 5, 3, ratios(*NEUTRAL)), (50778, 3, 1, 21)),
    ]
    stated = [(*tag, True) for tag in tags]
    return by_tifffile(sensor, photometric="cfa", metadata=None, resolution=(300, 150), extratags=stated)


def srgb(linear: float) -> float:
    return 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055


@pytest.mark.parametrize("colour", [(0.3, 0.3, 0.3), (0.5, 0.3, 0.2)])
def test_colours_are_srgb_in_sixteen_bits(colour: tuple[float, float, float]) -> None:
    picture = read(dng(mosaic(*colour)))
    assert (picture.channels, picture.pixels.dtype, picture.pixels.shape) == ("rgb", np.uint16, (64, 96, 3))
    expected = [65535 * srgb(value) for value in colour]
    np.testing.assert_allclose(picture.pixels[4:-4, 4:-4].mean(axis=(0, 1)), expected, rtol=0.02)


def test_it_is_turned_once_and_keeps_what_its_tags_say() -> None:
    sensor = mosaic(0.3, 0.3, 0.3)
    sensor[:32] //= 4
    data = dng(sensor, turn=6)
    assert probe(data).width == 64
    picture = read(data)
    assert picture.pixels.shape == (96, 64, 3)
    assert picture.pixels[:, :24].mean() > 1.5 * picture.pixels[:, 40:].mean()
    kept = Image.Exif()
    kept.load(picture.metadata.exif)
    assert (kept.get(274, 1), kept[271], kept[272]) == (1, "Maker", "Model")
    assert (kept[282], kept[283]) == (150, 300)


def test_damage(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.dng").write_bytes(dng(mosaic(0.3, 0.3, 0.3))[:-4000])
    with pytest.raises(PictureError, match=r"a\.dng: the file is damaged or cut off: Input/output error"):
        read(tmp_path / "a.dng")
    assert capfd.readouterr().err == ""
