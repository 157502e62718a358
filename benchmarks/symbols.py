"""What RDOQ after the fit gains, from real streams.

    python -m benchmarks.symbols --steps 600 PICTURES… --lmbda 0.02 0.006 0.002
    python -m benchmarks.symbols --steps 600 --lmbda 0.006 --threads 2 PICTURES… deep=1 "passes=2;base=False"

Each picture is encoded without the search and with it; J = D + λR has D from the decoded samples before rounding and R
from the size of the file. Variants, lists of RdoqSettings that differ from the defaults, search the stream that was
written without: they are compared with each other and with the first row of theirs, which has the defaults. Seconds
are of processors, all threads together.
"""

from __future__ import annotations

import argparse
import ast
from dataclasses import dataclass, replace
from pathlib import Path
from time import process_time

from benchmarks.whole import Whole, measured
from sgicodec import EncodeSettings, Picture, encode, open_stream, read
from sgicodec.device import Device
from sgicodec.metrics.psnr import psnr
from sgicodec.picture import to_unit
from sgicodec.rdoq import Rdoq, RdoqSettings

__all__ = ["Outcome", "searched", "timed"]


@dataclass(frozen=True)
class Outcome:
    """psnr: of the decoded picture, dB; seconds: of all processors for the encode."""

    whole: Whole
    psnr: float
    seconds: float


def timed(picture: Picture, settings: EncodeSettings) -> Outcome:
    """Encodes a picture and measures the stream."""
    started = process_time()
    encoded = encode(picture, settings)
    seconds = process_time() - started
    with open_stream(encoded.data) as stream:
        quality = psnr(picture.pixels, stream.picture().pixels)
    return Outcome(measured(picture, encoded, settings.threads), quality, seconds)


def searched(
    picture: Picture, data: bytes, lmbda: float, settings: RdoqSettings, threads: int
) -> tuple[float, float, float]:
    """J of a stream's model before and after a search that starts at what is decoded, and the search's seconds."""
    stream = open_stream(data)
    values = stream.model.decoded_values
    groups = {group.name: values[:, group.columns] for group in stream.header.spec.groups}
    model = replace(stream.model, attributes=groups, decoded=None)
    unit = to_unit(picture).transpose(2, 0, 1)
    started = process_time()
    search = Rdoq(stream.header, model, unit, lmbda, settings, Device(threads))
    found = search.at(lmbda)
    seconds = process_time() - started
    return search.objective.cost(model).at(lmbda), found.cost.at(lmbda), seconds


def main() -> None:
    """The command line of this module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("arguments", nargs="+", help="pictures and variants; a variant has a = in it")
    parser.add_argument("--lmbda", type=float, nargs="+", default=[0.02, 0.006, 0.002])
    parser.add_argument("--steps", type=int, default=600)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    variants = [argument for argument in options.arguments if not Path(argument).is_file()]
    if not variants:
        print("picture\tλ\tJ\tsearched\tchange\tbytes\tsearched\tPSNR\tsearched\tseeds\tsearched\tfit s\tsearch s")
    for path in (Path(argument) for argument in options.arguments if Path(argument).is_file()):
        picture = read(path)
        for lmbda in options.lmbda:
            settings = EncodeSettings(lmbda=lmbda, steps=options.steps, threads=options.threads, rdoq=False)
            if variants:
                _print_variants(picture, path.stem, settings, variants)
            else:
                _print_gain(picture, path.stem, settings)


def _print_gain(picture: Picture, name: str, settings: EncodeSettings) -> None:
    plain, refined = timed(picture, settings), timed(picture, replace(settings, rdoq=True))
    a, b = plain.whole, refined.whole
    print(
        f"{name}\t{settings.lmbda:g}\t{a.cost:.1f}\t{b.cost:.1f}\t{100 * (b.cost / a.cost - 1):+.2f} %"
        f"\t{len(a.encoded.data)}\t{len(b.encoded.data)}\t{plain.psnr:.2f}\t{refined.psnr:.2f}"
        f"\t{a.encoded.seeds}\t{b.encoded.seeds}\t{plain.seconds:.1f}\t{refined.seconds - plain.seconds:.1f}",
        flush=True,
    )


def _print_variants(picture: Picture, name: str, settings: EncodeSettings, variants: list[str]) -> None:
    lmbda = settings.lmbda or 0.0
    data = encode(picture, settings).data
    for variant in ["", *variants]:
        items = (item.split("=") for item in variant.split(";") if item)
        changes = {key.strip(): ast.literal_eval(value) for key, value in items}
        before, after, seconds = searched(picture, data, lmbda, RdoqSettings(**changes), settings.threads)
        change = 100 * (after / before - 1)
        print(f"{variant or 'defaults'}\t{name}\t{lmbda:g}\t{change:+.2f} %\t{seconds:.1f}", flush=True)


if __name__ == "__main__":
    main()
