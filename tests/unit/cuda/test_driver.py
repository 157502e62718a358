"""What is said where there is no driver or GPU, and what the driver says of one."""

from __future__ import annotations

import ctypes
from typing import Any

import pytest

from sgicodec.cuda import driver
from sgicodec.cuda.driver import Driver
from sgicodec.errors import NoDeviceError


def test_without_a_driver(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver, "LIBRARY", "libno-such-library.so.1")
    with pytest.raises(NoDeviceError, match=r"^no NVIDIA driver: libno-such-library.so.1 cannot be loaded$") as error:
        Driver()
    assert error.value.exit_code == 2


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
