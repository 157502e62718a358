"""What `sgi decode` may take for a stream that a stranger sent: --max-pixels and --max-memory."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from sgicodec.cli.texts import NO_MEMORY
from sgicodec.errors import LimitError
from sgicodec.executors.available import group_memory
from sgicodec.executors.peak import own_peak

_MIB = 1 << 20


@dataclass(frozen=True)
class DecodeLimits:
    """pixels: that are written at most; memory: bytes beyond what the program takes before it decodes; None for any.
    asked: whether that was asked for with --max-memory, or is what is left of the control group's.
    """

    pixels: float | None
    memory: float | None
    asked: bool = True

    @classmethod
    def of(cls, pixels: float | None, memory: float | None) -> DecodeLimits:
        """As was asked for; without a limit of memory, that of the control group: it would end the program without a
        word.
        """
        if memory is None and (group := group_memory()) is not None:
            return cls(pixels, max(0, group - (own_peak() or 0)), asked=False)
        return cls(pixels, memory)

    @property
    def bound(self) -> float | None:
        """Bytes that `held` allows; None for any."""
        return self.memory if self.asked else None

    def check(self, width: int, height: int, sample_bytes: int) -> None:
        """Refuses a picture of this size, of which `sample_bytes` are in memory at a time. Raises LimitError."""
        if self.pixels is not None and width * height > self.pixels:
            raise LimitError(f"{width}×{height} pixels are more than --max-pixels {self.pixels:.0f}")
        if self.memory is not None and sample_bytes > self.memory:
            allowed = "--max-memory" if self.asked else f"the {self.memory / _MIB:,.0f} MiB left in its control group"
            text = f"{width}×{height} pixels take {sample_bytes / _MIB:,.0f} MiB"
            raise LimitError(f"{text}, more than {allowed}; decode a --region, or a smaller --scale")

    @contextlib.contextmanager
    def held(self) -> Iterator[None]:
        """A block that takes no more memory (Linux), else LimitError. Libraries have to be loaded before it: some end
        the process where they get none.
        """
        with contextlib.ExitStack() as stack:
            if self.bound is not None and sys.platform.startswith("linux"):
                import resource

                before = resource.getrlimit(resource.RLIMIT_DATA)
                most = _data_bytes() + int(self.bound)
                if before[1] != resource.RLIM_INFINITY:
                    most = min(most, before[1])
                resource.setrlimit(resource.RLIMIT_DATA, (most, before[1]))
                stack.callback(resource.setrlimit, resource.RLIMIT_DATA, before)
            try:
                yield
            except (MemoryError, RuntimeError, OSError, ImportError) as error:
                lacks = isinstance(error, MemoryError) or any(text in str(error) for text in NO_MEMORY)
                if self.bound is None or not lacks:
                    raise
                raise LimitError(f"decoding takes more than --max-memory, {self.bound / _MIB:,.0f} MiB") from None


def _data_bytes() -> int:
    """What this process has of the memory that RLIMIT_DATA bounds."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next((1024 * int(line.split()[1]) for line in lines if line.startswith("VmData:")), 0)
