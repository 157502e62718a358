"""`sgi verify`: decodes everything in a stream and throws it away."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from sgicodec.cli.files import each_file
from sgicodec.cli.json_output import print_json
from sgicodec.cli.options import FILE, json_option, threads_option
from sgicodec.cli.paths import display, name_of, opened_stream
from sgicodec.device import Device
from sgicodec.errors import CorruptStreamError, StreamError

if TYPE_CHECKING:
    from sgicodec.decoder.stream import Stream

_BAND_SAMPLES = 1 << 24
"""Samples that are rendered at a time."""


@click.command(short_help="Check streams.")
@click.argument("sources", metavar="IN...", nargs=-1, required=True, type=FILE)
@threads_option
@json_option
@click.option("--quiet", is_flag=True, help="Print errors only.")
def verify(sources: tuple[str, ...], threads: int, as_json: bool, quiet: bool) -> None:
    """Decode all of streams IN and say "ok", or what is wrong (exit code 4; 1 if some of many are damaged)."""

    def check(source: str) -> None:
        try:
            found = _verified(source, Device(threads))
        except StreamError as error:
            if as_json:
                print_json({"input": name_of(source), "ok": False, "error": str(error)})
            raise
        if as_json:
            print_json({"input": name_of(source), "ok": True, "error": None} | found)
        elif not quiet:
            size = f"{found['width']}×{found['height']} pixels"
            click.echo(f"{display(source)}: ok, {size}, symbols {found['symbol_crc']}")

    each_file(sources, check)


def _verified(source: str, device: Device) -> dict[str, Any]:
    """What is said of a sound stream."""
    with opened_stream(source, device) as stream:
        _draw(stream)
        if stream.has_overview:
            _draw(stream.overview)
        found = {"width": stream.width, "height": stream.height, "bytes": stream.size, "tiles": stream.grid.count}
        return found | {"symbol_crc": f"{stream.symbol_crc:08x}"}


def _draw(stream: Stream) -> None:
    import numpy as np

    if stream.grid.count == 1 and stream.survey().part_bytes.keys() <= {"mask"}:
        return  # no pixel holds anything, however many there are
    stream.check_residual()
    rows = max(1, _BAND_SAMPLES // (stream.width * stream.header.spec.channels))
    for top in range(0, stream.height, rows):
        region = (0, top, stream.width, min(rows, stream.height - top))
        if stream.has_exact_pixels:
            stream.picture(region)  # through the residual layer
        band = stream.render(region)
        if not np.isfinite(band).all():
            raise CorruptStreamError(f"there are samples without a value in rows {top} to {top + len(band) - 1}")
