"""Gives hostile streams to libsgi under AddressSanitizer and UBSan: python tests/support/fuzz_library.py --seconds 60

Builds the static library and fuzz_library.cpp with checks that end the process. The golden streams come first, then
streams that are changed where their structure is, a batch in a process. One that ends it is kept in build/fuzz-library.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from data_files import ATTACKS, GOLDEN_STREAMS
from library import ROOT, installed
from mutate import mutated

KEPT = ROOT / "build" / "fuzz-library"
HERE = Path(__file__).resolve().parent
CHECKS = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-fno-omit-frame-pointer", "-g1", "-O1"]
OPTIONS = {
    "ASAN_OPTIONS": "allocator_may_return_null=1:max_allocation_size_mb=4096",
    "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
}
BATCH = 40


def driver() -> Path:
    """The program, compiled anew where it or the library changed."""
    prefix = installed("asan-library", SGI_SANITIZE="ON", BUILD_SHARED_LIBS="OFF", CMAKE_BUILD_TYPE="None")
    program, source = prefix.parent / "fuzz_library", HERE / "fuzz_library.cpp"
    library = prefix / "lib" / "libsgi.a"
    flags = ["-std=c++17", "-Wall", "-Wextra", "-DWITH_MAIN", f"-I{prefix / 'include'}"]
    subprocess.run(["c++", *flags, *CHECKS, source, library, "-pthread", "-o", program], check=True)
    return program


def fails(program: Path, streams: list[Path], patience: float) -> str | None:
    """What is wrong with these streams, or nothing."""
    try:
        done = subprocess.run(
            [program, *streams], capture_output=True, text=True, env=os.environ | OPTIONS, timeout=patience
        )
    except subprocess.TimeoutExpired:
        return f"no end after {patience:g} s"
    return f"status {done.returncode}\n{done.stderr[-6000:]}" if done.returncode else None


def run(program: Path, streams: list[Path], patience: float) -> None:
    """Raises SystemExit with the first stream that is handled wrongly, which is kept."""
    if fails(program, streams, patience * len(streams)) is None:
        return
    for stream in streams:
        failure = fails(program, [stream], patience)
        if failure is not None:
            KEPT.mkdir(parents=True, exist_ok=True)
            raise SystemExit(f"{shutil.copy(stream, KEPT)}: {failure}")
    raise SystemExit("a batch failed, but none of its streams did")


def main() -> None:
    """Until the time is over, or something is found."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=None, help="of the changes; by default another one each time")
    parser.add_argument("--patience", type=float, default=100, help="seconds for a stream")
    options = parser.parse_args()
    seed = int(np.random.SeedSequence().generate_state(1)[0]) if options.seed is None else options.seed
    rng, program = np.random.default_rng(seed), driver()
    golden = [*GOLDEN_STREAMS, *sorted(ATTACKS.glob("*.sgi"))]
    run(program, golden, options.patience)
    data, tries, end = [path.read_bytes() for path in golden], 0, time.monotonic() + options.seconds
    with tempfile.TemporaryDirectory() as folder:
        while time.monotonic() < end:
            batch = [Path(folder) / f"{seed}-{tries + i}.sgi" for i in range(BATCH)]
            for path in batch:
                path.write_bytes(mutated(data[int(rng.integers(len(data)))], data, rng))
            run(program, batch, options.patience)
            tries += BATCH
    print(f"libsgi: {len(golden)} streams and {tries} changed ones (seed {seed}): nothing found")


if __name__ == "__main__":
    main()
