"""Tests that AddressSanitizer has no room for."""

from __future__ import annotations

import os

import pytest

__all__ = ["needs_plain_memory"]


def needs_plain_memory() -> None:
    """Skips a test that bounds the address space, of which the sanitizer reserves terabytes."""
    if "libasan" in os.environ.get("LD_PRELOAD", ""):
        pytest.skip("AddressSanitizer reserves address space")
