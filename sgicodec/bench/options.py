"""What options of several benchmarks take."""

from __future__ import annotations

import re
import shlex

from sgicodec.errors import UsageError


def numbers(text: str, option: str) -> list[float]:
    """Numbers with commas between. Raises UsageError for what is none."""
    try:
        return [float(part) for part in text.split(",") if part.strip()]
    except ValueError as error:
        raise UsageError(f"{option} takes numbers with commas between, not {text!r}") from error


def variant(text: str, option: str) -> tuple[str, tuple[str, ...]]:
    """A name and the options of a command from NAME=OPTIONS. Raises UsageError for anything else."""
    label, equals, options = text.partition("=")
    try:
        words = tuple(shlex.split(options))
    except ValueError as error:
        raise UsageError(f"{option}: {error} in {options!r}") from error
    if not equals or not re.fullmatch(r"[\w.+-]+", label):
        raise UsageError(f"{option} takes NAME=OPTIONS, not {text!r}")
    return label, words
