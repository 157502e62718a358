"""A reader of texture that was written from docs/format.md, "Texture", and shares no code with the package."""

from __future__ import annotations

import math
import zlib
from importlib.resources import files
from typing import NamedTuple

from reference_decoder import Bits

CONTEXTS = 60812 + 50688
AFTER = [(0, 1), (3, 2), (5, 4), (6, 7), (1, 0), (2, 3), (4, 5), (7, 6)]
"""The state after an even and an odd symbol."""
LOGISTIC = [min(max(round(65536 / (1 + math.exp(-x / 256))), 16), 65519) for x in range(-3072, 3072)]


class Cell(NamedTuple):
    """A node of the quadtree."""

    x: int
    y: int
    side: int


class TextureReader:
    """Section "Texture". After `read`: steps, None where there is no texture, leaves, contrasts by root, and symbols
    [v][u] by channel and leaf. size: of the tile, and after `read` of the layer.
    """

    def __init__(self, bits: Bits, size: tuple[int, int], channels: int) -> None:
        self.number = 0
        self.bits, self.size, self.channels = bits, size, channels
        self.steps: dict[str, list[int]] | None = None
        self.leaves: list[Cell] = []
        self.leaf_at: dict[tuple[int, int], Cell] = {}  # by pixel // 8
        self.contrast: dict[tuple[int, int], int] = {}
        self.last_contrast = 0
        self.symbols: dict[tuple[int, Cell], list[list[int]]] = {}
        self.extent: dict[tuple[int, Cell], int] = {}

    def read(self) -> None:
        """Reads the part."""
        if not self.bits.raw(1):
            return
        self.number = self.bits.raw(4)
        self.begin()
        widths = {
            "step": (9, 1),
            "ratios": (5, self.channels - 1),
            "slopes": (5, 2),
            "excess": (4, 3),
            "contrasts": (1, 1),
            "separate": (1, 1),
        }
        self.steps = self.fields(widths)
        if self.steps["separate"] == [1]:
            self.steps |= self.fields({"before": (3, 2)})
            left, top = self.steps["before"]
            self.size = self.size[0] + left, self.size[1] + top
        if self.number == 3:
            assert self.channels >= 3
            self.steps |= self.fields({"shares": (6, 2), "turn": (4, 1)})
        assert (self.steps.get("shares"), self.steps.get("turn")) != ([32, 32], [8])
        for y in range(0, self.size[1], 32):
            for x in range(0, self.size[0], 32):
                self.node(Cell(x, y, 32))
        assert self.leaves

    def fields(self, widths: dict[str, tuple[int, int]]) -> dict[str, list[int]]:
        """Raw values by name, of so many bits and so many of them."""
        return {name: [self.bits.raw(n) for _ in range(count)] for name, (n, count) in widths.items()}

    def begin(self) -> None:
        """Section "Start"."""
        state = zlib.decompress(files("sgicodec.bitstream.parts").joinpath("texture.bin").read_bytes())
        assert len(state) == CONTEXTS
        self.logit = [4096 * (byte - 256 * (byte >> 7)) for byte in state]

    def adaptive(self, contexts: list[int], rate: int, further: int = 0) -> int:
        """A bit; `further` is added to all numbers."""
        contexts = [context + further for context in contexts]
        total = _wrapped(sum(self.logit[context] for context in contexts))
        one = LOGISTIC[min(max(total >> 8, -3072), 3071) + 3072]
        bit = self.bits.bit(one)
        for context in contexts:
            self.logit[context] = _wrapped(self.logit[context] + ((65536 * bit - one + (1 << rate - 1)) >> rate))
        return bit

    def even(self) -> int:
        return self.bits.bit(32768)

    def neighbours(self, cell: Cell) -> tuple[Cell | None, Cell | None]:
        x, y, half = cell.x, cell.y, cell.side // 2
        return self.leaf_at.get(((x - 1) // 8, (y + half) // 8)), self.leaf_at.get(((x + half) // 8, (y - 1) // 8))

    def node(self, cell: Cell) -> None:
        state = [leaf.side.bit_length() - 1 if leaf else 0 for leaf in self.neighbours(cell)]
        left, upper = 6 if cell.x == 0 else state[0], 6 if cell.y == 0 else state[1]
        z = cell.side.bit_length() - 4

        def flag(t: int) -> int:
            first = 60480 + 50 * t
            return self.adaptive([first + 7 * left + upper, first + 49], 4)

        what = flag(z)
        if what and cell.side > 8:
            what += flag(3 + z)
        self.bits.note(what)
        assert self.steps is not None
        if what and cell.side == 32 and self.steps["contrasts"] == [1]:
            self.read_contrast(cell)
        if what == 2:
            before, half = len(self.leaves), cell.side // 2
            for number in range(4):
                child = Cell(cell.x + (number & 1) * half, cell.y + (number >> 1) * half, half)
                if child.x < self.size[0] and child.y < self.size[1]:
                    self.node(child)
            assert len(self.leaves) > before
        elif what:
            self.leaf(cell)

    def read_contrast(self, root: Cell) -> None:
        def flag(number: int) -> int:
            return self.adaptive([60780 + number], 4)

        difference = 0
        if flag(0):
            sign, difference = flag(1), 1
            while difference < 30 and flag(1 + difference):
                difference += 1
            difference = -difference if sign else difference
        self.last_contrast += self.bits.note(difference)
        assert abs(self.last_contrast) <= 15
        self.contrast[root.x, root.y] = self.last_contrast

    def leaf(self, cell: Cell) -> None:
        self.leaves.append(cell)
        for j in range(cell.side // 8):
            for i in range(cell.side // 8):
                self.leaf_at[cell.x // 8 + i, cell.y // 8 + j] = cell
        for channel in range(self.channels):
            self.block(cell, channel)
        assert any(self.extent[channel, cell] for channel in range(self.channels))

    def reach(self, channel: int, leaf: Cell | None) -> int:
        extent = self.extent[channel, leaf] if leaf else 0
        return 1 + 15 * (extent - 1) // (2 * leaf.side - 2) if leaf and extent else 0

    def read_extent(self, cell: Cell, channel: int) -> int:
        left, upper = (self.reach(channel, leaf) for leaf in self.neighbours(cell))
        if cell.x == 0:
            left = upper
        if cell.y == 0:
            upper = left
        around = min(7, (left + upper + 3) // 4)
        beside = abs(left - upper) // 2 if channel == 0 else (self.reach(channel - 1, cell) + 1) // 2
        kind, node = 3 * min(channel, 2) + cell.side.bit_length() - 4, 1
        contexts = [64 * around, 512 + 64 * min(7, beside), 1024]
        for _ in range(cell.side.bit_length()):
            bit = self.adaptive([50688 + 1088 * kind + context + node for context in contexts], 4)
            node = 2 * node + bit
        return self.bits.note(node - 2 * cell.side)

    def block(self, cell: Cell, channel: int) -> None:
        side = cell.side
        q = self.symbols[channel, cell] = [[0] * side for _ in range(side)]
        extent = self.extent[channel, cell] = self.read_extent(cell, channel)
        state = 0
        for diagonal in range(extent):
            for u in range(max(0, diagonal - side + 1), min(diagonal, side - 1) + 1):
                v = diagonal - u
                q[v][u] = self.symbol(self.contexts(cell, channel, extent, v, u), state % 2)
                state = AFTER[state][q[v][u] % 2]
        if extent:
            assert any(q[extent - 1 - u][u] for u in range(side) if 0 <= extent - 1 - u < side)

    def symbol(self, contexts: list[int], odd: int) -> int:
        magnitude = 0
        while magnitude < 8 and self.adaptive(contexts, 6, 60812 * odd + magnitude):
            magnitude += 1
        if magnitude == 8:
            digits = 0
            while self.even():
                digits += 1
            assert digits <= 13
            rest = 1
            for _ in range(digits):
                rest = 2 * rest + self.even()
            magnitude += rest - 1
        return self.bits.note(-magnitude if magnitude and self.even() else magnitude)

    def contexts(self, cell: Cell, channel: int, extent: int, v: int, u: int) -> list[int]:
        q, n = self.symbols[channel, cell], cell.side
        h, z = min(channel, 2), n.bit_length() - 4
        left, upper = (self.shown(leaf, channel, n, v, u) for leaf in self.neighbours(cell))
        left, upper = upper if cell.x == 0 else left, left if cell.y == 0 else upper
        outside = min(2**14, left + upper)
        following = magnitude(q, v, u - 1) + magnitude(q, v - 1, u)
        inside = 4 * following
        for dv, du in ((-1, -1), (0, -2), (-2, 0), (1, -1), (-2, 1), (1, -2)):
            inside += 2 * magnitude(q, v + dv, u + du)
        total = 3 * inside + 2 * outside
        if channel:
            before = cross(self.symbols[0, cell], v, u, False)
            before += cross(self.symbols[channel - 1, cell], v, u, False) if channel > 1 else 0
            total = 3 * (total + 2 * min(2**14, before)) // 4
        zone = min(15, 8 * (u + v) // n)
        end, ahead = min(15, 8 * (extent - 1) // n), (extent - 1 - u - v).bit_length()
        place = {8: 8 * v + u, 16: 64 + 16 * v + u, 32: 320 + 16 * (v // 2) + u // 2}[n]
        return [
            8 * (576 * h + place),
            13824 + 8 * (256 * h + 16 * level(outside) + level(inside)),
            19968 + 8 * (512 * h + 32 * end + 8 * min(3, following) + ahead),
            32256 + 8 * (256 * (3 * h + z) + 16 * level(total) + zone),
        ]

    def shown(self, leaf: Cell | None, channel: int, n: int, v: int, u: int) -> int:
        if leaf is None:
            return 0
        q, other = self.symbols[channel, leaf], leaf.side
        if other == n:
            return cross(q, v, u, True)
        if other < n:
            return 8 * abs(q[v * other // n][u * other // n])
        k = other // n
        return 8 * sum(abs(q[k * v + i][k * u + j]) for i in range(k) for j in range(k)) // k**2


def _wrapped(number: int) -> int:
    """Modulo 2^22, as a signed number."""
    return (number + 2**21) % 2**22 - 2**21


def magnitude(q: list[list[int]], v: int, u: int) -> int:
    return abs(q[v][u]) if 0 <= v < len(q) and 0 <= u < len(q) else 0


def cross(q: list[list[int]], v: int, u: int, edge: bool) -> int:
    left = magnitude(q, v, 0 if edge and u == 0 else u - 1)
    upper = magnitude(q, 0 if edge and v == 0 else v - 1, u)
    return 4 * magnitude(q, v, u) + left + upper + magnitude(q, v, u + 1) + magnitude(q, v + 1, u)


def level(total: int) -> int:
    digits = total.bit_length()
    return total // 2 if total < 8 else min(15, 2 * digits - 4 + (total >> digits - 2 & 1))
