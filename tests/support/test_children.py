"""The check that tests leave no process behind."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from children import children, end_children


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="no other system lists a process's children in files")
def test_a_child_is_seen_named_and_ended() -> None:
    with subprocess.Popen([sys.executable, "-c", "input('left behind')"], stdin=subprocess.PIPE) as child:
        assert child.pid in children()
        assert list(end_children()) == [child.pid]
        assert child.pid not in children()
    assert child.returncode in (0, -signal.SIGKILL)  # 0: its status was read already


def test_a_test_can_be_interrupted() -> None:
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())
