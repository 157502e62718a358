"""`sgi decode` as a user types it."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from command import done, refused, sgi, told
from surgery import flipped

from sgicodec import imread, read, write
from sgicodec.decoder.stream import open_stream
from sgicodec.image.reader import probe
from sgicodec.picture import Picture, convert, from_unit


def test_out_is_a_png_beside_in(stream: Path) -> None:
    done("decode", stream)
    written = read(stream.with_suffix(".png"))
    assert written.channels == "rgb"
    np.testing.assert_array_equal(written.pixels, imread(stream))


def test_out_is_a_tiff_for_floats(shared: Path, tmp_path: Path) -> None:
    source = tmp_path / "f.sgi"
    source.write_bytes((shared / "float.sgi").read_bytes())
    done("decode", source)
    np.testing.assert_array_equal(read(tmp_path / "f.tif").pixels, imread(source))
    done("decode", source, "--depth", 16)
    assert probe(tmp_path / "f.png").dtype == np.uint16


def test_out_is_a_tiff_for_bands(tmp_path: Path, pixels: np.ndarray) -> None:
    bands = np.concatenate([pixels, pixels[..., :2]], axis=2)
    write(Picture(bands, "multi", (0.0, 255.0)), tmp_path / "bands.tif")
    done("encode", tmp_path / "bands.tif", "--steps", 2)
    (tmp_path / "bands.tif").unlink()
    done("decode", tmp_path / "bands.sgi")
    assert read(tmp_path / "bands.tif").pixels.shape == (32, 48, 5)
    assert sgi("decode", tmp_path / "bands.sgi", tmp_path / "bands.png").exit_code == 3


@pytest.mark.parametrize(
    ("options", "arguments"),
    [
        ("--region 3,5,20,11", {"region": (3, 5, 20, 11)}),
        ("--scale 2", {"size": (96, 64)}),
        ("--scale 1/4", {"size": (12, 8)}),
        ("--size 30x10", {"size": (15, 10)}),
        ("--size 96x96", {"size": (96, 64)}),
        ("--size 30x10!", {"size": (30, 10)}),
        ("--region 0,0,20,10 --size 30x30", {"region": (0, 0, 20, 10), "size": (30, 15)}),
        ("--region -4,-2,20,11 --boundless", {"region": (-4, -2, 20, 11), "boundless": True}),
        ("--region 40,0,20,20 --boundless --scale 2", {"region": (40, 0, 20, 20), "scale": 2.0, "boundless": True}),
        ("--size 24x", {"size": (24, 16)}),
        ("--size x64", {"size": (96, 64)}),
        ("--region 0,0,48,1 --size 4x", {"region": (0, 0, 48, 1), "size": (4, 1)}),
        ("--region 8,8,16,16 --scale 1.5", {"region": (8, 8, 16, 16), "size": (24, 24)}),
        ("--threads 3", {}),
    ],
)
def test_parts_and_scales(stream: Path, tmp_path: Path, options: str, arguments: dict[str, tuple[int, ...]]) -> None:
    done("decode", stream, tmp_path / "out.png", *options.split())
    with open_stream(stream) as opened:
        np.testing.assert_array_equal(read(tmp_path / "out.png").pixels, opened.picture(**arguments).pixels)


def test_a_region_over_the_edge_is_cut_with_a_warning(stream: Path, tmp_path: Path) -> None:
    result = done("decode", stream, tmp_path / "out.png", "--region", "40,-5,20,20")
    text = "region 40,-5,20,20 reaches over the picture of 48×32 pixels; it is cut to 40,0,8,15"
    assert result.stderr == f"sgi: warning: {text} (--boundless pads)\n"
    np.testing.assert_array_equal(read(tmp_path / "out.png").pixels, imread(stream, region=(40, 0, 8, 15)))


@pytest.mark.parametrize(("depth", "dtype"), [(8, np.uint8), (16, np.uint16), (32, np.float32)])
def test_depth(stream: Path, tmp_path: Path, depth: int, dtype: type) -> None:
    done("decode", stream, tmp_path / "out.tif", "--depth", depth)
    with open_stream(stream) as opened:
        unit, low = opened.render().clip(0, 1), opened.picture()
    expected = from_unit(unit, "rgb", dtype).pixels
    if depth != 8:
        assert not np.array_equal(expected, convert(low, depth).pixels), "more than eight bits, multiplied"
    written = read(tmp_path / "out.tif").pixels
    assert written.dtype == dtype
    np.testing.assert_array_equal(written, expected)


@pytest.mark.parametrize(
    ("name", "options", "signature"),
    [
        ("out.jpg", [], b"\xff\xd8\xff"),
        ("out.TIF", [], b"II*\0"),
        ("out", ["--format", "ppm"], b"P6"),
        ("out.dat", ["--format", "png"], b"\x89PNG"),
        ("out.png", ["--format", "webp"], b"RIFF"),
        ("out.sgi", ["--format", "sgi"], b"\x01\xda"),
        ("out.rgb", [], b"\x01\xda"),
    ],
)
def test_format(stream: Path, tmp_path: Path, name: str, options: list[str], signature: bytes) -> None:
    target = tmp_path / "folder" / name
    target.parent.mkdir()
    done("decode", stream, target, *options)
    assert target.read_bytes().startswith(signature)


@pytest.mark.parametrize(
    ("target", "options", "complaint"),
    [
        ("out.xyz", "", "'xyz' is no picture format"),
        ("out", "", "has no extension"),
        ("out.png", "--format xyz", "'xyz' is no picture format"),
        ("out.sgi", "", "add --format sgi"),
        ("out.png", "--scale 0", "--scale"),
        ("out.png", "--scale 2 --size 5x5", "exclude each other"),
        ("out.png", "--region 48,0,20,20", "not inside the picture of 48×32"),
        ("out.png", "--boundless", "--boundless goes with --region"),
        ("out.png", "--region 0,0,0,5", "not inside"),
        ("out.png", "--scale " + "9" * 308, "scale"),
        ("out.png", "--scale 99999", "too many"),
        ("out.png", "--depth 12", "--depth"),
        ("out.png", "-j -2", "--threads"),
        ("nowhere/out.png", "", "does not exist"),
        (".", "--format png", "is a folder"),
    ],
)
def test_arguments_that_make_no_sense(stream: Path, tmp_path: Path, target: str, options: str, complaint: str) -> None:
    assert complaint in refused(2, "decode", stream, tmp_path / target, *options.split())
    assert [path.name for path in tmp_path.iterdir()] == ["scene.sgi"]


def test_an_existing_output_stays_without_force(stream: Path) -> None:
    target = stream.with_suffix(".png")
    target.write_bytes(b"old")
    assert refused(6, "decode", stream, target) == f"sgi: {target} exists; give -f to overwrite it\n"
    assert target.read_bytes() == b"old"
    done("decode", stream, target, "-f")
    assert read(target).pixels.shape == (32, 48, 3)


@pytest.mark.parametrize("more", [[], ["-f"], ["-f", "--format", "jpg"], ["-f", "--depth", "32"], ["-f", "-r"]])
def test_a_default_out_replaces_no_file(stream: Path, more: list[str]) -> None:
    """It may be the picture that the stream was made of."""
    originals = [stream.with_suffix(suffix) for suffix in (".png", ".jpg", ".tif")]
    for original in originals:
        original.write_bytes(b"original")
    result = sgi("decode", stream, *more)
    assert result.exit_code == (1 if "-r" in more else 6)
    assert "exists, and no default OUT replaces it; name OUT or --output-dir, with -f" in result.stderr
    assert [original.read_bytes() for original in originals] == [b"original"] * 3


@pytest.mark.parametrize("how", ["by position", "in a folder"])
def test_a_stream_that_was_matched_as_out_is_never_replaced(stream: Path, how: str) -> None:
    """`sgi decode *.sgi --format sgi -f` in a folder of two streams."""
    second = stream.with_name("second.sgi")
    second.write_bytes(stream.read_bytes())
    if how == "by position":
        result = sgi("decode", stream, second, "-f", "--format", "png")
        assert result.exit_code == 2
    else:
        result = sgi("decode", stream, "--output-dir", stream.parent, "-f", "--format", "sgi")
        assert result.exit_code == 1
    assert "a stream; decode many" in result.stderr or "both input and output" in result.stderr
    assert second.read_bytes() == stream.read_bytes()
    done("decode", stream, "-o", second, "-f", "--format", "png")
    assert second.read_bytes().startswith(b"\x89PNG")


def test_the_input_is_never_the_output(stream: Path) -> None:
    before = stream.read_bytes()
    refused(2, "decode", stream, stream, "-f", "--format", "sgi")
    assert stream.read_bytes() == before


def test_a_line_tells_what_was_written(stream: Path) -> None:
    target = stream.with_suffix(".png")
    result = sgi("decode", stream, "--scale", "1/2")
    line = rf"{re.escape(str(target))}: 24×16 pixels, rgb, {target.stat().st_size:,} bytes, \d+\.\d s\n"
    assert re.fullmatch(line, result.stdout)
    assert result.stderr == ""
    assert sgi("decode", stream, target, "-f", "--quiet").output == ""
    assert told("decode", stream, target, "-f")["width"] == 48


@pytest.mark.parametrize(
    ("spoil", "complaint"),
    [
        (lambda data: data[:-9], "cut short"),
        (lambda data: flipped(data, 8 * 60 + 2), ""),
        (lambda data: b"", "empty"),
        (lambda data: b"\x89PNG\r\n\x1a\n" + data, "this is a PNG file"),
        (lambda data: data.replace(b"\r\n", b"\n", 1), "text mode"),
    ],
)
@pytest.mark.parametrize("command", ["decode", "info", "verify"])
def test_spoilt_streams(stream: Path, command: str, spoil: Callable[[bytes], bytes], complaint: str) -> None:
    stream.write_bytes(spoil(stream.read_bytes()))
    line = refused(4, command, stream)
    assert line.startswith(f"sgi: {stream}: ")
    assert complaint in line
    assert list(stream.parent.iterdir()) == [stream]


@pytest.mark.parametrize("command", ["decode", "info", "verify"])
def test_streams_that_cannot_be_opened(tmp_path: Path, command: str) -> None:
    folder = "it is a folder; add -r to take the streams in it" if command == "decode" else "Is a directory"
    for path, complaint in ((tmp_path / "missing.sgi", "No such file or directory"), (tmp_path, folder)):
        assert refused(4, command, path) == f"sgi: {path}: {complaint}\n"
