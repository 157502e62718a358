"""One GPU: its memory, the kernels, their launches."""

from __future__ import annotations

import ctypes
from contextlib import suppress
from functools import cache
from threading import local
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from sgicodec.cuda.compiler import compiled
from sgicodec.cuda.driver import CudaError, Driver, Pointer, the_driver

_NON_BLOCKING = ctypes.c_uint(1)
"""CU_STREAM_NON_BLOCKING."""


class Gpu:
    """GPU `index` with the kernels of `image`, machine code for it or PTX. Not safe for use by two threads at once.
    Kernels and stream go with it.
    """

    def __init__(self, driver: Driver, index: int, image: bytes) -> None:
        self.driver, self.index = driver, index
        self._context = driver.context(index)
        self.use()
        self._module = driver.handle("cuModuleLoadData", ctypes.c_char_p(image))
        self._functions: dict[str, Pointer] = {}
        self.stream = driver.handle("cuStreamCreate", _NON_BLOCKING)

    def __del__(self) -> None:
        with suppress(AttributeError, CudaError):  # it was not opened; or the process ends, and the driver has done so
            self.use()
            self.wait()
            self.driver.call("cuStreamDestroy_v2", self.stream)
            self.driver.call("cuModuleUnload", self._module)

    @property
    def name(self) -> str:
        """What the GPU is called."""
        return self.driver.name(self.index)

    def use(self) -> None:
        """Makes it that of this thread: to be called before anything else in it."""
        self.driver.call("cuCtxSetCurrent", self._context)

    def array(self, shape: int | tuple[int, ...], dtype: DTypeLike = np.float32) -> GpuArray:
        """Memory for an array, not set."""
        return GpuArray(self, shape, dtype)

    def put(self, values: NDArray[Any]) -> GpuArray:
        """A copy of an array."""
        array = GpuArray(self, values.shape, values.dtype)
        array.upload(values)
        return array

    def launch(self, kernel: str, blocks: int, threads: int, arguments: ctypes.Structure) -> None:
        """Lets `blocks` blocks run, behind what was launched before."""
        if blocks < 1:
            return
        given = (ctypes.c_void_p * 1)(ctypes.addressof(arguments))
        sizes = [ctypes.c_uint(n) for n in (blocks, 1, 1, threads, 1, 1, 0)]
        self.driver.call("cuLaunchKernel", self._function(kernel), *sizes, self.stream, given, None)

    def wait(self) -> None:
        """Until everything that was launched is done."""
        self.driver.call("cuStreamSynchronize", self.stream)

    def _function(self, kernel: str) -> Pointer:
        if kernel not in self._functions:
            self._functions[kernel] = self.driver.handle("cuModuleGetFunction", self._module, kernel.encode())
        return self._functions[kernel]


class GpuArray:
    """An array in the memory of a GPU, freed with this object."""

    def __init__(self, gpu: Gpu, shape: int | tuple[int, ...], dtype: DTypeLike) -> None:
        self.gpu, self.dtype = gpu, np.dtype(dtype)
        self.shape = (shape,) if isinstance(shape, int) else shape
        self.bytes = int(np.prod(self.shape, dtype=np.int64)) * self.dtype.itemsize
        self._memory = gpu.driver.handle("cuMemAlloc_v2", ctypes.c_size_t(max(1, self.bytes)))

    def __del__(self) -> None:
        with suppress(AttributeError, CudaError):  # no memory was had; or the process ends, and the driver has freed it
            self.gpu.use()  # whatever thread lets go of it last
            self.gpu.driver.call("cuMemFree_v2", self._memory)

    @property
    def address(self) -> int:
        """Where it begins."""
        return self._memory.value or 0

    def upload(self, values: NDArray[Any]) -> None:
        """Takes the values of an array of this shape and type."""
        if values.shape != self.shape or values.dtype != self.dtype:
            raise ValueError(f"{values.dtype}{values.shape} is not {self.dtype}{self.shape}")
        if self.bytes:
            whole = np.ascontiguousarray(values)
            self._copy("cuMemcpyHtoDAsync_v2", self._memory, ctypes.c_void_p(whole.ctypes.data))
            self.gpu.wait()  # the copy must not outlive what it reads

    def download(self) -> NDArray[Any]:
        """Its values, after everything that was launched."""
        values = np.empty(self.shape, self.dtype)
        if self.bytes:
            self._copy("cuMemcpyDtoHAsync_v2", ctypes.c_void_p(values.ctypes.data), self._memory)
        self.gpu.wait()
        return values

    def last(self) -> Any:
        """The last of its values, after everything that was launched."""
        value = np.empty((), self.dtype)
        end = ctypes.c_void_p(self.address + self.bytes - self.dtype.itemsize)
        self._copy("cuMemcpyDtoHAsync_v2", ctypes.c_void_p(value.ctypes.data), end, self.dtype.itemsize)
        self.gpu.wait()
        return value[()]

    def _copy(self, name: str, to: Pointer, source: Pointer, count: int | None = None) -> None:
        size = ctypes.c_size_t(self.bytes if count is None else count)
        self.gpu.driver.call(name, to, source, size, self.gpu.stream)


def opened(index: int) -> Gpu:
    """GPU `index`, with kernels for its architecture; every thread has its own, until it ends. Raises NoDeviceError,
    MissingExtraError.
    """
    held = own_gpus().held
    if index not in held:
        held[index] = _open(index)
    return held[index]


class _Own(local):
    """The GPUs of a thread by number, which nothing but their arrays holds when it has ended."""

    def __init__(self) -> None:
        self.held: dict[int, Gpu] = {}


@cache
def own_gpus() -> _Own:
    """Those of this thread."""
    return _Own()


def _open(index: int) -> Gpu:
    driver = the_driver()
    driver.context(index)
    return Gpu(driver, index, machine_code(driver.capability(index), driver.cuda))


@cache
def machine_code(architecture: int, cuda: int) -> bytes:
    """The kernels for an architecture and a driver of CUDA `cuda`, read or compiled once in each process."""
    return compiled(architecture, cuda)
