"""`sgi verify` as a user types it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import Result
from surgery import join, split

from sgicodec import EncodeSettings, Picture, encode_picture
from sgicodec.bitstream.container import SIGNATURE
from sgicodec.cli import verify as module
from sgicodec.decoder.stream import Stream, open_stream

ATTACKS = Path(__file__).parents[2] / "data" / "attacks"

Run = Callable[..., Result]


def test_sound(sgi: Run, stream: Path) -> None:
    with open_stream(stream) as opened:
        crc = opened.symbol_crc
    result = sgi("verify", stream)
    assert (result.exit_code, result.stdout) == (0, f"{stream}: ok, 48×32 pixels, symbols {crc:08x}\n")
    assert sgi("verify", "-", "-j", 1, stdin=stream.read_bytes()).stdout.startswith("stdin: ok")


def test_every_flipped_byte_is_found(sgi: Run, stream: Path) -> None:
    whole = stream.read_bytes()
    for at in range(0, len(whole), max(1, len(whole) // 60)):
        stream.write_bytes(whole[:at] + bytes([whole[at] ^ 0x10]) + whole[at + 1 :])
        result = sgi("verify", stream)
        assert (result.exit_code, result.stdout) == (4, ""), at
        assert result.stderr.count("\n") == 1


def test_an_overview_is_verified(sgi: Run, tmp_path: Path) -> None:
    out = tmp_path / "out.sgi"
    settings = EncodeSettings(steps=1, tile=32, overview=True)
    out.write_bytes(encode_picture(Picture(np.zeros((40, 70, 1), np.uint8), "gray", (0.0, 255.0)), settings).data)
    assert sgi("verify", out).exit_code == 0
    data = bytearray(out.read_bytes())
    data[data.index(SIGNATURE, 1) + 30] ^= 1
    out.write_bytes(data)
    assert sgi("verify", out).exit_code == 4


def test_all_rows_are_drawn_in_bands(sgi: Run, stream: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = []
    real = Stream.render

    def render(self: Stream, region: tuple[int, int, int, int]) -> np.ndarray:
        drawn.append(region)
        return real(self, region)

    monkeypatch.setattr(Stream, "render", render)
    monkeypatch.setattr(module, "_BAND_SAMPLES", 48 * 3 * 10)
    assert sgi("verify", stream).exit_code == 0
    assert drawn == [(0, 0, 48, 10), (0, 10, 48, 10), (0, 20, 48, 10), (0, 30, 48, 2)]


def test_samples_without_a_value(sgi: Run, stream: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Stream, "render", lambda *_, **__: np.array([[[0.5], [np.nan]]]))
    result = sgi("verify", stream)
    assert result.exit_code == 4
    assert "without a value" in result.stderr


def test_overviews_are_not_followed(sgi: Run, tmp_path: Path) -> None:
    """A thousand of one pixel, each in another."""
    dot = encode_picture(Picture(np.zeros((1, 1, 1), np.uint8), "gray", (0.0, 255.0)), EncodeSettings(steps=1)).data
    header, *rest = split(dot)
    nested = dot
    for _ in range(1000):
        nested = join([header, ("o", nested), *rest])
    out = tmp_path / "nested.sgi"
    out.write_bytes(nested)
    result = sgi("verify", out)
    assert (result.exit_code, result.stderr) == (4, f"sgi: {out}: overview: it is no smaller than the picture\n")


def test_many_files(sgi: Run, shared: Path, tmp_path: Path) -> None:
    good, bad = [shared / "scene.sgi", shared / "float.sgi"], tmp_path / "cut.sgi"
    bad.write_bytes(good[0].read_bytes()[:-3])
    assert sgi("verify", *good).stdout.count(": ok, 48×32 pixels") == 2
    assert sgi("verify", *good, "--quiet").output == ""
    result = sgi("verify", good[0], bad, good[1])
    assert result.exit_code == 1
    assert result.stdout.count(": ok, ") == 2
    first, last = result.stderr.splitlines()
    assert first.startswith(f"sgi: {bad}: ")
    assert last == "sgi: 1 of 3 files failed"


def test_json(sgi: Run, stream: Path) -> None:
    with open_stream(stream) as opened:
        crc = f"{opened.symbol_crc:08x}"
    facts = {"schema": 1, "input": str(stream), "ok": True, "error": None, "width": 48, "height": 32}
    found = json.loads(sgi("verify", stream, "--json").stdout)
    assert found == facts | {"bytes": stream.stat().st_size, "tiles": 1, "symbol_crc": crc}
    stream.write_bytes(stream.read_bytes()[:-3])
    result = sgi("verify", stream, "--json")
    assert result.exit_code == 4
    found = json.loads(result.stdout)
    assert (found["ok"], f"sgi: {found['error']}\n") == (False, result.stderr)


@pytest.mark.parametrize("name", ["none_60k", "none_2_17"])
def test_a_picture_of_nothing_is_not_drawn(sgi: Run, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """52 bytes that claim up to 2³⁴ pixels."""

    def render(self: Stream, region: object) -> None:
        raise AssertionError(f"drawn: {region}")

    monkeypatch.setattr(Stream, "render", render)
    result = sgi("verify", ATTACKS / f"mask_{name}.sgi")
    assert result.exit_code == 0, result.stderr
