"""The group `sgi`: its commands, and how whatever they raise becomes one line on stderr and an exit code."""

from __future__ import annotations

import io
import os
import sys
from importlib import import_module
from typing import Any, NoReturn

import click

from sgicodec.cli.options import VERBOSE, verbose_option
from sgicodec.errors import SgiError
from sgicodec.version import __version__

__all__ = ["cli", "main"]

_INTERNAL, _USAGE, _INTERRUPTED, _BROKEN_PIPE = 1, 2, 130, 141

_COMMANDS = {
    "encode": "sgicodec.cli.encode",
    "decode": "sgicodec.cli.decode",
    "info": "sgicodec.cli.info",
    "verify": "sgicodec.cli.verify",
    "compare": "sgicodec.bench.command",
    "bench": "sgicodec.bench.command",
}
"""The commands, and the modules that they live in."""

_EXIT_CODES = """\b
Exit codes:
  0    done
  1    internal error, or a benchmark point, a tile or a file of many that failed
  2    arguments or settings that make no sense
  3    a picture that cannot be read or written
  4    a stream that is damaged, unsupported or cannot be opened
  5    a target that was missed
  6    the output exists and -f was not given, or another encode is writing it
  130  interrupted, nothing written
  141  the reader of a pipe went away
"""


class Cli(click.Group):
    """A group that reports every failure as one line."""

    def main(  # type: ignore[override]
        self, args: list[str] | None = None, prog_name: str | None = None, **extra: Any
    ) -> NoReturn:
        """Runs a command line and exits with its status."""
        try:
            status = super().main(args, prog_name or "sgi", **extra | {"standalone_mode": False})
        except click.exceptions.NoArgsIsHelpError as error:
            error.show()
            status = _USAGE
        except click.UsageError as error:
            place = error.ctx.command_path if error.ctx else "sgi"
            status = _complain(f"{error.format_message().rstrip('.')}; see {place} --help", _USAGE)
        except SgiError as error:
            status = _complain(str(error), error.exit_code)
        except click.Abort:
            status = _complain("interrupted", _INTERRUPTED)
        sys.exit(status if isinstance(status, int) else 0)

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The commands in the order in which they are met."""
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """The command called `name`. Only its own module is loaded: starting takes half of the time of a decode."""
        if name in _COMMANDS and name not in self.commands:
            command: click.Command = getattr(import_module(_COMMANDS[name]), name)
            self.add_command(verbose_option(command))
        return super().get_command(ctx, name)

    def invoke(self, ctx: click.Context) -> Any:
        """Runs the command; what no user can be blamed for ends here."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            _drop_stdout()
            ctx.exit(_BROKEN_PIPE)
        except (SgiError, click.ClickException, click.Abort, click.exceptions.Exit):
            raise
        except MemoryError:
            ctx.exit(_complain("there is not enough memory for this picture", _INTERNAL))
        except Exception as error:
            if ctx.meta.get(VERBOSE):
                import traceback

                traceback.print_exc()
            what = " ".join(f"{type(error).__name__}: {error}".split())
            ctx.exit(_complain(f"internal error, please report it; -v prints the trace: {what}", _INTERNAL))


def _complain(message: str, status: int) -> int:
    click.echo(f"sgi: {' '.join(message.split())}", err=True)
    return status


def _drop_stdout() -> None:
    """Keeps the interpreter from complaining about what is still to be flushed when it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@click.group("sgi", cls=Cli, epilog=_EXIT_CODES, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="sgi", message="%(prog)s %(version)s")
def cli() -> None:
    """Pictures as 2D Gaussians in small files, decoded at any scale."""


def main() -> None:
    """Entry point of `sgi`."""
    # OpenBLAS starts a thread per core as numpy loads: half of the time of `sgi info`, for products too small to share.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a locale that lacks × or δ is no reason to fail
    cli()
