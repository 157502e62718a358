"""sgidec and sgi-info, the programs in C that are installed with libsgi: they do what `sgi` does."""

from __future__ import annotations

import ctypes
import json
import os
import select
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from children import HANGS
from data_files import GOLDEN_STREAMS
from image_files import SRGB
from library import NEEDS_COMPILER, ROOT
from numpy.typing import NDArray
from PIL import Image

import sgicodec
from sgicodec.metadata.blobs import Metadata

pytestmark = NEEDS_COMPILER

SGI = (sys.executable, "-m", "sgicodec")
RGB, FLOAT, TILES = (GOLDEN_STREAMS[0].with_stem(name) for name in ("rgb8", "float", "rgb8-tiles-lossless"))
DEPTHS = {"8": "uint8", "16": "uint16", "32": "float32"}
FORMATS = {"gray": {"pgm", "pam", "png"}, "rgb": {"ppm", "pam", "png"}, "multi": {"pam"}}
"""By layout, those that hold 8 and 16 bits; others are `pam` and `png`."""


@pytest.fixture(scope="module")
def sgidec(prefix: Path) -> Path:
    return prefix / "bin" / "sgidec"


@pytest.fixture(scope="module")
def formats(sgidec: Path) -> set[str]:
    """What it was built with."""
    shown = subprocess.run([sgidec, "--help"], capture_output=True, text=True, check=True).stdout
    return {name.strip() for name in shown.split("one of ")[1].split(";")[0].split(",")}


def run(*command: object, **options: Any) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(list(map(str, command)), capture_output=True, timeout=HANGS, **options)


def done(*command: object) -> bytes:
    """What a command that must succeed in silence printed."""
    finished = run(*command)
    assert (finished.returncode, finished.stderr) == (0, b"")
    return finished.stdout


def read_pam(path: Path) -> NDArray[Any]:
    head, _, samples = path.read_bytes().partition(b"ENDHDR\n")
    fields = dict(line.split(" ", 1) for line in head.decode().splitlines()[1:])
    shape = int(fields["HEIGHT"]), int(fields["WIDTH"]), int(fields["DEPTH"])
    return np.frombuffer(samples, ">u2" if fields["MAXVAL"] == "65535" else "u1").reshape(shape)


def read(path: Path) -> NDArray[Any]:
    return read_pam(path) if path.suffix == ".pam" else np.atleast_3d(sgicodec.read(path).pixels)


@pytest.mark.parametrize("path", GOLDEN_STREAMS, ids=lambda path: path.stem)
def test_pictures_are_those_of_the_package(path: Path, sgidec: Path, formats: set[str], tmp_path: Path) -> None:
    with sgicodec.open(path) as stream:
        layout, is_lossy_elsewhere = stream.header.channels, stream.max_error is not None and not stream.has_exact_views
        has_nodata = stream.header.masked == "nodata"
        for bits, dtype in DEPTHS.items():
            is_lossy = is_lossy_elsewhere and stream.header.sample_type != dtype
            floats = {"pfm"} if layout in ("gray", "rgb") else set()
            held = floats if bits == "32" else FORMATS.get(layout, {"pam", "png"})
            for extension in held & formats:
                out = tmp_path / f"{bits}.{extension}"
                result = run(sgidec, path, out, "--depth", bits)
                assert (result.returncode, b"those of the lossy picture" in result.stderr) == (0, is_lossy)
                assert (b"not kept: nodata value" in result.stderr) == has_nodata
                assert len(result.stderr.splitlines()) == is_lossy + has_nodata
                np.testing.assert_array_equal(read(out), stream.picture(dtype=dtype).pixels)
                assert list(tmp_path.iterdir()) == [out]
                out.unlink()
        if is_lossy_elsewhere and stream.header.sample_type != "float32" and layout != "multi":
            out, size = tmp_path / "a.pam", f"{stream.width // 2}x{stream.height}!"
            assert b"the stream's scale alone" in run(sgidec, path, out, "--size", size).stderr
            assert b"alone" not in run(sgidec, path, out, "--size", size, "--lossy", "-f").stderr


@pytest.mark.parametrize(
    "options",
    [
        ["--region", "20,10,50,40"],
        ["--region", "20,10,51,40", "--scale", "4"],
        ["--region", "-5,-9,30,20", "--boundless"],
        ["--region", "150,100,500,500"],
        ["--scale", "1/3"],
        ["--scale", "37%"],
        ["--scale", ".015625"],
        ["--scale", "22"],
        ["--size", "50x50"],
        ["--size", "51x"],
        ["--size", "x77"],
        ["--size", "300x10!"],
        ["--region", "3,3,31,77", "--size", "64x64"],
        ["--exact", "--size", "12x"],
        ["--depth", "16"],
        ["--threads", "1"],
        ["--no-dither"],
        ["--lossy"],
    ],
    ids=" ".join,
)
@pytest.mark.parametrize("name", ["rgb8", "rgb8-tiles-lossless", "gray16-texture"])
def test_options_mean_what_they_mean_in_sgi(name: str, options: list[str], sgidec: Path) -> None:
    """As many pixels, and the same ones; the same is said."""
    stream = ROOT / "tests" / "conformance" / "golden" / f"{name}.sgi"
    arguments = (stream, "-", *options, "--format", "ppm")
    ours, theirs = run(sgidec, *arguments), run(*SGI, "decode", *arguments)
    assert ours.returncode == theirs.returncode
    told = [line for line in theirs.stderr.decode().splitlines() if line.startswith("sgi: ")]
    assert ours.stderr.decode().splitlines() == [line.replace("sgi: ", "sgidec: ", 1) for line in told]
    assert ours.stdout == theirs.stdout


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        ([], 2, "give IN and OUT; see sgidec --help"),
        (["nope.sgi", "a.ppm"], 4, "nope.sgi: No such file or directory"),
        ([ROOT, "a.ppm"], 4, "Is a directory"),
        ([ROOT / "LICENSE", "a.ppm"], 4, "no stream of this codec: it starts with"),
        ([RGB, "a.xyz"], 2, "there is no format 'xyz'"),
        ([RGB, "a"], 2, "a has no extension that names a format"),
        ([RGB, "a.pfm"], 3, "a.pfm: pfm cannot hold 8 bits per sample"),
        ([FLOAT, "a.ppm"], 3, "pnm cannot hold 32-bit float per sample"),
        ([GOLDEN_STREAMS[-1], "a.ppm"], 3, "pnm cannot hold rgba"),
        ([RGB, "there.ppm"], 6, "there.ppm exists; give -f to overwrite it"),
        ([RGB, "there.sgi", "--format", "ppm", "-f"], 2, "there.sgi is a stream, no picture"),
        ([RGB, "folder", "--format", "ppm"], 2, "folder is a folder"),
        ([RGB, "none/a.ppm"], 2, "none/a.ppm: No such file or directory"),
        ([RGB, "/dev/full", "--format", "ppm"], 3, "No space left on device"),
        ([RGB, "a.ppm", "--region", "1,2,3"], 2, "'1,2,3' is not X,Y,W,H"),
        ([RGB, "a.ppm", "--region", "1,2,3,4,"], 2, "is not X,Y,W,H"),
        ([RGB, "a.ppm", "--region", "500,500,10,10"], 2, "is not inside the picture of 192×128 pixels"),
        ([RGB, "a.ppm", "--region", "1,1,0,4"], 2, "region 1,1,0,4 is not inside"),
        ([RGB, "a.ppm", "--region", f"1,1,{2**62},4"], 2, "is not X,Y,W,H"),
        ([RGB, "a.ppm", "--boundless"], 2, "--boundless goes with --region"),
        ([RGB, "a.ppm", "--scale", "0"], 2, "a positive number"),
        ([RGB, "a.ppm", "--scale", "nan"], 2, "'nan' is not F"),
        ([RGB, "a.ppm", "--scale", "1/0"], 2, "a positive number"),
        ([RGB, "a.ppm", "--scale", "99999"], 2, "too many; a side has at most 16777216"),
        ([RGB, "a.ppm", "--scale", "2", "--size", "9x"], 2, "exclude each other"),
        ([RGB, "a.ppm", "--size", "x"], 2, "'x' is not WxH"),
        ([RGB, "a.ppm", "--size", "0x5"], 2, "is not a size in pixels"),
        ([RGB, "a.ppm", "--depth", "12"], 2, "'12' is not 8, 16 or 32"),
        ([RGB, "a.ppm", "-j", "x"], 2, "'x' is not a whole number from 0 to 1024"),
        ([RGB, "a.ppm", "--bad"], 2, "No such option '--bad'"),
        ([RGB, "a.ppm", "--scale"], 2, "Option '--scale' needs a value"),
    ],
)
def test_failures_are_one_line(arguments: list[object], code: int, text: str, sgidec: Path, tmp_path: Path) -> None:
    """With the codes of `sgi`; nothing is written or replaced."""
    (tmp_path / "folder").mkdir()
    (tmp_path / "there.ppm").write_bytes(b"P5")
    shutil.copy(RGB, tmp_path / "there.sgi")
    finished = run(sgidec, *arguments, cwd=tmp_path)
    (line,) = finished.stderr.decode().splitlines()
    assert (finished.returncode, finished.stdout) == (code, b"")
    assert line.startswith("sgidec: ")
    assert text in line
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder", "there.ppm", "there.sgi"]
    assert (tmp_path / "there.ppm").read_bytes() == b"P5"
    assert (tmp_path / "there.sgi").read_bytes() == RGB.read_bytes()


def test_force_replaces_a_picture(sgidec: Path, tmp_path: Path) -> None:
    out = tmp_path / "a.ppm"
    out.write_bytes(b"P5")
    out.chmod(0o600)
    done(sgidec, RGB, out, "-f")
    assert out.read_bytes().startswith(b"P6\n192 128\n255\n")
    assert out.stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize(("path", "start"), [(RGB, b"P6"), (FLOAT, b"Pf"), (GOLDEN_STREAMS[-1], b"P7")])
def test_pipes(path: Path, start: bytes, sgidec: Path) -> None:
    """What comes out of one is the simplest format that holds it."""
    piped = run(sgidec, "-", "-", input=path.read_bytes())
    assert (piped.returncode, piped.stderr) == (0, b"")
    assert piped.stdout.startswith(start + b"\n")
    assert piped.stdout == done(sgidec, path, "-")


def test_a_damaged_tile_leaves_nothing(sgidec: Path, tmp_path: Path) -> None:
    data = bytearray(RGB.read_bytes())
    data[len(data) * 2 // 3] ^= 1
    (tmp_path / "a.sgi").write_bytes(data)
    finished = run(sgidec, tmp_path / "a.sgi", tmp_path / "a.ppm")
    assert finished.returncode == 4
    assert b"wrong CRC" in finished.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["a.sgi"]


@pytest.fixture
def created(tmp_path: Path) -> Iterator[int]:
    """What becomes readable when a file is created in `tmp_path`: inotify."""
    system = ctypes.CDLL(None)
    number = system.inotify_init()
    assert system.inotify_add_watch(number, bytes(tmp_path), 0x100) >= 0  # IN_CREATE
    yield number
    os.close(number)


@pytest.mark.skipif(sys.platform != "linux", reason="needs inotify")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_nothing(number: signal.Signals, created: int, sgidec: Path, tmp_path: Path) -> None:
    """While a picture of a gigapixel is being written."""
    with subprocess.Popen([sgidec, RGB, tmp_path / "a.ppm", "--scale", "200"]) as process:
        assert select.select([created], [], [], HANGS)[0]
        process.send_signal(number)
    assert process.returncode == 128 + number
    assert not any(tmp_path.iterdir())


def test_the_reader_of_a_pipe_may_go_away(sgidec: Path) -> None:
    with subprocess.Popen([sgidec, RGB, "-", "--scale", "20"], stdout=subprocess.PIPE) as process:
        process.stdout.read(9)
        process.stdout.close()
    assert process.returncode == 141


def test_metadata_travel_in_png(sgidec: Path, formats: set[str], tmp_path: Path) -> None:
    if "png" not in formats:
        pytest.skip("built without libpng")
    picture = sgicodec.read(ROOT / "tests" / "data" / "pictures" / "basn2c08.png")
    exif = Image.Exif()
    exif[0x010E] = "a description"
    xmp = b'<x:xmpmeta xmlns:x="adobe:ns:meta/"></x:xmpmeta>'
    kept = Metadata(icc=SRGB, exif=exif.tobytes()[6:], xmp=xmp)
    (tmp_path / "a.sgi").write_bytes(sgicodec.encode(replace(picture, metadata=kept), steps=2))
    done(sgidec, tmp_path / "a.sgi", tmp_path / "a.png")
    found = sgicodec.read(tmp_path / "a.png").metadata
    assert (found.icc, found.xmp) == (SRGB, xmp)
    with Image.open(tmp_path / "a.png") as image:
        assert image.getexif()[0x010E] == "a description"
    done(sgidec, tmp_path / "a.sgi", tmp_path / "b.png", "--no-metadata")
    assert sgicodec.read(tmp_path / "b.png").metadata == Metadata()
    for options, told in ([], "sgidec: stdout: not kept: ICC profile, EXIF, XMP\n"), (["--no-metadata"], ""):
        assert run(sgidec, tmp_path / "a.sgi", "-", *options).stderr.decode() == told


def test_a_profile_that_png_refuses_is_told(sgidec: Path, formats: set[str], tmp_path: Path) -> None:
    if "png" not in formats:
        pytest.skip("built without libpng")
    picture = sgicodec.read(ROOT / "tests" / "data" / "pictures" / "hopper_gray.jpg")
    (tmp_path / "a.sgi").write_bytes(sgicodec.encode(replace(picture, metadata=Metadata(icc=SRGB)), steps=2))
    finished = run(sgidec, tmp_path / "a.sgi", tmp_path / "a.png")
    assert finished.returncode == 0
    assert b"sgidec: warning:" in finished.stderr
    assert b"profile" in finished.stderr
    assert sgicodec.read(tmp_path / "a.png").pixels.shape[:2] == picture.pixels.shape[:2]


def test_the_report_has_keys_of_sgi_info(prefix: Path) -> None:
    ours = done(prefix / "bin" / "sgi-info", "--json", "--verify", *GOLDEN_STREAMS).decode().splitlines()
    theirs = done(*SGI, "info", "--json", "--survey", *GOLDEN_STREAMS).decode().splitlines()
    for path, line, other in zip(GOLDEN_STREAMS, ours, theirs, strict=True):
        found, expected = json.loads(line), json.loads(other)
        with sgicodec.open(path) as stream:
            header = stream.header
        assert found.pop("nodata") == (header.nodata if header.masked == "nodata" else None)
        assert found == {key: expected[key] for key in found}


def test_the_report_for_people(prefix: Path, tmp_path: Path) -> None:
    program = prefix / "bin" / "sgi-info"
    shown = done(program, TILES).decode()
    for line in (
        "picture     192×128, rgb, 8 bits\n",
        "tiles       4 of",
        "overview    12×8\n",
        "samples     without loss\n",
    ):
        assert line in shown
    damaged = bytearray(TILES.with_stem("rgb8-tiles").read_bytes())
    damaged[len(damaged) * 2 // 3] ^= 1  # in a tile
    (tmp_path / "a.sgi").write_bytes(damaged)
    assert run(program, tmp_path / "a.sgi").returncode == 0
    for files, code in (([tmp_path / "a.sgi"], 4), ([tmp_path / "a.sgi", RGB], 1), ([RGB, "-"], 1)):
        finished = run(program, "--verify", *files, input=b"GIF8")
        assert finished.returncode == code
        assert len(finished.stderr.splitlines()) == 1
        assert (b"192" in finished.stdout) == (RGB in files)


@pytest.mark.skipif(not shutil.which("man"), reason="needs man")
@pytest.mark.parametrize("name", ["sgidec", "sgi-info"])
def test_the_manual_pages_are_well_formed(name: str, prefix: Path) -> None:
    """man says nothing against one, and it has each option that the program tells of."""
    page = prefix / "share" / "man" / "man1" / f"{name}.1"
    finished = run("man", "--warnings", "-E", "UTF-8", "-l", page, env={"PATH": "/usr/bin:/bin", "MANPAGER": "cat"})
    assert (finished.returncode, finished.stderr) == (0, b"")
    told = {word for word in done(prefix / "bin" / name, "--help").decode().split() if word.startswith("--")}
    missing = [option for option in told - {"--help", "--version"} if option.encode() not in finished.stdout]
    assert missing == []
