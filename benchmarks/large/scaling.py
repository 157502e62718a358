"""How time and memory grow with the size of a large picture: squares out of the middle of one."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path

from benchmarks.large.notes import Job, Notes
from benchmarks.large.sgi import decode, encode
from sgicodec.bench.sgi import Run
from sgicodec.decoder.stream import open_stream
from sgicodec.image import open_sink, open_source

__all__ = ["SizePoint", "measure_size", "read_sizes", "write_crop", "write_size_plot", "write_sizes"]

_BAND = 256


@dataclass(frozen=True)
class SizePoint:
    """One square, encoded and decoded by command: seconds and peak MiB of all processes together; NaN for processor
    seconds that are not known.
    """

    side: int
    tiles: int
    stream_bytes: int
    encode_seconds: float
    encode_cpu: float
    encode_mib: float
    decode_seconds: float
    decode_cpu: float
    decode_mib: float

    @property
    def megapixels(self) -> float:
        """Millions of pixels."""
        return self.side**2 / 1e6


def write_crop(picture: Path, side: int, out: Path) -> None:
    """The middle square of a picture as a TIFF, a band of rows at a time."""
    with open_source(picture) as source:
        left, top = (source.width - side) // 2, (source.height - side) // 2
        bands = source.header.count if source.channels == "multi" else None
        with open_sink(out, side, side, source.channels, source.dtype, bands=bands) as sink:
            for y in range(0, side, _BAND):
                sink.write_rows(y, source.read(left, top + y, side, min(_BAND, side - y)).pixels)


def measure_size(picture: Path, megapixels: float, effort: int, job: Job) -> SizePoint | None:
    """The square of this many megapixels, as far as the notes in the job's folder do not have it already; None if the
    picture is too small. Raises SgiError if a command fails.
    """
    side = round(math.sqrt(megapixels * 1e6))
    with open_source(picture) as source:
        if side > min(source.width, source.height):
            return None
    crop = job.folder / f"{picture.stem}-middle{side}.tif"
    stream = job.folder / f"{crop.stem}-e{effort}.sgi"
    asked = job.asked_of(picture) | {"side": side, "effort": effort, "steps": job.steps, "tile": job.tile}
    notes = Notes(stream.with_suffix(".json"), asked)
    if "decode" not in notes:
        write_crop(picture, side, crop)
        encode(crop, stream, effort, job, notes)
        out = job.folder / f"{crop.stem}-decoded.tif"
        run = decode(stream, out, job)
        with open_stream(stream) as opened:
            notes.put("tiles", opened.grid.count)
        notes.put("bytes", stream.stat().st_size)
        notes.put("decode", run)
        for path in (crop, out):
            path.unlink()
    return _point(side, notes)


def _point(side: int, notes: Notes) -> SizePoint:
    figures = [
        math.nan if value is None else float(value) for name in ("encode", "decode") for value in _of(notes, name)
    ]
    return SizePoint(side, notes["tiles"], notes["bytes"], *figures)


def _of(notes: Notes, name: str) -> tuple[float | None, float | None, float | None]:
    run = Run(*notes[name])
    return run.seconds, run.cpu, run.peak


def write_sizes(points: Sequence[SizePoint], path: Path) -> None:
    """The points as tab-separated values."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, delimiter="\t", lineterminator="\n")
        writer.writerow(["megapixels", *(field.name for field in fields(SizePoint))])
        for point in points:
            figures = (f"{value:.5g}" if isinstance(value, float) else value for value in astuple(point))
            writer.writerow([f"{point.megapixels:.3f}", *figures])


def read_sizes(path: Path) -> list[SizePoint]:
    """The points of such a table."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file, delimiter="\t"))[1:]
    return [SizePoint(*map(int, row[1:4]), *map(float, row[4:])) for row in rows]


def write_size_plot(points: Sequence[SizePoint], measure: str, unit: str, path: Path) -> None:
    """Encode and decode against megapixels, both logarithmic; measure: seconds or mib. Gray lines grow in proportion
    to the pixels.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    x = [point.megapixels for point in points]
    for number, action in enumerate(("encode", "decode")):
        y = [getattr(point, f"{action}_{measure}") for point in points]
        axes.loglog(x, y, "o-", color=f"C{number}", label=action, ms=4)
        label = "proportional" if number == 0 else None
        axes.loglog([x[0], x[-1]], [y[0], y[0] * x[-1] / x[0]], color="0.7", lw=1, zorder=0, label=label)
    axes.set(xlabel="megapixels", ylabel=unit)
    axes.set_xticks(x, [f"{size:.3g}" for size in x])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=120)
