"""The commands `bench` and `compare`."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import math
import sys
from collections.abc import Iterator, Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sgicodec.bench.options import numbers, variant
from sgicodec.errors import (
    OutputExistsError,
    PictureError,
    SgiError,
    StreamError,
    TargetMissedError,
    UsageError,
    require,
)
from sgicodec.metadata.layouts import range_text
from sgicodec.remote.url import is_url

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from sgicodec.bench.run import Codec
    from sgicodec.bench.sgi import SgiCodec
    from sgicodec.picture import Picture

_PEERS = ("jpeg", "jpeg2000", "webp", "jxl", "avif-iq", "avif-iq-s2", "avif", "avif-s2")
_PUBLISHED = ("coolchic5",)
_CODECS = ("sgi", *_PEERS, *_PUBLISHED)
_FILE = click.Path(path_type=Path)
_SCHEMA = 1
"""Of what `--json` prints, and of summary.json: grows when a key goes or changes its meaning."""
_PERCEIVED = {
    "ssimulacra2": ("SSIMULACRA 2", 2),
    "butteraugli": ("Butteraugli 3-norm", 3),
    "flip": ("FLIP", 4),
    "cvvdp": ("ColorVideoVDP", 3),
    "lpips": ("LPIPS", 4),
    "dists": ("DISTS", 4),
}
"""The fields of `Perceived`: title, and digits behind the point."""


@contextlib.contextmanager
def _writing() -> Iterator[None]:
    """Turns errors of the system into PictureErrors: results that cannot be written are no defect of the program."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise PictureError(f"{error.filename or 'the results'}: {error.strerror or error}") from error


@click.command()
@click.argument("places", nargs=-1, required=True, metavar="DIR|FILES...")
@click.option("--codecs", help=f"Some of {','.join(_CODECS)}.  [default: all that are installed]")
@click.option("--qualities", default="20,35,50,65,80", show_default=True, help="Points of sgi's default profile.")
@click.option("--efforts", default="", help="Efforts of it, one curve each.  [default: sgi's own]")
@click.option("--sgi", "variants", multiple=True, metavar="NAME=OPTIONS", help="A curve with options of sgi encode.")
@click.option("--threads", default=1, show_default=True, type=click.IntRange(1), help="Threads of each codec.")
@click.option("--out", default="bench-out", show_default=True, type=_FILE, help="Folder for the results.")
@click.option("--at-score", type=float, help="Tell the bytes at which curves reach this SSIMULACRA 2, too.")
@click.option("--lossless", is_flag=True, help="Measure bytes without loss instead of curves: --max-error 0.")
@click.option("--max-error", "errors", multiple=True, type=click.FloatRange(0), help="… within N levels, repeatable.")
@click.option("--plots/--no-plots", default=True, show_default=True, help="Draw the curves as PNG files.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary as JSON instead of tables.")
@_writing()
def bench(
    places: tuple[str, ...],
    codecs: str | None,
    qualities: str,
    efforts: str,
    variants: tuple[str, ...],
    threads: int,
    out: Path,
    at_score: float | None,
    lossless: bool,
    errors: tuple[float, ...],
    plots: bool,
    as_json: bool,
) -> None:
    """Measure rate, distortion and time of sgi against other codecs on the same pictures.

    Every codec gets the pictures as 8-bit RGB. Results are added to OUT/results.tsv as they come; points
    that it already holds are not measured again. OUT/summary.json holds what follows from this run's points.
    A point that a codec fails on is reported, does not stop the run, and makes the command end with status 1.

    With --lossless and --max-error every codec (sgi, png, jpegls, webp, lerc, jxl) gets each picture's own samples, of
    any depth and number of bands, and its bytes and processor seconds go to OUT/lossless.tsv.
    """
    if at_score is not None and not math.isfinite(at_score):
        raise UsageError(f"--at-score {at_score} is no score")
    errors = ((0.0,) if lossless else ()) + errors
    if errors:
        if at_score is not None:
            raise UsageError("--at-score is of curves, which --lossless and --max-error do not measure")
        _measure_lossless(places, codecs, errors, efforts, variants, threads, out, as_json)
        return
    for library in ("scipy", "matplotlib") if plots else ("scipy",):
        require(library, "sgi bench", "bench")
    wanted = _wanted(codecs, _CODECS)
    chosen = _choose_codecs(wanted, codecs is not None, threads)
    if "sgi" in wanted:
        chosen = [*_sgi_curves(qualities, efforts, variants, threads), *chosen]
    pictures = _pictures(places)
    published = [name for name in wanted if name in _PUBLISHED]
    _measure_curves(pictures, chosen, published, out, at_score, plots, as_json)


def _pictures(places: Sequence[str]) -> list[Path]:
    from sgicodec.bench.run import find_pictures

    if "" in places:
        raise UsageError("the name of a picture or folder is empty")
    if remote := [name for name in places if is_url(name)]:
        raise UsageError(f"{remote[0]}: sgi bench measures files, not URLs; fetch it first")
    return find_pictures([Path(name) for name in places])


def _report(line: str) -> None:
    click.echo(line, err=True)


def _measure_curves(
    pictures: list[Path],
    codecs: list[Codec],
    published: list[str],
    out: Path,
    at_score: float | None,
    plots: bool,
    as_json: bool,
) -> None:
    from rich.console import Console

    from sgicodec.bench.plots import write_plots
    from sgicodec.bench.published import PUBLISHED
    from sgicodec.bench.run import run_bench
    from sgicodec.bench.tables import print_bytes_at, print_summary

    drawn = [PUBLISHED[name] for name in published]
    summary = run_bench(pictures, codecs, out, published=drawn, report=_report)
    text = json.dumps({"schema": _SCHEMA} | summary.to_json(at_score), indent=2)
    (out / "summary.json").write_text(text + "\n", "utf-8")
    if plots:
        write_plots(summary, out)
    if as_json:
        click.echo(text)
    else:
        print_summary(summary, Console())
        if at_score is not None:
            print_bytes_at(summary, at_score, Console())
    _check_failures(summary.failures)


def _measure_lossless(
    places: Sequence[str],
    codecs: str | None,
    errors: Sequence[float],
    efforts: str,
    variants: tuple[str, ...],
    threads: int,
    out: Path,
    as_json: bool,
) -> None:
    from rich.console import Console

    from sgicodec.bench.lossless import PEERS, LosslessCodec, measure_lossless
    from sgicodec.bench.tables import print_lossless

    wanted = _wanted(codecs, ("sgi", *PEERS))
    chosen: list[LosslessCodec] = []
    if "sgi" in wanted:
        chosen += _sgi_curves("", efforts, variants, threads)
    chosen += [PEERS[name] for name in wanted if name != "sgi"]
    rows, failures = measure_lossless(_pictures(places), chosen, errors, out, _report)
    if as_json:
        click.echo(json.dumps({"schema": _SCHEMA, "rows": [dataclasses.asdict(row) for row in rows]}, indent=2))
    elif rows:
        print_lossless(rows, Console())
    _check_failures(failures)


def _check_failures(failures: Sequence[str]) -> None:
    if failures:
        raise SgiError(f"{len(failures)} points failed, the first of them: {failures[0]}")


@click.command()
@click.argument("a")
@click.argument("b")
@click.option("--map", "map_path", help="Write the error B - A around mid-gray as a picture.")
@click.option("--gain", default=8.0, show_default=True, help="Amplification of the error in that picture.")
@click.option("-f", "--force", is_flag=True, help="Overwrite an existing error picture.")
@click.option("--fail-under", type=float, metavar="DB", help="Exit with status 5 if the PSNR is below DB.")
@click.option("--json", "as_json", is_flag=True, help="Print the figures as JSON.")
def compare(
    a: str, b: str, map_path: str | None, gain: float, force: bool, fail_under: float | None, as_json: bool
) -> None:
    """Print how far picture B is from picture A, files or URLs: PSNR, luma PSNR, SSIM and MS-SSIM. Streams are decoded,
    and - stands for stdin.

    SSIMULACRA 2, Butteraugli and other scores for the eye follow where they are installed, of the pictures as 8-bit
    RGB.
    """
    require("scipy", "sgi compare", "bench")
    from sgicodec.bench.run import to_rgb
    from sgicodec.metrics.perceptual import perceived
    from sgicodec.metrics.psnr import largest_difference
    from sgicodec.metrics.scores import error_map, scores
    from sgicodec.picture import comparable, without_opaque_alpha

    if a == b == "-":
        raise UsageError("stdin holds one file; name A or B")
    if not (math.isfinite(gain) and (fail_under is None or not math.isnan(fail_under))):
        raise UsageError("--gain and --fail-under take numbers")
    if "" in (a, b, map_path):
        raise UsageError("the name of a picture is empty")
    if map_path is not None:
        _check_map(map_path, (a, b), force)
    reference, other = _picture(a), _picture(b)
    profiles = reference.metadata.icc, other.metadata.icc
    if profiles[0] != profiles[1]:
        what = "only one has an ICC profile" if None in profiles else "their ICC profiles differ"
        click.echo(f"sgi: {what}; samples are compared as they are", err=True)
    if reference.channels != other.channels:
        reference, other = without_opaque_alpha(reference), without_opaque_alpha(other)
    if reference.pixels.dtype == other.pixels.dtype:  # else the scores say that they cannot be compared
        other = dataclasses.replace(other, sample_range=reference.sample_range)
    first, second = comparable(reference), comparable(other)
    found = scores(first, second)
    seen = perceived(to_rgb(_eight_bits(first)), to_rgb(_eight_bits(second)))
    largest = largest_difference(reference.pixels, other.pixels)
    if as_json:
        figures = dataclasses.asdict(found) | dataclasses.asdict(seen) | {"largest_difference": largest}
        finite = {name: v if v is not None and math.isfinite(v) else None for name, v in figures.items()}
        click.echo(json.dumps({"schema": _SCHEMA} | finite))
    else:
        peak = "" if reference.sample_range == (0.0, 255.0) else f" of the range {range_text(reference.sample_range)}"
        click.echo(f"PSNR                {found.psnr:.3f} dB{peak}")
        click.echo(f"luma PSNR           {found.luma_psnr:.3f} dB")
        click.echo(f"SSIM                {found.ssim:.5f}")
        click.echo(f"MS-SSIM             {found.ms_ssim:.5f}")
        for name, (title, digits) in _PERCEIVED.items():
            if (value := getattr(seen, name)) is not None:
                click.echo(f"{title:<20}{value:.{digits}f}")
        click.echo(f"largest difference  {largest:g}")
    if map_path is not None:
        _write_map(map_path, error_map(first, second, gain=gain))
    if fail_under is not None and not found.psnr >= fail_under:
        raise TargetMissedError(f"{b} is at {found.psnr:.3f} dB of {a}, below the {fail_under:g} dB asked for")


def _check_map(path: str, sources: Sequence[str], force: bool) -> None:
    """Raises PictureError, UsageError or OutputExistsError for what could not be written, or should not."""
    from sgicodec.image.formats import find

    find(Path(path).suffix)
    if not Path(path).absolute().parent.is_dir():
        raise UsageError(f"{path}: its folder does not exist")
    if not Path(path).exists():
        return
    if any(Path(source).exists() and Path(source).samefile(path) for source in sources):
        raise UsageError(f"{path} is both input and output; name another --map")
    if not force:
        raise OutputExistsError(f"{path} exists; give -f to overwrite it")


def _kept(origin: str) -> str | bytes:
    """The origin, or all that comes from a pipe, which would be read twice."""
    path = Path(origin)
    return path.read_bytes() if path.exists() and not (path.is_file() or path.is_dir()) else origin


def _picture(origin: str) -> Picture:
    """The picture in a file, in stdin (-) or behind a URL; of a stream that which it decodes to. Raises PictureError,
    StreamError.
    """
    from sgicodec.bitstream.container import SIGNATURE
    from sgicodec.decoder.stream import file_at, open_stream
    from sgicodec.image.source import open_source

    data = sys.stdin.buffer.read() if origin == "-" else _kept(origin)
    try:
        with BytesIO(data) if isinstance(data, bytes) else file_at(data) as file:
            is_stream = file.read(len(SIGNATURE)) == SIGNATURE
    except (OSError, SgiError):
        is_stream = False  # what reads pictures tells
    if not is_stream:
        with open_source(data) as source:
            if source.pages > 1:
                click.echo(f"sgi: {origin}: the first of {source.pages} pages is compared", err=True)
            return source.read(0, 0, source.width, source.height)
    try:
        with open_stream(data) as stream:
            return stream.picture()
    except StreamError as error:
        raise type(error)(f"{origin}: {str(error).removeprefix(f'{origin}: ')}") from error


def _eight_bits(pixels: npt.NDArray[Any]) -> npt.NDArray[np.uint8]:
    """Integer samples, or floating-point ones where the range is 0..1, as 8 bits."""
    import numpy as np

    peak = 1.0 if pixels.dtype.kind == "f" else float(np.iinfo(pixels.dtype).max)
    return np.clip(np.rint(pixels * (255.0 / peak)), 0, 255).astype(np.uint8)


def _write_map(path: str, pixels: npt.NDArray[np.uint8]) -> None:
    from sgicodec.image.writer import write
    from sgicodec.picture import Picture

    # An error in alpha would show as transparency.
    shown, layout = (pixels[..., :1], "gray") if pixels.shape[2] < 3 else (pixels[..., :3], "rgb")
    write(Picture(shown, layout, (0.0, 255.0)), path)


def _wanted(names: str | None, known: Sequence[str]) -> Sequence[str]:
    wanted = known if names is None else [name.strip() for name in names.split(",")]
    if unknown := [name for name in wanted if name not in known]:
        raise UsageError(f"no codec is called {unknown[0]!r}; there are {', '.join(known)}")
    return wanted


def _choose_codecs(wanted: Sequence[str], by_name: bool, threads: int) -> list[Codec]:
    """The peers, which may be missing only where none is asked for by name."""
    from sgicodec.bench.peers import PEERS, find_peers

    peers, missing = find_peers([name for name in PEERS if name in wanted], threads)
    if missing and by_name:
        raise UsageError("; ".join(missing.values()))
    for reason in missing.values():
        click.echo(f"left out: {reason}", err=True)
    return [*peers]


def _whole(effort: float) -> int:
    if effort != int(effort):
        raise UsageError(f"--efforts {effort:g}: an effort is a whole number")
    return int(effort)


def _sgi_curves(qualities: str, efforts: str, variants: tuple[str, ...], threads: int) -> list[SgiCodec]:
    """Sgi at each effort with each variant's options."""
    from sgicodec.bench.sgi import SgiCodec

    points = tuple(sorted(numbers(qualities, "--qualities")))
    levels: list[int | None] = [_whole(level) for level in numbers(efforts, "--efforts")]
    given = [variant(text, "--sgi") for text in variants] or [("", ())]
    return [
        SgiCodec(points, level, threads, label=label, options=options)
        for label, options in given
        for level in levels or [None]
    ]
