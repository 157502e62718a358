"""The sgi codec's runner, driven by a stand-in for the command line, and the memory of all processes of a command."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sgicodec.bench.peak import family, together
from sgicodec.bench.sgi import SgiCodec
from sgicodec.errors import SgiError

pytest.importorskip("PIL")

# Notes its arguments, and "codes" a picture as its own PNG.
STAND_IN = """
import json, pathlib, shutil, sys
here = pathlib.Path(sys.argv[0])
with here.with_suffix(".log").open("a") as log:
    log.write(json.dumps(sys.argv[1:]) + "\\n")
verb, source, target, *options = sys.argv[1:]
if options[:2] == ["-q", "13"]:
    print("Traceback ...\\nUnlucky: 13 is not a quality\\n", file=sys.stderr)
    sys.exit(2)
held = bytearray(300 << 20 if verb == "decode" and here.stem == "big" else 0)
held[::4096] = b"x" * len(held[::4096])
print("chatter")
shutil.copy(source, target)
"""


def stand_in(folder: Path, name: str = "fake") -> tuple[str, ...]:
    script = folder / f"{name}.py"
    script.write_text(STAND_IN)
    return (sys.executable, str(script))


def picture() -> np.ndarray:
    return np.random.default_rng(0).integers(0, 256, (9, 14, 3), np.uint8)


def test_commands_get_the_files_and_settings(tmp_path: Path) -> None:
    codec = SgiCodec(effort=3, threads=2, command=stand_in(tmp_path))
    trip = codec.round_trip(picture(), 35)
    assert np.array_equal(trip.pixels, picture())
    assert trip.data.startswith(b"\x89PNG")
    assert trip.encode_seconds > 0
    assert trip.decode_seconds > 0
    encode, decode = (json.loads(line) for line in (tmp_path / "fake.log").read_text().splitlines())
    assert encode[0] == "encode"
    assert encode[2].endswith(".sgi")
    assert encode[3:] == ["-q", "35", "-f", "--quiet", "--no-verify", "--threads", "2", "-e", "3"]
    assert decode == ["decode", encode[2], decode[2], "-f"]
    assert not Path(encode[1]).exists()


def test_a_failing_command_passes_on_its_last_line(tmp_path: Path) -> None:
    with pytest.raises(SgiError, match=r"failed: Unlucky: 13 is not a quality$"):
        SgiCodec(command=stand_in(tmp_path)).round_trip(picture(), 13)


@pytest.mark.skipif(sys.platform == "win32", reason="the system does not tell a child's peak memory")
def test_peak_memory_is_the_command_s_and_not_the_benchmark_s(tmp_path: Path) -> None:
    ballast = np.ones(300 << 17)  # 300 MiB held here
    small = SgiCodec(command=stand_in(tmp_path, "small")).round_trip(picture(), 50).peak_mib
    big = SgiCodec(command=stand_in(tmp_path, "big")).round_trip(picture(), 50).peak_mib
    assert ballast.nbytes == 300 << 20
    assert 0 < small < 150
    assert 300 < big < 500


def test_a_size_is_a_target_of_the_command(tmp_path: Path) -> None:
    SgiCodec(command=stand_in(tmp_path)).trip(picture(), ("--size", "1234"))
    encode = json.loads((tmp_path / "fake.log").read_text().splitlines()[0])
    assert encode[3:5] == ["--size", "1234"]
    assert "-q" not in encode


HOLD = "held = bytearray(100 << 20); held[::4096] = b'x' * len(held[::4096]); print('held', flush=True); input()"
PARENT = f"""
import subprocess, sys
for _ in range(int(sys.argv[1])):
    child = subprocess.Popen([sys.executable, "-c", {HOLD!r}], stdout=subprocess.PIPE)
    child.stdout.readline()
print("ready", flush=True)
input()
"""


@pytest.mark.skipif(sys.platform != "linux", reason="no other system tells what processes share")
@pytest.mark.parametrize("children", [0, 1, 2])
def test_processes_are_added_up(children: int) -> None:
    command = [sys.executable, "-c", PARENT, str(children)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as parent:
        parent.stdout.readline()
        assert len(list(family(parent.pid))) == 1 + children
        held = together(parent.pid)
        parent.communicate(b"\n\n\n")
    assert 100 * children <= held <= 140 * children
