"""Seeds that come and go on a GPU, of which the kernels are compiled for the host, beside the processor's."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from fake_cuda import backwards, only_gpu

from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.device import Device
from sgicodec.fit.device_fit import DeviceFit
from sgicodec.fit.trainer import Trainer
from sgicodec.model.layout import adaptive_layout
from sgicodec.profiles.default import default_settings, default_spec

F32 = np.ndarray[Any, np.dtype[np.float32]]


@pytest.fixture
def gpu(monkeypatch: pytest.MonkeyPatch) -> Device:
    return only_gpu(monkeypatch)


def trainer_of(device: Device, steps: int = 60, weighted: bool = False, size: tuple[int, int] = (70, 90)) -> Trainer:
    """A fit of noise on a slope, before its first step."""
    rng, (height, width) = np.random.default_rng(1), size
    target = rng.normal(0, 0.1, (3, height, width)).astype(np.float32)
    target += np.linspace(-0.3, 0.3, width, dtype=np.float32)
    weights = rng.uniform(0.2, 2, (height, width)).astype(np.float32) if weighted else None
    spec, layout = default_spec(3), adaptive_layout(target, 0.5)
    networks = load_prior(spec)
    return Trainer(spec, default_settings(0.004, steps), target, layout, 1, networks, device=device, weights=weights)


def stepped(device: Device, count: int, **how: Any) -> tuple[Trainer, DeviceFit]:
    """A fit after some steps, whose host arrays are those of its beginning."""
    trainer = trainer_of(device, **how)
    for _, _ in zip(range(count), trainer.iterate(), strict=False):
        pass
    assert trainer.on_gpu is not None
    return trainer, trainer.on_gpu


def test_energy(gpu: Device) -> None:
    trainer, fit = stepped(gpu, 9)
    old = trainer.seeds.energy()
    found = fit.energy()
    with backwards():
        np.testing.assert_array_equal(fit.energy(), found)
    trainer.fetch()
    np.testing.assert_allclose(found, trainer.seeds.energy(), rtol=2e-5)
    assert np.abs(found - old).max() > 1e-3


def state(trainer: Trainer) -> dict[str, list[F32]]:
    """All that trains, and its moments."""
    trainer.fetch()
    moments = {name: trainer.adam.moments(name, array) for name, array in trainer.parameters.trained().items()}
    return {
        name: [array.copy(), moments[name].mean.copy(), moments[name].square.copy()]
        for name, array in trainer.parameters.trained().items()
    }


def test_rows_stay_go_and_come(gpu: Device) -> None:
    """What stays has its values and moments of the GPU, what comes those of the host and zeros; then steps go on."""
    trainer, fit = stepped(gpu, 40)
    before = state(trainer)
    kept = np.random.default_rng(2).random(len(trainer.seeds)) < 0.7
    for values in trainer.seeds.values.values():
        values[:] = np.nan  # the host's are not asked for
    trainer._keep(kept)
    after = state(trainer)
    for name, arrays in before.items():
        rows = kept if name in trainer.seeds.values else slice(None)
        for old, new in zip(arrays, after[name], strict=True):
            np.testing.assert_array_equal(old[rows], new)
    assert all(arrays[2].any() for arrays in after.values())
    trainer.settings = replace(trainer.settings, lmbda=1e-4)
    old = len(trainer.seeds)
    trainer._grow()
    assert len(trainer.seeds) > old
    fresh = {name: values[old:].copy() for name, values in trainer.seeds.values.items()}
    grown = state(trainer)
    for name, values in fresh.items():
        np.testing.assert_array_equal(grown[name][0], np.concatenate([after[name][0], values]))
        for moment in (1, 2):
            np.testing.assert_array_equal(grown[name][moment][:old], after[name][moment])
            assert not grown[name][moment][old:].any()
    level = trainer.levels[0]
    rates = dict.fromkeys(trainer.parameters.trained(), 1e-3)
    errors = [fit.run("noise", 50 + number, level, 1e-4, rates)[0] for number in range(20)]
    assert np.mean(errors[10:]) < np.mean(errors[:10])
