"""The programs and the notebook in examples/, and the examples of README.md, docs/api.md and docs/plugins.md, run and
give what they say.
"""

from __future__ import annotations

import contextlib
import io
import json
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from command import sgi
from data_files import ROOT, crop, geotiff
from PIL import Image

import sgicodec
from sgicodec.server.viewer import missing_decoder, viewer_folder

EXAMPLES = ROOT / "examples"
VIEWER = viewer_folder()
assert VIEWER is not None
NOTE = missing_decoder(VIEWER)


def run(folder: Path, program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(EXAMPLES / program), *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture
def photos(tmp_path: Path) -> Path:
    """A folder with two photographs whose names differ in their suffix alone."""
    pixels = sgicodec.read(ROOT / "tests" / "data" / "kodim23.png").pixels[180:276, 100:228]
    Image.fromarray(pixels).save(tmp_path / "a & b.png")
    Image.fromarray(pixels[:, ::-1]).save(tmp_path / "a & b.jpg", quality=95)
    return tmp_path


@pytest.mark.skipif(NOTE is not None, reason="the viewer's WebAssembly is not compiled")
def test_web_gallery(photos: Path) -> None:
    result = run(photos, "web_gallery.py", "a & b.png", "a & b.jpg", "--out", "made")
    assert (result.returncode, result.stderr) == (0, "")
    page = (photos / "made" / "index.html").read_text("utf-8")
    assert re.findall('src="(streams/[^"]*)"', page) == ["streams/a%20%26%20b.png.sgi", "streams/a%20%26%20b.jpg.sgi"]
    assert 'alt="a &amp; b.png"' in page
    assert "viewer/?file=../streams/a%2520%2526%2520b.png.sgi" in page  # twice: a URL within a URL
    assert (photos / "made" / "viewer" / "element.js").is_file()
    first = sgicodec.imread(photos / "made" / "streams" / "a & b.png.sgi").astype(int)
    assert np.abs(first - np.asarray(Image.open(photos / "a & b.png"))).mean() < 5


@pytest.mark.skipif(NOTE is not None, reason="the viewer's WebAssembly is not compiled")
def test_a_gallery_names_what_is_missing(photos: Path) -> None:
    result = run(photos, "web_gallery.py", "absent.jpg", "a & b.png")
    assert result.returncode == 1
    assert result.stderr.splitlines()[0].startswith("web_gallery: absent.jpg: ")
    assert result.stderr.splitlines()[1:] == ["web_gallery: 1 of 2 pictures are missing"]


def scene(path: Path, seed: int, columns: int = 64) -> None:
    """A scene of four bands of 16 bits, of 10 m."""
    geotiff(path, np.random.default_rng(seed).integers(0, 4000, (4, 48, columns), np.uint16))


@pytest.mark.skipif(NOTE is not None, reason="the viewer's WebAssembly is not compiled")
def test_time_series(tmp_path: Path) -> None:
    scene(tmp_path / "june.tif", 1)
    scene(tmp_path / "may.tif", 2)
    result = run(tmp_path, "time_series.py", "2026-06-02=june.tif", "2026-05-01=may.tif", "--out", "made")
    assert (result.returncode, result.stderr) == (0, "")
    rows = json.loads((tmp_path / "made" / "index.json").read_text("utf-8"))
    assert [row["date"] for row in rows] == ["2026-05-01", "2026-06-02"]
    for row in rows:
        stream = tmp_path / "made" / row["stream"]
        assert row["bytes"] == stream.stat().st_size
        assert sgicodec.imread(stream).shape == (48, 64, 4)
        assert (row["epsg"], row["pixel_size"]) == (32632, [10, 10])
        assert row["bounds"] == [500000, 5400000 - 480, 500640, 5400000]
    scene(tmp_path / "wide.tif", 3, columns=80)
    result = run(tmp_path, "time_series.py", "2026-06-02=june.tif", "2026-07-01=wide.tif")
    assert (result.returncode, "cut them to one place first" in result.stderr) == (0, True)
    result = run(tmp_path, "time_series.py", "2026-13-01=may.tif")
    assert (result.returncode, "'2026-13-01' is no date" in result.stderr) == (2, True)


def test_slide(tmp_path: Path) -> None:
    pixels = sgicodec.read(ROOT / "tests" / "data" / "kodim13.png").pixels
    tifffile.imwrite(tmp_path / "scan.tif", pixels, resolution=(20000, 20000), resolutionunit="CENTIMETER")
    result = run(tmp_path, "slide.py", "scan.tif", "--out", "seen", "--microns", "60")
    assert (result.returncode, result.stderr) == (0, "")
    assert "768×512 pixels, 3 levels; 0.5 µm a pixel" in result.stdout
    sizes = [Image.open(tmp_path / f"seen-{level}.png").size for level in range(3)]
    assert sizes == [(120, 120), (120, 120), (120, 120)]
    middle = sgicodec.imread(tmp_path / "seen.sgi", region=(384 - 60, 256 - 60, 120, 120))
    assert np.array_equal(np.asarray(Image.open(tmp_path / "seen-0.png")), middle)
    exact = run(tmp_path, "slide.py", "scan.tif", "--lossless")
    assert exact.returncode == 0
    assert np.array_equal(sgicodec.imread(tmp_path / "scan.sgi"), pixels)


def test_notebook(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """All cells in turn, as one program."""
    monkeypatch.chdir(EXAMPLES)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    names: dict[str, Any] = {"__name__": "notebook"}
    cells = json.loads((EXAMPLES / "first_steps.ipynb").read_text("utf-8"))["cells"]
    for cell in (cell for cell in cells if cell["cell_type"] == "code"):
        assert cell["outputs"] == [], f"{cell['id']}: outputs are not committed"
        exec(compile("".join(cell["source"]), cell["id"], "exec"), names)
    assert names["difference"] < 0.01
    for points in names["curves"].values():
        assert points == sorted(points)
        assert [quality for _, quality in points] == sorted(quality for _, quality in points)
    lines = capsys.readouterr().out.splitlines()
    paper, default = lines[0], lines[-1]
    assert paper.startswith("150 seeds")
    assert (
        int(re.findall(r"([\d,]+) bytes", default)[0])
        < 2000
        < int(re.findall(r"([\d,]+) bytes", paper)[0].replace(",", ""))
    )


README, API, PLUGINS = (ROOT / name for name in ("README.md", "docs/api.md", "docs/plugins.md"))
SECTIONS = ("First file", "Choose the quality", "Many pictures", "Look at a part")
"""Those of README.md whose commands fit a small picture."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with the files that examples read."""
    sgicodec.write(crop("kodim23", np.s_[200:264, 100:196]), tmp_path / "photo.png")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def blocks(page: Path) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", [README, API, PLUGINS], ids=lambda page: page.name)
def test_python_examples(page: Path, folder: Path) -> None:
    """All blocks of a page in turn, as one program; a comment behind print is what it prints."""
    found = blocks(page)
    assert found
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile("\n".join(found), page.name, "exec"), {"__name__": "example"})
    expected = re.findall(r"^ *print\(.*\)  # (.*)$", "\n".join(found), re.MULTILINE)
    assert expected
    lines = printed.getvalue().splitlines()
    assert [line for line in lines if line in expected] == expected


def commands() -> list[str]:
    parts = re.split(r"^## (.*)\n", README.read_text("utf-8"), flags=re.MULTILINE)
    sections = dict(zip(parts[1::2], parts[2::2], strict=True))
    return [
        line for name in SECTIONS for line in re.findall(r"^    (sgi .*?)(?: +#.*)?$", sections[name], re.MULTILINE)
    ]


def test_commands_of_the_readme(folder: Path) -> None:
    """In turn: later ones read what earlier ones wrote."""
    found = commands()
    assert len(found) >= 10
    for command in found:
        arguments = [
            path
            for word in shlex.split(command)[1:]
            for path in (sorted(str(path) for path in Path().glob(word)) if "*" in word else [word])
        ]
        result = sgi(*arguments)
        assert result.exit_code == 0, f"{command}: {result.output}"
    assert sgicodec.read(folder / "eye.png").width == 160
    assert sgicodec.read(folder / "small.png").width == 64
