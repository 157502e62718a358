"""`sgi decode --max-pixels` and `--max-memory`."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import Result
from sanitizer import needs_plain_memory

import sgicodec
from sgicodec.cli.limits import DecodeLimits
from sgicodec.cli.texts import NO_MEMORY
from sgicodec.errors import LimitError
from sgicodec.executors.peak import own_peak

Run = Callable[..., Result]
ATTACKS = Path(__file__).parents[2] / "data" / "attacks"


@pytest.mark.parametrize("view", [(), ("--scale", "10"), ("--size", "480x320")])
def test_too_many_pixels(sgi: Run, stream: Path, tmp_path: Path, view: tuple[str, ...]) -> None:
    """48×32 of them, or a hundred times as many."""
    most = 10 * (100 if view else 1)
    result = sgi("decode", stream, tmp_path / "a.png", "--max-pixels", most, *view)
    assert (result.exit_code, list(tmp_path.glob("a.png"))) == (4, [])
    assert f"pixels are more than --max-pixels {most}\n" in result.stderr
    assert sgi("decode", stream, tmp_path / "a.png", "--max-pixels", 480 * 320, *view).exit_code == 0


def test_samples_that_take_too_much(sgi: Run, tmp_path: Path) -> None:
    """60,000×60,000 pixels of nothing in 52 bytes, which one call would not render at all as it is."""
    for options in ((), ("--scale", "1/4", "--max-memory", "500MiB")):
        result = sgi("decode", ATTACKS / "mask_none_60k.sgi", tmp_path / "a.png", *options)
        assert (result.exit_code, list(tmp_path.iterdir())) == (4, []), result.stderr
    assert "15000×15000 pixels take 858 MiB, more than --max-memory" in result.stderr
    part = sgi(
        "decode", ATTACKS / "mask_none_60k.sgi", tmp_path / "a.png", "--region", "0,0,9,9", "--max-memory", "90M"
    )
    assert part.exit_code == 0, part.stderr


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the system holds the limit")
def test_the_system_holds_the_limit() -> None:
    needs_plain_memory()
    with pytest.raises(LimitError, match="takes more than --max-memory, 20 MiB"), DecodeLimits(None, 20 << 20).held():
        bytearray(100 << 20)
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


@pytest.mark.parametrize("text", NO_MEMORY)
def test_what_libraries_say_of_too_little_memory(text: str) -> None:
    with pytest.raises(LimitError, match="takes more than --max-memory"), DecodeLimits(None, 1e9).held():
        raise ImportError(f"libx.so: {text}")


def test_other_failures_pass_through() -> None:
    with pytest.raises(RuntimeError, match="something else"), DecodeLimits(None, 1e9).held():
        raise RuntimeError("something else")


def test_what_is_left_of_the_control_group(
    sgi: Run, stream: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whoever takes more is ended without a word: it is refused before, if nobody says another limit."""
    left = 20 << 20
    monkeypatch.setattr("sgicodec.cli.limits.group_memory", lambda: (own_peak() or 0) + left)
    arguments = ("decode", stream, tmp_path / "a.png", "--scale", "100")
    assert sgi(*arguments).exit_code == 4
    assert sgi(*arguments, "--max-memory", "900MiB").exit_code == 0
    left = 100 << 20
    assert sgi(*arguments, "-f").exit_code == 0


def test_what_writers_hold_counts(sgi: Run, stream: Path, tmp_path: Path) -> None:
    """The writer of JPEG 2000 takes nine times the samples, and crashes where it does not get them."""
    limit = ("--scale", "20", "--max-memory", "9MiB")
    assert sgi("decode", stream, tmp_path / "a.ppm", *limit).exit_code == 0
    result = sgi("decode", stream, tmp_path / "a.jp2", *limit)
    assert "960×640 pixels take 18 MiB, more than --max-memory" in result.stderr
    assert result.exit_code == 4


def test_a_stream_that_is_not_sound_gets_no_samples(
    sgi: Run, stream: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of one tile, whose payload is decoded first."""
    from sgicodec.decoder.stream import Stream

    drawn = []
    real = Stream._draw
    monkeypatch.setattr(Stream, "_draw", lambda *arguments: drawn.append(arguments) or real(*arguments))
    assert sgi("decode", stream, tmp_path / "sound.png").exit_code == 0
    assert drawn
    drawn.clear()
    data = bytearray(stream.read_bytes())
    data[-20] ^= 1
    stream.write_bytes(data)
    assert sgi("decode", stream, tmp_path / "a.png").exit_code == 4
    assert not drawn
