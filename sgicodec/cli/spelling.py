"""What is wrong with a command line before its options are read: a value that a space splits, a mode that is none."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from os.path import exists

import click

__all__ = ["check_spelling"]

_NUMBER = re.compile(r"[-+]?[.,]?\d[\d.,:/xX×!+-]*")
"""How a value of numbers begins."""

_FRAGMENT = re.compile(r"[-+]?[\d.,:/xX×!][\d.,:/xX×!+-]*")
"""Numbers, and what stands between them."""

_UNIT = re.compile(r"%|percent|d[bB]|bpp|bits?|px|pixels?|[kmgt]i?b|bytes?|sec|secs|seconds?|min|minutes?|hours?", re.I)
"""Units that no file is called by chance."""

_LETTERS = {"BYTES": "kmgb", "SIZE": "kmgb", "F": "x×", "S": "smh"}
"""One letter that may stand for a unit, by what help calls the option's value."""

_JOINTS = {"F": "/", "WxH": "xX×"}
"""What stands between the numbers of a value, by the same name; else commas."""

_SECONDS = {"m": 60, "h": 3600}
"""Of minutes and hours, by their first letter."""


def check_spelling(command: click.Command, group: click.Context, args: list[str]) -> None:
    """Raises click.UsageError with the right spelling."""
    context = click.Context(command, group, command.name)
    for written, right in _split_values(command, args):
        raise click.UsageError(f"a space splits {written!r}; write {right!r}", context)


def _split_values(command: click.Command, args: list[str]) -> Iterator[tuple[str, str]]:
    """Values that go on in the next arguments, as they are written, and as they should be."""
    options = _options_with_value(command)
    names, at = 0, 0
    while at < len(args) and args[at] != "--":
        name, value, after = _option(options, args, at)
        if name is None or value is None:
            names += not args[at].startswith("-")
            at += 1
            continue
        rest = _rest(options[name], value, args[after:])
        if rest and not (names == 0 and exists(rest[0])):  # which would be IN
            yield " ".join([*args[at:after], *rest]), f"{name} {_joined(options[name], value, rest)}"
        at = after


def _options_with_value(command: click.Command) -> dict[str, click.Option]:
    found = (param for param in command.params if isinstance(param, click.Option))
    return {name: option for option in found if not (option.is_flag or option.count) for name in option.opts}


def _option(options: Mapping[str, click.Option], args: list[str], at: int) -> tuple[str | None, str | None, int]:
    """The option that stands at a place, its value, and the place after it; None for what is none or has no value."""
    name, equals, value = args[at].partition("=")
    if name in options and equals:
        return name, value, at + 1
    if name in options:
        return name, args[at + 1] if at + 1 < len(args) else None, at + 2
    short, value = args[at][:2], args[at][2:]
    return (short, value, at + 1) if short in options and value and short != "--" else (None, None, at + 1)


def _rest(option: click.Option, value: str, following: list[str]) -> list[str]:
    """The arguments that go on with a value of numbers."""
    rest: list[str] = []
    if not _NUMBER.fullmatch(value):
        return rest
    for word in following:
        so_far = "".join([value, *rest])
        joints = tuple(_JOINTS.get(option.metavar or "", ","))
        joins = so_far.endswith(joints) or word.startswith(joints) or (_joint(option) and not _reads(option, so_far))
        if not (_is_unit(option, word) or (joins and _FRAGMENT.fullmatch(word))):
            break
        rest.append(word)
    return rest


def _is_unit(option: click.Option, word: str) -> bool:
    letters = _LETTERS.get(option.metavar or "", "")
    return bool(_UNIT.fullmatch(word)) or (len(word) == 1 and word.lower() in letters)


def _joined(option: click.Option, value: str, rest: list[str]) -> str:
    """The value in one word, without a unit that the option does not take; minutes and hours as seconds."""
    if option.metavar == "S":
        return f"{float(value) * _SECONDS.get(rest[0][0].lower(), 1):g}"
    numbers = [value, *(word for word in rest if not _is_unit(option, word))]
    for joint in ("", _joint(option)):
        for words in ([value, *rest], numbers):
            if _reads(option, found := joint.join(words)):
                return found
    return "".join(numbers)


def _joint(option: click.Option) -> str:
    """What stands between the numbers of its value."""
    name = "LOW,HIGH" if option.name == "sample_range" else option.metavar or ""
    return next((joint for joint in (",", "x") if joint in name), "")


def _reads(option: click.Option, value: str) -> bool:
    try:
        option.type.convert(value, option, None)
    except click.BadParameter:
        return False
    return True
