"""The files of `sgi encode`: which pictures it takes, and where streams go."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from command import done, refused, sgi
from data_files import PICTURES

from sgicodec import imread


def test_an_existing_output_stays(picture: Path, asked: dict[str, Any]) -> None:
    target = picture.with_suffix(".sgi")
    target.write_bytes(b"old")
    assert refused(6, "encode", picture, target) == f"sgi: {target} exists; give -f to overwrite it\n"
    assert target.read_bytes() == b"old"
    assert asked == {}


@pytest.mark.parametrize("old", [b"old", b"", b"\x89SGX not ours"])
@pytest.mark.parametrize("more", [[], ["-f"], ["-f", "-r"]])
def test_a_default_out_replaces_streams_alone(picture: Path, old: bytes, more: list[str]) -> None:
    target = picture.with_suffix(".sgi")
    target.write_bytes(old)
    result = sgi("encode", picture, "--steps", 2, *more)
    assert result.exit_code == (1 if "-r" in more else 6)
    assert "exists, and no default OUT replaces it; name OUT or --output-dir, with -f" in result.stderr
    assert target.read_bytes() == old


@pytest.mark.parametrize("more", [[], ["-r"]])
def test_a_stream_beside_its_picture_is_replaced_with_force(picture: Path, stream: Path, more: list[str]) -> None:
    before = stream.read_bytes()
    assert sgi("encode", picture, "--steps", 2, *more).exit_code == (1 if more else 6)
    assert stream.read_bytes() == before
    done("encode", picture, "-f", "--steps", 2, *more)
    assert stream.read_bytes() != before


def test_the_input_is_never_the_output(picture: Path) -> None:
    before = picture.read_bytes()
    link = picture.with_name("link.png")
    link.symlink_to(picture)
    for target in (picture, link):
        assert "both input and output" in refused(2, "encode", picture, target, "-f")
    assert picture.read_bytes() == before


@pytest.mark.parametrize("name", ["truncated_jpeg.jpg", "xcsn0g01.png", "README.md", "missing.png", "."])
def test_unreadable_pictures(tmp_path: Path, name: str) -> None:
    assert refused(3, "encode", PICTURES / name, tmp_path / "out.sgi").startswith(f"sgi: {PICTURES / name}: ")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("more", [[], ["-f"]])
def test_a_picture_that_was_matched_as_out_is_never_overwritten(picture: Path, more: list[str]) -> None:
    """`sgi encode *.png` in a folder of two pictures."""
    second = picture.with_name("second.png")
    second.write_bytes(picture.read_bytes())
    line = refused(2, "encode", picture, second, *more)
    assert "second.png would be OUT" in line
    assert "--output-dir" in line
    assert second.read_bytes() == picture.read_bytes()


@pytest.mark.parametrize("name", ["hopper.sgi", "icc_profile.png", "truncated_jpeg.jpg", "la.tga"])
def test_a_picture_is_known_by_its_content(picture: Path, name: str) -> None:
    """Whether it is called a stream, is damaged, or is of a format without a signature."""
    target = picture.with_name("x.sgi")
    target.write_bytes((PICTURES / name).read_bytes())
    assert "it is a picture" in refused(2, "encode", picture, target, "-f")
    assert target.read_bytes() == (PICTURES / name).read_bytes()
    done("encode", picture, "-f")  # scene.sgi


@pytest.mark.parametrize("name", ["x.bin", "x.png", "x.sgi.bak"])
def test_out_has_the_suffix_of_streams_or_is_named(picture: Path, name: str) -> None:
    target = picture.with_name(name)
    assert "does not end in .sgi" in refused(2, "encode", picture, target)
    assert not target.exists()
    done("encode", picture, "-o", target, "--steps", 2)
    assert imread(target).shape == (32, 48, 3)
