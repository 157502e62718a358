"""What the search for symbols after the fit gains, from real streams.

    python -m sgicodec.bench.symbols PICTURES… --lmbda 0.02 0.006 0.002 --steps 600

Each picture is encoded without the search and with it; J = D + λR has D from the decoded samples before rounding and R
from the size of the file. Seconds are of processors, all threads together.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path
from time import process_time

import numpy as np

from sgicodec import Encoded, EncodeSettings, Picture, encode, open_stream, read
from sgicodec.image import to_unit
from sgicodec.metrics import psnr

__all__ = ["Outcome", "measured"]


@dataclass(frozen=True)
class Outcome:
    """cost: J; size: bytes on disk; psnr: of the decoded picture, dB; seconds: of all processors for the encode."""

    cost: float
    size: int
    psnr: float
    seeds: int
    seconds: float


def measured(picture: Picture, settings: EncodeSettings) -> Outcome:
    """Encodes a picture and measures the stream."""
    started = process_time()
    encoded: Encoded = encode(picture, settings)
    seconds = process_time() - started
    with open_stream(encoded.data) as stream:
        error = np.sum(np.square(stream.render() - to_unit(picture), dtype=np.float64))
        decoded = stream.picture()
    cost = float(error) + encoded.lmbda * 8 * len(encoded.data)
    return Outcome(cost, len(encoded.data), psnr(picture.pixels, decoded.pixels), encoded.seeds, seconds)


def main() -> None:
    """The command line of this module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", nargs="+", type=Path)
    parser.add_argument("--lmbda", type=float, nargs="+", default=[0.02, 0.006, 0.002])
    parser.add_argument("--steps", type=int, default=600)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    print("picture\tλ\tJ\tsearched\tchange\tbytes\tsearched\tPSNR\tsearched\tseeds\tsearched\tfit s\tsearch s")
    for path in options.pictures:
        picture = read(path)
        for lmbda in options.lmbda:
            settings = EncodeSettings(lmbda=lmbda, steps=options.steps, threads=options.threads, refine=False)
            a, b = measured(picture, settings), measured(picture, replace(settings, refine=True))
            print(
                f"{path.stem}\t{lmbda:g}\t{a.cost:.1f}\t{b.cost:.1f}\t{100 * (b.cost / a.cost - 1):+.2f} %"
                f"\t{a.size}\t{b.size}\t{a.psnr:.2f}\t{b.psnr:.2f}\t{a.seeds}\t{b.seeds}"
                f"\t{a.seconds:.1f}\t{b.seconds - a.seconds:.1f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
