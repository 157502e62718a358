"""Streams stay open while there is room, and while they are used; what the viewer's folder lacks."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from data_files import GOLDEN

from sgicodec.device import Device
from sgicodec.errors import StreamError
from sgicodec.server.open_streams import OpenStreams
from sgicodec.server.viewer import missing_decoder

NAMES = ("rgb8", "gray16", "rgba8")


@pytest.fixture
def streams() -> OpenStreams:
    return OpenStreams(2, Device(1))


def test_the_last_ones_stay(streams: OpenStreams) -> None:
    opened = []
    for name in NAMES:
        with streams.opened(GOLDEN / f"{name}.sgi") as stream:
            opened.append(stream)
    assert [stream.closed for stream in opened] == [True, False, False]
    with streams.opened(GOLDEN / "gray16.sgi") as stream:
        assert stream is opened[1]
    streams.close()
    assert all(stream.closed for stream in opened)


def test_a_file_that_changed_is_another(streams: OpenStreams, tmp_path: Path) -> None:
    path = tmp_path / "a.sgi"
    shutil.copy(GOLDEN / "rgb8.sgi", path)
    with streams.opened(path) as stream:
        before = stream.shape
    shutil.copy(GOLDEN / "gray16.sgi", path)
    with streams.opened(path) as stream:
        assert stream.shape != before


def test_errors_do_not_name_the_path(streams: OpenStreams, tmp_path: Path) -> None:
    (tmp_path / "a.sgi").write_bytes(b"no stream")
    for name in ("a.sgi", "b.sgi"):
        with pytest.raises(StreamError) as caught, streams.opened(tmp_path / name):
            pass
        assert str(tmp_path) not in str(caught.value)
    assert len(streams) == 0


def test_a_decoder_that_was_not_compiled_is_named(tmp_path: Path) -> None:
    (tmp_path / "wasm").mkdir()
    (tmp_path / "wasm" / "sgi.wasm").touch()
    note = missing_decoder(tmp_path)
    assert "WebAssembly" in note
    assert "make viewer" in note
    (tmp_path / "wasm" / "sgi-scalar.wasm").touch()
    assert missing_decoder(tmp_path) is None
