"""Every number that steers RDOQ."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["RdoqSettings"]


@dataclass(frozen=True)
class RdoqSettings:
    """How RDOQ follows a fit. What each part gains was measured: docs/notes/2026-11-rdoq.md."""

    passes: int = 6
    """Times that all seeds are gone through."""
    deep: int = 2
    """Choices of a seed's colours that are followed to its shape and offset."""
