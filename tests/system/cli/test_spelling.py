"""Command lines that are nearly right: what they are answered with, and that nothing is written."""

from __future__ import annotations

from pathlib import Path

import pytest
from command import sgi


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
