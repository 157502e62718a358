"""How time and memory grow with the picture (`python -m benchmarks.scaling PICTURE --out docs`)."""

from __future__ import annotations

import csv
import math
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from sgicodec.bench.extra import require
from sgicodec.bench.sgi import run_timed
from sgicodec.decoder.stream import open_stream

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sgicodec.picture import Picture

__all__ = ["MEASURES", "Memory", "Point", "crop_of", "exponent", "fit_memory", "main", "read_points", "write_points"]

SIZES = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
"""Megapixels."""

QUALITIES = (30.0, 60.0)
"""Two, so that pixels and Gaussians do not grow in step."""

MEASURES = {
    "encode_seconds": "encode, s",
    "encode_cpu": "encode, processor s",
    "decode_seconds": "decode to PNG, s",
    "decode_cpu": "decode to PNG, processor s",
    "pixels_seconds": "open file to pixels, s",
    "encode_mib": "encode, MiB",
    "decode_mib": "decode to PNG, MiB",
}


@dataclass(frozen=True)
class Point:
    """One crop at one quality. Encode and decode are whole processes: wall-clock and processor seconds, peak memory.
    `pixels_seconds` is the fastest of five decodes in one process.
    """

    quality: float
    width: int
    height: int
    gaussians: int
    stream_bytes: int
    encode_seconds: float
    encode_cpu: float
    encode_mib: float
    decode_seconds: float
    decode_cpu: float
    decode_mib: float
    pixels_seconds: float

    @property
    def megapixels(self) -> float:
        """Millions of pixels."""
        return self.width * self.height / 1e6


@dataclass(frozen=True)
class Memory:
    """Peak MiB = fixed + per_megapixel · megapixels + per_kilo_gaussian · thousands of Gaussians, and the largest
    relative error of that over the points.
    """

    fixed: float
    per_megapixel: float
    per_kilo_gaussian: float
    error: float


def crop_of(picture: Picture, megapixels: float) -> Picture:
    """The middle of a picture, of its shape and so many pixels. Raises click.UsageError if it has fewer."""
    from dataclasses import replace

    height, width, _ = picture.pixels.shape
    shrink = math.sqrt(megapixels * 1e6 / (width * height))
    if shrink > 1:
        raise click.UsageError(f"the picture has {width * height / 1e6:.1f} megapixels, fewer than {megapixels:g}")
    rows, columns = max(1, round(height * shrink)), max(1, round(width * shrink))
    top, left = (height - rows) // 2, (width - columns) // 2
    return replace(picture, pixels=np.ascontiguousarray(picture.pixels[top : top + rows, left : left + columns]))


def measure(picture: Picture, quality: float, threads: int, effort: int, steps: int | None) -> Point:
    """Encodes and decodes one picture by command."""
    from sgicodec.image import write

    command, shared = [sys.executable, "-m", "sgicodec"], ["-f", "-j", str(threads)]
    with tempfile.TemporaryDirectory(prefix="sgi-scaling-") as folder:
        source, stream, result = (str(Path(folder, name)) for name in ("in.png", "x.sgi", "out.png"))
        write(picture, source, png_level=1)
        chosen = ["-q", f"{quality:g}", "-e", str(effort), *([] if steps is None else ["--steps", str(steps)])]
        encode = [*command, "encode", source, stream, *chosen, *shared, "--quiet", "--no-verify"]
        encoded = run_timed(encode)
        decoded = run_timed([*command, "decode", stream, result, *shared])
        with open_stream(stream) as opened:
            gaussians = opened.survey().seeds * opened.header.spec.per_seed
            size = opened.size
        return Point(
            quality,
            picture.width,
            picture.height,
            gaussians,
            size,
            encoded.seconds,
            encoded.cpu or math.nan,
            encoded.peak or math.nan,
            decoded.seconds,
            decoded.cpu or math.nan,
            decoded.peak or math.nan,
            _seconds_to_pixels(stream, threads),
        )


def _seconds_to_pixels(stream: str, threads: int) -> float:
    """The fastest of five decodes in a fresh process, after one that finds memory."""
    code = (
        "import sys, time; from sgicodec import open_stream\n"
        "seconds = []\n"
        "for turn in range(6):\n"
        "    start = time.perf_counter(); open_stream(sys.argv[1]).picture(threads=int(sys.argv[2]))\n"
        "    seconds.append(time.perf_counter() - start)\n"
        "print(min(seconds[1:]))"
    )
    fresh = [sys.executable, "-c", code, stream, str(threads)]
    return float(subprocess.run(fresh, capture_output=True, text=True, check=True).stdout)


def exponent(points: Sequence[Point], measure: str, least: float = 1.0) -> float:
    """The power of the number of pixels with which a measure grows, over the points of `least` megapixels and more."""
    slopes = []
    for quality in sorted({point.quality for point in points}):
        chosen = [point for point in points if point.quality == quality and point.megapixels >= 0.95 * least]
        if len(chosen) > 1:
            x, y = (np.log([getattr(point, name) for point in chosen]) for name in ("megapixels", measure))
            slopes.append(float(np.polyfit(x, y, 1)[0]))
    return float(np.mean(slopes)) if slopes else math.nan


def fit_memory(points: Sequence[Point], measure: str) -> Memory:
    """The formula by least squares of relative errors, no term below zero."""
    peak = np.array([getattr(point, measure) for point in points])
    terms = np.array([[1.0, point.megapixels, point.gaussians / 1e3] for point in points])
    kept = [0, 1, 2]
    while True:
        found, *_ = np.linalg.lstsq(terms[:, kept] / peak[:, None], np.ones(len(points)), rcond=None)
        if found.min() >= 0:
            break
        kept.remove(kept[int(np.argmin(found))])
    whole = np.zeros(3)
    whole[kept] = found
    fixed, per_megapixel, per_kilo_gaussian = whole.tolist()
    return Memory(fixed, per_megapixel, per_kilo_gaussian, float(np.abs(terms @ whole / peak - 1).max()))


def write_points(points: Sequence[Point], path: Path) -> None:
    """The points as a table of tab-separated values."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Point)], delimiter="\t", lineterminator="\n")
        writer.writeheader()
        for point in points:
            rounded = {name: f"{value:.4g}" for name, value in asdict(point).items() if isinstance(value, float)}
            writer.writerow(asdict(point) | rounded)


def read_points(path: Path) -> list[Point]:
    """The points of such a table."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    whole = ("width", "height", "gaussians", "stream_bytes")
    numbers: list[dict[str, Any]] = [
        {name: int(value) if name in whole else float(value) for name, value in row.items()} for row in rows
    ]
    return [Point(**row) for row in numbers]


def write_plot(points: Sequence[Point], path: Path) -> None:
    """Seconds and peak memory against megapixels, with a line of slope one."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 5), layout="constrained")
    FigureCanvasAgg(figure)
    seconds, memory = figure.subplots(1, 2)
    _draw(seconds, points, ["encode_cpu", "decode_cpu", "pixels_seconds"], "seconds")
    _draw(memory, points, ["encode_mib", "decode_mib"], "peak MiB")
    figure.savefig(path, dpi=120)


def _draw(axes: Axes, points: Sequence[Point], measures: Sequence[str], unit: str) -> None:
    qualities = sorted({point.quality for point in points})
    for number, measure in enumerate(measures):
        for quality, style in zip(qualities, ("o--", "o-", "o:", "o-."), strict=False):
            chosen = [point for point in points if point.quality == quality]
            x, y = ([getattr(point, name) for point in chosen] for name in ("megapixels", measure))
            axes.loglog(x, y, style, color=f"C{number}", label=f"{MEASURES[measure]}, quality {quality:g}", ms=4)
        axes.loglog([x[-1], x[0]], [y[-1], y[-1] * x[0] / x[-1]], color="0.8", lw=1, zorder=0)
    axes.set(xlabel="megapixels", ylabel=unit)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=8, ncols=len(measures), loc="lower center", bbox_to_anchor=(0.5, 1.0))


def report(points: Sequence[Point]) -> str:
    """The table, the powers, and the formulas of memory."""
    lines = [
        "| megapixels | quality | Gaussians | " + " | ".join(MEASURES.values()) + " |",
        "|" + "---:|" * (3 + len(MEASURES)),
    ]
    for point in points:
        values = [f"{getattr(point, name):.3g}" for name in MEASURES]
        cells = [f"{point.megapixels:.2f}", f"{point.quality:g}", f"{point.gaussians:,}", *values]
        lines.append("| " + " | ".join(cells) + " |")
    powers = [f"{label}: {exponent(points, name):.2f}" for name, label in MEASURES.items()]
    lines += ["", "Power of the number of pixels, from 1 megapixel on: " + "; ".join(powers)]
    for name in ("encode_mib", "decode_mib"):
        m = fit_memory(points, name)
        lines.append(
            f"{MEASURES[name]} = {m.fixed:.0f} + {m.per_megapixel:.1f} · megapixels "
            f"+ {m.per_kilo_gaussian:.2f} · thousands of Gaussians, within {100 * m.error:.0f} %"
        )
    return "\n".join(lines)


@click.command()
@click.argument("path", type=click.Path(path_type=Path, exists=True), metavar="PICTURE|TABLE.tsv")
@click.option("--out", default=Path("bench-out"), show_default=True, type=click.Path(path_type=Path), help="Folder.")
@click.option("--threads", default=2, show_default=True, type=click.IntRange(1))
@click.option("--effort", default=1, show_default=True, type=click.IntRange(1, 9))
@click.option("--steps", type=click.IntRange(1), help="Steps of the fit, instead of what the effort says.")
@click.option("--most", default=max(SIZES), show_default=True, type=float, help="Megapixels of the largest crop.")
def main(path: Path, out: Path, threads: int, effort: int, steps: int | None, most: float) -> None:
    """Encode and decode the middle of PICTURE at growing sizes; or report on a TABLE that did.

    Writes OUT/results/scaling.tsv and OUT/images/scaling.png.
    """
    require("the benchmark", "matplotlib")
    table, image = out / "results" / "scaling.tsv", out / "images" / "scaling.png"
    for file in (table, image):
        file.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == ".tsv":
        points = read_points(path)
    else:
        from sgicodec.image import read

        picture, points = read(path), []
        crops = [crop_of(picture, size) for size in SIZES if size <= most]
        for crop in crops:
            for quality in QUALITIES:
                points.append(measure(crop, quality, threads, effort, steps))
                click.echo(f"{points[-1].megapixels:.2f} megapixels, quality {quality:g}: done", err=True)
                write_points(points, table)
    write_plot(points, image)
    click.echo(report(points))


if __name__ == "__main__":
    main()
