"""`sgi man`: the manual page, made from the commands themselves."""

from __future__ import annotations

import inspect
import re

import click

from sgicodec.cli.command import HelpfulCommand
from sgicodec.cli.texts import EXAMPLES, EXIT_CODES
from sgicodec.version import __version__

__all__ = ["man", "man_page"]


@click.command(short_help="Print the manual page.")
def man() -> None:
    """Print the manual page: sgi man | man -l -, or sgi man > sgi.1."""
    group = click.get_current_context().find_root().command
    assert isinstance(group, click.Group)
    click.echo(man_page(group), nl=False)


def man_page(cli: click.Group) -> str:
    """The page in the macros of man(7), in the order of man-pages(7)."""
    context = click.Context(cli, info_name="sgi", **cli.context_settings)
    lines = [
        f'.TH SGI 1 "" "sgicodec {__version__}" "User Commands"',
        ".SH NAME",
        r"sgi \- pictures as 2D Gaussians in small files, decoded at any scale",
        ".SH SYNOPSIS",
        r".B sgi",
        r"\fICOMMAND\fR [\fIOPTIONS\fR] [\fIARGUMENTS\fR]",
    ]
    lines += [".SH DESCRIPTION", *_paragraphs(cli.help or ""), *_options(context, cli)]
    lines += [".SH COMMANDS"]
    for name in cli.list_commands(context):
        command = cli.get_command(context, name)
        assert command is not None
        lines += _command(click.Context(command, context, info_name=name), command)
    lines += [".SH EXIT STATUS", *_entries((str(code), text) for code, text in EXIT_CODES)]
    lines += [".SH EXAMPLES", *_entries(EXAMPLES)]
    return "\n".join(lines) + "\n"


def _command(context: click.Context, command: click.Command) -> list[str]:
    usage = " ".join(command.collect_usage_pieces(context))
    lines = [rf".SS sgi {context.info_name} {_escaped(usage)}", *_paragraphs(command.help or "")]
    lines += _options(context, command)
    if isinstance(command, HelpfulCommand):
        lines += [".PP", "Examples:", *_entries(command.examples)]
    return lines


def _options(context: click.Context, command: click.Command) -> list[str]:
    options = (param for param in command.get_params(context) if isinstance(param, click.Option))
    return _entries(record for record in (option.get_help_record(context) for option in options) if record is not None)


def _entries(pairs: object) -> list[str]:
    """Terms, each with what it means."""
    lines = []
    for term, text in pairs:  # type: ignore[attr-defined]
        lines += [".TP", rf"\fB{_escaped(term)}\fR", _escaped(" ".join(text.split()))]
    return lines


def _paragraphs(text: str) -> list[str]:
    lines = []
    for paragraph in inspect.cleandoc(text).split("\n\n"):
        if paragraph.startswith("\b"):
            lines += [".PP", ".nf", *map(_escaped, paragraph.splitlines()[1:]), ".fi"]
        else:
            lines += [".PP", _escaped(" ".join(paragraph.split()))]
    return lines


def _escaped(text: str) -> str:
    """Text as roff wants it: no control line, no escape, hyphens that can be searched for."""
    text = text.replace("\\", r"\e").replace("-", r"\-")
    return re.sub(r"^([.'])", r"\\&\1", text)
