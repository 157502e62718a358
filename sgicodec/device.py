"""What computes: threads and instruction set of the processor, and a GPU."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from numbers import Integral

from sgicodec.errors import UsageError


@dataclass(frozen=True)
class Device:
    """threads: 0 for one per core. isa: auto, avx512, avx2 or portable. gpu: the number of an NVIDIA GPU that fits, as
    far as its kernels can (`cuda.choice.device_of` says which there are), None for the processor alone. Raises
    UsageError for an instruction set that this machine lacks.

    What a stream decodes to depends on nothing of it. What an encode makes of a picture does not depend on `threads`,
    but may on `isa` and `gpu`, where sums are rounded in another order. A program makes one where it begins and hands
    it down to whatever computes.
    """

    threads: int = 0
    isa: str = "auto"
    gpu: int | None = None

    def __post_init__(self) -> None:
        if isinstance(self.threads, bool) or not isinstance(self.threads, Integral) or self.threads < 0:
            raise UsageError(f"threads {self.threads!r}; 0 (all cores) or more")
        if self.gpu is not None and (isinstance(self.gpu, bool) or not isinstance(self.gpu, Integral) or self.gpu < 0):
            raise UsageError(f"gpu {self.gpu!r}; 0 or more, or None")
        if self.isa != "auto":
            from sgicodec._native import instruction_set

            try:
                instruction_set(self.isa)
            except (TypeError, ValueError) as error:
                raise UsageError(f"isa {self.isa!r}: {str(error).splitlines()[0]}") from None

    @property
    def cores(self) -> int:
        """How many threads that is."""
        return self.threads or own_cores()

    def found(self) -> Device:
        """As `NamedDevice`: itself."""
        return self

    @property
    def processor(self) -> Device:
        """The same without a GPU."""
        return replace(self, gpu=None)

    def shared_among(self, workers: int) -> Device:
        """What each of so many workers has, who compute at the same time."""
        return self.with_threads(max(1, self.cores // max(1, workers)))

    def with_threads(self, threads: int) -> Device:
        """The same with another number of threads."""
        return replace(self, threads=threads)


def own_cores() -> int:
    """Cores that this process may use: all of the machine's, or those that it is bound to."""
    try:
        return len(os.sched_getaffinity(0))
    except (AttributeError, OSError):  # not Linux
        return os.cpu_count() or 1


def check_device(device: object) -> None:
    """Raises UsageError for what is no Device."""
    if not isinstance(device, Device):
        raise UsageError(f"device {device!r}; it must be a Device")


def room_left() -> int | None:
    """MiB of address space that its limit (ulimit -v) leaves; None without one."""
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    except (ImportError, AttributeError, OSError):
        return None
    if limit == resource.RLIM_INFINITY:
        return None
    try:
        with open("/proc/self/statm", "rb") as file:
            used = int(file.read().split()[0]) * resource.getpagesize()
    except OSError:
        used = 0
    return max(0, limit - used) >> 20


def check_room(mebibytes: int, what: str) -> None:
    """Raises MemoryError if a limit of the address space (ulimit -v) leaves less than `what` takes."""
    left = room_left()
    if left is not None and left < mebibytes:
        raise MemoryError(f"{what} takes {mebibytes} MiB of address space to begin, and {left} are left (ulimit -v)")


ALL_CORES = Device()
PROCESSOR = "processor"
"""What reports call it, where they have the names of GPUs."""
ONE_THREAD = Device(threads=1)
