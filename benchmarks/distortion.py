"""What a distortion gains, and through which stage: streams of equal size with its weights left out of one at a time.

Every stream is decoded and measured as a file would be: the distortion itself, PSNR and, where the package is there,
SSIMULACRA 2. Differences are against squared error in every stage, at equal bytes (Bjøntegaard's mean difference).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np

from sgicodec.bench.bdrate import Curve, bd_quality
from sgicodec.bench.run import to_rgb
from sgicodec.bitstream.parts.prior import load_prior
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.encoded import Encoded
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.encoder.tile.inputs import tile_of
from sgicodec.encoder.tile.stages import in_integers, prepare, rdoq
from sgicodec.encoder.tile.writing import stream_of, write
from sgicodec.fit.base_layer import base_layer
from sgicodec.fit.pyramid import levels_of
from sgicodec.fit.trainer import Trainer
from sgicodec.image import read
from sgicodec.metrics.choices import DISTORTIONS
from sgicodec.metrics.distortion import QuadraticReference, decibels, squared_error
from sgicodec.metrics.perceptual import perceived
from sgicodec.model.layout import adaptive_layout
from sgicodec.picture import Picture, convert, to_unit

__all__ = ["STAGES", "Outcome", "encoded_without", "main", "outcome"]

STAGES = ("base", "split", "step", "seeds", "rdoq")
"""The base layer's first grid; the quadtree that a fit starts with; its steps; seeds pruned and added; RDOQ."""


@dataclass(frozen=True)
class Outcome:
    """distortion: as PSNR is of squared error, dB; psnr: dB; ssimulacra2: NaN where it is not installed."""

    size: int
    distortion: float
    psnr: float
    ssimulacra2: float


def encoded_without(picture: Picture, settings: EncodeSettings, stages: Sequence[str], device: Device) -> Encoded:
    """The stream of a picture, these stages working on plain squared error."""
    tile = tile_of(picture, stream_plan(Shape.of(picture), settings), device)
    prepared, spec = prepare(tile, tile.fit.lmbda), tile.spec
    fit, weights = prepared.fit, tile.reference.weights
    within = {stage: None if stage in stages else weights for stage in STAGES}
    base_step, base, target = base_layer(spec, tile.unit, fit.lmbda, within["base"])
    layout = adaptive_layout(target, fit.split_price * fit.lmbda, weights=within["split"])
    family, networks = tile.header.family, load_prior(spec)
    trainer = Trainer(spec, fit, target, layout, family, networks, device=device, weights=within["seeds"])
    trainer.levels = levels_of(target, within["step"], len(trainer.levels))
    reference = QuadraticReference(within["rdoq"])
    prepared = replace(prepared, base_step=base_step, base=base, target=target, seed_reference=reference)
    written = write(rdoq(in_integers(prepared, trainer.run())))
    data, gaussians = stream_of(written, tile), written.seeds * spec.per_seed
    return Encoded(data, written.part_bytes, written.seeds, gaussians, written.lmbda)


def outcome(picture: Picture, encoded: Encoded, distortion: str, device: Device) -> Outcome:
    """What the stream shows."""
    with open_stream(encoded.data, device) as stream:
        decoded = stream.picture()
    reference = DISTORTIONS[distortion].reference(np.ascontiguousarray(to_unit(picture).transpose(2, 0, 1)))
    samples = picture.pixels.size
    errors = (squared_error(picture, decoded, weights) for weights in (reference.weights, None))
    weighted, plain = (decibels(error, samples) for error in errors)
    seen = perceived(*(to_rgb(convert(shown, 8).pixels) for shown in (picture, decoded))).ssimulacra2
    return Outcome(len(encoded.data), weighted, plain, math.nan if seen is None else seen)


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--distortion", default="weighted", show_default=True, type=click.Choice(list(DISTORTIONS)))
@click.option("--quality", "qualities", multiple=True, default=(40, 50, 60, 70), show_default=True, type=float)
@click.option("--effort", default=3, show_default=True, type=click.IntRange(1, 9))
@click.option("--stages/--no-stages", default=True, show_default=True, help="Leave out each stage in turn.")
@click.option("--threads", default=2, show_default=True, type=click.IntRange(0))
def main(
    pictures: tuple[Path, ...],
    distortion: str,
    qualities: tuple[float, ...],
    effort: int,
    stages: bool,
    threads: int,
) -> None:
    """Encode PICTURES, without texture, with squared error, a distortion in every stage, and in all stages but one."""
    device = Device(threads)
    left_out = {"squared": STAGES, distortion: ()} | ({f"without {s}": (s,) for s in STAGES} if stages else {})
    click.echo("picture\tstages\tquality\tbytes\tdistortion\tPSNR\tSSIMULACRA 2")
    for path in pictures:
        picture, curves = read(path), dict[str, list[Outcome]]()
        for name, without in left_out.items():
            for quality in qualities:
                settings = EncodeSettings(quality=quality, effort=effort, distortion=distortion, texture=False)
                found = outcome(picture, encoded_without(picture, settings, without, device), distortion, device)
                curves.setdefault(name, []).append(found)
                scores = f"{found.distortion:.2f}\t{found.psnr:.2f}\t{found.ssimulacra2:.1f}"
                click.echo(f"{path.stem}\t{name}\t{quality:g}\t{found.size}\t{scores}")
        for name, curve in curves.items():
            click.echo(f"# {path.stem}, {name}: {_compared(curves['squared'], curve)}")


def _compared(plain: list[Outcome], curve: list[Outcome]) -> str:
    """Gains over `plain` at equal bytes."""
    gains = {}
    for score in ("distortion", "psnr", "ssimulacra2"):
        ours, theirs = (Curve([o.size for o in c], [getattr(o, score) for o in c]) for c in (curve, plain))
        gains[score] = bd_quality(theirs, ours).value
    return "distortion {distortion:+.2f} dB, PSNR {psnr:+.2f} dB, SSIMULACRA 2 {ssimulacra2:+.1f}".format(**gains)
