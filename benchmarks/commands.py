"""Seconds of `sgi decode` as a process, and of decodes in a running one, next to another version of the package"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from operator import methodcaller
from pathlib import Path
from statistics import median

import click

from benchmarks._turns import in_turn
from sgicodec.errors import TargetMissedError

__all__ = ["main"]

_CODE = """
import statistics, sys, time
import sgicodec

opened, seconds = getattr(sgicodec, "open", None) or sgicodec.open_stream, []
for _ in range(10):
    start = time.perf_counter()
    with opened(sys.argv[1]) as stream:
        stream.picture()
    seconds.append(time.perf_counter() - start)
print(statistics.median(seconds[1:]))
"""
"""Decodes a file ten times; the median of all but the first, which finds memory."""


@dataclass(frozen=True)
class Version:
    """A version of the package: its python, and a stream of it. Its byte code is kept, as of any that is installed."""

    python: Path
    stream: Path

    def encode(self, picture: Path, *options: str) -> int:
        """Encodes a picture; the bytes of its stream."""
        self._run("-m", "sgicodec", "encode", str(picture), str(self.stream), "--no-verify", "-f", *options)
        return self.stream.stat().st_size

    def decode(self) -> float:
        """Seconds of `sgi decode` to PNG."""
        start = time.perf_counter()
        self._run("-m", "sgicodec", "decode", str(self.stream), str(self.stream.with_suffix(".png")), "-f")
        return time.perf_counter() - start

    def decode_again(self) -> float:
        """Seconds of a decode from a file to samples in a process that has decoded it before."""
        return float(self._run("-c", _CODE, str(self.stream)))

    def _run(self, *arguments: str) -> str:
        kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        command = [str(self.python), "-P", *arguments]  # the package of its own environment, not that of this folder
        done = subprocess.run(command, env=kept, capture_output=True, text=True, check=False)
        if done.returncode not in (0, TargetMissedError.exit_code):
            raise click.ClickException(f"{' '.join(command)}: {done.stderr.strip()}")
        return done.stdout


@click.command()
@click.argument("other", type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.argument("pictures", nargs=-1, required=True, type=click.Path(path_type=Path, exists=True, dir_okay=False))
@click.option("--quality", default=50, show_default=True, type=click.IntRange(0, 100))
@click.option("--effort", default=5, show_default=True, type=click.IntRange(1, 9))
@click.option("--repeat", default=11, show_default=True, type=click.IntRange(1), help="Processes, which take turns.")
def main(other: Path, pictures: tuple[Path, ...], quality: int, effort: int, repeat: int) -> None:
    """Encode each of PICTURES with this version, and to as many bytes with that of the python OTHER, and print as
    Markdown the seconds of `sgi decode` to PNG and the milliseconds of decodes in a running process, medians.
    """
    click.echo("| picture | bytes | other | `sgi decode`, s | other | ratio | running process, ms | other | ratio |")
    click.echo("|---|" + "---:|" * 8)
    with tempfile.TemporaryDirectory(prefix="sgi-commands-") as folder:
        this, another = (
            Version(Path(sys.executable), Path(folder, "this.sgi")),
            Version(other, Path(folder, "that.sgi")),
        )
        for picture in pictures:
            size = this.encode(picture, "-q", str(quality), "-e", str(effort))
            found = another.encode(picture, "--size", str(size), "-e", str(effort))
            cells = [f"{size:,}", f"{found:,}"]
            for method, scale, count in (("decode", 1, repeat + 1), ("decode_again", 1e3, repeat // 3 + 1)):
                runs = in_turn((this, another), count, methodcaller(method))
                cells += _compared([scale * median(of_one[count > 1 :]) for of_one in runs])
            click.echo(f"| {' | '.join([picture.stem, *cells])} |")


def _compared(those: Sequence[float]) -> list[str]:
    return [*(f"{one:.3g}" for one in those), f"{those[0] / those[1]:.2f}"]
