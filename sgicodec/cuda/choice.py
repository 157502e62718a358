"""From what a user asks for (`auto`, `cpu`, `cuda`, `cuda:1`) to a Device."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from sgicodec.device import Device
from sgicodec.errors import SgiError, UsageError

CHOICES = "auto, cpu, cuda or cuda:N"


def check_name(name: str) -> int | None:
    """The number of a GPU in a name, None where there is none. Raises UsageError for what is no device's name."""
    found = re.fullmatch(r"auto|cpu|cuda(?::(\d{1,3}))?", name) if isinstance(name, str) else None
    if found is None:
        raise UsageError(f"device {name!r}; it must be {CHOICES}")
    return None if found[1] is None else int(found[1])


def device_of(name: str = "auto", threads: int = 0) -> Device:
    """The device of this name, with as many threads of the processor. `cuda` is the first GPU; `auto` is the same if
    it can be used, else the processor alone.

    Raises UsageError for another name; NoDeviceError or MissingExtraError where `cuda` lacks GPU, driver or compiler.
    """
    number = check_name(name)
    if name == "cpu":
        return Device(threads)
    try:
        _check_usable(number or 0)
    except (SgiError, MemoryError):
        if name != "auto":
            raise
        return Device(threads)
    return Device(threads, gpu=number or 0)


@dataclass(frozen=True)
class NamedDevice:
    """A device by its name, which every worker that is sent it finds at its own machine. processor: its threads and
    instruction set there.
    """

    name: str
    processor: Device

    def found(self) -> Device:
        """What computes in this process. Raises as `device_of`."""
        return replace(self.processor, gpu=device_of(self.name, self.processor.threads).gpu)


def _check_usable(number: int) -> None:
    """Raises an error if this GPU cannot be used."""
    from sgicodec.cuda.gpu import opened

    opened(number)
