"""Which device a name means, and one line for what is missing: a driver, a GPU."""

from __future__ import annotations

import ctypes
from typing import Any
from unittest.mock import Mock

import pytest

from sgicodec.cuda import choice
from sgicodec.cuda.choice import device_of
from sgicodec.cuda.driver import Driver
from sgicodec.device import Device
from sgicodec.errors import MissingExtraError, NoDeviceError


@pytest.fixture
def _two_gpus(monkeypatch: pytest.MonkeyPatch) -> None:
    def usable(number: int) -> None:
        if number > 1:
            raise NoDeviceError(f"no GPU {number}: this machine has 2")

    monkeypatch.setattr(choice, "_check_usable", usable)


@pytest.mark.usefixtures("_two_gpus")
def test_names() -> None:
    assert device_of("cpu", 3) == Device(3)
    assert device_of("auto", 3) == device_of("cuda", 3) == Device(3, gpu=0)
    assert device_of("cuda:0", 3) == Device(3, gpu=0)
    assert device_of("cuda:1") == Device(gpu=1)
    with pytest.raises(NoDeviceError, match="no GPU 2"):
        device_of("cuda:2")


@pytest.mark.parametrize("error", [NoDeviceError("no driver"), MissingExtraError("no NVRTC"), MemoryError("full")])
def test_auto_takes_the_processor_where_cuda_says_why_not(error: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(choice, "_check_usable", Mock(side_effect=error))
    assert device_of("auto", 2) == Device(2)
    with pytest.raises(type(error), match=str(error)):
        device_of("cuda")


class Broken:
    """A driver with functions that fail or find nothing."""

    def __init__(self, **status: int) -> None:
        self._status = status

    def __getattr__(self, name: str) -> Any:
        return lambda *arguments: self._status.get(name, 0)


@pytest.mark.parametrize("status", [{"cuInit": 100}, {}], ids=["no device", "none of them"])
def test_without_a_gpu(status: dict[str, int], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ctypes, "CDLL", lambda name: Broken(**status))
    with pytest.raises(NoDeviceError, match="no GPU that the NVIDIA driver can use"):
        Driver()
