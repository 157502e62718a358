"""The sources that are compiled at run time, and what Python reads of them."""

from __future__ import annotations

import pytest

from sgicodec.cuda import sources


def test_the_digest_follows_every_file(monkeypatch: pytest.MonkeyPatch) -> None:
    files = sources._all_of("cuda/kernels.cu")
    assert {"cuda/kernels.cu", "cuda/raster/tile_forward.hpp", "model/gaussians.hpp", "cmath"} <= files.keys()
    before = sources.digest("a")
    assert before == sources.digest("a") != sources.digest("b")
    monkeypatch.setattr(sources, "_all_of", lambda path: files | {"model/gaussians.hpp": "another"})
    assert sources.digest("a") != before


def test_constants_of_headers() -> None:
    assert sources.constants("cuda/raster/tiling.hpp") == {"kTileColumns": 32, "kTileRows": 16}
    assert sources.constants("cuda/base/scan.hpp") == {"kScanThreads": 256, "kScanItems": 8}
