"""Trains the prior that ships with the package: one MLP_p, fitted along with the seeds of many pictures at once.

    python -m tools.train_prior PICTURES_DIR OUT.bin --epochs 3

A prior cannot be trained on finished fits alone: the refinements r of the steps trade bits for distortion, which only
a running fit knows. So many fits run in step under one network, and their mean gradient moves it on.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from sgicodec.device import Device
from sgicodec.fit.adam import Adam
from sgicodec.fit.base_layer import base_layer
from sgicodec.fit.context_weights import ContextWeights
from sgicodec.fit.trainer import Trainer
from sgicodec.image import read
from sgicodec.model.layout import adaptive_layout
from sgicodec.picture import to_unit
from sgicodec.profiles.default import DEFAULT, default_settings, default_spec
from sgicodec.profiles.fit_settings import FitSettings
from tools.prior_file import SHIFT, write_prior

__all__ = ["train"]

LMBDA_RANGE = (3e-4, 6e-2)
CROP = (320, 256)


def train(
    paths: list[Path], context: ContextWeights, settings: FitSettings, rate: float, seed: int, device: Device
) -> None:
    """Fits a random crop of every picture, mirrored at random, at a random λ, all in step, and moves `context` on by
    their mean gradient.

    Each fit weighs by its bits per seed: its loss is divided by λ and by the number of its seeds.
    """
    rng = np.random.default_rng(seed)
    trainers = [_trainer(path, context, settings, rng, seed, device) for path in paths]
    fits = [trainer.iterate() for trainer in trainers]
    adam = Adam((0.9, 0.999), 1e-8, device)
    for step in range(settings.steps):
        factor = min(1.0, 2.0 * (1 - step / settings.steps)) + 0.002
        total = {name: np.zeros_like(weights) for name, weights in context.trained().items()}
        seeds = bits = 0.0
        for trainer, fit in zip(trainers, fits, strict=True):
            progress = next(fit)
            weight = np.float32(1.0 / (trainer.settings.lmbda * progress.seeds * len(trainers)))
            for name, gradient in total.items():
                if name in trainer.gradients:
                    gradient += trainer.gradients[name] * weight
            seeds, bits = seeds + progress.seeds, bits + progress.bits
        if bits:
            for name, weights in context.trained().items():
                adam.move(name, weights, total[name], rate * factor)
        if step % 25 == 0 or step == settings.steps - 1:
            print(f"step {step:4d}  {seeds:8.0f} seeds  {bits / seeds:.3f} bits per seed", flush=True)


def _trainer(
    path: Path, context: ContextWeights, settings: FitSettings, rng: np.random.Generator, seed: int, device: Device
) -> Trainer:
    lmbda = float(np.exp(rng.uniform(*np.log(LMBDA_RANGE))))
    unit = to_unit(read(path)).transpose(2, 0, 1)
    x, y = (int(rng.integers(0, max(1, n - c + 1))) for n, c in zip(unit.shape[:0:-1], CROP, strict=True))
    crop = unit[:3, y : y + CROP[1], x : x + CROP[0]]
    crop = crop[:, :: rng.choice((-1, 1)), :: rng.choice((-1, 1))]
    crop = np.ascontiguousarray(crop if rng.random() < 0.5 else crop.swapaxes(1, 2))
    fit = replace(settings, lmbda=lmbda, seed=seed)
    _, _, target = base_layer(context.spec, crop, lmbda)
    layout = adaptive_layout(target, fit.split * lmbda * fit.seed_bits)
    return Trainer(context.spec, fit, target, layout, DEFAULT.family, context=context, device=device)


def main() -> None:
    """The command line of this module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--epochs", type=int, default=3)
    parser.add_argument("--steps", type=int, default=500, help="of each fit")
    parser.add_argument("--rate", type=float, default=0.005)
    parser.add_argument("--start", type=Path, help="continue from this prior")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    context = ContextWeights(default_spec(3, prior=0), (), np.random.default_rng(arguments.seed))
    if arguments.start:
        from sgicodec.bitstream.parts.prior import parse_prior

        context.load(parse_prior(arguments.start.read_bytes()), trains=True)
    settings = default_settings(1.0, arguments.steps)
    settings = replace(settings, phases=settings.phases[:-1])
    paths = sorted(arguments.pictures.glob("*.png"))
    for epoch in range(arguments.epochs):
        rate, seed = arguments.rate * (1 - epoch / arguments.epochs), arguments.seed + epoch
        train(paths, context, settings, rate, seed, Device(arguments.threads))
        print("sha256", write_prior(context.integers(SHIFT), arguments.out), flush=True)


if __name__ == "__main__":
    main()
