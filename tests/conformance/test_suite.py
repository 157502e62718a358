"""The conformance suite on every instruction set of this machine, and its runner."""

from __future__ import annotations

import subprocess
import sys

import pytest
from scenes import ISAS

from sgicodec.device import Device
from tests.conformance import suite
from tests.conformance.golden.add_golden import samples


@pytest.mark.parametrize("isa", ISAS)
def test_every_sample(isa: str) -> None:
    assert list(suite.failures(lambda case: samples(case, Device(2, isa)))) == []
    assert set(suite.expected()) == set(suite.all_cases())


def test_the_runner_says_which_cases_differ() -> None:
    write = 'import sys; open(sys.argv[1], "wb").write(bytes(7))'
    command = f"'{sys.executable}' -c '{write}' {{out}}"
    ran = subprocess.run(
        [sys.executable, suite.__file__, command, "--streams", "gray16-texture"], capture_output=True, text=True
    )
    assert ran.returncode == 1
    lines = ran.stdout.splitlines()
    assert lines[0].startswith("gray16-texture: 0,0,109,75 109x75 u8: ")
    assert lines[-1] == "10 cases of 1 streams, 10 differ"
    assert len(lines) == 11


def test_the_runner_says_that_a_decoder_failed() -> None:
    ran = subprocess.run(
        [sys.executable, suite.__file__, f"'{sys.executable}' -c raise", "--streams", "one-pixel"],
        capture_output=True,
        text=True,
    )
    assert ran.returncode == 1
    assert "returned non-zero exit status 1" in ran.stdout
