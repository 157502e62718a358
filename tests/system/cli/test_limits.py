"""`sgi decode --max-pixels` and `--max-memory`."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from command import done, refused
from data_files import ATTACKS
from little_memory import needs_plain_memory

import sgicodec
from sgicodec.cli.limits import DecodeLimits
from sgicodec.errors import LimitError


@pytest.mark.parametrize("view", [(), ("--scale", "10"), ("--size", "480x320")])
def test_too_many_pixels(stream: Path, tmp_path: Path, view: tuple[str, ...]) -> None:
    """48×32 of them, or a hundred times as many."""
    most = 10 * (100 if view else 1)
    line = refused(4, "decode", stream, tmp_path / "a.png", "--max-pixels", most, *view)
    assert f"pixels are more than --max-pixels {most}\n" in line
    assert not list(tmp_path.glob("a.png"))
    done("decode", stream, tmp_path / "a.png", "--max-pixels", 480 * 320, *view)


def test_samples_that_take_too_much(tmp_path: Path) -> None:
    """60,000×60,000 pixels of nothing in 52 bytes, which one call would not render at all as it is."""
    decode = ("decode", ATTACKS / "mask_none_60k.sgi", tmp_path / "a.png")
    for options in ((), ("--scale", "1/4", "--max-memory", "500MiB")):
        line = refused(4, *decode, *options)
        assert list(tmp_path.iterdir()) == []
    assert "15000×15000 pixels take 858 MiB, more than --max-memory" in line
    done(*decode, "--region", "0,0,9,9", "--max-memory", "90M")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the system holds the limit")
def test_the_system_holds_the_limit() -> None:
    needs_plain_memory()
    with pytest.raises(LimitError, match="takes more than --max-memory, 20 MiB"), DecodeLimits(None, 20 << 20).held():
        bytearray(8 << 30)  # more than earlier tests may have left free
    bytearray(100 << 20)
    with DecodeLimits(None, 200 << 20).held():
        bytearray(100 << 20)
    with pytest.raises(MemoryError), DecodeLimits(None, None).held():
        raise MemoryError


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the system holds the limit")
@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.tif"])
def test_a_small_limit_leaves_a_picture_or_a_line(stream: Path, tmp_path: Path, name: str) -> None:
    """Processes of their own: a library that gets no memory may end its own."""
    needs_plain_memory()
    endings = set()
    for size in ("1MiB", "10MiB", "30MiB", "200MiB"):
        command = (sys.executable, "-m", "sgicodec", "decode", stream, tmp_path / name, "-f", "--max-memory", size)
        done = subprocess.run(command, capture_output=True, text=True)
        endings.add(done.returncode)
        if done.returncode == 0:
            assert sgicodec.read(tmp_path / name).pixels.shape == (32, 48, 3)
            (tmp_path / name).unlink()
        else:
            assert (done.returncode, done.stderr[:5], done.stderr.count("\n")) == (4, "sgi: ", 1), done.stderr
            assert list(tmp_path.glob("*a.*")) == []
    assert 0 in endings
