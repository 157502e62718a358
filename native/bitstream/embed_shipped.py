"""Writes the tables and networks that a decoder needs as C++ source: python embed_shipped.py shipped.cpp

CMake calls it when the native code is built. Models of texture are inflated here, so that the library needs no zlib.
It uses nothing but Python's own library.
"""

from __future__ import annotations

import sys
import zlib
from pathlib import Path

BITSTREAM = Path(__file__).resolve().parents[2] / "sgicodec" / "bitstream"
HEAD = """#include "bitstream/byte_planes.hpp"
#include "bitstream/shipped.hpp"

namespace sgi {

namespace {

Bytes held(const std::vector<uint8_t> &bytes) { return {bytes.data(), bytes.size()}; }
"""
_COLUMNS = 64
_OCTAL = [f"\\{byte:03o}" for byte in range(256)]


def numbered(stem: str) -> dict[int, bytes]:
    """The files parts/<stem><number>.bin by their numbers."""
    return {int(path.stem.removeprefix(stem)): path.read_bytes() for path in (BITSTREAM / "parts").glob(f"{stem}*.bin")}


def array(name: str, data: bytes) -> str:
    """The definition of an array of bytes: as text, which compilers read quickly."""
    lines = ("".join(_OCTAL[byte] for byte in data[at : at + _COLUMNS]) for at in range(0, len(data), _COLUMNS))
    return f"alignas(16) const unsigned char {name}[] =\n" + "\n".join(f'    "{line}"' for line in lines) + ";\n"


def planes(data: bytes, width: int) -> bytes:
    """The bytes of integers as joined_planes (byte_planes.hpp) takes them."""
    if width == 1:
        return data
    values = [int.from_bytes(data[at : at + width], "little", signed=width == 2) for at in range(0, len(data), width)]
    if width == 2:
        values = [2 * value if value >= 0 else -2 * value - 1 for value in values]
    return bytes(value >> 8 * byte & 255 for byte in range(width) for value in values)


def joined(name: str, held: str, width: int) -> str:
    """The function that joins an array of planes when it is first asked for."""
    return (
        f"static const std::vector<uint8_t> &{name}_joined() {{\n"
        f"  static const std::vector<uint8_t> all = joined_planes({held}, {width});\n"
        "  return all;\n}\n"
    )


def source() -> str:
    """All of shipped.cpp."""
    arrays, functions = [], []

    def add(function: str, parameter: str, blocks: dict[int, bytes], width: int = 1) -> None:
        cases, otherwise = "", "  return {};\n" if parameter else ""
        for number, data in sorted(blocks.items()):
            name = f"{function}{number}"
            arrays.append(array(name, planes(data, width)))
            condition = f"if (number == {number}) " if parameter else ""
            held = f"{{{name}, {len(data)}}}"
            if width > 1:
                functions.append(joined(name, held, width))
                held = f"held({name}_joined())"
            cases += f"  {condition}return {held};\n"
        functions.append(f"Bytes shipped_{function}({parameter}) {{\n{cases}{otherwise}}}\n")

    add("tables", "", {0: (BITSTREAM / "parts" / "tables.bin").read_bytes()}, 4)
    add("prior", "", {0: numbered("prior")[1]}, 2)
    add("texture", "", {0: zlib.decompress((BITSTREAM / "parts" / "texture.bin").read_bytes())})
    add("restoration", "int number", numbered("restoration"))
    return "\n".join([HEAD, *arrays, "}  // namespace\n", *functions, "}  // namespace sgi\n"])


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(source(), "ascii")
