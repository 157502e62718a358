"""The report of `sgi encode` about the stream that it wrote."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import click

from sgicodec.cli.json_output import print_json
from sgicodec.cli.parts import all_parts, print_parts, whole_bytes
from sgicodec.cli.paths import STANDARD, display

if TYPE_CHECKING:
    from sgicodec.encoder.encoded import Encoded
    from sgicodec.encoder.plan import Plan

__all__ = ["Report", "print_report"]


@dataclass(frozen=True)
class Report:
    """Figures of one encode.

    bpp: bits per pixel of the whole stream. psnr: dB over all samples, None if not measured, infinite for no error.
    parts: bytes of each part, metadata counted as container; they sum to `bytes`.
    time_limit: seconds that were allowed.
    """

    width: int
    height: int
    channels: str
    sample_type: str
    bytes: int
    bpp: float
    psnr: float | None
    profile: str
    lmbda: float
    seeds: int
    gaussians: int
    steps: int
    ended_early: bool
    parts: dict[str, float]
    tiles: int
    time_limit: float | None

    @classmethod
    def of(cls, plan: Plan, encoded: Encoded) -> Report:
        """Of a finished encode."""
        header = plan.header
        return cls(
            width=header.width,
            height=header.height,
            channels=header.channels,
            sample_type=header.sample_type,
            bytes=encoded.size,
            bpp=8 * encoded.size / (header.width * header.height),
            psnr=encoded.psnr,
            profile=header.profile,
            lmbda=encoded.lmbda,
            seeds=encoded.seeds,
            gaussians=encoded.gaussians,
            steps=encoded.steps,
            ended_early=encoded.ended_early,
            parts=all_parts(encoded.part_bytes, {}, encoded.size),
            tiles=header.grid.count,
            time_limit=plan.settings.time_limit,
        )


def print_report(
    report: Report, source: str, target: str, seconds: float, peak_mib: float | None, as_json: bool, verbose: bool
) -> None:
    """To stdout, or to stderr if stdout takes the stream. peak_mib: of all processes together, None if not known."""
    if as_json:
        psnr = report.psnr if report.psnr is None or math.isfinite(report.psnr) else None
        figures: dict[str, Any] = {"input": display(source), "output": display(target, "stdout")} | asdict(report)
        print_json(
            figures | {"psnr": psnr, "parts": whole_bytes(report.parts), "seconds": seconds, "peak_mib": peak_mib}
        )
        return
    line = f"{display(target, 'stdout')}: {report.bytes:,} bytes, {report.bpp:.3f} bpp, "
    line += f"PSNR {report.psnr:.2f} dB, " if report.psnr is not None else ""
    line += f"{report.gaussians:,} Gaussians, {seconds:.1f} s"
    if report.time_limit is not None and seconds > report.time_limit:
        line += f" ({seconds - report.time_limit:.1f} s beyond the time limit)"
    line += f", {peak_mib:.0f} MiB" if peak_mib is not None else ""
    click.echo(line, err=target == STANDARD)
    if verbose:
        print_parts(report.parts, err=target == STANDARD)
        click.echo(f"{report.steps:,} steps, λ {report.lmbda:.3g}", err=target == STANDARD)
