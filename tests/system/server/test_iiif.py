"""IIIF Image API 3, against what `sgi decode` draws and what the standard demands, and Deep Zoom."""

from __future__ import annotations

import io
import json
from pathlib import Path
from urllib.parse import quote
from xml.etree import ElementTree

import numpy as np
import pytest
from command import done
from http_server import Answer, Client
from PIL import Image

import sgicodec
from sgicodec.metadata.blobs import Metadata
from sgicodec.picture import Picture
from sgicodec.server.drawing import Drawing, drawn

TILES = "/iiif/3/rgb8-tiles.sgi"
WIDE = "/iiif/3/wide.sgi"


def pixels(answer: Answer) -> np.ndarray:
    assert answer.status == 200, answer.text
    return np.asarray(Image.open(io.BytesIO(answer.body)))


def decoded(stream: Path, folder: Path, *options: object) -> np.ndarray:
    """What the command draws."""
    target = folder / "decoded.png"
    done("decode", stream, target, "--depth", 8, "-f", "--quiet", *options)
    return np.asarray(Image.open(target))


@pytest.mark.parametrize("name", ["rgb8-tiles.sgi", "gray16.sgi", "sub dir/räume & <b>.sgi", "gray8-alpha.sgi"])
@pytest.mark.parametrize(
    ("region", "size", "options"),
    [
        ("full", "max", []),
        ("8,4,24,16", "^96,64", ["--region", "8,4,24,16", "--scale", "4"]),
        ("0,0,30,20", "15,10", ["--region", "0,0,30,20", "--scale", "1/2"]),
        ("full", "!20,20", ["--size", "20x20"]),
    ],
)
def test_pixels_are_those_of_the_command(
    get: Client, folder: Path, tmp_path: Path, name: str, region: str, size: str, options: list[str]
) -> None:
    found = pixels(get(f"/iiif/3/{quote(name, safe='')}/{region}/{size}/0/default.png"))
    assert np.array_equal(found, decoded(folder / name, tmp_path, *options))


@pytest.mark.parametrize(
    ("size", "expected"),
    [
        *(("max", (1100, 40)), ("550,", (550, 20)), (",20", (550, 20)), ("pct:50", (550, 20))),
        *(("300,30", (300, 30)), ("!300,30", (300, 11)), ("!5000,5000", (1100, 40)), ("^!2200,2200", (1898, 69))),
        *(("^1500,", (1500, 55)), ("^pct:120", (1320, 48)), ("^max", (1898, 69)), ("1,", (1, 1))),
    ],
)
def test_sizes(get: Client, size: str, expected: tuple[int, int]) -> None:
    assert Image.open(io.BytesIO(get(f"{WIDE}/full/{size}/0/default.jpg").body)).size == expected


@pytest.mark.parametrize(
    ("region", "box"),
    [
        *(
            ("square", (530, 0, 570, 40)),
            ("pct:50,25,10,50", (550, 10, 660, 30)),
            ("1000,30,500,500", (1000, 30, 1100, 40)),
        ),
        *(("pct:0,0,100,100", (0, 0, 1100, 40)), ("1099,39,1,1", (1099, 39, 1100, 40))),
        ("1000,30,99999999999999999999,500", (1000, 30, 1100, 40)),
    ],
)
def test_regions(get: Client, folder: Path, region: str, box: tuple[int, int, int, int]) -> None:
    left, top, right, bottom = box
    expected = sgicodec.imread(folder / "wide.sgi", region=(left, top, right - left, bottom - top))
    assert np.array_equal(pixels(get(f"{WIDE}/{region}/max/0/default.png")), expected)


@pytest.mark.parametrize("rotation", ["0", "90", "180", "270", "!0", "!90", "!180", "360", "90.0"])
def test_rotations(get: Client, rotation: str) -> None:
    plain = Image.fromarray(pixels(get(f"{TILES}/full/max/0/default.png")))
    if rotation.startswith("!"):
        plain = plain.transpose(Image.Transpose.FLIP_LEFT_RIGHT)
    turned = plain.rotate(-float(rotation.removeprefix("!")), expand=True)
    assert np.array_equal(pixels(get(f"{TILES}/full/max/{rotation}/default.png")), np.asarray(turned))


@pytest.mark.parametrize("name", ["rgb8-tiles.sgi", "gray16.sgi", "gray8-alpha.sgi", "multi8.sgi", "float.sgi"])
def test_qualities_and_formats(get: Client, name: str) -> None:
    kinds = {"jpg": "JPEG", "png": "PNG", "webp": "WEBP", "tif": "TIFF"}
    media = {"jpg": "image/jpeg", "png": "image/png", "webp": "image/webp", "tif": "image/tiff"}
    for format_, kind in kinds.items():
        for quality in ("default", "color", "gray", "bitonal"):
            answer = get(f"/iiif/3/{name}/full/max/0/{quality}.{format_}")
            image = Image.open(io.BytesIO(answer.body))
            assert (answer.headers["content-type"], image.format) == (media[format_], kind)
            if quality == "bitonal" and format_ in ("png", "tif"):
                assert image.mode == "1"
            if quality == "gray" and format_ != "webp":
                assert image.mode in ("L", "LA")


@pytest.mark.parametrize(("channels", "space"), [("gray", b"GRAY"), ("rgb", b"RGB ")])
def test_profiles_are_those_of_the_samples(channels: str, space: bytes) -> None:
    profile = bytes(16) + space + bytes(108)
    samples = np.full((8, 8, 1 if channels == "gray" else 3), 90, np.uint8)
    picture = Picture(samples, channels, (0.0, 255.0), Metadata(icc=profile))
    with sgicodec.open(sgicodec.encode(picture, steps=1)) as stream:
        for format_ in ("jpg", "png", "webp", "tif"):
            image = Image.open(io.BytesIO(drawn(stream, Drawing((0, 0, 8, 8), (8, 8), format_))))
            assert ("icc_profile" in image.info) == ((image.mode == "L") == (channels == "gray"))


@pytest.mark.parametrize(
    ("path", "status"),
    [
        *(
            ("1100,0,1,1/max/0/default.jpg", 400),
            ("0,0,0,5/max/0/default.jpg", 400),
            ("a,b,c,d/max/0/default.jpg", 400),
        ),
        *(("-1,0,5,5/max/0/default.jpg", 400), ("pct:0,0,0,0/max/0/default.jpg", 400), ("full/0,/0/default.jpg", 400)),
        *(("full/2200,/0/default.jpg", 400), ("full/pct:101/0/default.jpg", 400), ("full/,/0/default.jpg", 400)),
        *(("full/^9999,9999/0/default.jpg", 400), ("full/full/0/default.jpg", 400), ("full/!0,5/0/default.jpg", 400)),
        *(("full/max/45/default.jpg", 501), ("full/max/361/default.jpg", 400), ("full/max/x/default.jpg", 400)),
        *(("full/max/0/native.jpg", 400), ("full/max/0/default.gif", 501), ("full/max/0/default.xyz", 400)),
        *(
            ("٠,0,5,5/max/0/default.jpg", 400),
            ("full/٩,/0/default.jpg", 400),
            (f"full/^{'9' * 99},/0/default.jpg", 400),
        ),
        *(("full/^65501,1/0/default.jpg", 400), ("full/^16384,1/0/default.webp", 400)),
        *(("full/max/0/default", 404), ("full/max/0", 404), ("full/99999999999999999999,/0/default.jpg", 400)),
    ],
)
def test_errors(get: Client, path: str, status: int) -> None:
    answer = get(f"{WIDE}/{quote(path, safe='/,:!^')}")
    assert answer.status == status
    assert answer.headers["content-type"].startswith("text/plain")
    assert answer.text.strip()


def test_information(get: Client) -> None:
    answer = get(f"{WIDE}/info.json")
    found = json.loads(answer.body)
    assert answer.headers["content-type"].startswith("application/ld+json")
    assert 'rel="profile"' in answer.headers["link"]
    assert found["id"] == f"{get.address}{WIDE}"
    assert (found["type"], found["profile"], found["width"], found["height"]) == ("ImageService3", "level2", 1100, 40)
    assert found["@context"] == "http://iiif.io/api/image/3/context.json"
    assert found["maxArea"] == 1 << 17
    for size in found["sizes"]:
        image = pixels(get(f"{WIDE}/full/{size['width']},{size['height']}/0/default.png"))
        assert image.shape[:2] == (size["height"], size["width"])
    plain = get(f"{WIDE}/info.json", Accept="application/json")
    assert plain.headers["content-type"] == "application/json"
    assert json.loads(plain.body) == found


def test_tiles_make_up_the_picture(get: Client, folder: Path) -> None:
    found = json.loads(get(f"{WIDE}/info.json").body)
    [tiles] = found["tiles"]
    whole = np.concatenate(
        [
            pixels(get(f"{WIDE}/{x},0,{min(tiles['width'], 1100 - x)},40/max/0/default.png"))
            for x in range(0, 1100, tiles["width"])
        ],
        axis=1,
    )
    assert np.array_equal(whole, sgicodec.imread(folder / "wide.sgi"))
    for factor in tiles["scaleFactors"]:
        width, height = -(-1100 // factor), -(-40 // factor)
        assert pixels(get(f"{WIDE}/full/{width},{height}/0/default.png")).shape[:2] == (height, width)


SPACE = "{http://schemas.microsoft.com/deepzoom/2008}"


def test_levels_and_tiles_of_deep_zoom(get: Client, folder: Path) -> None:
    root = ElementTree.fromstring(get("/dzi/wide.sgi.dzi").body)
    side, size = int(root.attrib["TileSize"]), root.find(f"{SPACE}Size")
    assert size is not None
    assert (root.attrib["Format"], root.attrib["Overlap"]) == ("jpg", "0")
    width, height = int(size.attrib["Width"]), int(size.attrib["Height"])
    assert (width, height) == (1100, 40)
    for level in range(12):
        across, down = (-(-length >> (11 - level)) for length in (width, height))
        tiles = []
        for column in range(-(-across // side)):
            answer = get(f"/dzi/wide.sgi_files/{level}/{column}_0.png")
            tiles.append(np.asarray(Image.open(io.BytesIO(answer.body))))
        assert get(f"/dzi/wide.sgi_files/{level}/{column + 1}_0.png").status == 404
        assert get(f"/dzi/wide.sgi_files/{level}/0_1.png").status == 404
        whole = np.concatenate(tiles, axis=1)
        assert whole.shape[:2] == (down, across)
    assert np.array_equal(whole, sgicodec.imread(folder / "wide.sgi"))
    assert Image.open(io.BytesIO(get("/dzi/wide.sgi_files/11/0_0.jpg").body)).format == "JPEG"


@pytest.mark.parametrize("path", ["wide.sgi_files/12/0_0.jpg", "wide.sgi_files/11/0_0.gif", "wide_files/1/0_0.jpg"])
def test_what_deep_zoom_has_not(get: Client, path: str) -> None:
    assert get(f"/dzi/{path}").status == 404
