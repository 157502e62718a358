"""Writes texture in any spelling, legal or not: the reader of docs/format.md asks for bits, and is given them."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
from reference_decoder import Bits
from symbols import SymbolWriter
from texture_reader import TextureReader


class _Script(Bits):
    """Gives bits as they are wanted, then zeros, and notes their probabilities."""

    def __init__(self, bits: str, has_contrast: bool, models: int) -> None:
        self.wanted, self.models = [int(bit) for bit in bits], models
        self.bits: list[int] = []
        self.ones: list[int] = []
        self.fields: list[tuple[int, int]] = []
        self.flags = iter([1, int(has_contrast), 0])  # there is texture; whether it has contrasts; cells lap over
        self.noted: list[int] = []

    def bit(self, one: int) -> int:
        self.bits.append(self.wanted.pop(0) if self.wanted else 0)
        self.ones.append(one)
        return self.bits[-1]

    def raw(self, n_bits: int) -> int:
        value = next(self.flags) if n_bits == 1 else self.models if len(self.fields) == 1 else 0
        self.fields.append((value, n_bits))
        return value

    def note(self, value: int) -> int:
        self.noted.append(value)
        return value


def spell(
    writer: SymbolWriter,
    bits: str,
    size: tuple[int, int] = (32, 32),
    channels: int = 1,
    has_contrast: bool = False,
    models: int = 2,
) -> None:
    """Writes the texture part of a tile that has these bits, then zeros, up to where the reader takes no more."""
    script = _Script(bits, has_contrast, models)
    with suppress(AssertionError):
        TextureReader(script, size, channels).read()
    for value, n_bits in script.fields:
        writer.code_int(value, n_bits)
    writer.flags(*(np.array(part, np.int32) for part in (script.bits, script.ones, script.noted)))


def spelled(bits: str, has_contrast: bool = False, models: int = 2) -> bytes:
    """The payload of nothing else, for a tile of 32×32 pixels of one channel."""
    writer = SymbolWriter()
    spell(writer, bits, has_contrast=has_contrast, models=models)
    return writer.finish()
