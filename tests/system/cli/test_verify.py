"""`sgi verify` as a user types it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from command import done, refused, sgi
from data_files import GOLDEN
from surgery import join, split

from sgicodec import EncodeSettings, Picture, encode_picture
from sgicodec.bitstream.container import SIGNATURE
from sgicodec.decoder.stream import open_stream


def test_sound(stream: Path) -> None:
    with open_stream(stream) as opened:
        crc = opened.symbol_crc
    assert done("verify", stream).stdout == f"{stream}: ok, 48×32 pixels, symbols {crc:08x}\n"
    assert sgi("verify", "-", "-j", 1, stdin=stream.read_bytes()).stdout.startswith("stdin: ok")


def test_a_residual_layer_is_verified(tmp_path: Path) -> None:
    """All of it but its first fields: N may be another number, with samples that are as they were."""
    golden = GOLDEN / "gray16-lossless-blocks.sgi"
    whole, path = golden.read_bytes(), tmp_path / "a.sgi"
    path.write_bytes(whole)
    done("verify", path)
    for at in range(140, len(whole), len(whole) // 80):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0x10]) + whole[at + 1 :])
        assert sgi("verify", path).exit_code == 4, at


def test_a_layer_of_text_alone_is_verified(tmp_path: Path) -> None:
    data = (GOLDEN / "rgb8-mixed.sgi").read_bytes()
    parts = split(data)
    layer = bytearray(dict(parts)["r"])
    layer[-40] ^= 0x10
    damaged = tmp_path / "mixed.sgi"
    damaged.write_bytes(join([(kind, bytes(layer) if kind == "r" else payload) for kind, payload in parts]))
    done("verify", GOLDEN / "rgb8-mixed.sgi")
    assert "residual layer" in refused(4, "verify", damaged)


def test_an_overview_is_verified(tmp_path: Path) -> None:
    out = tmp_path / "out.sgi"
    settings = EncodeSettings(steps=1, tile=32, overview=True)
    out.write_bytes(encode_picture(Picture(np.zeros((40, 70, 1), np.uint8), "gray", (0.0, 255.0)), settings).data)
    done("verify", out)
    data = bytearray(out.read_bytes())
    data[data.index(SIGNATURE, 1) + 30] ^= 1
    out.write_bytes(data)
    refused(4, "verify", out)
