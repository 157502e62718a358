"""From what a user asks for (`auto`, `cpu`, `cuda`, `cuda:1`) to a Device."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from sgicodec.device import Device
from sgicodec.errors import SgiError, UsageError

__all__ = ["CHOICES", "NamedDevice", "check_name", "decoding_device_of", "device_of", "own_device_of"]

CHOICES = "auto, cpu, cuda or cuda:N"


def check_name(name: str) -> int | None:
    """The number of a GPU in a name, None where there is none. Raises UsageError for what is no device's name."""
    found = re.fullmatch(r"auto|cpu|cuda(?::(\d{1,3}))?", name) if isinstance(name, str) else None
    if found is None:
        raise UsageError(f"device {name!r}; it must be {CHOICES}")
    return None if found[1] is None else int(found[1])


def device_of(name: str = "auto", threads: int = 0) -> Device:
    """The device of this name, with as many threads of the processor. `cuda` is all GPUs, of which a picture in one
    tile takes the first; `auto` is the same if they can be used, else the processor alone.

    Raises UsageError for another name; NoDeviceError or MissingExtraError where `cuda` lacks GPU, driver or compiler.
    """
    number = check_name(name)
    if name == "cpu":
        return Device(threads)
    try:
        count = _usable(number or 0)
    except (SgiError, MemoryError):
        if name != "auto":
            raise
        return Device(threads)
    return Device(threads, gpu=number or 0, gpus=count if number is None else 1)


def own_device_of(name: str = "auto", threads: int = 0) -> Device:
    """The same for one of several processes of a machine: of several GPUs, one that the fewest others have claimed."""
    if name == "cpu" or check_name(name) is not None:
        return device_of(name, threads)
    from sgicodec.cuda.claim import claimed_gpu

    try:
        return device_of(f"cuda:{claimed_gpu()}", threads)
    except (SgiError, MemoryError):
        if name != "auto":
            raise
        return Device(threads)


def decoding_device_of(name: str = "auto", threads: int = 0) -> Device:
    """The device that decodes: as `device_of`, but `auto` is the processor, which has drawn most pictures before a GPU
    is ready (docs/performance.md), and `cuda` one GPU.
    """
    return device_of("cpu" if name == "auto" else name, threads).of_tile(0)


@dataclass(frozen=True)
class NamedDevice:
    """A device by its name, which every worker that is sent it finds at its own machine. processor: its threads and
    instruction set there.
    """

    name: str
    processor: Device

    def of_tile(self, number: int) -> Device:
        """What computes any tile in this process. Raises as `device_of`."""
        found = own_device_of(self.name, self.processor.threads)
        return replace(self.processor, gpu=found.gpu, gpus=1)


def _usable(number: int) -> int:
    """How many GPUs there are. Raises an error if this one cannot be used."""
    from sgicodec.cuda.gpu import opened

    return opened(number).driver.count
