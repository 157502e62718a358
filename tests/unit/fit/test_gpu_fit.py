"""Whole encodes that a GPU draws, with its kernels compiled for the host (tests/support/fake_cuda.cpp)."""

from __future__ import annotations

import numpy as np
import pytest
from fake_cuda import backwards, only_gpu

import sgicodec
from sgicodec.device import ONE_THREAD
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.picture import Picture


@pytest.mark.parametrize("options", [{}, {"tune": "psnr", "texture": False}, {"bpp": 0.8}], ids=str)
def test_whole_streams(options: dict[str, object], monkeypatch: pytest.MonkeyPatch) -> None:
    """The same bytes in any order of threads and blocks, and about as good as the processor's: weights, texture and
    targets included.
    """
    y, x = np.mgrid[:64, :96] / 64
    waves = [0.2 * np.sin(7 * x + 3 * y + c) + 0.1 * np.cos(19 * x * (c + 1) - 11 * y) for c in range(3)]
    pixels = np.clip((np.stack(waves, axis=2) + 0.5 + 0.1 * (x + y > 1)[..., None]) * 256, 0, 255).astype(np.uint8)
    picture, settings = Picture(pixels, "rgb", (0, 255)), EncodeSettings(steps=70, **options)  # type: ignore[arg-type]
    device = only_gpu(monkeypatch)
    first, cpu = (encode_picture(picture, settings, device=d).data for d in (device, ONE_THREAD))
    with backwards():
        assert encode_picture(picture, settings, device=device).data == first
    assert first != cpu
    errors = [float(((sgicodec.decode(data).astype(float) - pixels) ** 2).mean()) for data in (first, cpu)]
    assert 10 * abs(np.log10(errors[0] / errors[1])) < 1.5
    assert len(first) == pytest.approx(len(cpu), rel=0.15)
