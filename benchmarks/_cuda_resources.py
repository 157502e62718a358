"""What the kernels take of a GPU's multiprocessor, as NVIDIA's assembler tells it, without any GPU."""

from __future__ import annotations

import re
from typing import NamedTuple

from sgicodec.cuda.compiler import Compiler

ARCHITECTURES = (75, 80, 86, 89, 90, 100, 120)
"""Of all families that NVRTC 13 knows, the first; later members of a family run what is compiled for it."""


class Resources(NamedTuple):
    """registers: of a thread; shared: bytes of a block; spilled: bytes of a thread that found no register."""

    registers: int
    shared: int
    spilled: int


_PATTERNS = (r"Used (\d+) registers", r"(\d+) bytes smem", r"(\d+) bytes spill stores")


def resources(compiler: Compiler, architecture: int) -> dict[str, Resources]:
    """What a thread or block of each kernel takes on an architecture."""
    log = compiler.compile(f"sm_{architecture}", "ProgramLog", "--ptxas-options=-v").decode()
    found = {}
    for name, text in re.findall(r"entry function '(\w+)'(.*?Used.*?)$", log, re.MULTILINE | re.DOTALL):
        numbers = (re.search(pattern, text) for pattern in _PATTERNS)
        found[name] = Resources(*(int(number[1]) if number else 0 for number in numbers))
    return found
