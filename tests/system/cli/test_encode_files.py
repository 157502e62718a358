"""The files of `sgi encode`: which pictures it takes, and where streams go."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import Result
from PIL import Image

from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.tile.state import TileState
from sgicodec.encoder.tile.writing import WrittenTile
from sgicodec.encoder.tiles import tasks
from sgicodec.image import read, write
from sgicodec.picture import Picture

Run = Callable[..., Result]


ODD = Path(__file__).parents[2] / "data" / "pictures"


def test_an_existing_output_stays(sgi: Run, picture: Path, asked: dict[str, Any]) -> None:
    target = picture.with_suffix(".sgi")
    target.write_bytes(b"old")
    result = sgi("encode", picture, target)
    assert result.exit_code == 6
    assert result.stderr == f"sgi: {target} exists; give -f to overwrite it\n"
    assert target.read_bytes() == b"old"
    assert asked == {}


def test_force_overwrites(sgi: Run, picture: Path) -> None:
    target = picture.with_suffix(".sgi")
    target.write_bytes(b"old")
    assert sgi("encode", picture, target, "-f", "--steps", 2).exit_code == 0
    assert sgi("verify", target).exit_code == 0


@pytest.mark.parametrize("old", [b"old", b"", b"\x89SGX not ours"])
@pytest.mark.parametrize("more", [[], ["-f"], ["-f", "-r"]])
def test_a_default_out_replaces_streams_alone(sgi: Run, picture: Path, old: bytes, more: list[str]) -> None:
    target = picture.with_suffix(".sgi")
    target.write_bytes(old)
    result = sgi("encode", picture, "--steps", 2, *more)
    assert result.exit_code == (1 if "-r" in more else 6)
    assert "exists, and no default OUT replaces it; name OUT or --output-dir, with -f" in result.stderr
    assert target.read_bytes() == old


@pytest.mark.parametrize("more", [[], ["-r"]])
def test_a_stream_beside_its_picture_is_replaced_with_force(
    sgi: Run, picture: Path, stream: Path, more: list[str]
) -> None:
    before = stream.read_bytes()
    assert sgi("encode", picture, "--steps", 2, *more).exit_code == (1 if more else 6)
    assert stream.read_bytes() == before
    assert sgi("encode", picture, "-f", "--steps", 2, *more).exit_code == 0
    assert stream.read_bytes() != before


def test_failure_leaves_nothing(sgi: Run, picture: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = tasks.write

    def damaged(state: TileState) -> WrittenTile:
        whole = real(state)
        chunk = bytearray(whole.chunk)
        chunk[len(chunk) // 2] ^= 1
        return replace(whole, chunk=bytes(chunk))

    monkeypatch.setattr(tasks, "write", damaged)
    result = sgi("encode", picture, "--steps", 2)
    assert result.exit_code == 4
    assert result.stderr.startswith("sgi: ")
    assert [path.name for path in picture.parent.iterdir()] == ["scene.png"]


@pytest.mark.parametrize("name", ["x.sgi", "x.SGI"])
def test_a_silicon_graphics_picture_needs_an_out(sgi: Run, tmp_path: Path, name: str) -> None:
    source = tmp_path / name
    source.write_bytes((ODD / "hopper.sgi").read_bytes())
    result = sgi("encode", source, "-f", "--steps", 2)
    assert result.exit_code == 2
    assert result.stderr == f"sgi: {source} already ends in .sgi; name OUT\n"
    assert source.read_bytes() == (ODD / "hopper.sgi").read_bytes()
    assert sgi("encode", source, tmp_path / "out.sgi", "--steps", 2).exit_code == 0


def test_the_input_is_never_the_output(sgi: Run, picture: Path) -> None:
    before = picture.read_bytes()
    link = picture.with_name("link.png")
    link.symlink_to(picture)
    for target in (picture, link):
        result = sgi("encode", picture, target, "-f")
        assert result.exit_code == 2
        assert "both input and output" in result.stderr
    assert picture.read_bytes() == before


@pytest.mark.parametrize("source", ["/", ".", ".."])
def test_a_folder_is_no_picture(sgi: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, source: str) -> None:
    monkeypatch.chdir(tmp_path)
    result = sgi("encode", source, "-f")
    text = f"sgi: {source}: it is a folder; add -r to take the pictures in it\n"
    assert (result.exit_code, result.stderr) == (3, text)


def test_an_empty_name_is_no_file(sgi: Run, picture: Path) -> None:
    assert sgi("encode", "").exit_code == 3
    assert sgi("encode", picture, "").exit_code == 2


@pytest.mark.parametrize("options", [("-o", ""), ("--output-dir", "")])
@pytest.mark.parametrize("command", ["encode", "decode"])
def test_an_empty_name_is_no_default(
    sgi: Run, picture: Path, asked: dict[str, Any], command: str, options: Any
) -> None:
    result = sgi(command, picture, "-f", *options)
    assert result.exit_code == 2
    assert "the name is empty" in result.stderr
    assert asked == {}


@pytest.mark.parametrize("target", ["nowhere/out.sgi", "."])
def test_targets_that_cannot_be(sgi: Run, picture: Path, asked: dict[str, Any], target: str) -> None:
    result = sgi("encode", picture, picture.parent / target)
    assert result.exit_code == 2
    assert "folder" in result.stderr
    assert asked == {}


def test_a_full_device(sgi: Run, picture: Path) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("this system has no /dev/full")
    result = sgi("encode", picture, "/dev/full", "--steps", 2)
    assert result.exit_code == 4
    assert result.stderr == "sgi: /dev/full: No space left on device\n"


@pytest.mark.parametrize("name", ["truncated_jpeg.jpg", "xcsn0g01.png", "README.md", "missing.png", "."])
def test_unreadable_pictures(sgi: Run, tmp_path: Path, name: str) -> None:
    result = sgi("encode", ODD / name, tmp_path / "out.sgi")
    assert result.exit_code == 3
    assert result.stderr.startswith(f"sgi: {ODD / name}: ")
    assert result.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_too_many_channels(sgi: Run, tmp_path: Path) -> None:
    write(Picture(np.zeros((4, 4, 65), np.uint8), "multi", (0.0, 255.0)), tmp_path / "many.tif")
    result = sgi("encode", tmp_path / "many.tif")
    assert result.exit_code == 3
    assert "at most 64 channels" in result.stderr


def test_a_stream_is_no_picture(sgi: Run, stream: Path, tmp_path: Path) -> None:
    for more in ([tmp_path / "again.sgi"], []):
        result = sgi("encode", stream, *more)
        assert result.exit_code == 3
        assert "decode it first" in result.stderr


@pytest.mark.parametrize("more", [[], ["-f"]])
def test_a_picture_that_was_matched_as_out_is_never_overwritten(sgi: Run, picture: Path, more: list[str]) -> None:
    """`sgi encode *.png` in a folder of two pictures."""
    second = picture.with_name("second.png")
    second.write_bytes(picture.read_bytes())
    result = sgi("encode", picture, second, *more)
    assert result.exit_code == 2
    assert "second.png would be OUT" in result.stderr
    assert "--output-dir" in result.stderr
    assert second.read_bytes() == picture.read_bytes()


@pytest.mark.parametrize("name", ["hopper.sgi", "icc_profile.png", "truncated_jpeg.jpg", "la.tga"])
def test_a_picture_is_known_by_its_content(sgi: Run, picture: Path, name: str) -> None:
    """Whether it is called a stream, is damaged, or is of a format without a signature."""
    target = picture.with_name("x.sgi")
    target.write_bytes((ODD / name).read_bytes())
    result = sgi("encode", picture, target, "-f")
    assert result.exit_code == 2
    assert "it is a picture" in result.stderr
    assert target.read_bytes() == (ODD / name).read_bytes()
    assert sgi("encode", picture, "-f").exit_code == 0  # scene.sgi


def test_the_default_out_is_no_picture_either(sgi: Run, picture: Path) -> None:
    beside = picture.with_suffix(".sgi")
    beside.write_bytes((ODD / "hopper.sgi").read_bytes())
    result = sgi("encode", picture, "-f")
    assert result.exit_code == 2
    assert beside.read_bytes() == (ODD / "hopper.sgi").read_bytes()


@pytest.mark.parametrize("name", ["x.bin", "x.png", "x.sgi.bak"])
def test_out_has_the_suffix_of_streams_or_is_named(sgi: Run, picture: Path, name: str) -> None:
    target = picture.with_name(name)
    result = sgi("encode", picture, target)
    assert result.exit_code == 2
    assert "does not end in .sgi" in result.stderr
    assert not target.exists()
    assert sgi("encode", picture, "-o", target, "--steps", 2).exit_code == 0
    with open_stream(target) as stream:
        assert stream.width == 48


def test_a_named_out_is_overwritten_with_force_alone(sgi: Run, picture: Path) -> None:
    target = picture.with_name("second.png")
    target.write_bytes(picture.read_bytes())
    assert sgi("encode", picture, "-o", target).exit_code == 6
    assert sgi("encode", picture, "-o", target, "-f", "--steps", 2).exit_code == 0
    with open_stream(target) as stream:
        assert stream.width == 48


def test_a_stream_and_what_is_left_of_one_are_overwritten(sgi: Run, picture: Path, stream: Path) -> None:
    for data in (stream.read_bytes(), stream.read_bytes()[:20], b""):
        target = picture.with_name("x.sgi")
        target.write_bytes(data)
        assert sgi("encode", picture, target, "-f", "--steps", 2).exit_code == 0


@pytest.mark.parametrize("command", ["encode", "decode"])
def test_a_named_out_goes_with_one_in(sgi: Run, picture: Path, stream: Path, command: str) -> None:
    for more in ([picture.with_name("x.sgi")], ["--output-dir", picture.parent]):
        result = sgi(command, picture if command == "encode" else stream, *more, "-o", picture.with_name("y.sgi"))
        assert result.exit_code == 2
        assert "one IN" in result.stderr


def test_a_picture_of_avif_is_encoded_upright(sgi: Run, picture: Path, tmp_path: Path) -> None:
    source = tmp_path / "photo.avif"
    tags = Image.Exif()
    tags[274] = 6
    Image.fromarray(read(picture).pixels).save(source, exif=tags)
    result = sgi("encode", source, "-e1")
    assert result.exit_code == 0, result.output
    with open_stream(tmp_path / "photo.sgi") as stream:
        assert (stream.width, stream.height) == (32, 48)
