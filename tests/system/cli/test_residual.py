"""`sgi encode --lossless`, `--max-error`, `sgi decode --lossy`, `sgi refine`, `sgi strip`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from command import done, refused, sgi, told
from PIL import Image

from sgicodec import imwrite, read


def test_a_picture_comes_back(picture: Path, tmp_path: Path) -> None:
    out, back, lossy = tmp_path / "a.sgi", tmp_path / "a.png", tmp_path / "b.png"
    assert "without loss" in done("encode", picture, out, "--lossless", "--steps", 20).stdout
    done("decode", out, back)
    np.testing.assert_array_equal(read(back).pixels, read(picture).pixels)
    assert "those of the lossy picture" in sgi("decode", out, lossy, "--depth", 16).stderr
    said = sgi("decode", out, lossy, "--scale", 0.5, "-f").stderr
    assert "samples are those of the lossy picture: its residual layer has the stream's scale alone" in said
    assert done("decode", out, lossy, "--region", "5,6,20,20", "-f").stderr == ""
    assert done("decode", out, lossy, "--lossy", "--scale", 0.5, "-f").stderr == ""
    assert done("decode", out, lossy, "--lossy", "--depth", 8, "-f").stderr == ""
    assert (read(lossy).pixels != read(picture).pixels).any()
    facts = told("info", out)
    assert (facts["max_error"], facts["encoder"].split()[1]) == (0, "lossless")
    assert facts["parts"]["residual"] > 0
    assert sum(facts["parts"].values()) == out.stat().st_size
    assert "no sample is off" not in sgi("info", out).stdout
    assert "without loss" in sgi("info", out).stdout


def test_that_reductions_are_lossy_is_said(tmp_path: Path) -> None:
    """They are not the means of exact samples, as of a map of classes with nodata."""
    areas = np.kron(np.random.default_rng(1).integers(1, 9, (5, 7)), np.ones((80, 80), int)).astype(np.uint8)
    imwrite(tmp_path / "a.sgi", areas, nodata=1, effort=1)
    said = done("decode", tmp_path / "a.sgi", tmp_path / "a.tif", "--pyramid").stderr
    assert "reductions are those of the lossy picture: its residual layer has the stream's scale alone" in said
    np.testing.assert_array_equal(read(tmp_path / "a.tif").pixels[..., 0], areas)
    assert (
        done("decode", tmp_path / "a.sgi", tmp_path / "a.tif", "--pyramid", "--region", "0,0,99,99", "-f").stderr == ""
    )


def test_it_is_added_and_taken_off(picture: Path, tmp_path: Path) -> None:
    plain, near, again = tmp_path / "a.sgi", tmp_path / "b.sgi", tmp_path / "c.sgi"
    done("encode", picture, plain, "--steps", 20)
    (line,) = done("refine", picture, plain, near, "--max-error", 3).stdout.splitlines()
    assert "residual layer" in line
    assert "at most 3 levels" in sgi("info", near).stdout
    back = tmp_path / "near.png"
    done("decode", near, back)
    assert 0 < np.abs(read(back).pixels.astype(int) - read(picture).pixels).max() <= 3
    assert sgi("strip", near, again, "--quiet").stdout == ""
    assert again.read_bytes() == plain.read_bytes()


def test_text_is_left_whole(tmp_path: Path) -> None:
    page, out = tmp_path / "page.png", tmp_path / "page.sgi"
    pixels = np.full((60, 80, 3), 255, np.uint8)
    pixels[10:50:8, 6:70:3] = 30
    Image.fromarray(pixels).save(page)
    assert "without loss" in done("encode", page, out).stdout
    assert "without loss, in all views" in sgi("info", out).stdout
    for command in (("strip", out, tmp_path / "a.sgi"), ("decode", out, tmp_path / "a.png", "--lossy")):
        assert "in the residual layer alone" in refused(2, *command)
    done("decode", out, tmp_path / "half.png", "--scale", 0.5)
    half = pixels.reshape(30, 2, 40, 2, 3).mean(axis=(1, 3))
    assert np.abs(read(tmp_path / "half.png").pixels - half).max() <= 0.5


def test_refusals(picture: Path, tmp_path: Path) -> None:
    out = tmp_path / "a.sgi"
    line = refused(2, "encode", picture, out, "--lossless", "--max-error", 2)
    assert line == "sgi: --lossless and --max-error exclude each other\n"
    refused(2, "encode", picture, out, "--max-error", -1)
    assert not out.exists()
    refused(4, "strip", picture, out)
    done("encode", picture, out, "--steps", 20)
    before = out.read_bytes()
    refused(2, "strip", out, out)
    refused(3, "refine", tmp_path / "none.png", out, tmp_path / "b.sgi")
    assert "nor infinite" in refused(2, "refine", picture, out, tmp_path / "b.sgi", "--max-error", "inf")
    assert out.read_bytes() == before


def test_no_input_is_replaced(picture: Path, stream: Path, tmp_path: Path) -> None:
    before = picture.read_bytes(), stream.read_bytes()
    hard, soft, other = tmp_path / "hard.sgi", tmp_path / "soft.sgi", tmp_path / "other.sgi"
    hard.hardlink_to(picture)
    soft.symlink_to(stream)
    other.write_bytes(before[0])
    for out in (picture, hard, stream, soft, other):
        line = refused(2, "refine", picture, stream, out, "-f")
        assert "both input and output" in line or "it is a picture" in line
    for out in (picture, stream, soft):
        refused(2, "strip", stream, out, "-f")
    assert (picture.read_bytes(), stream.read_bytes()) == before


def test_standard_streams(picture: Path, stream: Path, tmp_path: Path) -> None:
    out, data = tmp_path / "b.sgi", stream.read_bytes()
    done("refine", picture, "-", out, stdin=data)
    result = sgi("refine", "-", stream, "-", stdin=picture.read_bytes())
    assert (result.stdout_bytes, result.stderr.startswith("stdout: ")) == (out.read_bytes(), True)
    result = sgi("strip", "-", "-", stdin=out.read_bytes())
    assert (result.stdout_bytes, result.stderr) == (data, f"stdout: {len(data):,} bytes\n")
    assert sgi("refine", "-", "-", "-", stdin=data).stderr == "sgi: stdin holds one file; name PICTURE or IN\n"
    assert sgi("strip", "-", "-", stdin=b"none").stderr.startswith("sgi: stdin: ")
    assert sgi("view", "-", stdin=data).stderr == "sgi: sgi view shows files and URLs, not stdin; name a file\n"
    by_name, by_stdin = sgi("compare", picture, stream), sgi("compare", picture, "-", stdin=data)
    assert (by_stdin.exit_code, by_stdin.stdout) == (0, by_name.stdout)
    assert {path.name for path in tmp_path.iterdir()} == {"scene.png", "scene.sgi", "b.sgi"}


def test_damage_is_not_copied(stream: Path, tmp_path: Path) -> None:
    data = stream.read_bytes()
    for at in range(8, len(data), 7):
        (tmp_path / "x.sgi").write_bytes(data[:at] + bytes([data[at] ^ 64]) + data[at + 1 :])
        assert "damaged" in refused(4, "strip", tmp_path / "x.sgi", tmp_path / "y.sgi")
        assert not (tmp_path / "y.sgi").exists()
