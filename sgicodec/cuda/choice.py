"""From what a user asks for (`auto`, `cpu`, `cuda`, `cuda:1`) to a Device."""

from __future__ import annotations

import re

from sgicodec.device import Device
from sgicodec.errors import SgiError, UsageError

__all__ = ["CHOICES", "decoding_device_of", "device_of"]

CHOICES = "auto, cpu, cuda or cuda:N"


def device_of(name: str = "auto", threads: int = 0) -> Device:
    """The device of this name, with as many threads of the processor. `cuda` is all GPUs, of which a picture in one
    tile takes the first; `auto` is the same if they can be used, else the processor alone.

    Raises UsageError for another name; NoDeviceError or MissingExtraError where `cuda` lacks GPU, driver or compiler.
    """
    found = re.fullmatch(r"auto|cpu|cuda(?::(\d{1,3}))?", name)
    if found is None:
        raise UsageError(f"device {name!r}; it must be {CHOICES}")
    if name == "cpu":
        return Device(threads)
    try:
        number = int(found[1] or 0)
        count = _usable(number)
    except (SgiError, MemoryError):
        if name != "auto":
            raise
        return Device(threads)
    return Device(threads, gpu=number, gpus=1 if found[1] else count)


def decoding_device_of(name: str = "auto", threads: int = 0) -> Device:
    """The device that decodes: as `device_of`, but `auto` is the processor, which has drawn most pictures before a GPU
    is ready (docs/performance.md), and `cuda` one GPU.
    """
    return device_of("cpu" if name == "auto" else name, threads).of_tile(0)


def _usable(number: int) -> int:
    """How many GPUs there are. Raises an error if this one cannot be used."""
    from sgicodec.cuda.gpu import opened

    return opened(number).driver.count
