"""Writes the tables and networks that a decoder needs as C++ source: python embed_shipped.py shipped.cpp

CMake calls it when the native code is built. Models of texture are inflated here, so that the library needs no zlib.
It uses nothing but Python's own library.
"""

from __future__ import annotations

import sys
import zlib
from pathlib import Path

BITSTREAM = Path(__file__).resolve().parents[2] / "sgicodec" / "bitstream"
_COLUMNS = 64
_OCTAL = [f"\\{byte:03o}" for byte in range(256)]


def numbered(stem: str) -> dict[int, bytes]:
    """The files parts/<stem><number>.bin by their numbers."""
    return {int(path.stem.removeprefix(stem)): path.read_bytes() for path in (BITSTREAM / "parts").glob(f"{stem}*.bin")}


def array(name: str, data: bytes) -> str:
    """The definition of an array of bytes: as text, which compilers read quickly."""
    lines = ("".join(_OCTAL[byte] for byte in data[at : at + _COLUMNS]) for at in range(0, len(data), _COLUMNS))
    return f"alignas(16) const unsigned char {name}[] =\n" + "\n".join(f'    "{line}"' for line in lines) + ";\n"


def source() -> str:
    """All of shipped.cpp."""
    arrays, functions = [], []

    def add(function: str, parameter: str, blocks: dict[int, bytes]) -> None:
        cases, otherwise = "", "  return {};\n" if parameter else ""
        for number, data in sorted(blocks.items()):
            arrays.append(array(f"{function}{number}", data))
            condition = f"if (number == {number}) " if parameter else ""
            cases += f"  {condition}return {{{function}{number}, {len(data)}}};\n"
        functions.append(f"Bytes shipped_{function}({parameter}) {{\n{cases}{otherwise}}}\n")

    add("tables", "", {0: (BITSTREAM / "entropy" / "tables.bin").read_bytes()})
    add("positions", "", {0: numbered("positions")[1]})
    add("prior", "int number", numbered("prior"))
    add("texture", "int number", {number: zlib.decompress(data) for number, data in numbered("texture").items()})
    head = '#include "bitstream/shipped.hpp"\n\nnamespace sgi {\n\nnamespace {\n\n'
    return head + "\n".join(arrays) + "\n}  // namespace\n\n" + "\n".join(functions) + "\n}  // namespace sgi\n"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(source(), "ascii")
