"""The report of `sgi encode` about the stream that it wrote."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from sgicodec.cli.json_output import print_json
from sgicodec.cli.parts import all_parts, print_parts, whole_bytes
from sgicodec.cli.paths import STANDARD, display, name_of
from sgicodec.device import PROCESSOR
from sgicodec.metadata.layouts import range_text

if TYPE_CHECKING:
    from sgicodec.encoder.pipeline import Encoded
    from sgicodec.encoder.plan import Plan


@dataclass(frozen=True)
class Report:
    """A finished encode. rounding: by how much samples of more bits than a stream holds are off at most before they
    are coded. device: the name of what was asked for.
    """

    plan: Plan
    encoded: Encoded
    rounding: float
    device: str

    @property
    def bpp(self) -> float:
        """Bits per pixel of the whole stream."""
        return 8 * self.encoded.size / (self.plan.header.width * self.plan.header.height)

    @property
    def parts(self) -> dict[str, float]:
        """Bytes of each part, metadata counted as container; they sum to those of the stream."""
        return all_parts(self.encoded.part_bytes, {}, self.encoded.size)

    @property
    def fallback(self) -> str | None:
        """Why the processor fitted although a GPU was asked for."""
        channels = self.plan.header.spec.channels
        if PROCESSOR not in self.encoded.devices or self.device == "cpu":
            return None
        from sgicodec.cuda.tiles import MAX_CHANNELS  # takes long to load

        if channels > MAX_CHANNELS:
            return f"a GPU fits up to {MAX_CHANNELS} channels, not {channels}"
        return "there was no GPU that could be used"

    def figures(self) -> dict[str, Any]:
        """As JSON has them. psnr: None also where there is no error."""
        header, encoded = self.plan.header, self.encoded
        return {
            "width": header.width,
            "height": header.height,
            "channels": header.channels,
            "sample_type": header.sample_type,
            "sample_range": header.sample_range,
            "bytes": encoded.size,
            "bpp": self.bpp,
            "psnr": encoded.psnr if encoded.psnr is None or math.isfinite(encoded.psnr) else None,
            "rounding": self.rounding,
            "profile": header.profile,
            "lmbda": encoded.lmbda,
            "seeds": encoded.seeds,
            "gaussians": encoded.gaussians,
            "steps": encoded.steps,
            "ended_early": encoded.ended_early,
            "parts": whole_bytes(self.parts),
            "tiles": header.grid.count,
            "devices": encoded.devices,
            "fallback": self.fallback,
        }


def _of_range(report: Report) -> str:
    """What the peak of a PSNR is, where that is not the largest sample of eight bits."""
    header = report.plan.header
    low, high = header.sample_range
    if header.sample_range == (0.0, 255.0) and header.sample_type == "uint8":
        return ""
    if isinstance(low, tuple) or isinstance(high, tuple):
        return " of the range of each band"
    return f" of the range {range_text(header.sample_range)}"


def _fidelity(report: Report, psnr: float) -> str:
    if math.isfinite(psnr):
        return f"PSNR {psnr:.2f} dB{_of_range(report)}"
    return f"exact as 32-bit floats, off by up to {report.rounding:g}" if report.rounding else "without loss"


def _fitted(report: Report) -> str:
    """Which devices fitted, in words."""
    names = [f"the {name}" if name == PROCESSOR else name for name in report.encoded.devices]
    counts = [f" ({count} tiles)" if len(names) > 1 else "" for count in report.encoded.devices.values()]
    listed = ", ".join(name + count for name, count in zip(names, counts, strict=True))
    return f"fitted by {listed}" + (f": {report.fallback}" if report.fallback else "")


def print_report(
    report: Report, source: str, target: str, seconds: float, peak_mib: float | None, as_json: bool, verbose: bool
) -> None:
    """To stdout, or to stderr if stdout takes the stream. peak_mib: of all processes together, None if not known."""
    encoded = report.encoded
    if as_json:
        names = {"input": name_of(source), "output": name_of(target, "stdout")}
        print_json(names | report.figures() | {"seconds": seconds, "peak_mib": peak_mib})
        return
    line = f"{display(target, 'stdout')}: {encoded.size:,} bytes, {report.bpp:.3f} bpp, "
    if encoded.psnr is not None:
        line += f"{_fidelity(report, encoded.psnr)}, "
    line += f"{encoded.gaussians:,} Gaussians, {seconds:.1f} s"
    line += f", {peak_mib:.0f} MiB" if peak_mib is not None else ""
    click.echo(line, err=target == STANDARD)
    if encoded.devices and (verbose or report.fallback or PROCESSOR not in encoded.devices):
        click.echo(_fitted(report), err=target == STANDARD)
    if verbose:
        print_parts(report.parts, err=target == STANDARD)
        click.echo(f"{encoded.steps:,} steps, λ {encoded.lmbda:.3g}", err=target == STANDARD)
