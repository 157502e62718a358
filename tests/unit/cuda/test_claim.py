"""Processes of a machine that share its GPUs without knowing each other."""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest
from fake_cuda import fake_machine
from sanitizer import needs_plain_memory

CLAIM = "from sgicodec.cuda.claim import claimed_gpu as own; print(own(), own(), flush=True); input()"


def test_processes_spread_over_the_gpus(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each takes one that fewest have; what a killed one had is free, and numbers need not be the same GPUs."""
    needs_plain_memory()
    fake_machine(monkeypatch, tmp_path, 3)
    with ExitStack() as stack:

        def claims(seen: str | None = None) -> tuple[subprocess.Popen[str], int]:
            environment = dict(os.environ) | ({} if seen is None else {"CUDA_VISIBLE_DEVICES": seen})
            process = subprocess.Popen(
                [sys.executable, "-c", CLAIM], env=environment, stdin=-1, stdout=-1, text=True, close_fds=True
            )
            stack.enter_context(process)
            stack.callback(process.kill)
            assert process.stdout is not None
            first, again = process.stdout.readline().split()
            assert first == again
            return process, int(first)

        (_, a), (second, b), (_, c), (_, d) = (claims() for _ in range(4))
        assert (a, b, c, d) == (0, 1, 2, 0)
        second.kill()
        second.wait()
        assert claims("0,1")[1] == 1
        assert claims("2,1")[1] == 0  # the GPU 2 of the others
        assert claims("2,0,1")[1] == 2
