"""What the viewer's folder lacks."""

from __future__ import annotations

from pathlib import Path

from sgicodec.server.viewer import missing_decoder


def test_a_decoder_that_was_not_compiled_is_named(tmp_path: Path) -> None:
    (tmp_path / "wasm").mkdir()
    (tmp_path / "wasm" / "sgi.wasm").touch()
    note = missing_decoder(tmp_path)
    assert note is not None
    assert "WebAssembly" in note
    assert "make viewer" in note
    (tmp_path / "wasm" / "sgi-scalar.wasm").touch()
    assert missing_decoder(tmp_path) is None
