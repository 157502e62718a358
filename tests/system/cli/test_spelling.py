"""Command lines that are nearly right: what they are answered with, and that nothing is written."""

from __future__ import annotations

from pathlib import Path

import pytest
from command import sgi


@pytest.mark.parametrize(
    ("line", "written", "right"),
    [
        ("encode scene.png --size 20 kB", "--size 20 kB", "--size 20kB"),
        ("encode scene.png --max-memory 2 GiB x.sgi", "--max-memory 2 GiB", "--max-memory 2GiB"),
        ("encode scene.png -q 80 %", "-q 80 %", "-q 80"),
        ("encode scene.png -q80 percent", "-q80 percent", "-q 80"),
        ("encode scene.png --psnr 35 dB -f", "--psnr 35 dB", "--psnr 35"),
        ("serve streams --max-age 2 min", "--max-age 2 min", "--max-age 120"),
        ("encode scene.png --range 0, 1", "--range 0, 1", "--range 0,1"),
        ("encode scene.png --range 0 4095", "--range 0 4095", "--range 0,4095"),
        ("decode scene.sgi --region 0, 0, 10, 10", "--region 0, 0, 10, 10", "--region 0,0,10,10"),
        ("decode scene.sgi --region -4, -2, 10, 10", "--region -4, -2, 10, 10", "--region -4,-2,10,10"),
        ("decode scene.sgi --size 512 x 384", "--size 512 x 384", "--size 512x384"),
        ("decode scene.sgi --size 512 384", "--size 512 384", "--size 512x384"),
        ("decode scene.sgi --scale 50 %", "--scale 50 %", "--scale 50%"),
        ("decode scene.sgi --scale 1 / 4", "--scale 1 / 4", "--scale 1/4"),
        ("bench . --qualities 20, 30", "--qualities 20, 30", "--qualities 20,30"),
    ],
)
def test_a_space_in_a_value(
    picture: Path, stream: Path, monkeypatch: pytest.MonkeyPatch, line: str, written: str, right: str
) -> None:
    monkeypatch.chdir(picture.parent)
    result = sgi(*line.split())
    command = line.split()[0]
    text = f"sgi: a space splits {written!r}; write {right!r}; see sgi {command} --help\n"
    assert (result.exit_code, result.stderr) == (2, text)
    assert sorted(path.name for path in picture.parent.iterdir()) == ["scene.png", "scene.sgi"]


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        ("-q high", "a number from 1 to 100, as in 90 (visually lossless), 65 (web) or 40 (preview)"),
        ("--quality 80%", "a number from 1 to 100"),
        ("-q lossless", "a number from 1 to 100"),
        ("--psnr 35dB", "a number of dB, as in 35"),
        ("--ssimulacra2 good", "a SSIMULACRA 2 score, as in 70"),
        ("--bpp 1bpp", "a number of bits per pixel, as in 0.5"),
        ("-e fast", "a valid integer from 1 to 9, as in 2 (fast)"),
        ("--effort 2.5", "a valid integer from 1 to 9"),
    ],
)
def test_a_word_for_a_number(picture: Path, line: str, wanted: str) -> None:
    result = sgi("encode", picture, *line.split())
    assert result.exit_code == 2
    assert f"is not {wanted}" in result.stderr
    assert "float" not in result.stderr
