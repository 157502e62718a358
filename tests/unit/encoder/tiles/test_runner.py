"""BLAS has one thread while pictures are encoded, and its own number afterwards."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import numpy as np  # noqa: F401 (whose BLAS it is)
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from sgicodec.encoder.tiles.runner import one_blas_thread


def blas_threads() -> set[int]:
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


@pytest.fixture(autouse=True)
def _three_threads(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    with threadpool_limits(limits=3, user_api="blas"):
        if blas_threads() != {3}:
            pytest.skip("a BLAS of one thread")
        yield


def failing() -> None:
    with one_blas_thread():
        assert blas_threads() == {1}
        with one_blas_thread():
            assert blas_threads() == {1}
        assert blas_threads() == {1}
        raise ZeroDivisionError


def test_one_and_then_as_before() -> None:
    for _ in range(2):
        with pytest.raises(ZeroDivisionError):
            failing()
        assert blas_threads() == {3}


def test_encodes_side_by_side() -> None:
    """The second one changes nothing, whichever ends first."""
    began, ends = threading.Event(), threading.Event()

    def second() -> None:
        with one_blas_thread():
            began.set()
            assert ends.wait(10)

    with one_blas_thread():
        thread = threading.Thread(target=second)
        thread.start()
        assert began.wait(10)
        assert blas_threads() == {1}
    assert blas_threads() == {3}
    ends.set()
    thread.join()
    assert blas_threads() == {3}


def test_a_program_that_chose_keeps_its_choice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "3")
    with one_blas_thread():
        assert blas_threads() == {3}
