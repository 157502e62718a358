"""What is packed: the source distribution, and the files by which other programs recognise streams."""

from __future__ import annotations

import configparser
import re
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
from importlib.metadata import files
from pathlib import Path

import pytest
from data_files import GOLDEN, ROOT
from installed import CHOSEN
from PIL import Image

SHARE = ROOT / "share"
OURS = "image/x-sgicodec"


def test_the_thumbnailer_writes_a_png_whatever_its_name(tmp_path: Path) -> None:
    entry = configparser.ConfigParser(interpolation=None)
    entry.read(SHARE / "thumbnailers" / "sgicodec.thumbnailer")
    assert entry["Thumbnailer Entry"]["MimeType"] == f"{OURS};"
    out = tmp_path / ".thumbnail.XYZ"  # exists, and has no suffix: GNOME's way
    out.touch()
    values = {"%i": str(GOLDEN / "float.sgi"), "%o": str(out), "%sx%s": "64x64"}
    program, *options = entry["Thumbnailer Entry"]["Exec"].split()
    assert program == entry["Thumbnailer Entry"]["TryExec"] == "sgi"
    command = [Path(sysconfig.get_path("scripts")) / program, *(values.get(option, option) for option in options)]
    result = subprocess.run(command, capture_output=True, check=False)
    assert (result.returncode, result.stdout, result.stderr) == (0, b"", b"")
    with Image.open(out) as thumbnail:
        assert (thumbnail.format, max(thumbnail.size)) == ("PNG", 64)


@pytest.mark.skipif(sys.platform == "win32", reason="not installed there")
def test_these_files_are_installed() -> None:
    installed = {
        Path(str(path)).as_posix().split("share/", 1)[1]: path.read_text()
        for path in files("sgicodec") or ()
        if "/share/" in str(path)
    }
    assert installed == {
        path.relative_to(SHARE).as_posix(): path.read_text() for path in SHARE.rglob("*") if path.is_file()
    }


@pytest.fixture(scope="module")
def sdist(tmp_path_factory: pytest.TempPathFactory) -> dict[str, int]:
    """Paths in the source distribution, with their sizes."""
    folder = tmp_path_factory.mktemp("sdist")
    build = f"from scikit_build_core.build import build_sdist; build_sdist({str(folder)!r})"
    subprocess.run([sys.executable, "-c", build], cwd=ROOT, check=True, capture_output=True)
    (archive,) = folder.iterdir()
    assert archive.stat().st_size < 3 << 20
    with tarfile.open(archive) as tar:
        return {member.name.split("/", 1)[1]: member.size for member in tar if member.isfile()}


def test_the_sdist_has_what_a_build_needs(sdist: dict[str, int]) -> None:
    needed = {"pyproject.toml", "CMakeLists.txt", "README.md", "LICENSE", "tests/conformance/golden/manifest.json"}
    for folder, pattern in (
        *(("native", "*.?pp"), ("sgicodec", "*.py"), ("sgicodec", "*.bin"), ("share", "*.*")),
        *(("programs", "*"), ("gdk-pixbuf", "*"), ("packaging", "*")),
    ):
        needed |= {path.relative_to(ROOT).as_posix() for path in (ROOT / folder).rglob(pattern) if path.is_file()}
    assert needed - set(sdist) == set()


def test_what_tries_a_wheel_needs_no_extra() -> None:
    places = [ROOT / "tests" / name for name in CHOSEN]
    files = [str(file) for place in places for file in (place.glob("test_*.py") if place.is_dir() else [place])]
    without = "sys.modules.update(dict.fromkeys(['tifffile', 'imagecodecs', 'rasterio', 'zarr', 'torch']))"
    code = f"import runpy, sys; {without}; sys.path += ['.', 'tests/support']; [*map(runpy.run_path, {files})]"
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True)


def test_recipes_have_the_version_and_the_dependencies_of_the_package() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    recipe = (ROOT / "packaging" / "conda" / "recipe.yaml").read_text("utf-8")
    assert f"version: {project['version']}\n" in recipe
    run = recipe.split("\n  run:\n")[1].split("\n\n")[0]
    names = {"OpenImageIO": "py-openimageio", "isal": "python-isal"}
    expected = {f"python {project['requires-python']}"}
    for package in project["dependencies"]:
        name, bounds = re.fullmatch(r"(\w+)(.*)", package).groups()  # type: ignore[union-attr]
        expected.add(f"{names.get(name, name)} {bounds}")
    assert {line.removeprefix("    - ") for line in run.splitlines()} == expected
    changelog = (ROOT / "packaging" / "debian" / "changelog").read_text("utf-8")
    assert changelog.startswith(f"sgicodec ({project['version']}-1) ")
    control = (ROOT / "packaging" / "debian" / "control").read_text("utf-8")
    assert f"Package: libsgi{project['version'].partition('.')[0]}\n" in control
