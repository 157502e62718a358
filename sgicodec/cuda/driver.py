"""NVIDIA's driver through its C interface (libcuda.so.1), with errors as exceptions."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any

from sgicodec.errors import NoDeviceError, SgiError

LIBRARY = "libcuda.so.1"
"""What the driver installs. It is no part of the toolkit."""

_MAJOR, _MINOR = 75, 76
"""CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_*"""
_OUT_OF_MEMORY = 2

Pointer = ctypes.c_void_p


class CudaError(SgiError):
    """A call of the driver that failed (exit 1)."""


class Driver:
    """The functions of libcuda. Raises NoDeviceError where there is no driver or no GPU."""

    def __init__(self) -> None:
        try:
            self._library = ctypes.CDLL(LIBRARY)
        except OSError:
            raise NoDeviceError(f"no NVIDIA driver: {LIBRARY} cannot be loaded") from None
        try:
            self.call("cuInit", ctypes.c_uint(0))
        except CudaError as error:
            raise NoDeviceError(f"no GPU that the NVIDIA driver can use: {error}") from None
        self.count = self._number("cuDeviceGetCount")
        if not self.count:
            raise NoDeviceError("no GPU that the NVIDIA driver can use")

    def call(self, name: str, *arguments: Any) -> None:
        """Calls a function that returns a CUresult. Raises CudaError, or MemoryError, for any but success."""
        status = getattr(self._library, name)(*arguments)
        if not status:
            return
        text = ctypes.c_char_p()
        self._library.cuGetErrorString(status, ctypes.byref(text))
        said = (text.value or b"unknown error").decode()
        if status == _OUT_OF_MEMORY:
            raise MemoryError(f"the GPU has too little memory ({name})")
        raise CudaError(f"{name}: {said} ({status})")

    def handle(self, name: str, *arguments: Any) -> Pointer:
        """What a function writes to the pointer that is its first argument."""
        found = Pointer()
        self.call(name, ctypes.byref(found), *arguments)
        return found

    @property
    def cuda(self) -> int:
        """The major version of CUDA that it knows."""
        return self._number("cuDriverGetVersion") // 1000

    def name(self, index: int) -> str:
        """What the GPU is called."""
        text = ctypes.create_string_buffer(128)
        self.call("cuDeviceGetName", text, ctypes.c_int(len(text)), self._device(index))
        return text.value.decode()

    def capability(self, index: int) -> int:
        """Its compute capability: 90 for 9.0."""
        major, minor = (self.attribute(index, number) for number in (_MAJOR, _MINOR))
        return 10 * major + minor

    def attribute(self, index: int, number: int) -> int:
        """A property of it, by its number in CUdevice_attribute."""
        return self._number("cuDeviceGetAttribute", ctypes.c_int(number), self._device(index))

    def context(self, index: int) -> Pointer:
        """Its primary context, which all users in this process share."""
        if not 0 <= index < self.count:
            raise NoDeviceError(f"no GPU {index}: this machine has {self.count}")
        return self.handle("cuDevicePrimaryCtxRetain", self._device(index))

    def _device(self, index: int) -> ctypes.c_int:
        return ctypes.c_int(self._number("cuDeviceGet", ctypes.c_int(index)))

    def _number(self, name: str, *arguments: Any) -> int:
        found = ctypes.c_int()
        self.call(name, ctypes.byref(found), *arguments)
        return found.value


@cache
def the_driver() -> Driver:
    """The driver, initialised once in each process."""
    return Driver()
