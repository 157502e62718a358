"""Changes streams at random and decodes them until time is up: make fuzz SECONDS=600

Each try must give a picture or an SgiError of one line, within --patience seconds and --memory bytes of address space
(0 where a sanitizer needs more). Every third try ignores the checksum inside payloads, as if a forger had made it fit.
Instruction sets take turns. Streams that end in a new way join the corpus, from which later runs start, too; the log
in --corpus has the seed of every run. Whatever else happens ends the run and leaves the stream in --out.
"""

from __future__ import annotations

import argparse
import re
import sys
import time
import warnings
import zlib
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from data_files import ATTACKS, GOLDEN
from mutate import mutated
from scenes import ISAS

from sgicodec import Device, SgiError, _native
from sgicodec.decoder.stream import CACHE_BYTES, Stream

SEEDS = (GOLDEN, ATTACKS)
LONGEST = 40_000
"""Bytes of a stream that the corpus takes."""
_VARYING = re.compile(r"chunk .|\b[0-9a-f]{2,8}\b|[0-9][0-9.,]*")
"""What differs between messages of one kind."""
SIDE = 96
"""Pixels of a side of what is rendered."""


def look(data: bytes, device: Device, checked: bool = True) -> str:
    """What came of a stream: its kind of picture, or its error without numbers. Raises whatever is no SgiError."""
    try:
        native = _native.Stream(data, device.threads, device.isa, CACHE_BYTES, checked=checked)
        with Stream(data, device=device, native=native) as stream:
            _draw(stream)
            stream.survey()
            if stream.has_overview:
                _draw(stream.overview)
            header = stream.header
            what = header.channels, header.sample_type, header.masked, header.profile, stream.grid.count > 1
            return f"picture {what} {stream.has_overview}"
    except SgiError as error:
        if "\n" in str(error):
            raise ValueError("a message of several lines") from error
        return f"{type(error).__name__}: {_VARYING.sub('#', str(error))}"


def _draw(stream: Stream) -> None:
    """A region as it is and scaled, and all of it in small."""
    region = (0, 0, min(stream.width, SIDE), min(stream.height, SIDE))
    stream.picture(region)
    stream.picture(region, size=(50, 40))
    if not np.isfinite(stream.render(region, size=(7, 130))).all():
        raise ValueError("samples without a value")
    stream.picture(size=(min(stream.width, 20), min(stream.height, 10)))


@dataclass
class Fuzzer:
    """A run. corpus: where streams are kept that ended in a new way."""

    seed: int
    corpus: Path
    patience: float
    outcomes: Counter[str] = field(default_factory=Counter)
    slowest: float = 0.0
    broken: bytes = b""

    def __post_init__(self) -> None:
        self.corpus.mkdir(parents=True, exist_ok=True)
        self.first = [path.read_bytes() for folder in SEEDS for path in sorted(folder.glob("*.sgi"))]
        self.streams = self.first + [path.read_bytes() for path in sorted(self.corpus.glob("*.sgi"))]
        self.rng = np.random.default_rng(self.seed)
        self.devices = [Device(threads, isa) for isa in ISAS for threads in (1, 3)]

    def run(self, seconds: float) -> None:
        """Until time is up. `broken` is the stream whose exception this raises."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            known = self.streams if self.rng.random() < 0.5 else self.first
            data = known[int(self.rng.integers(len(known)))]
            for _ in range(int(self.rng.geometric(0.6))):
                data = mutated(data, self.streams, self.rng)
            try:
                self._try(data)
            except BaseException:
                self.broken = data
                raise

    def _try(self, data: bytes) -> None:
        number, started = self.outcomes.total(), time.monotonic()
        forged = number % 3 == 0
        outcome = look(data, self.devices[number % len(self.devices)], not forged)
        seconds = time.monotonic() - started
        if seconds > self.patience:
            raise TimeoutError(f"{seconds:.1f} seconds")
        if not self.outcomes[outcome] and not forged:
            self._keep(data, outcome)
        self.outcomes[outcome] += 1
        self.slowest = max(self.slowest, seconds)

    def _keep(self, data: bytes, outcome: str) -> None:
        path = self.corpus / f"{zlib.crc32(outcome.encode()):08x}.sgi"
        if len(data) <= LONGEST and not path.exists():
            path.write_bytes(data)
            self.streams.append(data)


def main() -> None:
    """Runs until time is up or something is found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--seed", type=int, default=None, help="of the random numbers; else that of the clock")
    parser.add_argument("--patience", type=float, default=10.0)
    parser.add_argument("--memory", type=int, default=3 << 30)
    parser.add_argument("--corpus", type=Path, default=Path("build/fuzz"))
    parser.add_argument("--out", type=Path, default=Path("fuzz-out"))
    chosen = parser.parse_args()
    warnings.simplefilter("error")
    if chosen.memory and sys.platform.startswith("linux"):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (chosen.memory, chosen.memory))
    seed = time.time_ns() % 2**32 if chosen.seed is None else chosen.seed
    fuzzer = Fuzzer(seed, chosen.corpus, chosen.patience)
    print(f"seed {seed}, {len(fuzzer.streams)} streams to begin with", flush=True)
    end = "ended"
    try:
        fuzzer.run(chosen.seconds)
    except BaseException as error:
        chosen.out.mkdir(parents=True, exist_ok=True)
        path = chosen.out / f"found-{seed}-{fuzzer.outcomes.total()}.sgi"
        path.write_bytes(fuzzer.broken)
        end = f"{path}: {type(error).__name__}: {error}"
        raise
    finally:
        kinds = Counter(outcome.partition(":")[0].partition(" ")[0] for outcome in fuzzer.outcomes.elements())
        text = f"{fuzzer.outcomes.total()} tries, {len(fuzzer.outcomes)} ends, slowest {fuzzer.slowest:.2f} s, "
        text += f"{dict(kinds)}; {end}"
        print(text)
        with (chosen.corpus / "log.txt").open("a") as log:
            log.write(f"{time.strftime('%Y-%m-%d %H:%M')} seed {seed}, {chosen.seconds:g} s: {text}\n")


if __name__ == "__main__":
    main()
