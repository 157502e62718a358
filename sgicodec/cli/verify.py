"""`sgi verify`: decodes everything in a stream and throws it away."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from sgicodec.cli.options import threads_option
from sgicodec.cli.paths import display, opened_stream
from sgicodec.device import Device
from sgicodec.errors import CorruptStreamError

if TYPE_CHECKING:
    from sgicodec.decoder.stream import Stream

__all__ = ["verify"]

_BAND_SAMPLES = 1 << 24
"""Samples that are drawn at a time."""


@click.command(short_help="Check a stream.")
@click.argument("source", metavar="IN")
@threads_option
def verify(source: str, threads: int) -> None:
    """Decode all of stream IN and say "ok", or what is wrong with it (exit code 4)."""
    with opened_stream(source, Device(threads)) as stream:
        _draw(stream)
        if stream.has_overview:
            _draw(stream.overview)
        click.echo(f"{display(source)}: ok, {stream.width}×{stream.height} pixels, symbols {stream.symbol_crc:08x}")


def _draw(stream: Stream) -> None:
    import numpy as np

    rows = max(1, _BAND_SAMPLES // (stream.width * stream.header.spec.channels))
    for top in range(0, stream.height, rows):
        band = stream.render((0, top, stream.width, min(rows, stream.height - top)))
        if not np.isfinite(band).all():
            raise CorruptStreamError(f"there are samples without a value in rows {top} to {top + len(band) - 1}")
