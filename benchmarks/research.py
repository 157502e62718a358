"""One change at a time: fits pictures under variants of the settings and prints what each gains.

    python -m benchmarks.research PICTURES… --steps 800 prune=2 "hold=0.5;shape=0.02" own:neighbours=0

A variant is a list of settings that differ from the defaults: fields of FitSettings and LearningRates, `free` and
`rounded` for the first and last phase's share of the steps, `level` for the first phase's pyramid level, `drops` and
`growths` for how often seeds are pruned and added. With `own:` in front MLP_p trains along instead of being the shipped
prior, and fields of ContextSpec may differ too. `colours` is the space that is coded: 'opponent', 'rgb', or 'klt' for
the principal axes of the picture's own colours. Variants are compared by J = D + λR with the bits of everything that
varies: attributes, positions at one bit each, the hash grid, and own weights as the stream codes them. Lower is
better; 1 % of J is about 2 % of rate.
"""

from __future__ import annotations

import argparse
import ast
from dataclasses import dataclass, fields, replace
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from sgicodec.bitstream.entropy.symbol_coder import SymbolWriter
from sgicodec.bitstream.parts.prior import PRIORS, load_prior
from sgicodec.bitstream.parts.tile import code_networks
from sgicodec.encoder.plan import FAMILY
from sgicodec.fit.base_layer import base_layer
from sgicodec.fit.settings import FitSettings, LearningRates, default_settings
from sgicodec.fit.trainer import Trainer
from sgicodec.image import read
from sgicodec.model.gaussians import colour_matrix
from sgicodec.model.layout import adaptive_layout
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ContextSpec, ModelSpec, default_spec
from sgicodec.picture import to_unit

__all__ = ["Outcome", "fit_variant"]


@dataclass(frozen=True)
class Outcome:
    """cost: J in units of λ, that is bits; side_bits: hash grid and own weights."""

    seeds: int
    psnr: float
    bits_per_seed: float
    side_bits: float
    bpp: float
    cost: float
    seconds: float


def fit_variant(path: Path, variant: str, lmbda: float, steps: int, threads: int) -> Outcome:
    """Fits one picture under one variant."""
    own, text = variant.startswith("own:"), variant.removeprefix("own:")
    changes = {k.strip(): ast.literal_eval(v) for k, v in (item.split("=") for item in text.split(";") if item)}
    settings = _settings(default_settings(lmbda, steps), changes, threads)
    unit = np.ascontiguousarray(to_unit(read(path)).transpose(2, 0, 1))
    spec = _spec(unit.shape[0], own, changes)
    unit = _rotated(unit, str(changes.pop("colours", "opponent")))
    if changes:
        raise SystemExit(f"research: unknown settings {sorted(changes)} in {variant!r}")
    _, _, target = base_layer(spec, unit, lmbda)
    layout = adaptive_layout(target, settings.split * lmbda * settings.seed_bits)
    networks = None if own else load_prior(spec)
    started = monotonic()
    trainer = Trainer(spec, settings, target, layout, FAMILY, networks)
    last = list(trainer.iterate())[-1]
    side = float(trainer.net.hash_bits().detach()) + _network_bits(spec, trainer.result().networks)
    bits = last.bits + last.seeds + side
    cost = 10 ** (-last.psnr / 10) * unit.size / lmbda + bits
    pixels = unit.shape[1] * unit.shape[2]
    return Outcome(last.seeds, last.psnr, last.bits / last.seeds, side, bits / pixels, cost, monotonic() - started)


def _rotated(unit: NDArray[np.float32], colours: str) -> NDArray[np.float32]:
    """A picture [C, H, W] whose opponent channels are those of another orthonormal space: errors stay as they are."""
    opponent = np.array(colour_matrix(len(unit)))
    spaces = {"opponent": opponent, "rgb": np.eye(len(unit))}
    if colours == "klt":
        spaces["klt"] = np.linalg.eigh(np.cov(unit.reshape(len(unit), -1)))[1].T[::-1]
    if colours not in spaces:
        raise SystemExit(f"research: colours {colours!r}; there are opponent, rgb and klt")
    return np.ascontiguousarray(np.tensordot(opponent.T @ spaces[colours], unit, axes=1), np.float32)


def _settings(settings: FitSettings, changes: dict[str, Any], threads: int) -> FitSettings:
    def taken(kind: type) -> dict[str, Any]:
        return {f.name: changes.pop(f.name) for f in fields(kind) if f.name in changes}

    rates = replace(settings.rates, **taken(LearningRates))
    free, noisy, rounded = settings.phases
    total = settings.steps
    free_steps = round(float(changes.pop("free", free.steps / total)) * total)
    rounded_steps = round(float(changes.pop("rounded", rounded.steps / total)) * total)
    noisy = replace(
        noisy,
        steps=total - free_steps - rounded_steps,
        prune=changes.pop("drops", noisy.prune),
        grow=changes.pop("growths", noisy.grow),
    )
    level = int(changes.pop("level", free.level))
    parts = (replace(free, steps=free_steps, level=level), noisy, replace(rounded, steps=rounded_steps))
    phases = tuple(phase for phase in parts if phase.steps)
    return replace(settings, **{**taken(FitSettings), "rates": rates, "phases": phases, "threads": threads})


def _spec(channels: int, own: bool, changes: dict[str, Any]) -> ModelSpec:
    spec = default_spec(
        channels,
        per_seed=int(changes.pop("per_seed", 1)),
        prior=0 if own else max(PRIORS),
        hidden=int(changes.pop("decoders", 0)),
    )
    names = [f.name for f in fields(ContextSpec) if f.name in changes]
    return replace(spec, context=replace(spec.context, **{name: changes.pop(name) for name in names}))


def _network_bits(spec: ModelSpec, networks: tuple[IntNetwork, ...]) -> float:
    walk = SymbolWriter()
    code_networks(walk, spec, networks)
    return sum(walk.bits.values())


def main() -> None:
    """The command line of this module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("arguments", nargs="+", help="pictures and variants; a variant has a = in it, or is 'own:'")
    parser.add_argument("--lmbda", type=float, default=0.006)
    parser.add_argument("--steps", type=int, default=800)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    torch.set_num_threads(1)  # as in an encode: more would change the sums from run to run
    pictures = [Path(a) for a in options.arguments if Path(a).is_file()]
    variants = ["", *(a for a in options.arguments if not Path(a).is_file())]
    print("variant\tpicture\tseeds\tPSNR\tbits/seed\tside bits\tbpp\tJ/λ\tagainst defaults\tseconds")
    plain: dict[Path, float] = {}
    for variant in variants:
        for picture in pictures:
            o = fit_variant(picture, variant, options.lmbda, options.steps, options.threads)
            change = 100 * (o.cost / plain.setdefault(picture, o.cost) - 1)
            print(
                f"{variant or 'defaults'}\t{picture.stem}\t{o.seeds}\t{o.psnr:.2f}\t{o.bits_per_seed:.2f}"
                f"\t{o.side_bits:.0f}\t{o.bpp:.4f}\t{o.cost:.0f}\t{change:+.2f} %\t{o.seconds:.1f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
