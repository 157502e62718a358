"""What SIGINT does inside and outside a fit."""

from __future__ import annotations

import signal

import pytest

from sgicodec.cli.interrupt import EarlyEnd


def test_first_signal_asks_second_interrupts() -> None:
    with EarlyEnd() as early:
        early.arm()
        early.arm()
        assert not early.asked
        signal.raise_signal(signal.SIGINT)
        assert early.asked
        early.arm()
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_nothing_changes_before_arming() -> None:
    with EarlyEnd() as early, pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
    assert not early.asked


def test_handler_is_restored_after_an_error() -> None:
    early = EarlyEnd()
    early.arm()
    with pytest.raises(OSError, match="failed"), early:
        raise OSError("failed")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_ignored_signal_stays_ignored() -> None:
    old = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with EarlyEnd() as early:
            early.arm()
            signal.raise_signal(signal.SIGINT)
            assert not early.asked
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, old)
