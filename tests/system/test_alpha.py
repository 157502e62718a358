"""What an encode does with alpha: masks, bands, and an alpha that hides everything."""

from __future__ import annotations

from pathlib import Path
from unittest.mock import Mock, call

import numpy as np
import pytest
from command import done
from data_files import crop
from tags import TIED, geo_of, text

from sgicodec import EncodeSettings, NullListener, Picture, decode, encode_picture, open_source, read, write
from sgicodec.decoder.stream import open_stream
from sgicodec.image.source import LIGHT, NO_OPACITY, open_to_encode
from sgicodec.picture import Metadata, full_range

TILES = [0, 64]


@pytest.fixture(scope="module")
def colours() -> np.ndarray:
    return crop("kodim23", np.s_[100:180, 150:250]).pixels


def with_alpha(colours: np.ndarray, alpha: int) -> np.ndarray:
    return np.dstack([colours, np.full(colours.shape[:2], alpha, np.uint8)])


@pytest.mark.parametrize("tile", TILES)
def test_colours_are_kept_where_alpha_hides_them_all(tmp_path: Path, colours: np.ndarray, tile: int) -> None:
    listener, settings = Mock(wraps=NullListener()), EncodeSettings(steps=20, tile=tile)
    write(Picture(with_alpha(colours, 0), "rgba", (0.0, 255.0)), tmp_path / "x.png")
    with open_source(tmp_path / "x.png") as source:
        encoded = encode_picture(source, settings, progress=listener, verify=True)
    assert listener.note.mock_calls == [call("alpha is 0 everywhere; it is left out, and the colours are kept")]
    assert encoded.data == encode_picture(Picture(colours, "rgb", (0.0, 255.0)), settings).data
    assert np.abs(decode(encoded.data).astype(int) - colours).mean() < 12


@pytest.mark.parametrize("tile", TILES)
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_alpha_that_is_opaque_everywhere_is_left_out(colours: np.ndarray, tile: int, dtype: type) -> None:
    listener, settings, high = Mock(wraps=NullListener()), EncodeSettings(steps=5, tile=tile), full_range(dtype)[1]
    pixels = (with_alpha(colours, 255) * (high / 255)).astype(dtype)
    encoded = encode_picture(Picture(pixels, "rgba", (0.0, high)), settings, progress=listener, verify=True)
    assert listener.remark.mock_calls == [call("alpha is opaque everywhere; it is left out")]
    assert listener.note.mock_calls == []
    assert encoded.data == encode_picture(Picture(pixels[..., :3], "rgb", (0.0, high)), settings).data


@pytest.mark.parametrize("tile", TILES)
@pytest.mark.parametrize("how", [["--steps", 5], ["--lossless"]])
def test_light_without_a_body(tmp_path: Path, colours: np.ndarray, how: list[object], tile: int) -> None:
    """Colours where alpha is 0, which EXR adds to what lies behind. A filling would be a bright cloud there."""
    pixels = np.dstack([colours / np.float32(255), np.ones((80, 100), np.float32)])
    pixels[:40] = 0
    write(Picture(pixels, "rgba", (0.0, 1.0)), tmp_path / "dark.exr")
    pixels[9:20, 9:20, :3] = (2, 1, 0)
    write(Picture(pixels, "rgba", (0.0, 2.0)), tmp_path / "light.exr")
    for name in ("dark", "light"):
        stream = tmp_path / f"{name}.sgi"
        said = done("encode", tmp_path / f"{name}.exr", *how, "--tile", tile, "-j", 1).stderr
        assert (LIGHT in said) == (name == "light")
        done("decode", stream, tmp_path / "back.exr", "-f")
        is_exact = how == ["--lossless"]
        found = read(tmp_path / "back.exr").pixels[:40]
        np.testing.assert_array_equal(found, read(tmp_path / f"{name}.exr").pixels[:40] if is_exact else 0)
        done("decode", stream, tmp_path / "back.exr", "-f", "--scale", 2)
        assert not read(tmp_path / "back.exr").pixels[:70].any()


@pytest.mark.parametrize("tile", TILES)
def test_what_is_opaque_beside_other_alpha_stays_opaque(colours: np.ndarray, tile: int) -> None:
    """A soft edge between an empty and an opaque side."""
    pixels = with_alpha(colours, 255)
    pixels[..., 3] = np.clip(8 * (np.arange(100) - 40), 0, 255)
    picture = Picture(pixels, "rgba", (0.0, 255.0))
    alpha = decode(encode_picture(picture, EncodeSettings(effort=1, tile=tile)).data)[..., 3].astype(int)
    assert not alpha[:, :41].any()
    assert (alpha[:, 74:] == 255).mean() > 0.995
    assert np.abs(alpha[:, 41:72] - pixels[:, 41:72, 3]).mean() < 8


@pytest.mark.parametrize("tile", TILES)
@pytest.mark.parametrize("nodata", [False, True])
def test_a_stream_of_nothing_says_so(tile: int, nodata: bool) -> None:
    listener, pixels = Mock(wraps=NullListener()), np.zeros((70, 80, 4), np.uint8)
    metadata = Metadata(geo=geo_of({**TIED, 42113: text("0")})) if nodata else Metadata()
    picture = Picture(pixels[..., :3] if nodata else pixels, "rgb" if nodata else "rgba", (0.0, 255.0), metadata)
    encode_picture(picture, EncodeSettings(steps=5, tile=tile), progress=listener)
    what = "every pixel has the nodata value" if nodata else "alpha is 0 everywhere and there are no colours"
    assert listener.note.mock_calls == [call(f"{what}; the stream holds no picture")]


@pytest.mark.parametrize("nodata", [None, "0"])
def test_near_infrared_that_is_declared_as_alpha(tmp_path: Path, colours: np.ndarray, nodata: str | None) -> None:
    """A satellite's fourth band may be declared as alpha. It is told, and as a band it hides nothing."""
    infrared = colours[..., :1] // 2
    infrared[20:60, 20:80] = 0
    pixels = np.concatenate([colours, infrared], axis=2)
    tags = TIED if nodata is None else {**TIED, 42113: text(nodata)}
    write(Picture(pixels, "rgba", (0.0, 255.0), Metadata(geo=geo_of(tags))), tmp_path / "x.tif")
    errors = {}
    for alpha in ("auto", "band"):
        listener = Mock(wraps=NullListener())
        with open_source(tmp_path / "x.tif", alpha=alpha) as source:
            data = encode_picture(source, EncodeSettings(quality=70, steps=30), progress=listener).data
        found = open_stream(data).picture()
        errors[alpha] = np.abs(found.pixels.astype(int) - pixels)[25:55, 25:75, :3].mean()
        told = [
            "the last band is declared as alpha",
            "there is a nodata value besides alpha: alpha is lossy, also where",
        ]
        told = told[: 1 if nodata is None else 2] if alpha == "auto" else []
        said = [one.args[0] for one in listener.note.mock_calls]
        assert [one.startswith(text) for one, text in zip(said, told, strict=True)] == [True] * len(told)
    assert found.channels == "multi"
    assert errors["band"] < 6
    assert nodata is not None or errors["auto"] > 2 * errors["band"]


@pytest.mark.parametrize(("name", "channels"), [("x.png", "rgba"), ("x.tif", "multi"), ("x.jp2", "multi")])
def test_alpha_of_16_bits_that_is_opaque_nowhere(tmp_path: Path, colours: np.ndarray, name: str, channels: str) -> None:
    """Near infrared in TIFF and JPEG 2000; that of PNG is alpha, and PNG could not hold it as a band."""
    pixels = np.dstack([colours, colours[..., 0] // 2]).astype(np.uint16) * 100
    write(Picture(pixels, "rgba", (0.0, 65535.0)), tmp_path / name)
    said: list[str] = []
    with open_to_encode(tmp_path / name, said.append) as source:
        assert source.channels == channels
    assert said == ([] if channels == "rgba" else [NO_OPACITY])
