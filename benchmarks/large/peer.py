"""One encode or decode of a peer as a process of its own, so that its time and memory are its own.

python -m benchmarks.large.peer encode jxl city.tif city.jxl --rung 70
python -m benchmarks.large.peer decode jxl city.jxl part.tif --region 0,0,1024,1024
"""

from __future__ import annotations

import sys
from pathlib import Path

import click

from benchmarks.large.peers import LARGE_PEERS
from sgicodec.errors import SgiError
from sgicodec.image import open_sink
from sgicodec.model.tile_grid import Rect

__all__ = ["REFUSED", "main"]

REFUSED = "refused: "
"""How the last line on stderr begins where a codec does not want a picture."""

_codec = click.argument("codec", type=click.Choice(list(LARGE_PEERS)))
_source = click.argument("source", type=click.Path(exists=True, dir_okay=False, path_type=Path))
_out = click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
_threads = click.option("--threads", default=1, type=click.IntRange(1))


def _rect(context: click.Context, parameter: click.Parameter, value: str) -> Rect:
    x, y, width, height = map(int, value.split(","))
    return x, y, width, height


@click.group()
def main() -> None:
    """Encode or decode one picture."""


@main.command()
@_codec
@_source
@_out
@_threads
@click.option("--rung", required=True, type=int, help="Quality, from 0.")
def encode(codec: str, source: Path, out: Path, threads: int, rung: int) -> None:
    """Encode a picture of 8-bit RGB."""
    LARGE_PEERS[codec](threads).encode(source, out, rung)


@main.command()
@_codec
@_source
@_out
@_threads
@click.option("--region", required=True, callback=_rect, metavar="X,Y,W,H", help="Pixels to decode.")
def decode(codec: str, source: Path, out: Path, threads: int, region: Rect) -> None:
    """Decode into a TIFF as sgi decode writes it."""
    _, _, width, height = region
    with open_sink(out, width, height, "rgb", "uint8", threads=threads) as sink:
        row = 0
        for rows in LARGE_PEERS[codec](threads).bands(source, region):
            sink.write_rows(row, rows)
            row += len(rows)


if __name__ == "__main__":
    try:
        main()
    except (SgiError, OSError, ValueError, RuntimeError, MemoryError) as error:
        print(f"{REFUSED}{str(error) or type(error).__name__}".replace("\n", " "), file=sys.stderr)
        sys.exit(1)
