"""What is packed: the source distribution, and the files by which other programs recognise streams."""

from __future__ import annotations

import configparser
import runpy
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import xml.etree.ElementTree as ET
from importlib.metadata import files, metadata
from pathlib import Path

import pytest
from installed import check_kernels
from PIL import Image

from sgicodec.bitstream.container import SIGNATURE

TESTS = Path(__file__).parents[1]
ROOT = TESTS.parent
SHARE = ROOT / "share"
GOLDEN = sorted((TESTS / "conformance" / "golden").glob("*.sgi"))
SILICON_GRAPHICS = [TESTS / "data" / "pictures" / name for name in ("hopper.sgi", "corrupt_rle.sgi")]
OURS, THEIRS = "image/x-sgicodec", "image/x-sgi"
MIME = "{http://www.freedesktop.org/standards/shared-mime-info}"


def test_kernels_that_lack_a_header_are_no_sound_installation(tmp_path: Path) -> None:
    package = tmp_path / "sgicodec"
    place = package / "cuda" / "sources"
    for folder in ("cuda", "native/base", "native/model", "native/fit", "native/raster"):
        shutil.copytree(ROOT / folder, place / folder)
    shutil.copy(ROOT / "sgicodec" / "cuda" / "sources.py", package / "cuda" / "sources.py")

    def check() -> None:
        found = runpy.run_path(str(package / "cuda" / "sources.py"))
        assert found["root"]() == place
        check_kernels(package, place, found["digest"](""), list(found["_all_of"]("cuda/kernels.cu")))

    check()
    with pytest.raises(SystemExit, match="not from what was installed"):
        check_kernels(tmp_path / "elsewhere", place, "", [])
    header = place / "native" / "model" / "gaussians.hpp"
    header.write_text(header.read_text("utf-8") + "//", "utf-8")
    with pytest.raises(SystemExit, match="are others than those here"):
        check()
    header.unlink()
    with pytest.raises(SystemExit, match=r"the kernels lack model/gaussians\.hpp$"):
        check()


def matches(rule: ET.Element, data: bytes) -> bool:
    """Whether a rule of shared-mime-info, and one of those in it if there are any, holds for a file's start."""
    value, at = rule.attrib["value"], int(rule.attrib["offset"])
    sizes = {"byte": 1, "big16": 2}
    if rule.attrib["type"] == "string":
        wanted = value.encode().decode("unicode_escape").encode("latin-1")
    else:
        wanted = int(value, 0).to_bytes(sizes[rule.attrib["type"]], "big")
    return data[at : at + len(wanted)] == wanted and (not len(rule) or any(matches(child, data) for child in rule))


def types_by_content(path: Path) -> list[str]:
    root = ET.parse(SHARE / "mime" / "packages" / "sgicodec.xml").getroot()
    return [
        kind.attrib["type"]
        for kind in root.iter(f"{MIME}mime-type")
        if any(matches(rule, path.read_bytes()) for rule in kind.findall(f"{MIME}magic/{MIME}match"))
    ]


@pytest.mark.parametrize("path", GOLDEN, ids=lambda path: path.stem)
def test_the_mime_type_of_streams(path: Path) -> None:
    assert types_by_content(path) == [OURS]


@pytest.mark.parametrize("path", SILICON_GRAPHICS, ids=lambda path: path.stem)
def test_the_mime_type_of_silicon_graphics_pictures(path: Path) -> None:
    assert types_by_content(path) == [THEIRS]


@pytest.mark.skipif(not (shutil.which("update-mime-database") and shutil.which("gio")), reason="needs GLib's tools")
def test_the_desktop_tells_them_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(SHARE / "mime", tmp_path / "mime")
    subprocess.run(["update-mime-database", tmp_path / "mime"], check=True)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    for path, expected in [(GOLDEN[0], OURS), *((path, THEIRS) for path in SILICON_GRAPHICS)]:
        found = subprocess.run(
            ["gio", "info", "-a", "standard::content-type", path], check=True, capture_output=True, text=True
        ).stdout
        assert f"standard::content-type: {expected}\n" in found, path.name


def test_the_magic_is_the_signature() -> None:
    (line,) = (line for line in (SHARE / "misc" / "sgicodec.magic").read_text().splitlines() if line.startswith("0\t"))
    _, kind, value, _ = line.split("\t")
    assert kind == "string"
    assert value.encode().decode("unicode_escape").encode("latin-1") == SIGNATURE


@pytest.mark.skipif(not shutil.which("file"), reason="needs file(1)")
def test_file_tells_them_apart() -> None:
    def told(*options: str) -> list[str]:
        command = ["file", "--brief", "--magic-file", str(SHARE / "misc" / "sgicodec.magic"), *options]
        result = subprocess.run([*command, *GOLDEN, *SILICON_GRAPHICS], check=True, capture_output=True, text=True)
        return [line.strip() for line in result.stdout.splitlines()]

    assert told() == ["sgicodec image (2D Gaussians)"] * len(GOLDEN) + ["data"] * len(SILICON_GRAPHICS)
    assert told("--mime-type")[: len(GOLDEN)] == [OURS] * len(GOLDEN)


def test_the_thumbnailer_writes_a_png_whatever_its_name(tmp_path: Path) -> None:
    entry = configparser.ConfigParser(interpolation=None)
    entry.read(SHARE / "thumbnailers" / "sgicodec.thumbnailer")
    assert entry["Thumbnailer Entry"]["MimeType"] == f"{OURS};"
    out = tmp_path / ".thumbnail.XYZ"  # exists, and has no suffix: GNOME's way
    out.touch()
    values = {"%i": str(TESTS / "conformance" / "golden" / "float.sgi"), "%o": str(out), "%sx%s": "64x64"}
    program, *options = entry["Thumbnailer Entry"]["Exec"].split()
    assert program == entry["Thumbnailer Entry"]["TryExec"] == "sgi"
    command = [Path(sysconfig.get_path("scripts")) / program, *(values.get(option, option) for option in options)]
    result = subprocess.run(command, capture_output=True, check=False)
    assert (result.returncode, result.stdout, result.stderr) == (0, b"", b"")
    with Image.open(out) as thumbnail:
        assert (thumbnail.format, max(thumbnail.size)) == ("PNG", 64)


@pytest.mark.skipif(sys.platform == "win32", reason="not installed there")
def test_these_files_and_the_manual_page_are_installed() -> None:
    installed = {
        Path(str(path)).as_posix().split("share/", 1)[1]: path.read_text()
        for path in files("sgicodec") or ()
        if "/share/" in str(path)
    }
    page = installed.pop("man/man1/sgi.1")
    assert page.startswith(".TH SGI 1 ")
    assert ".SS sgi encode " in page
    assert installed == {
        path.relative_to(SHARE).as_posix(): path.read_text() for path in SHARE.rglob("*") if path.is_file()
    }


def test_the_metadata() -> None:
    about = metadata("sgicodec")
    assert about["License-Expression"] == "BSD-3-Clause"
    assert "Operating System :: POSIX :: Linux" in about.get_all("Classifier", [])
    assert about.get_all("Project-URL") == ["Paper of the method, https://arxiv.org/abs/2603.07789"]


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
    for folder, pattern in (("native", "*.?pp"), ("sgicodec", "*.py"), ("sgicodec", "*.bin"), ("share", "*.*")):
        needed |= {path.relative_to(ROOT).as_posix() for path in (ROOT / folder).rglob(pattern) if path.is_file()}
    assert needed - set(sdist) == set()


def test_the_sdist_has_no_big_files_and_nothing_that_was_built(sdist: dict[str, int]) -> None:
    assert {path: size for path, size in sdist.items() if size > 100_000} == {}
    assert [path for path in sdist if path.endswith((".so", ".pyc", ".whl")) or path.startswith((".", "build"))] == [
        *(path for path in (".clang-format", ".gitignore") if path in sdist)
    ]
