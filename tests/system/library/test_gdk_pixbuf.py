"""The module of gdk-pixbuf: its own programs find it, and draw what libsgi draws."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from data_files import GOLDEN_STREAMS
from library import ROOT, Handle, Library
from PIL import Image

NEEDED = ("cmake", "cc", "pkg-config", "gdk-pixbuf-thumbnailer", "update-mime-database")
Thumbnailer = Callable[..., "subprocess.CompletedProcess[str]"]


def has_headers() -> bool:
    if not all(map(shutil.which, NEEDED)):
        return False
    return subprocess.run(["pkg-config", "--exists", "gdk-pixbuf-2.0"]).returncode == 0


pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not has_headers(), reason=f"needs libgdk-pixbuf-2.0-dev, {', '.join(NEEDED)}"),
]


@pytest.fixture(scope="module")
def installed_module(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The module, installed as docs/plugins.md says, in an environment that knows it and the MIME type."""
    build, place = tmp_path_factory.mktemp("gdk-pixbuf"), tmp_path_factory.mktemp("gdk-pixbuf-prefix")
    settings = {"CMAKE_PREFIX_PATH": prefix, "CMAKE_INSTALL_PREFIX": place, "SGI_PIXBUF_MODULES": place / "loaders"}
    configure = ["cmake", "-S", ROOT / "gdk-pixbuf", "-B", build, *(f"-D{key}={settings[key]}" for key in settings)]
    for command in (configure, ["cmake", "--build", build, "--target", "install"]):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        assert done.returncode == 0, done.stdout
    query = subprocess.run(
        ["pkg-config", "--variable=gdk_pixbuf_query_loaders", "gdk-pixbuf-2.0"], capture_output=True, text=True
    ).stdout.strip()
    module = place / "loaders" / "pixbufloader-sgicodec.so"
    cache = subprocess.run([query, module], capture_output=True, text=True, check=True).stdout
    assert '"image/x-sgicodec"' in cache
    (place / "loaders.cache").write_text(cache)
    share = place / "share"
    shutil.copytree(ROOT / "share" / "mime", share / "mime")
    subprocess.run(["update-mime-database", share / "mime"], check=True)
    assert "gdk-pixbuf-thumbnailer" in (share / "thumbnailers" / "gdk-pixbuf-sgicodec.thumbnailer").read_text()
    return {"GDK_PIXBUF_MODULE_FILE": str(place / "loaders.cache"), "XDG_DATA_DIRS": f"{share}:/usr/share"}


@pytest.fixture
def thumbnailer(installed_module: dict[str, str]) -> Thumbnailer:
    """What a file manager starts."""

    def run(path: Path, out: Path, size: int) -> subprocess.CompletedProcess[str]:
        command = ["gdk-pixbuf-thumbnailer", "-s", str(size), str(path), str(out)]
        return subprocess.run(command, env=os.environ | installed_module, capture_output=True, text=True)

    return run


def colours(handle: Handle, columns: int, rows: int) -> np.ndarray:
    return handle.draw(sample=0, pixels=1, columns=columns, rows=rows)


@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
def test_thumbnails_are_what_the_library_draws(
    path: Path, thumbnailer: Thumbnailer, library: Library, tmp_path: Path
) -> None:
    handle, out = library.open(path.read_bytes()), tmp_path / "out.png"
    info = handle.info()
    done = thumbnailer(path, out, 50)
    if info.layout == 0:
        assert done.returncode != 0
        assert f"{info.channels} bands without a meaning have no colours" in done.stderr
        return
    assert (done.returncode, done.stderr) == (0, "")
    with Image.open(out) as image:
        assert max(image.size) == 50  # also of what is smaller
        assert image.mode == ("RGB" if info.layout == 3 and not info.has_nodata else "RGBA")
        np.testing.assert_array_equal(np.asarray(image.convert("RGBA")), colours(handle, *image.size))


@pytest.mark.parametrize("kept", [1, 8, 20, 300])
def test_a_file_that_is_cut_is_refused(kept: int, thumbnailer: Thumbnailer, tmp_path: Path) -> None:
    path = tmp_path / "a.sgi"
    path.write_bytes(GOLDEN_STREAMS[-1].read_bytes()[:kept])
    done = thumbnailer(path, tmp_path / "out.png", 50)
    assert done.returncode not in (0, -11, -6)
    assert not (tmp_path / "out.png").exists()
