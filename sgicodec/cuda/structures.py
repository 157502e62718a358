"""The arguments of kernels as ctypes have them, read from the header that states them (cuda/arguments.hpp)."""

from __future__ import annotations

import ctypes
import re
from functools import cache
from typing import Any

from sgicodec.cuda import sources

_TYPES: dict[str, Any] = {
    "int32_t": ctypes.c_int32,
    "uint32_t": ctypes.c_uint32,
    "int64_t": ctypes.c_int64,
    "float": ctypes.c_float,
    "double": ctypes.c_double,
}
_STRUCT = re.compile(r"^struct (\w+) \{\n(.*?)^\};", re.MULTILINE | re.DOTALL)
_FIELD = re.compile(r"^  (?:const )?(\w+) (\*?)(\w+)(?:\[(\d+)\])?;$")


@cache
def structures() -> dict[str, type[ctypes.Structure]]:
    """Every struct of the header, by name."""
    text = (sources.root() / "cuda" / "arguments.hpp").read_text("utf-8")
    return {name: type(name, (ctypes.Structure,), {"_fields_": _fields(body)}) for name, body in _STRUCT.findall(text)}


def _fields(body: str) -> list[tuple[str, Any]]:
    fields = []
    for line in body.splitlines():
        found = _FIELD.match(line)
        if found is None:
            raise ValueError(f"no field of a kernel's arguments: {line}")
        kind, pointer, name, count = found.groups()
        one = ctypes.c_void_p if pointer else _TYPES[kind]
        fields.append((name, one * int(count) if count else one))
    return fields
