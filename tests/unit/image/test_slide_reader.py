"""Slides by OpenSlide: pixels, size of a pixel, background; what is said of files that only seem to be slides."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import openslide
import pytest
import tifffile
from click.testing import CliRunner, Result
from PIL import Image
from range_server import served

import sgicodec
from sgicodec.cli.main import cli
from sgicodec.errors import MissingExtraError, PictureError
from sgicodec.image import slide_reader
from sgicodec.image.slide_reader import is_slide
from sgicodec.metadata.georeference import resolution
from sgicodec.metadata.tiff import DESCRIPTION, described
from sgicodec.plugins.openslide import Slide
from sgicodec.plugins.pyramid import write_pyramid

WIDTH, HEIGHT = 700, 300


@pytest.fixture(scope="module")
def pixels() -> np.ndarray:
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    return np.stack([120 + 100 * np.sin(x / 60), 120 + 90 * np.cos(y / 50), (x + y) / 5], axis=2).astype(np.uint8)


@pytest.fixture(scope="module")
def slide(pixels: np.ndarray, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """As Aperio's scanners write them with JPEG 2000: with a thumbnail, a label and a macro."""
    path = tmp_path_factory.mktemp("slide") / "a.svs"
    with tifffile.TiffWriter(path) as file:
        text = "Aperio Image Library v11.0.37\n700x300 (256x256) J2K/YUV16 Q=70|AppMag = 40|MPP = 0.2525"
        options = {"compression": "APERIO_JP2000_RGB", "compressionargs": {"level": 0}, "photometric": "rgb"}
        file.write(pixels, tile=(256, 256), description=text, metadata=None, **options)
        for name, level, kind in (("", 200, 0), ("label ", 90, 1), ("macro ", 120, 9)):
            small = np.full((40, 60, 3), level, np.uint8)
            text = f"Aperio Image Library v11.0.37\n{name}60x40"
            file.write(small, description=text, metadata=None, photometric="rgb", subfiletype=kind)
    return path


def test_openslide_knows_the_slide(slide: Path) -> None:
    with openslide.OpenSlide(slide) as found:
        assert found.properties["openslide.vendor"] == "aperio"
        assert sorted(found.associated_images) == ["label", "macro", "thumbnail"]


def test_pixels_and_their_size(slide: Path, pixels: np.ndarray) -> None:
    assert is_slide(slide)
    picture = sgicodec.read(slide)
    assert (picture.channels, picture.pixels.dtype) == ("rgb", np.uint8)
    assert np.abs(picture.pixels.astype(int) - pixels).mean() < 1.5
    found = resolution(picture.metadata.geo, picture.metadata.exif)
    assert found is not None
    assert found.microns == pytest.approx((0.2525, 0.2525), rel=1e-8)
    assert described(picture.metadata.exif)[DESCRIPTION].data == b"aperio|AppMag = 40\0"


def test_the_objective_is_kept_and_texts_are_not(slide: Path, tmp_path: Path) -> None:
    sgicodec.imwrite(tmp_path / "a.sgi", slide, steps=1)
    with Slide(tmp_path / "a.sgi") as found, openslide.OpenSlide(slide) as original:
        name = "openslide.objective-power"
        assert found.properties[name] == original.properties[name] == "40"
        assert found.properties["openslide.comment"] == "aperio|AppMag = 40"
    with sgicodec.open(tmp_path / "a.sgi") as stream:
        write_pyramid(stream, tmp_path / "a.tif")
    with openslide.OpenSlide(tmp_path / "a.tif") as pyramid:
        assert pyramid.properties["openslide.comment"] == "aperio|AppMag = 40"
    sgicodec.imwrite(tmp_path / "b.sgi", tmp_path / "a.tif", steps=1)
    with Slide(tmp_path / "b.sgi") as again:
        assert again.properties[name] == "40"


@pytest.mark.parametrize("power", ["", "none", "40x", "1e3", "John Doe", "40000", "-4"])
def test_magnifications_that_are_none(power: str) -> None:
    given = {"openslide.vendor": "aperio", "openslide.objective-power": power}
    assert slide_reader._description(given) is None


def test_windows(slide: Path) -> None:
    whole = sgicodec.read(slide).pixels
    with sgicodec.open_source(slide) as source:
        for x, y, width, height in ((0, 0, 700, 20), (500, 250, 200, 50), (255, 17, 2, 280)):
            np.testing.assert_array_equal(source.read(x, y, width, height).pixels, whole[y : y + height, x : x + width])


def test_a_slide_becomes_a_stream(slide: Path, tmp_path: Path) -> None:
    sgicodec.imwrite(tmp_path / "a.sgi", slide, steps=2, tile=512)
    with sgicodec.open(tmp_path / "a.sgi") as stream:
        assert stream.shape == (300, 700, 3)
        found = resolution(stream.metadata.geo, stream.metadata.exif)
        assert found is not None
        assert found.microns == pytest.approx((0.2525, 0.2525), rel=1e-8)


def test_label_and_macro_as_files(slide: Path, tmp_path: Path) -> None:
    def encode(*options: object) -> Result:
        arguments = ["encode", slide, tmp_path / "b.sgi", "--steps", 1, "--quiet", "--associated", *options]
        return CliRunner().invoke(cli, list(map(str, arguments)))

    assert encode("--no-verify").exit_code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["b.label.png", "b.macro.png", "b.sgi"]
    assert (sgicodec.read(tmp_path / "b.label.png").pixels == 90).all()
    assert Slide(tmp_path / "b.sgi").associated_images["macro"].getpixel((5, 5)) == (120, 120, 120, 255)
    (tmp_path / "b.sgi").unlink()
    again = encode("--no-verify")
    assert (again.exit_code, "b.label.png exists" in again.output) == (6, True)
    assert not (tmp_path / "b.sgi").exists()
    no_slide = CliRunner().invoke(cli, ["encode", str(tmp_path / "b.label.png"), "--associated"])
    text = "it is no slide that OpenSlide reads; --associated takes the label and the macro of slides"
    assert (no_slide.exit_code, text in no_slide.output) == (3, True)


@pytest.mark.parametrize("names", [("label", "macro"), ("macro",), ()])
def test_what_a_slide_has_beside_its_levels_is_told(pixels: np.ndarray, tmp_path: Path, names: tuple[str, ...]) -> None:
    kinds = {"thumbnail": 0, "label": 1, "macro": 9}
    with tifffile.TiffWriter(tmp_path / "a.svs") as file:
        text = "Aperio Image Library v11.0.37\n700x300 (256x256)"
        file.write(pixels, tile=(256, 256), description=text, metadata=None, photometric="rgb")
        for name in ("thumbnail", *names):
            small, text = np.zeros((40, 60, 3), np.uint8), f"Aperio Image Library v11.0.37\n{name} 60x40"
            file.write(small, description=text, metadata=None, photometric="rgb", subfiletype=kinds[name])
    arguments = ["encode", str(tmp_path / "a.svs"), "--steps", "1", "--no-verify", "--associated"]
    result = CliRunner().invoke(cli, arguments)
    assert result.exit_code == 0
    told = [line.split(" pixels")[0] for line in result.stdout.splitlines() if ".png" in line]
    assert told == [f"{tmp_path / f'a.{name}.png'}: 60×40" for name in names]
    none = f"sgi: {tmp_path / 'a.svs'}: the slide has no label and no macro for --associated to write\n"
    assert result.stderr == ("" if names else none)
    quiet = CliRunner().invoke(cli, [*arguments, str(tmp_path / "b.sgi"), "--quiet"])
    assert (quiet.exit_code, quiet.output) == (0, "")


def test_files_beside_an_out_that_nobody_named_replace_none(slide: Path, tmp_path: Path) -> None:
    (tmp_path / "a.svs").write_bytes(slide.read_bytes())
    (tmp_path / "a.label.png").write_bytes(b"mine")
    arguments = ["encode", str(tmp_path / "a.svs"), "--steps", "1", "--quiet", "--no-verify", "--associated", "-f"]
    assert CliRunner().invoke(cli, arguments).exit_code == 6
    assert (tmp_path / "a.label.png").read_bytes() == b"mine"
    assert CliRunner().invoke(cli, [*arguments, str(tmp_path / "a.sgi")]).exit_code == 0
    assert (sgicodec.read(tmp_path / "a.label.png").pixels == 90).all()


def test_slides_behind_urls(slide: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A copy keeps the ending by which a slide is known."""
    monkeypatch.chdir(tmp_path)
    with served({"a.svs": slide.read_bytes()}) as server:
        url = f"{server.url}/a.svs"
        np.testing.assert_array_equal(sgicodec.read(url).pixels, sgicodec.read(slide).pixels)
        done = CliRunner().invoke(cli, ["encode", url, "--steps", "1", "--quiet", "--associated"])
    assert done.exit_code == 0, done.output
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.label.png", "a.macro.png", "a.sgi"]


def test_other_compressions_are_left_to_openimageio(tmp_path: Path, pixels: np.ndarray) -> None:
    options = {"tile": (256, 256), "photometric": "rgb", "metadata": None, "compression": "zlib"}
    tifffile.imwrite(tmp_path / "a.svs", pixels, description="Aperio Image Library|MPP = 0.5", **options)
    assert not is_slide(tmp_path / "a.svs")
    np.testing.assert_array_equal(sgicodec.read(tmp_path / "a.svs").pixels, pixels)
    (tmp_path / "b.svs").write_bytes(b"no TIFF")
    assert not is_slide(tmp_path / "b.svs")


class Scan(SimpleNamespace):
    """A slide of MIRAX, of whose canvas a part was scanned."""

    def __init__(self, path: Path) -> None:
        bounds = {"x": 100, "y": 50, "width": 60, "height": 40}
        super().__init__(
            properties={f"openslide.bounds-{name}": str(value) for name, value in bounds.items()}
            | {"openslide.mpp-x": "0.25", "openslide.mpp-y": "none", "openslide.background-color": "0a1400"},
            dimensions=(1000, 900),
            color_profile=None,
        )

    def read_region(self, location: tuple[int, int], level: int, size: tuple[int, int]) -> Image.Image:
        assert level == 0
        x, y = np.meshgrid(location[0] + np.arange(size[0]), location[1] + np.arange(size[1]))
        rgba = np.stack([x, y, 0 * x, np.where(x < 130, 255, 0)], axis=2)
        return Image.fromarray(rgba.astype(np.uint8))

    def close(self) -> None:
        pass


@pytest.fixture
def scanned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(openslide, "OpenSlide", Scan)
    (tmp_path / "a.MRXS").write_bytes(b"")
    (tmp_path / "a").mkdir()
    return tmp_path / "a.MRXS"


def test_the_scanned_part_on_its_background(scanned: Path) -> None:
    picture = sgicodec.read(scanned)
    assert picture.pixels.shape == (40, 60, 3)
    assert picture.pixels[0, 0].tolist() == [100, 50, 0]
    assert picture.pixels[39, 29].tolist() == [129, 89, 0]
    assert picture.pixels[39, 30].tolist() == [10, 20, 0]
    assert picture.metadata.geo is None


def test_what_goes_wrong(tmp_path: Path, slide: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.ndpi").write_bytes(b"II*\0nothing of the kind")
    with pytest.raises(PictureError, match=r"^[^:]*a\.ndpi: it is no slide that OpenSlide reads"):
        sgicodec.read(tmp_path / "a.ndpi")
    (tmp_path / "cut.svs").write_bytes(slide.read_bytes())
    with tifffile.TiffFile(slide) as file:
        start, count = file.pages[0].dataoffsets[0], file.pages[0].databytecounts[0]
    with (tmp_path / "cut.svs").open("r+b") as file:
        file.seek(start)
        file.write(bytes(count))
    with pytest.raises(PictureError, match=r"cut\.svs: OpenSlide cannot read it: "):
        sgicodec.read(tmp_path / "cut.svs")
    monkeypatch.setitem(sys.modules, "openslide", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'sgicodec\[slides\]'"):
        sgicodec.read(slide)


@pytest.mark.parametrize(
    ("microns", "expected"),
    [(["0.25", "0.5"], (0.25, 0.5)), (["0.2325", "0.2325"], (0.2325, 0.2325)), (["120", "1e3"], (120, 1000))],
)
def test_resolutions(microns: list[str], expected: tuple[float, float]) -> None:
    found = resolution(slide_reader._resolution(microns), None)
    assert found is not None
    assert found.microns == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("microns", [["0", "1"], ["-1", "1"], ["inf", "1"], ["x", "1"], [None, "1"], ["1e-9", "1"]])
def test_resolutions_that_are_none(microns: list[str]) -> None:
    assert slide_reader._resolution(microns) is None
