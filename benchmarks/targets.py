"""How near encodes come to a size or a PSNR, and what that costs."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

import click

from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.encoded import Encoded
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.errors import TargetMissedError, UsageError
from sgicodec.image import read
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import Picture, comparable

__all__ = ["Outcome", "Point", "Target", "loss", "main", "report", "run", "targets_of"]


@dataclass(frozen=True)
class Target:
    """A target: `name` is bpp, size or psnr, as in EncodeSettings."""

    name: str
    value: float

    def put_into(self, settings: EncodeSettings) -> EncodeSettings:
        """The settings with this target."""
        return replace(
            settings,
            bpp=self.value if self.name == "bpp" else None,
            size=self.value if self.name == "size" else None,
            psnr=self.value if self.name == "psnr" else None,
        )

    def reached(self, point: Point) -> float:
        """What a point reaches, in the unit of the target."""
        return {"bpp": point.bpp, "size": float(point.bytes), "psnr": point.psnr}[self.name]


@dataclass(frozen=True)
class Point:
    """One encode: seconds of the encode alone, by the clock and of processors (cpu), PSNR in dB of the decoded samples,
    λ at its end.
    """

    bytes: int
    bpp: float
    psnr: float
    lmbda: float
    seconds: float
    cpu: float


@dataclass(frozen=True)
class Outcome:
    """An encode towards a target, and a plain one at the λ that it ended with."""

    picture: str
    target: Target
    found: Point
    plain: Point
    missed: bool


def run(path: Path, targets: list[Target], effort: int, device: Device, tile: int | None = None) -> list[Outcome]:
    """Both encodes of every target on one picture, in turn: a busy machine slows them alike."""
    picture, outcomes = read(path), []
    for target in targets:
        settings = EncodeSettings(effort=effort, tile=tile)
        found, missed = _point(picture, target.put_into(settings), device)
        plain, _ = _point(picture, replace(settings, lmbda=found.lmbda), device)
        outcomes.append(Outcome(path.stem, target, found, plain, missed))
    return outcomes


def _point(picture: Picture, settings: EncodeSettings, device: Device) -> tuple[Point, bool]:
    started, worked, missed = time.monotonic(), time.process_time(), False
    try:
        encoded = encode_picture(picture, settings, device=device)
    except TargetMissedError as error:
        nearest, missed = error.nearest, True
        assert isinstance(nearest, Encoded)
        encoded = nearest
    spent = time.monotonic() - started, time.process_time() - worked
    decoded = open_stream(encoded.data, device).picture()
    quality = psnr(comparable(picture), comparable(decoded))
    size = len(encoded.data)
    return Point(size, 8 * size / (picture.width * picture.height), quality, encoded.lmbda, *spent), missed


def loss(point: Point, plain: list[Point]) -> float:
    """How many dB `point` is below the plain points, by a line over log rate: between the two whose rates enclose its
    own, else through the nearest and the nearest to that of at least 15 % more or less.

    NaN where there are no two such points.
    """
    near = sorted(plain, key=lambda p: abs(math.log(p.bytes / point.bytes)))
    other_side = [p for p in near if (p.bytes < point.bytes) != (near[0].bytes < point.bytes)]
    apart = [p for p in near if abs(math.log(p.bytes / near[0].bytes)) >= math.log(1.15)]
    if not (other_side or apart):
        return math.nan
    first, second = near[0], (other_side or apart)[0]
    if first.bytes == second.bytes:
        return first.psnr - point.psnr
    slope = (second.psnr - first.psnr) / math.log(second.bytes / first.bytes)
    return first.psnr + slope * math.log(point.bytes / first.bytes) - point.psnr


COLUMNS = (
    *("picture", "kind", "target", "reached", "bytes", "bpp", "psnr", "lmbda", "seconds"),
    *("plain_bytes", "plain_psnr", "plain_seconds", "ratio", "cpu_ratio", "loss"),
)


def report(outcomes: list[Outcome]) -> list[str]:
    """A row for each outcome of one picture; the plain encodes of all of them make its curve."""
    plain, rows = [outcome.plain for outcome in outcomes], []
    for one in outcomes:
        found = one.found
        cells = [one.picture, one.target.name, f"{one.target.value:g}"]
        cells += [
            f"{one.target.reached(found):.5g}" + ("!" if one.missed else ""),
            f"{found.bytes}",
            f"{found.bpp:.4f}",
        ]
        cells += [f"{found.psnr:.3f}", f"{found.lmbda:.5g}", f"{found.seconds:.2f}"]
        cells += [f"{one.plain.bytes}", f"{one.plain.psnr:.3f}", f"{one.plain.seconds:.2f}"]
        cells += [f"{found.seconds / one.plain.seconds:.3f}", f"{found.cpu / one.plain.cpu:.3f}"]
        cells.append(f"{loss(found, plain):.3f}")
        rows.append("\t".join(cells))
    return rows


def summary(outcomes: dict[str, list[Outcome]]) -> list[str]:
    """Worst and median of each kind of target, as comment lines."""
    lines = []
    for name in dict.fromkeys(one.target.name for ones in outcomes.values() for one in ones):
        ones = [(one, loss(one.found, [o.plain for o in all_])) for all_ in outcomes.values() for one in all_]
        ones = [(one, lost) for one, lost in ones if one.target.name == name]
        if name == "psnr":
            errors = [one.found.psnr - one.target.value for one, _ in ones]
            kept = f"reached − target from {min(errors):+.3f} to {max(errors):+.3f} dB"
        else:
            shares = [100 * one.target.reached(one.found) / one.target.value for one, _ in ones]
            kept = f"reached / target from {min(shares):.2f} % to {max(shares):.2f} %"
        ratio = [one.found.seconds / one.plain.seconds for one, _ in ones]
        cpu = [one.found.cpu / one.plain.cpu for one, _ in ones]
        losses = [lost for _, lost in ones if math.isfinite(lost)]
        lost = f"loss median {median(losses):.3f}, most {max(losses):.3f} dB" if losses else "loss unknown"
        took = f"time ratio median {median(ratio):.2f}, most {max(ratio):.2f}"
        took += f", of processors {median(cpu):.2f} and {max(cpu):.2f}"
        lines.append(f"# {name}: {kept}; {took}; {lost}")
    return lines


def targets_of(name: str, values: str) -> list[Target]:
    """Targets from comma-separated numbers. Raises UsageError for what is none."""
    try:
        return [Target(name, float(value)) for value in values.split(",") if value]
    except ValueError as error:
        raise UsageError(f"--{name} {values}: numbers with commas between, as in 0.15,0.3") from error


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--bpp", default="0.15,0.3,0.6", show_default=True, help="Target rates.")
@click.option("--psnr", "decibels", default="28,32,36", show_default=True, help="Target PSNRs.")
@click.option("--effort", default=5, show_default=True, type=click.IntRange(1, 9))
@click.option("--threads", default=2, show_default=True, type=click.IntRange(0))
@click.option("--tile", type=int, help="Side of tiles, as in sgi encode.")
def main(pictures: tuple[Path, ...], bpp: str, decibels: str, effort: int, threads: int, tile: int | None) -> None:
    """Encode PICTURES towards rates and PSNRs and print tab-separated rows.

    reached ends in ! where the encoder said that it missed. plain_…: of an encode at the λ that the other ended with;
    ratio: of their seconds, cpu_ratio of those of processors, which other work changes less. loss: dB below the curve
    of a picture's plain encodes at the same rate.
    """
    targets = [*targets_of("bpp", bpp), *targets_of("psnr", decibels)]
    outcomes: dict[str, list[Outcome]] = {}
    click.echo("\t".join(COLUMNS))
    for path in pictures:
        outcomes[path.stem] = run(path, targets, effort, Device(threads), tile)
        click.echo("\n".join(report(outcomes[path.stem])))
    click.echo("\n".join(summary(outcomes)))
