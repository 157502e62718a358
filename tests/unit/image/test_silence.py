"""Lines of libpng, and of nobody else, are held back."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from sgicodec.image.silence import without_libpng


@pytest.mark.parametrize("is_png", [True, False])
def test_only_its_lines_go(capfd: pytest.CaptureFixture[str], is_png: bool) -> None:
    with without_libpng(is_png), without_libpng(is_png):
        os.write(2, b"libpng error: CgBI\nlibpng warning: iCCP\n")
        print("ours, libpng error: no", file=sys.stderr, flush=True)
        os.write(2, b"\x1b[2K half a line")
    os.write(2, b"\nafter\n")
    err = capfd.readouterr().err
    assert err.endswith("ours, libpng error: no\n\x1b[2K half a line\nafter\n")
    assert err.startswith("libpng") == (not is_png)


def test_after_an_error_all_is_as_before(capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ZeroDivisionError), without_libpng():
        print(1 / 0)
    os.write(2, b"libpng error: after\n")
    assert capfd.readouterr().err == "libpng error: after\n"


def test_a_closed_stderr_stays_closed(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    kept = os.dup(2)
    os.close(2)
    try:
        with without_libpng():
            assert not Path("/dev/fd/2").exists()
    finally:
        os.dup2(kept, 2)
        os.close(kept)
