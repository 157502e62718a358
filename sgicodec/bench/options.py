"""What options of several benchmarks take."""

from __future__ import annotations

from sgicodec.errors import UsageError

__all__ = ["numbers"]


def numbers(text: str, option: str) -> list[float]:
    """Numbers with commas between. Raises UsageError for what is none."""
    try:
        return [float(part) for part in text.split(",") if part.strip()]
    except ValueError as error:
        raise UsageError(f"{option} takes numbers with commas between, not {text!r}") from error
