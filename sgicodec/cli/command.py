"""Commands with a small help: the options that people use and examples; `--help-all` shows the others."""

from __future__ import annotations

from typing import Any

import click

_HELP_ALL = "sgicodec.help-all"
"""Key in a context's `meta`: whether all options are to be shown."""


class HelpfulCommand(click.Command):
    """common: names of the parameters that `--help` shows. research: of those that `--help-all` shows last. examples:
    pairs of a command line and what it does.
    """

    def __init__(
        self,
        *args: Any,
        common: tuple[str, ...] = (),
        research: tuple[str, ...] = (),
        examples: tuple[tuple[str, str], ...] = (),
        **kwargs: Any,
    ) -> None:
        super().__init__(*args, **kwargs)
        self.common, self.research, self.examples = common, research, examples

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """`--help -v` is `--help-all`, in any order."""
        if {"-v", "--verbose"} & set(args):
            ctx.meta[_HELP_ALL] = True
        return super().parse_args(ctx, args)

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """Those of the command, and `--help-all`."""
        return [*super().get_params(ctx), self._help_all_option()]

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The common options, or all in groups."""
        records: dict[str, list[tuple[str, str]]] = {"Options": [], "More options": [], "For research": []}
        for param in self.get_params(ctx):
            record = param.get_help_record(ctx)
            if record is not None and isinstance(param, click.Option):
                records[self._group(param)].append(record)
        shown = records if ctx.meta.get(_HELP_ALL) else {"Options": records["Options"]}
        for name, group in shown.items():
            if group:
                with formatter.section(name):
                    formatter.write_dl(group)
        hidden = sum(map(len, records.values())) - sum(map(len, shown.values()))
        if hidden:
            formatter.write_paragraph()
            formatter.write_text(f"{ctx.command_path} --help-all shows {hidden} more options.")

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The examples."""
        if self.examples:
            formatter.write_paragraph()
            formatter.write(examples_text(self.examples))

    def _group(self, param: click.Parameter) -> str:
        if param.name in self.research:
            return "For research"
        is_common = param.name in (*self.common, "help_all", "verbose") or "--help" in param.opts
        return "Options" if is_common else "More options"

    def _help_all_option(self) -> click.Option:
        def show(ctx: click.Context, param: click.Parameter, value: bool) -> None:
            if value and not ctx.resilient_parsing:
                ctx.meta[_HELP_ALL] = True
                click.echo(ctx.get_help())
                ctx.exit()

        text = "Show all options and exit."
        return click.Option(["--help-all"], is_flag=True, expose_value=False, is_eager=True, callback=show, help=text)


def examples_text(examples: tuple[tuple[str, str], ...]) -> str:
    """Lines of help that show command lines and what they do."""
    width = max(len(command) for command, _ in examples)
    lines = (f"  {command:<{width}}  {what}".rstrip() for command, what in examples)
    return "Examples:\n" + "\n".join(lines) + "\n"
