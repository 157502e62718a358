"""Whole fits and encodes that a GPU draws, with its kernels compiled for the host (tests/support/fake_cuda.cpp)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fake_cuda import backwards, fake_gpu, only_gpu

import sgicodec
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.device import ONE_THREAD, Device
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.fit.trainer import Fitted, Trainer
from sgicodec.model.layout import adaptive_layout
from sgicodec.picture import Picture
from sgicodec.profiles.default import default_settings, default_spec
from sgicodec.profiles.fit_settings import FitSettings

LMBDA, FAMILY = 0.004, 1


def smooth_picture(width: int, height: int) -> np.ndarray:
    """Samples [3, H, W] in 0..1 with an edge and two frequencies."""
    y, x = np.mgrid[:height, :width] / height
    waves = [0.2 * np.sin(7 * x + 3 * y + c) + 0.1 * np.cos(19 * x * (c + 1) - 11 * y) for c in range(3)]
    return np.asarray(np.stack(waves) + 0.5 + 0.1 * (x + y > 1), np.float32)


def fit(settings: FitSettings, device: Device) -> tuple[Fitted, list[float], Trainer]:
    """A fit, what its loss was at each step, and what fitted."""
    spec, target = default_spec(3), smooth_picture(80, 64) - np.float32(0.5)
    layout = adaptive_layout(target, 30 * LMBDA)
    trainer = Trainer(spec, settings, target, layout, FAMILY, load_prior(spec), device=device)
    seen = list(trainer.iterate())
    return trainer.result(), [10 ** (-p.psnr / 10) * target.size + LMBDA * p.bits for p in seen], trainer


def still(steps: int, coarse: bool = False) -> FitSettings:
    """Without pruning or growth, whose decisions differ where two float32 programs do."""
    settings = default_settings(LMBDA, steps, coarse)
    return replace(settings, phases=tuple(replace(phase, prune=0, grow=0) for phase in settings.phases))


@pytest.mark.parametrize("coarse", [False, True])
def test_the_loss_is_the_processors(coarse: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first one, and over the second half of a fit within 2 %: portable code and AVX2 differ by up to 0.9 % there,
    for Adam amplifies what float32 rounds.
    """
    losses = []
    for device in (only_gpu(monkeypatch), ONE_THREAD):
        _, loss, trainer = fit(still(80, coarse), device)
        assert trainer.device_name == ("processor" if device.gpu is None else fake_gpu().name)
        losses.append((loss[0], np.mean(loss[40:])))
    assert losses[0][0] == pytest.approx(losses[1][0], rel=1e-5)
    assert losses[0][1] == pytest.approx(losses[1][1], rel=2e-2)


def test_the_order_of_threads_and_blocks_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """In all kernels of a fit."""
    device = only_gpu(monkeypatch)
    forwards, *_ = fit(default_settings(LMBDA, 30), device)
    with backwards():
        other, *_ = fit(default_settings(LMBDA, 30), device)
    for name, values in forwards.attributes.items():
        np.testing.assert_array_equal(values, other.attributes[name])


@pytest.mark.parametrize("options", [{}, {"tune": "psnr", "texture": False}, {"bpp": 0.8}], ids=str)
def test_whole_streams(options: dict[str, object], monkeypatch: pytest.MonkeyPatch) -> None:
    """The same bytes twice, and about as good as the processor's: weights, texture and the λ controller included."""
    pixels = np.clip(smooth_picture(96, 64).transpose(1, 2, 0) * 256, 0, 255).astype(np.uint8)
    picture, settings = Picture(pixels, "rgb", (0, 255)), EncodeSettings(steps=70, **options)  # type: ignore[arg-type]
    device = only_gpu(monkeypatch)
    first, again, cpu = (encode_picture(picture, settings, device=d).data for d in (device, device, ONE_THREAD))
    assert first == again
    assert first != cpu
    errors = [float(((sgicodec.decode(data).astype(float) - pixels) ** 2).mean()) for data in (first, cpu)]
    assert 10 * abs(np.log10(errors[0] / errors[1])) < 1.5
    assert len(first) == pytest.approx(len(cpu), rel=0.15)
