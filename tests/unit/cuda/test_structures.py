"""What Python passes to kernels lies in memory as C++ has it."""

from __future__ import annotations

import ctypes
import re

import pytest
from fake_cuda import fake_driver

from sgicodec.cuda import sources
from sgicodec.cuda.structures import structures

NAMES = (
    *("RasterArguments", "SampleArguments", "TextureArguments", "ScanArguments"),
    *("FitArguments", "StepNumbers", "StepReport", "AdamArguments"),
    *("EnergyArguments", "RowArguments", "ResidualArguments"),
    *("ProductArguments", "SumArguments", "FeatureArguments"),
)


def test_every_struct_is_read() -> None:
    assert set(structures()) == set(NAMES)
    text = (sources.root() / "cuda" / "arguments.hpp").read_text("utf-8")
    assert sum(len(struct._fields_) for struct in structures().values()) == len(
        re.findall(r"^  .*;$", text, re.MULTILINE)
    )


@pytest.mark.parametrize("name", NAMES)
def test_sizes_are_those_of_the_compiler(name: str) -> None:
    size = fake_driver().sgi_fake_size
    assert ctypes.sizeof(structures()[name]) == size(name.encode())


def test_where_fields_lie_is_what_the_compiler_says() -> None:
    """Of one field behind all kinds: pointers, floats, arrays."""
    offset = fake_driver().sgi_fake_offset
    for number, (struct, field) in enumerate(
        (("AdamArguments", "pairs"), ("FitArguments", "report"), ("StepNumbers", "rate"))
    ):
        assert getattr(structures()[struct], field).offset == offset(number)
