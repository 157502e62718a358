"""The group `sgi`: its commands, and how whatever they raise becomes one line on stderr and an exit code."""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import Any, NoReturn

import click

from sgicodec.cli.command import examples_text
from sgicodec.cli.options import VERBOSE, verbose_option
from sgicodec.cli.standard_streams import drop, repair
from sgicodec.cli.texts import EXAMPLES, EXIT_CODES, NO_MEMORY
from sgicodec.device import check_room
from sgicodec.errors import SgiError
from sgicodec.version import __version__

_INTERNAL, _USAGE, _INTERRUPTED, _BROKEN_PIPE = 1, 2, 130, 141

_COMMANDS = {
    "encode": "sgicodec.cli.encode",
    "decode": "sgicodec.cli.decode",
    "info": "sgicodec.cli.info",
    "verify": "sgicodec.cli.verify",
    "refine": "sgicodec.cli.residual",
    "strip": "sgicodec.cli.residual",
    "view": "sgicodec.cli.view",
    "serve": "sgicodec.cli.serve",
    "compare": "sgicodec.bench.command",
    "bench": "sgicodec.bench.command",
    "completion": "sgicodec.cli.completion",
}
"""The commands, and the modules that they live in."""


_ROOM_MIB = {"encode": 200, "decode": 136, "verify": 136, "view": 200, "serve": 200, "compare": 200, "bench": 200}
"""Address space that the libraries of a command take as they load; some end the process where there is less."""


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
            command = error.ctx.command_path if error.ctx else "sgi"
            status = _complain(f"{error.format_message().rstrip('.')}; see {command} --help", _USAGE)
        except SgiError as error:
            status = _complain(str(error), error.exit_code)
        except click.Abort as error:  # made of a KeyboardInterrupt
            status = _complain(str(error.__cause__ or "") or "interrupted", _INTERRUPTED)
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

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Examples and exit codes."""
        formatter.write_paragraph()
        formatter.write(examples_text(EXAMPLES))
        formatter.write_paragraph()
        codes = "".join(f"  {code:<3}  {text}\n" for code, text in EXIT_CODES)
        formatter.write(f"Exit codes:\n{codes}")

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The command that is named first. Raises UsageError, with what may have been meant."""
        name = args[0]
        if name not in _COMMANDS and not name.startswith("-"):
            from difflib import get_close_matches  # takes long to load

            close = get_close_matches(name, _COMMANDS, 1, 0.5)
            if os.path.isfile(name):
                hint = f" (it is a file; did you mean 'sgi {_command_for(name)} {name}'?)"
            else:
                hint = f" (did you mean {close[0]!r}?)" if close else ""
            raise click.UsageError(f"there is no command {name!r}{hint}", ctx)
        check_room(_ROOM_MIB.get(name, 0), f"sgi {name}")
        return super().resolve_command(ctx, args)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """`--version -v` says more, in any order."""
        ctx.meta[VERBOSE] = bool({"-v", "--verbose"} & set(args)) and "--version" in args
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        """Runs the command; what no user can be blamed for ends here."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            drop(1)
            ctx.exit(_BROKEN_PIPE)
        except (SgiError, click.ClickException, click.Abort, click.exceptions.Exit):
            raise
        except MemoryError as error:
            what = f": {error}" if "(ulimit -v)" in str(error) else " for this picture"
            ctx.exit(_complain(f"there is not enough memory{what}", _INTERNAL))
        except Exception as error:
            if any(text in str(error) for text in NO_MEMORY):
                ctx.exit(_complain(f"there is not enough memory: {str(error).splitlines()[-1]}", _INTERNAL))
            if ctx.meta.get(VERBOSE):
                import traceback

                traceback.print_exc()
            what = " ".join(f"{type(error).__name__}: {error}".split())
            ctx.exit(_complain(f"internal error, please report it; -v prints the trace: {what}", _INTERNAL))


def _command_for(path: str) -> str:
    """What one does with a file: a stream is decoded, a picture encoded."""
    from sgicodec.bitstream.recognition import looks_like_stream

    return "decode" if looks_like_stream(path) else "encode"


def _print_version(ctx: click.Context, param: click.Parameter, value: bool) -> None:
    if not value or ctx.resilient_parsing:
        return
    click.echo(f"sgi {__version__}")
    if ctx.meta.get(VERBOSE):
        from sgicodec.cli.versions import version_lines

        click.echo("\n".join(version_lines()))
    ctx.exit()


def _complain(message: str, status: int) -> int:
    from sgicodec.cli.files import one_line

    click.echo(f"sgi: {one_line(message)}", err=True)
    return status


@click.group("sgi", cls=Cli, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_version,
    help="Show the version and exit; with -v libraries and instruction set too.",
)
@click.option("-v", "--verbose", is_flag=True, expose_value=False, help="With --version: tell more.")
def cli() -> None:
    """Pictures as 2D Gaussians in small files, decoded at any scale."""


def main() -> None:
    """Entry point of `sgi`."""
    # OpenBLAS starts a thread per core as numpy loads: half of the time of `sgi info`, for products too small to share.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    repair()
    cli()
