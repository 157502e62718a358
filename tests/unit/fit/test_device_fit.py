"""Whole fits and encodes with a GPU, of which the kernels are compiled for the host (tests/support/fake_cuda.cpp)."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from fake_cuda import backwards, fake_gpu, only_gpu

import sgicodec
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.device import ONE_THREAD, Device
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.fit.context_weights import ContextWeights
from sgicodec.fit.trainer import Fitted, Progress, Trainer
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


def fit(settings: FitSettings, device: Device, prior: int = 3) -> tuple[Fitted, list[float], Trainer]:
    """A fit, what its loss was at each step, and what fitted."""
    spec, target = default_spec(3, prior=prior), smooth_picture(80, 64) - np.float32(0.5)
    networks = load_prior(spec) if prior else None
    trainer = Trainer(spec, settings, target, adaptive_layout(target, 30 * LMBDA), FAMILY, networks, device=device)
    seen: list[Progress] = []
    fitted = trainer.run(lambda progress: not seen.append(progress))
    return fitted, [10 ** (-p.psnr / 10) * target.size + LMBDA * p.bits for p in seen], trainer


def still(steps: int, low_effort: bool = False) -> FitSettings:
    """Without pruning or growth, whose decisions differ where two float32 programs do."""
    settings = default_settings(LMBDA, steps, low_effort)
    return replace(settings, phases=tuple(replace(phase, prune=0, grow=0) for phase in settings.phases))


@pytest.mark.parametrize(("prior", "low_effort"), [(3, False), (0, False), (3, True)])
def test_the_loss_is_the_processors(prior: int, low_effort: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Over the second half of a fit, within 1 %, as two instruction sets are: their cutoffs differ, noise amplifies."""
    losses = []
    for device in (only_gpu(monkeypatch), ONE_THREAD):
        _, loss, trainer = fit(still(80, low_effort), device, prior)
        assert (trainer.on_gpu is not None) == (device.gpu is not None)
        losses.append(np.mean(loss[40:]))
    assert losses[0] == pytest.approx(losses[1], rel=1e-2)


def test_two_fits_are_the_same_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Through pruning and growth."""
    device = only_gpu(monkeypatch)
    (first, *_), (second, *_) = (fit(default_settings(LMBDA, 60), device) for _ in range(2))
    np.testing.assert_array_equal(first.layout.corner, second.layout.corner)
    for name, values in first.attributes.items():
        np.testing.assert_array_equal(values, second.attributes[name])
        assert values.std() > 0


@pytest.mark.parametrize("prior", [3, 0])
def test_the_order_of_threads_and_blocks_changes_nothing(prior: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """In all kernels of a fit, with a prior and with a network that trains."""
    device = only_gpu(monkeypatch)
    forwards, *_ = fit(default_settings(LMBDA, 30), device, prior)
    with backwards():
        other, *_ = fit(default_settings(LMBDA, 30), device, prior)
    for name, values in forwards.attributes.items():
        np.testing.assert_array_equal(values, other.attributes[name])


def test_fits_in_several_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    device = only_gpu(monkeypatch)
    alone, *_ = fit(default_settings(LMBDA, 20), device)
    with ThreadPoolExecutor(3) as threads:
        both = [threads.submit(fit, default_settings(LMBDA, 20), device) for _ in range(3)]
    for done in both:
        fitted, *_ = done.result()
        for name, values in alone.attributes.items():
            np.testing.assert_array_equal(values, fitted.attributes[name])


def test_tiles_take_gpus_in_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    device, asked = replace(only_gpu(monkeypatch), gpus=2), set()
    monkeypatch.setattr("sgicodec.cuda.gpu.opened", lambda index: asked.add(index) or fake_gpu())
    pixels = np.clip(smooth_picture(200, 64).transpose(1, 2, 0) * 256, 0, 255).astype(np.uint8)
    settings = EncodeSettings(steps=4, tile=64, texture=False)
    first, again = (encode_picture(Picture(pixels, "rgb", (0, 255)), settings, device=device).data for _ in "ab")
    assert asked == {0, 1}
    assert first == again


def test_seeds_come_and_go(monkeypatch: pytest.MonkeyPatch) -> None:
    device, counts = only_gpu(monkeypatch), set()
    spec, target = default_spec(3, prior=3), smooth_picture(80, 64) - np.float32(0.5)
    layout = adaptive_layout(target, 30 * LMBDA)
    settings = default_settings(LMBDA, 60)
    trainer = Trainer(spec, settings, target, layout, FAMILY, load_prior(spec), device=device)
    trainer.run(lambda progress: not counts.add(progress.seeds))
    assert len(counts) > 3
    assert len(trainer.seed_bits()) == len(trainer.seeds)


def test_what_the_kernels_lack_is_the_processors(monkeypatch: pytest.MonkeyPatch) -> None:
    """Five channels; a network that the caller trains."""
    device, settings = only_gpu(monkeypatch), default_settings(LMBDA, 6)
    for channels, own in ((5, False), (3, True)):
        spec, target = default_spec(channels, prior=0), np.zeros((channels, 32, 32), np.float32)
        context = ContextWeights(spec, (), np.random.default_rng(1)) if own else None
        layout = adaptive_layout(target + np.eye(32, dtype=np.float32), 1.0)
        trainer = Trainer(spec, settings, target, layout, FAMILY, context=context, device=device)
        assert trainer.on_gpu is None
        trainer.run()


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
