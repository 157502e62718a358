"""Lossless and near-lossless bytes beside JPEG XL, WebP, PNG, JPEG-LS and LERC, and processor seconds a megapixel."""

from __future__ import annotations

import io
import math
import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

from sgicodec import EncodeSettings, Picture, encode_picture, read
from sgicodec.bitstream.rewriting import rewrite_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.residual import Layer, residual_layer
from sgicodec.errors import require

__all__ = ["Peer", "main", "peers_of"]

Pixels = NDArray[Any]


@dataclass(frozen=True)
class Peer:
    """A codec that codes pixels [h, w, C] within `most` levels of themselves."""

    name: str
    most: float
    encode: Callable[[Pixels], bytes]
    decode: Callable[[bytes], Pixels]


def peers_of(pixels: Pixels, errors: tuple[float, ...]) -> list[Peer]:
    """Those that take such pixels: without loss, then with each of these greatest errors. Raises MissingExtraError."""
    require("imagecodecs", "other codecs", "bench")
    import imagecodecs as codecs

    def coder(name: str, most: float, **options: Any) -> Peer:
        encode, decode = (getattr(codecs, f"{name}_{way}") for way in ("encode", "decode"))
        return Peer(_NAMES[name], most, lambda pixels: bytes(encode(pixels, **options)), decode)

    found = []
    is_float, is_common = pixels.dtype == np.float32, pixels.shape[2] in (1, 3)
    if is_common:
        found.append(coder("jpegxl", 0, lossless=True, effort=7))
    if is_common and not is_float:
        found.append(coder("png", 0, level=9))
    if pixels.shape[2] == 3 and pixels.dtype == np.uint8:
        found.append(coder("webp", 0, lossless=True, level=100))
    for most in (0.0, *errors):
        if is_common and not is_float:
            found.append(coder("jpegls", most, level=int(most)))
        found.append(coder("lerc", most, level=most, compression="zstd"))
    return found


_NAMES = {"jpegxl": "JPEG XL e7", "png": "PNG", "webp": "WebP", "jpegls": "JPEG-LS", "lerc": "LERC"}
"""Of codecs, by what imagecodecs calls them."""


@dataclass
class Figures:
    """Bytes, and processor seconds of encodes and decodes, a megapixel."""

    bytes: int
    encode: float
    decode: float


def measured(pixels: Pixels, peer: Peer) -> Figures:
    """Of one encode and one decode, whose samples are checked."""
    started = time.process_time()
    data = peer.encode(pixels)
    encoded = time.process_time()
    found = peer.decode(data).reshape(pixels.shape)
    decoded, size = time.process_time(), pixels.shape[0] * pixels.shape[1] / 1e6
    off = np.abs(found.astype(float) - pixels).max()
    rounded = np.spacing(np.abs(pixels).max()) if pixels.dtype == np.float32 else 0  # LERC is off by it
    if off > peer.most + rounded:
        raise click.ClickException(f"{peer.name}: a sample is {off} levels off")
    return Figures(len(data), (encoded - started) / size, (decoded - encoded) / size)


def sgi(picture: Picture, settings: EncodeSettings, errors: tuple[float, ...]) -> list[Peer]:
    """This codec, over one lossy picture."""
    device = Device(1)
    lossy = encode_picture(picture, settings, device=device).data

    def encode(_: Pixels, most: float) -> bytes:
        out = io.BytesIO()
        with open_stream(lossy, device) as stream:
            layer = residual_layer(stream, Layer(windows_of(picture), most), device)
        rewrite_stream(io.BytesIO(lossy), out, layer)
        return out.getvalue()

    def decode(data: bytes) -> Pixels:
        with open_stream(data, device) as stream:
            return stream.picture().pixels

    return [Peer("sgi", most, partial(encode, most=most), decode) for most in (0, *errors)]


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True))
@click.option("--crop", default=1024, show_default=True, help="Largest side; the middle of a larger picture is taken.")
@click.option("--error", "errors", multiple=True, type=float, default=(1, 2, 4), show_default=True)
@click.option("-q", "--quality", default=45.0, show_default=True, help="Of the lossy picture.")
@click.option("-e", "--effort", default=1, show_default=True)
def main(pictures: tuple[str, ...], crop: int, errors: tuple[float, ...], quality: float, effort: int) -> None:
    """Print bytes of each codec, in a row for each picture and greatest error, then geometric means of sgi's bytes
    relative to each. Seconds of sgi are those of the residual layer, added and decoded, by one thread.
    """
    settings = EncodeSettings(quality=quality, effort=effort, tune="psnr")
    logs: dict[tuple[str, float], list[float]] = defaultdict(list)
    seconds: dict[tuple[str, float], list[tuple[float, float]]] = defaultdict(list)
    for path in pictures:
        picture = _middle(read(path), crop)
        found = sgi(picture, settings, errors) + peers_of(picture.pixels, errors)
        for most in (0, *errors):
            row = {peer.name: measured(picture.pixels, peer) for peer in found if peer.most == most}
            for name, figures in row.items():
                seconds[name, most].append((figures.encode, figures.decode))
                logs[name, most].append(math.log(row["sgi"].bytes / figures.bytes))
            listed = ", ".join(f"{name} {figures.bytes:,}" for name, figures in row.items())
            click.echo(
                f"{Path(path).stem} {picture.width}×{picture.height}×{picture.pixels.shape[2]} ±{most:g}: {listed}"
            )
    click.echo("\n| codec | greatest error | pictures | sgi's bytes | encode, s/MP | decode, s/MP |")
    click.echo("|---|---:|---:|---:|---:|---:|")
    for (name, most), values in sorted(logs.items(), key=lambda item: (item[0][1], item[0][0])):
        encode, decode = np.median(seconds[name, most], axis=0)
        change = f"{100 * math.expm1(float(np.mean(values))):+.1f} %" if name != "sgi" else ""
        click.echo(f"| {name} | {most:g} | {len(values)} | {change} | {encode:.2f} | {decode:.3f} |")


def _middle(picture: Picture, side: int) -> Picture:
    top, left = max(0, picture.height - side) // 2, max(0, picture.width - side) // 2
    pixels = np.ascontiguousarray(picture.pixels[top : top + side, left : left + side])
    return Picture(pixels, picture.channels, picture.sample_range, blank=picture.blank, exact=picture.exact)
