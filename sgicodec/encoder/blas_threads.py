"""How many threads the products of matrices have while pictures are encoded: one."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits

__all__ = ["one_blas_thread"]

_VARIABLE = "OPENBLAS_NUM_THREADS"
"""By which somebody chose already; the command line does, before numpy loads."""
_setting = threading.Lock()
"""Held by the encode that has set the limit."""


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """BLAS has one thread meanwhile, in the whole process. Products are too small to share here, and threads that wait
    for the next one spin: a quarter of the processor time of an encode.

    Of encodes side by side, the one that set the limit takes it away when it ends; others may go on without. A program
    that sets OPENBLAS_NUM_THREADS keeps that.
    """
    if _VARIABLE in os.environ or not _setting.acquire(blocking=False):
        yield
        return
    try:
        with threadpool_limits(limits=1, user_api="blas"):
            yield
    finally:
        _setting.release()
