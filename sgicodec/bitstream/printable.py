"""Text that somebody else wrote, made safe to show."""

from __future__ import annotations

_MAX_TEXT = 200
"""Bytes that are shown of the name of the program that wrote a stream."""


def printable(text: bytes) -> str:
    """The start of a text that somebody else wrote, without what could steer a terminal."""
    decoded = text[:_MAX_TEXT].decode("utf-8", "replace")
    return "".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in decoded)
