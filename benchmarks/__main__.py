"""The runner of all benchmarks: `python -m benchmarks` lists them, `python -m benchmarks NAME …` runs one."""

from __future__ import annotations

import sys
from importlib import import_module

import click

from sgicodec.errors import SgiError

BENCHMARKS = {
    "decode": ("benchmarks.decode", "What decoding costs, next to another version of the package."),
    "ladder": ("benchmarks.ladder", "What each effort takes and gives, beside AVIF and JPEG XL."),
    "alpha": ("benchmarks.alpha", "Bytes and scores of pictures with alpha, beside AVIF and WebP."),
    "raster": ("benchmarks.raster", "The native rasteriser's passes, next to the peak of the cores."),
    "cuda": ("benchmarks.cuda", "Check and measure the kernels on a GPU; count floors without."),
    "paper": ("benchmarks.paper.command", "The paper's tables, measured again beside its own figures."),
    "indices": ("benchmarks.indices", "What coding does to NDVI and band ratios, beside JPEG 2000."),
    "sheets": ("benchmarks.sheets", "Draw details of pictures by all codecs in as many bytes."),
    "figure": ("benchmarks.figure", "Draw the README's picture: original, sgi, AVIF of equal size."),
}
"""Name on the command line → the module whose `main` is the command, and what it does."""


class Runner(click.Group):
    """Loads the module of the benchmark that is run, and no other."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """All names, in the order of the table."""
        return list(BENCHMARKS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """The benchmark called `name`."""
        if name not in BENCHMARKS:
            return None
        command: click.Command = import_module(BENCHMARKS[name][0]).main
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """One line for each, without loading any."""
        with formatter.section("Benchmarks"):
            formatter.write_dl([(name, line) for name, (_, line) in BENCHMARKS.items()])


@click.command(cls=Runner, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
def main() -> None:
    """Measure sgicodec. `python -m benchmarks NAME --help` says what one takes."""


if __name__ == "__main__":
    try:
        main(prog_name="python -m benchmarks")
    except SgiError as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
