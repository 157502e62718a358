"""`python -m benchmarks graphics PICTURES`: text, screens and mixed pictures at equal score, beside AVIF and WebP."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sgicodec import EncodeSettings, Picture, encode_picture
from sgicodec.bench.peer import pillow_encode
from sgicodec.bench.peers import Avif, AvifIq
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.metrics.perceptual import ssimulacra2

Pixels = NDArray[np.uint8]
Code = Callable[[Pixels, float], tuple[int, Pixels]]
"""From pixels and a quality to the bytes of a stream and what it decodes to."""


def sgi(pixels: Pixels, quality: float) -> tuple[int, Pixels]:
    """This codec at its default effort."""
    data = encode_picture(Picture(pixels, "rgb", (0.0, 255.0)), EncodeSettings(quality=quality), device=Device(1)).data
    with open_stream(data) as stream:
        return len(data), stream.picture().pixels


def avif(peer: Avif) -> Code:
    """AVIF by libaom."""

    def code(pixels: Pixels, quality: float) -> tuple[int, Pixels]:
        data = peer.encode(pixels, quality)
        return len(data), peer.decode(data)

    return code


CODECS: dict[str, tuple[Code, range]] = {
    "sgi": (sgi, range(25, 96, 5)),
    "avif-iq": (avif(AvifIq()), range(20, 97, 4)),
    "avif": (avif(Avif()), range(40, 99, 3)),
}
"""How each codes, and the qualities that are tried."""


def smallest(code: Code, qualities: range, pixels: Pixels, score: float) -> tuple[float, float, float]:
    """Bytes of the smallest stream that reaches a score, its quality, and its score."""
    found = []
    for quality in qualities:
        size, decoded = code(pixels, quality)
        reached = ssimulacra2(pixels, decoded)
        if reached >= score:
            found.append((float(size), float(quality), reached))
        if len(found) == 3:  # a finer quality may take less where text begins to be coded by itself
            break
    return min(found, default=(np.nan, np.nan, np.nan))


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True))
@click.option("--score", default=85.0, show_default=True, help="SSIMULACRA 2 that is to be reached.")
def main(pictures: tuple[str, ...], score: float) -> None:
    """Print, for each picture, the bytes with which each codec reaches a score, beside lossless WebP and sgi at its
    default quality.
    """
    click.echo(
        "| picture | " + " | ".join([*CODECS, "sgi against AVIF's best", "WebP lossless", "sgi by default"]) + " |"
    )
    click.echo("|---|" + "---:|" * (len(CODECS) + 3))
    logs = []
    for path in pictures:
        pixels = np.asarray(Image.open(path).convert("RGB"))
        found = {name: smallest(code, tried, pixels, score) for name, (code, tried) in CODECS.items()}
        best = min(found[name][0] for name in found if name != "sgi")
        logs.append(np.log(found["sgi"][0] / best))
        size, decoded = sgi(pixels, 50)
        row = [f"{bytes_:,.0f} (`-q` {quality:g}: {reached:.1f})" for bytes_, quality, reached in found.values()]
        row += [
            f"{100 * np.expm1(logs[-1]):+.1f} %",
            f"{len(pillow_encode(pixels, 'WEBP', lossless=True, method=6, quality=100, exact=True)):,}",
        ]
        row += [f"{size:,} ({ssimulacra2(pixels, decoded):.1f})"]
        click.echo(f"| {Path(path).stem} | " + " | ".join(row) + " |")
    click.echo(f"\nGeometric mean of sgi against AVIF's best: {100 * np.expm1(np.nanmean(logs)):+.1f} %")
