"""The report of `sgi encode` about the stream that it wrote."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import click

from sgicodec.cli.json_output import print_json
from sgicodec.cli.parts import all_parts, print_parts, whole_bytes
from sgicodec.cli.paths import STANDARD, display, name_of
from sgicodec.device import PROCESSOR
from sgicodec.metadata.layouts import SampleRange, range_text

if TYPE_CHECKING:
    from sgicodec.encoder.pipeline import Encoded
    from sgicodec.encoder.plan import Plan

__all__ = ["Report", "print_report"]


@dataclass(frozen=True)
class Report:
    """Figures of one encode.

    bpp: bits per pixel of the whole stream. psnr: dB over all samples, of a peak that is the sample range; None if
    not measured, infinite for no error. rounding: by how much samples of more bits than a stream holds are off at
    most before they are coded. parts: bytes of each part, metadata counted as container; they sum to `bytes`.
    devices: how many tiles each fitted, by the name of a GPU or the processor.
    fallback: why the processor fitted although a GPU was asked for.
    """

    width: int
    height: int
    channels: str
    sample_type: str
    sample_range: SampleRange
    bytes: int
    bpp: float
    psnr: float | None
    rounding: float
    profile: str
    lmbda: float
    seeds: int
    gaussians: int
    steps: int
    ended_early: bool
    parts: dict[str, float]
    tiles: int
    devices: dict[str, int]
    fallback: str | None

    @classmethod
    def of(cls, plan: Plan, encoded: Encoded, rounding: float, device: str = "cpu") -> Report:
        """Of a finished encode; device: the name of what was asked for."""
        header = plan.header
        return cls(
            width=header.width,
            height=header.height,
            channels=header.channels,
            sample_type=header.sample_type,
            sample_range=header.sample_range,
            bytes=encoded.size,
            bpp=8 * encoded.size / (header.width * header.height),
            psnr=encoded.psnr,
            rounding=rounding,
            profile=header.profile,
            lmbda=encoded.lmbda,
            seeds=encoded.seeds,
            gaussians=encoded.gaussians,
            steps=encoded.steps,
            ended_early=encoded.ended_early,
            parts=all_parts(encoded.part_bytes, {}, encoded.size),
            tiles=header.grid.count,
            devices=encoded.devices,
            fallback=_fallback(plan, device) if PROCESSOR in encoded.devices else None,
        )


def _fallback(plan: Plan, device: str) -> str | None:
    """Why the processor fits although this device was asked for; None where it was that."""
    header = plan.header
    if device == "cpu":
        return None
    from sgicodec.cuda.tiles import MAX_CHANNELS  # takes long to load

    if header.spec.channels > MAX_CHANNELS:
        return f"a GPU fits up to {MAX_CHANNELS} channels, not {header.spec.channels}"
    return "there was no GPU that could be used"


def _of_range(report: Report) -> str:
    """What the peak of a PSNR is, where that is not the largest sample of eight bits."""
    low, high = report.sample_range
    if report.sample_range == (0.0, 255.0) and report.sample_type == "uint8":
        return ""
    if isinstance(low, tuple) or isinstance(high, tuple):
        return " of the range of each band"
    return f" of the range {range_text(report.sample_range)}"


def _fidelity(report: Report, psnr: float) -> str:
    if math.isfinite(psnr):
        return f"PSNR {psnr:.2f} dB{_of_range(report)}"
    return f"exact as 32-bit floats, off by up to {report.rounding:g}" if report.rounding else "without loss"


def _fitted(report: Report) -> str:
    """Which devices fitted, in words."""
    names = [f"the {name}" if name == PROCESSOR else name for name in report.devices]
    counts = [f" ({count} tiles)" if len(names) > 1 else "" for count in report.devices.values()]
    listed = ", ".join(name + count for name, count in zip(names, counts, strict=True))
    return f"fitted by {listed}" + (f": {report.fallback}" if report.fallback else "")


def print_report(
    report: Report, source: str, target: str, seconds: float, peak_mib: float | None, as_json: bool, verbose: bool
) -> None:
    """To stdout, or to stderr if stdout takes the stream. peak_mib: of all processes together, None if not known."""
    if as_json:
        psnr = report.psnr if report.psnr is None or math.isfinite(report.psnr) else None
        figures: dict[str, Any] = {"input": name_of(source), "output": name_of(target, "stdout")} | asdict(report)
        print_json(
            figures | {"psnr": psnr, "parts": whole_bytes(report.parts), "seconds": seconds, "peak_mib": peak_mib}
        )
        return
    line = f"{display(target, 'stdout')}: {report.bytes:,} bytes, {report.bpp:.3f} bpp, "
    if report.psnr is not None:
        line += f"{_fidelity(report, report.psnr)}, "
    line += f"{report.gaussians:,} Gaussians, {seconds:.1f} s"
    line += f", {peak_mib:.0f} MiB" if peak_mib is not None else ""
    click.echo(line, err=target == STANDARD)
    if report.devices and (verbose or report.fallback or PROCESSOR not in report.devices):
        click.echo(_fitted(report), err=target == STANDARD)
    if verbose:
        print_parts(report.parts, err=target == STANDARD)
        click.echo(f"{report.steps:,} steps, λ {report.lmbda:.3g}", err=target == STANDARD)
