"""What `--json` prints: one object a line, with the number of its schema."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import click

SCHEMA = 1
"""Grows when a key goes or changes its meaning, not when one is added."""


def print_json(facts: Mapping[str, Any]) -> None:
    """Prints an object on one line of stdout. Bytes of names that are no UTF-8 are escaped as Python has them."""
    text = json.dumps({"schema": SCHEMA} | dict(facts), ensure_ascii=False, allow_nan=False)
    click.echo(text.encode("utf-8", "backslashreplace").decode())
