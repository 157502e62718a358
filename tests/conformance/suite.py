"""The conformance suite: which samples every decoder gives for the golden streams, bit for bit.

    python tests/conformance/suite.py 'mydecoder {stream} {out} {x} {y} {width} {height} {columns} {rows} {type}'

runs a decoder for each case of golden/samples.json and compares the SHA-256 of what it wrote to {out}: the samples of
the region (x, y, width, height) of the picture rendered to columns × rows pixels, row by row, channels interleaved, as
little-endian numbers of {type} u8, u16 or f32, rounded to nearest, never from the overview. Options: `--streams TEXT`
for those whose names hold TEXT alone; `--make`, with a decoder that is trusted, writes samples.json anew.
docs/conformance.md describes it for other decoders. It needs nothing but Python.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

GOLDEN = Path(__file__).resolve().parent / "golden"
SAMPLES = GOLDEN / "samples.json"
TYPES = {"uint8": "u8", "uint16": "u16", "float32": "f32"}


class Case(NamedTuple):
    """A region in pixels of the picture, the size in which it is rendered, and the type of its samples."""

    stream: str
    x: int
    y: int
    width: int
    height: int
    columns: int
    rows: int
    type: str

    @property
    def key(self) -> str:
        """Such as "0,0,192,128 71x47 u8": the case within its stream's entry of samples.json."""
        return f"{self.x},{self.y},{self.width},{self.height} {self.columns}x{self.rows} {self.type}"


def cases(stream: str, width: int, height: int, own_type: str) -> Iterator[Case]:
    """The whole picture in all types, reduced, much reduced and enlarged; a region as it is, enlarged and reduced."""
    whole = (0, 0, width, height)
    left, top = width // 3, height // 4
    part = (left, top, max(1, width // 2), max(1, height // 3))

    def case(region: tuple[int, int, int, int], scale: float, kind: str) -> Case:
        columns, rows = (max(1, int(side * scale + 0.5)) for side in region[2:])
        return Case(stream, *region, columns, rows, kind)

    for kind in ("u8", "u16", "f32"):
        yield case(whole, 1, kind)
    for scale in (0.37, 1 / 16, 2.5):
        yield case(whole, scale, "f32")
    for region, scale in ((whole, 0.7), (part, 1), (part, 3), (part, 0.5)):
        yield case(region, scale, own_type)


def all_cases() -> dict[str, list[Case]]:
    """The cases of every golden stream."""
    manifest = json.loads((GOLDEN / "manifest.json").read_text())
    return {
        name: list(dict.fromkeys(cases(name, *entry["picture"][:2], TYPES[entry["sample_type"]])))
        for name, entry in sorted(manifest.items())
    }


def expected() -> dict[str, dict[str, str]]:
    """The SHA-256 of the samples of each case, by stream and key."""
    found: dict[str, dict[str, str]] = json.loads(SAMPLES.read_text())
    return found


def failures(decode: Callable[[Case], bytes], streams: str = "") -> Iterator[tuple[Case, str]]:
    """The cases for which a decoder gives other samples, or none, with what it gave."""
    known = expected()
    for name, found in all_cases().items():
        for case in found if streams in name else ():
            try:
                digest = hashlib.sha256(decode(case)).hexdigest()
            except (OSError, subprocess.SubprocessError) as error:
                yield case, str(error)
                continue
            if digest != known[name].get(case.key):
                yield case, digest


def by_command(template: str, out: Path) -> Callable[[Case], bytes]:
    """A decoder that is a command."""
    words = shlex.split(template)

    def decode(case: Case) -> bytes:
        given = case._asdict() | {"stream": str(GOLDEN / f"{case.stream}.sgi"), "out": str(out)}
        out.unlink(missing_ok=True)
        subprocess.run([word.format(**given) for word in words], check=True)
        return out.read_bytes()

    return decode


def main() -> int:
    """0 if all cases are as they must be, else 1."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("command", help="the decoder, with {stream}, {out} and the fields of a case")
    parser.add_argument("--streams", default="", metavar="TEXT", help="those whose names hold TEXT")
    parser.add_argument("--make", action="store_true", help="write samples.json anew")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        decode = by_command(given.command, Path(folder) / "samples")
        if given.make:
            made = {
                name: {case.key: hashlib.sha256(decode(case)).hexdigest() for case in found}
                for name, found in all_cases().items()
            }
            SAMPLES.write_text(json.dumps(made, indent=1, sort_keys=True) + "\n")
            return 0
        failed = 0
        for case, found in failures(decode, given.streams):
            failed += 1
            print(f"{case.stream}: {case.key}: {found}")
    chosen = [cases_of for name, cases_of in all_cases().items() if given.streams in name]
    print(f"{sum(map(len, chosen))} cases of {len(chosen)} streams, {failed} differ")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
