"""The first minutes of a photographer: a page of photographs in Chromium."""

from __future__ import annotations

import functools
import json
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import numpy as np
import pytest
from data_files import ROOT
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
def photos(tmp_path: Path) -> Path:
    """Two photographs as cameras write them, turned by EXIF; the folder is the photographer's home, too."""
    exif = Image.Exif()
    exif[274], exif[271] = 6, "A camera"  # orientation, make
    for name in ("kodim13", "kodim23"):
        pixels = sgicodec.read(ROOT / "tests" / "data" / f"{name}.png").pixels[100:400, 100:600]
        Image.fromarray(np.rot90(pixels)).save(tmp_path / f"{name}.jpg", quality=95, exif=exif)
    return tmp_path


def run(folder: Path, *command: str) -> str:
    """What a command prints, of a user with nothing but this folder and what is installed."""
    environment = {"HOME": str(folder), "PATH": f"{Path(sys.executable).parent}:/usr/local/bin:/usr/bin:/bin"}
    kept = {name: os.environ[name] for name in ("CHROMIUM",) if name in os.environ}
    done = subprocess.run(command, cwd=folder, env=environment | kept, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


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


@pytest.mark.skipif(not HAS_PAGE, reason="needs make test-viewer's node modules, Chromium and the viewer's WebAssembly")
def test_a_page_of_them(photos: Path, capsys: pytest.CaptureFixture[str]) -> None:
    gallery, shot = str(ROOT / "examples" / "web_gallery.py"), photos / "shot.png"
    started = time.monotonic()
    run(photos, "python", gallery, "kodim13.jpg", "kodim23.jpg", "--out", "made")
    with served(photos / "made") as address:
        found = json.loads(run(photos, "node", str(Path(__file__).with_name("look.js")), address, str(shot)))
    seconds = time.monotonic() - started
    assert found["errors"] == []
    assert found["viewed"] == "kodim13.jpg.sgi"
    assert [0 < picture["width"] < 500 for picture in found["pictures"]] == [True, True]
    seen = np.asarray(Image.open(shot).convert("RGB")).astype(int)
    height, width = seen.shape[:2]
    expected = sgicodec.imread(photos / "made" / "streams" / "kodim13.jpg.sgi", size=(width, height))
    assert np.abs(seen - expected).max() <= 1
    with capsys.disabled():
        print(f"\n  photographer: from photographs to a page of them in Chromium in {seconds:.1f} s")
