"""Makes a WebAssembly module compress better: python merge_segments.py MODULE.wasm

Joins neighbouring data segments: Binaryen leaves out runs of zeros, which cuts tables into hundreds of pieces. Leaves
out custom sections, which say what compiled it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

_CUSTOM, _DATA, _DATA_COUNT = 0, 11, 12
_MOST_ZEROS = 256
"""Between two segments that are joined."""

Segment = tuple[int, bytes]
"""Where it begins in memory, and its bytes."""


def number(data: bytes, at: int, signed: bool = False) -> tuple[int, int]:
    """An integer in LEB128, and where it ends."""
    value = shift = 0
    while True:
        byte = data[at]
        at, value, shift = at + 1, value | (byte & 127) << shift, shift + 7
        if byte < 128:
            return value - (1 << shift if signed and byte & 64 else 0), at


def coded(value: int, signed: bool = False) -> bytes:
    """An integer as LEB128."""
    out = bytearray()
    while not (value in (0, -1) and out and (not signed or (out[-1] & 64 != 0) == (value < 0))):
        out.append(value & 127 | 128)
        value >>= 7
    out[-1] &= 127
    return bytes(out)


def sections(module: bytes) -> Iterator[tuple[int, bytes]]:
    """Number and content of each."""
    at = 8
    while at < len(module):
        size, start = number(module, at + 1)
        yield module[at], module[start : start + size]
        at = start + size


def segments(body: bytes) -> list[Segment]:
    """Those of a data section. Raises ValueError for others than (i32.const PLACE), of memory 0."""
    count, at = number(body, 0)
    found = []
    for _ in range(count):
        if body[at : at + 2] != b"\0\x41":
            raise ValueError("a data segment without a constant place")
        place, at = number(body, at + 2, signed=True)
        size, start = number(body, at + 1)  # after the end of the expression
        at = start + size
        found.append((place, body[start:at]))
    return found


def merged(found: list[Segment]) -> list[Segment]:
    """The same memory in fewer segments."""
    joined: list[tuple[int, bytearray]] = []
    for place, data in sorted(found):
        gap = place - joined[-1][0] - len(joined[-1][1]) if joined else _MOST_ZEROS + 1
        if 0 <= gap <= _MOST_ZEROS:
            joined[-1][1].extend(bytes(gap) + data)
        else:
            joined.append((place, bytearray(data)))
    return [(place, bytes(data)) for place, data in joined]


def main(path: Path) -> None:
    """Rewrites the file."""
    module = path.read_bytes()
    parts = [(kind, body) for kind, body in sections(module) if kind != _CUSTOM]
    found = merged(next(segments(body) for kind, body in parts if kind == _DATA))
    data = b"".join(b"\0\x41" + coded(place, True) + b"\x0b" + coded(len(part)) + part for place, part in found)
    new = {_DATA: coded(len(found)) + data, _DATA_COUNT: coded(len(found))}
    out = bytearray(module[:8])
    for kind, body in parts:
        content = new.get(kind, body)
        out += bytes([kind]) + coded(len(content)) + content
    path.write_bytes(out)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
