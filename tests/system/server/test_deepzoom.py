"""Deep Zoom: levels and tiles of a picture."""

from __future__ import annotations

import io
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from http_server import Client
from PIL import Image

import sgicodec

SPACE = "{http://schemas.microsoft.com/deepzoom/2008}"


def test_levels_and_tiles(get: Client, folder: Path) -> None:
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
def test_what_is_not_there(get: Client, path: str) -> None:
    assert get(f"/dzi/{path}").status == 404
