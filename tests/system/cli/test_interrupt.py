"""What SIGINT does inside and outside a fit."""

from __future__ import annotations

import contextlib
import signal
import subprocess
import sys
from unittest.mock import Mock

import pytest
from children import HANGS

from sgicodec import __main__
from sgicodec.cli.interrupt import EarlyEnd


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


BUSY = """
import hashlib, sys
from sgicodec.cli.interrupt import EarlyEnd
with EarlyEnd() as early:
    early.arm()
    print("armed", flush=True)
    hashlib.pbkdf2_hmac("sha256", b"", b"", 2**31 - 1)
"""


def test_the_second_signal_ends_what_is_busy_in_native_code() -> None:
    with subprocess.Popen([sys.executable, "-c", BUSY], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout.readline() == b"armed\n"
        for _ in range(100):  # signals of one number that come at once are one
            process.send_signal(signal.SIGINT)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(0.1)
                break
        assert process.communicate(timeout=HANGS)[1] == b"sgi: interrupted\n"
    assert process.returncode == 130


def test_an_interrupt_while_the_command_line_loads(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(__main__, "require", Mock(side_effect=KeyboardInterrupt))
    with pytest.raises(SystemExit) as ended:
        __main__.main()
    assert (ended.value.code, capsys.readouterr().err) == (130, "sgi: interrupted\n")
