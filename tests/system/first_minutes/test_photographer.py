"""The first minutes of a photographer: streams of photographs, and a page of them in Chromium."""

from __future__ import annotations

import functools
import json
import os
import shutil
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
import pytest
from data_files import ROOT
from newcomer import Newcomer
from PIL import Image

import sgicodec
from sgicodec.server.viewer import missing_decoder, viewer_folder

VIEWER = viewer_folder()
BROWSERS = (os.environ.get("CHROMIUM"), *map(shutil.which, ("chromium", "chromium-browser", "google-chrome")))
HAS_PAGE = (
    VIEWER is not None
    and missing_decoder(VIEWER) is None
    and shutil.which("node") is not None
    and any(BROWSERS)
    and (ROOT / "viewer" / "node_modules" / "playwright-core").is_dir()
)

pytestmark = pytest.mark.slow


@pytest.fixture
def photographer(newcomer: Newcomer) -> Newcomer:
    """Has two photographs as cameras write them, turned by EXIF."""
    exif = Image.Exif()
    exif[274], exif[271] = 6, "A camera"  # orientation, make
    for name in ("kodim13", "kodim23"):
        pixels = sgicodec.read(ROOT / "tests" / "data" / f"{name}.png").pixels[100:400, 100:600]
        Image.fromarray(np.rot90(pixels)).save(newcomer.home / f"{name}.jpg", quality=95, exif=exif)
    newcomer.install()
    return newcomer


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address of a plain static server of a folder, which sends no ranges."""

    class Handler(SimpleHTTPRequestHandler):
        def log_message(self, format: str, *args: object) -> None: ...

    with ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=str(folder))) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_address[1]}/"
        finally:
            server.shutdown()
            thread.join()


def test_photographs_and_back(photographer: Newcomer, reached: Callable[[str], None]) -> None:
    """As the README says: upright, with what the camera said, and smaller."""
    photographer.run("sgi", "encode", "kodim13.jpg", "kodim23.jpg", "--output-dir", "streams")
    photographer.run("sgi", "decode", "streams/kodim13.sgi", "decoded.jpg")
    reached("two photographs as streams, one as a JPEG again")
    decoded, source = (Image.open(photographer.home / name) for name in ("decoded.jpg", "kodim13.jpg"))
    assert (decoded.size, decoded.getexif()[271], decoded.getexif().get(274, 1)) == ((500, 300), "A camera", 1)
    error = np.asarray(decoded).astype(int) - np.rot90(np.asarray(source), -1)
    assert np.abs(error).mean() < 12
    size = (photographer.home / "streams" / "kodim13.sgi").stat().st_size
    assert size < (photographer.home / "kodim13.jpg").stat().st_size / 4


@pytest.mark.skipif(not HAS_PAGE, reason="needs make test-viewer's node modules, Chromium and the viewer's WebAssembly")
def test_a_page_of_them(photographer: Newcomer, reached: Callable[[str], None]) -> None:
    gallery, look = ROOT / "examples" / "web_gallery.py", Path(__file__).with_name("look.js")
    photographer.run("python", gallery, "kodim13.jpg", "kodim23.jpg", "--out", "made")
    with served(photographer.home / "made") as address:
        found = json.loads(photographer.run("node", look, address, "shot.png"))
    reached("a page of two photographs in Chromium")
    assert found["errors"] == []
    assert found["viewed"] == "kodim13.jpg.sgi"
    assert [0 < picture["width"] < 500 for picture in found["pictures"]] == [True, True]
    seen = np.asarray(Image.open(photographer.home / "shot.png").convert("RGB")).astype(int)
    height, width = seen.shape[:2]
    stream = photographer.home / "made" / "streams" / "kodim13.jpg.sgi"
    assert np.abs(seen - sgicodec.imread(stream, size=(width, height))).max() <= 1
