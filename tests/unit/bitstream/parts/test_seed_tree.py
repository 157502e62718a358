"""Trees of seeds against a decoder written from docs/format.md that visits one node at a time."""

from __future__ import annotations

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st
from page_bits import QUICK, BitModels
from reference_decoder import Bits
from symbols import Seeds, SymbolReader, SymbolWriter, write_tree

from sgicodec.errors import LimitError, UsageError

Size = tuple[int, int]
Node = tuple[int, int, int]  # level, column, row

SQUARE = 64, 64


def seeds_of(nodes: list[Node]) -> Seeds:
    table = np.array(nodes, np.int64).reshape(-1, 3)
    return (table[:, 1:] << table[:, :1]).astype(np.int32), table[:, 0].astype(np.int8)


def nodes_of(seeds: Seeds) -> list[Node]:
    return [(int(k), int(x) >> int(k), int(y) >> int(k)) for (x, y), k in zip(*seeds, strict=True)]


@st.composite
def trees(draw: st.DrawFn) -> tuple[Size, list[Node]]:
    """Seeds that crowd in places."""
    width, height = draw(st.integers(1, 300)), draw(st.integers(1, 200))
    count = draw(st.one_of(st.integers(0, 5), st.integers(0, 150)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    level = rng.integers(1, 1 + draw(st.integers(1, 6)), count)
    x = (width * rng.random(count) ** draw(st.integers(1, 3))).astype(int) >> level
    y = (height * rng.random(count) ** draw(st.integers(1, 3))).astype(int) >> level
    return (width, height), sorted(set(zip(level.tolist(), x.tolist(), y.tolist(), strict=True)))


class ReferenceDecoder:
    """docs/format.md, section "Tree", over sets of nodes."""

    def __init__(self, size: Size, payload: bytes) -> None:
        self.size, self.bits, self.models = size, Bits(payload), BitModels()
        self.split, self.seeds = set[Node](), set[Node]()

    def exists(self, node: Node) -> bool:
        level, x, y = node
        return 0 <= x << level < self.size[0] and 0 <= y << level < self.size[1]

    def flag(self, node: Node, kind: int) -> int:
        level, x, y = node
        t, c = 3 * (level - 1) + kind, (x & 1) + 2 * (y & 1)
        own, other = (self.seeds, self.split) if kind else (self.split, self.seeds)
        near = [(level, x - 1, y), (level, x, y - 1), (level, x - 1, y - 1), (level, x + 1, y - 1)]
        a, b = sum((n in own) << i for i, n in enumerate(near)), sum(n in other for n in near)
        k, i, j = parent = (level + 1, x >> 1, y >> 1)
        around = [(k, i + u, j + v) for u in (-1, 0, 1) for v in (-1, 0, 1) if u or v]
        d, e = sum(n in self.split for n in around), min(3, sum(n in self.seeds for n in around))
        f = any(n in self.split or n in self.seeds for n in self.siblings(node)[:c])
        u, v = 2 * (x & 1) - 1, 2 * (y & 1) - 1
        beside = [(k, i + u, j) in self.split, (k, i, j + v) in self.split, (k, i + u, j + v) in self.split]
        g = 8 * beside[0] + 4 * beside[1] + 2 * beside[2] + (parent in self.seeds)
        wide = [(level + 2, (x >> 2) + u, (y >> 2) + v) for u in (-1, 0, 1) for v in (-1, 0, 1)]
        h = sum(n in self.split for n in wide) if level < 6 else 0
        models = (
            64 * t + 4 * a + min(3, b),
            1152 + 144 * t + 16 * d + 4 * e + c,
            3744 + 8 * t + 4 * f + c,
            3888 + 160 * t + 10 * g + h,
            6768 + t,
        )
        return self.bits.note(self.models.bit(self.bits.bit, QUICK, *models))

    def siblings(self, node: Node) -> list[Node]:
        """All four, by child number."""
        level, x, y = node
        return [(level, x & ~1 | c & 1, y & ~1 | c >> 1) for c in range(4)]

    def visit(self, node: Node) -> None:
        level, x, y = node
        c = (x & 1) + 2 * (y & 1)
        if level > 1 and self.flag(node, 0):
            self.split.add(node)
        before, after = self.siblings(node)[:c], self.siblings(node)[c + 1 :]
        is_certain = level < 6 and node not in self.split and not any(self.exists(n) for n in after)
        is_certain &= not any(n in self.split or n in self.seeds for n in before)
        if is_certain or self.flag(node, 1 + (node in self.split)):
            self.seeds.add(node)

    def decode(self) -> list[Node]:
        width, height = self.size
        self.split = {(7, x, y) for x in range(-(-width // 128)) for y in range(-(-height // 128))}
        for level in range(6, 0, -1):
            for y in range((height - 1 >> level) + 1):
                for x in range((width - 1 >> level) + 1):
                    if (level + 1, x >> 1, y >> 1) in self.split:
                        self.visit((level, x, y))
        return sorted(self.seeds)


@settings(max_examples=examples(40))
@given(trees())
def test_the_page_reads_the_same_tree(tree: tuple[Size, list[Node]]) -> None:
    size, nodes = tree
    writer = SymbolWriter()
    write_tree(writer, size, seeds_of(nodes))
    decoder = ReferenceDecoder(size, writer.finish())
    assert decoder.decode() == nodes
    assert decoder.bits.ends_well()


@settings(max_examples=examples(80))
@given(trees())
def test_round_trip(tree: tuple[Size, list[Node]]) -> None:
    size, nodes = tree
    writer = SymbolWriter()
    write_tree(writer, size, seeds_of(nodes))
    content = writer.bits
    reader = SymbolReader(writer.finish())
    read = reader.read_tree(size, len(nodes))
    assert reader.bits == content
    reader.finish()
    assert sorted(nodes_of(read)) == nodes
    assert (read[0].dtype, read[1].dtype) == (np.int32, np.int8)


def test_more_seeds_than_allowed_are_refused() -> None:
    nodes = [(1, x, y) for x in range(32) for y in range(32)]
    writer = SymbolWriter()
    write_tree(writer, SQUARE, seeds_of(nodes))
    payload = writer.finish()
    assert len(SymbolReader(payload).read_tree(SQUARE, len(nodes))[1]) == len(nodes)
    for most in (3, 200, 1023):
        with pytest.raises(LimitError, match=f"more than {most} seeds"):
            SymbolReader(payload).read_tree(SQUARE, most)


@pytest.mark.parametrize(
    ("corner", "level", "message"),
    [((64, 0), 1, "outside"), ((1, 0), 1, "off its grid"), ((0, 0), 7, "size"), ((0, 0), 0, "size")],
)
def test_seeds_that_are_no_nodes_are_refused(corner: tuple[int, int], level: int, message: str) -> None:
    seeds = np.array([corner], np.int32), np.array([level], np.int8)
    with pytest.raises(UsageError, match=message):
        write_tree(SymbolWriter(), SQUARE, seeds)
    with pytest.raises(UsageError, match="share one node"):
        write_tree(SymbolWriter(), SQUARE, seeds_of([(2, 0, 0), (2, 0, 0)]))
