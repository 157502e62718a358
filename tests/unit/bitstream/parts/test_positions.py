"""Positions against a decoder written from docs/format.md that visits one node at a time."""

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st

from sgicodec._native import SymbolReader
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.entropy.tables import TOTAL
from sgicodec.bitstream.parts.positions import ONES, write_positions
from sgicodec.bitstream.parts.seed_tree import Seeds, TreeShape
from sgicodec.errors import CorruptStreamError, LimitError, UsageError

Node = tuple[int, int, int]  # level, column, row


def seeds_of(nodes: list[Node]) -> Seeds:
    table = np.array(nodes, np.int64).reshape(-1, 3)
    return (table[:, 1:] << table[:, :1]).astype(np.int32), table[:, 0].astype(np.int8)


def nodes_of(seeds: Seeds) -> list[Node]:
    return [(int(k), int(x) >> k, int(y) >> k) for (x, y), k in zip(*seeds, strict=True)]


@st.composite
def trees(draw: st.DrawFn) -> tuple[TreeShape, list[Node]]:
    low = draw(st.integers(0, 3))
    shape = TreeShape(draw(st.integers(1, 70)), draw(st.integers(1, 50)), low + draw(st.integers(0, 4)), low)
    count = draw(st.one_of(st.integers(0, 5), st.integers(0, 120)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    level = rng.integers(shape.min_log, shape.root_log + 1, count)
    x, y = rng.integers(0, shape.width, count) >> level, rng.integers(0, shape.height, count) >> level
    return shape, sorted(set(zip(level.tolist(), x.tolist(), y.tolist(), strict=True)))


def read_seeds(reader: SymbolReader, shape: TreeShape, most: int) -> Seeds:
    return reader.read_positions((shape.width, shape.height), shape.root_log, shape.min_log, most)


def payload_of(shape: TreeShape, nodes: list[Node]) -> bytes:
    writer = SymbolWriter()
    write_positions(writer, shape, seeds_of(nodes))
    return writer.finish()


def walk_order(nodes: list[Node]) -> list[Node]:
    """Depth first, a node before its children, children in the order (0,0), (1,0), (0,1), (1,1)."""

    def path(node: Node) -> tuple[list[int], int]:
        level, x, y = node
        corner = (x << level, y << level)
        return [(corner[1] >> i & 1) * 2 + (corner[0] >> i & 1) for i in range(20, -1, -1)], -level

    return sorted(nodes, key=path)


@settings(max_examples=examples(150))
@given(trees())
def test_round_trip_in_canonical_order(tree: tuple[TreeShape, list[Node]]) -> None:
    shape, nodes = tree
    reader = SymbolReader(payload_of(shape, nodes))
    read = read_seeds(reader, shape, len(nodes))
    reader.finish()
    assert nodes_of(read) == walk_order(nodes)
    assert (read[0].dtype, read[1].dtype) == (np.int32, np.int8)


class ReferenceDecoder:
    """docs/format.md, section "Seed positions", one flag at a time over a dictionary of nodes."""

    def __init__(self, shape: TreeShape, payload: bytes) -> None:
        self.shape, self.walk = shape, SymbolReader(payload)
        self.split: dict[Node, int] = {}
        self.seed: dict[Node, int] = {}
        self.sent: dict[tuple[int, ...], int] = {}
        self.shift = [0, 1, 2, 4][int(self.walk.read_bits(2, 1)[0])]

    def flags(self, contexts: dict[Node, tuple[int, ...]]) -> dict[Node, int]:
        for context in sorted(set(contexts.values())):
            if context not in self.sent:
                self.sent[context] = int(self.walk.read_bits(4, 1)[0])
        result = {}
        for code in range(16):
            ones = TOTAL // 256 * ONES[code]
            for node, context in contexts.items():
                if self.sent[context] == code:
                    coded = self.walk.read_categorical(np.array([[TOTAL - ones, ones]]), np.zeros(1, np.int16))
                    result[node] = int(coded[0])
        return result

    def nodes(self, level: int, nodes: list[Node], child: int) -> None:
        siblings = {node: self.siblings(node, child) for node in nodes}
        split = dict.fromkeys(nodes, 0)
        if level > self.shape.min_log:
            split = self.flags({n: (1, level, self.score(n, child), *siblings[n]) for n in nodes})
        at_bottom = int(level == self.shape.min_log)
        seed = self.flags({n: (0, at_bottom, split[n], *siblings[n]) for n in nodes})
        self.split |= split
        self.seed |= seed

    def siblings(self, node: Node, child: int) -> tuple[int, int]:
        level, x, y = node
        earlier = [(level, x & ~1 | c & 1, y & ~1 | c >> 1) for c in range(child)]
        occupied = [self.split[n] or self.seed[n] for n in earlier if n in self.split]
        return occupied.count(0), int(any(occupied))

    def score(self, node: Node, child: int) -> int:
        level, x, y = node
        if level == self.shape.root_log:
            return 0
        score = 0
        for nx, ny in ((x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)):
            if (nx & 1) + 2 * (ny & 1) < child:
                score += 2 * self.split.get((level, nx, ny), 0)
            else:
                score += self.split.get((level + 1, nx >> 1, ny >> 1), 0)
        return score >> self.shift

    def decode(self) -> list[Node]:
        shape = self.shape
        columns, rows = shape.root_grid
        top = shape.root_log
        self.nodes(top, walk_order([(top, x, y) for y in range(rows) for x in range(columns)]), 0)
        for level in range(top - 1, shape.min_log - 1, -1):
            parents = walk_order([node for node, split in self.split.items() if split and node[0] == level + 1])
            for child in range(4):
                children = [(level, 2 * x + (child & 1), 2 * y + (child >> 1)) for _, x, y in parents]
                inside = [(k, x, y) for k, x, y in children if x << k < shape.width and y << k < shape.height]
                self.nodes(level, inside, child)
        return walk_order([node for node, seed in self.seed.items() if seed])


@settings(max_examples=examples(40))
@given(trees())
def test_the_reference_decoder_reads_the_same_tree(tree: tuple[TreeShape, list[Node]]) -> None:
    shape, nodes = tree
    writer = SymbolWriter()
    write_positions(writer, shape, seeds_of(nodes))
    crc = writer.crc
    decoder = ReferenceDecoder(shape, writer.finish())
    assert decoder.decode() == walk_order(nodes)
    assert decoder.walk.read_bits(32, 1)[0] == crc  # it also stopped where the encoder did


GOLDEN_SHAPE = TreeShape(20, 13, 3, 1)
GOLDEN_NODES = [(3, 0, 0), (1, 1, 0), (2, 1, 1), (1, 9, 0), (3, 1, 1), (2, 2, 1), (1, 0, 5), (1, 1, 5)]
GOLDEN = "e688750e190945043da7375116f242f2b7a3de"


def test_golden_payload_decodes_for_ever() -> None:
    assert payload_of(GOLDEN_SHAPE, GOLDEN_NODES).hex() == GOLDEN
    reader = SymbolReader(bytes.fromhex(GOLDEN))
    assert nodes_of(read_seeds(reader, GOLDEN_SHAPE, 8)) == walk_order(GOLDEN_NODES)
    reader.finish()


def test_a_seed_of_an_adaptive_tree_costs_less_than_a_bit() -> None:
    """Leaves that shrink towards a diagonal edge: structure that the contexts must find."""
    leaves = []
    pending = [(6, x, y) for x in range(16) for y in range(16)]
    while pending:
        level, x, y = pending.pop()
        side = 1 << level
        if level > 1 and abs((2 * x + 1) * side - (2 * y + 1) * side) // 2 < side:
            pending += [(level - 1, 2 * x + i, 2 * y + j) for i in (0, 1) for j in (0, 1)]
        else:
            leaves.append((level, x, y))
    writer = SymbolWriter()
    write_positions(writer, TreeShape(1024, 1024, 6, 1), seeds_of(leaves))
    assert writer.bits["rest"] < 0.6 * len(leaves)


def test_random_pixels_cost_what_they_must() -> None:
    rng = np.random.default_rng(2)
    nodes = sorted({(0, int(x), int(y)) for x, y in rng.integers(0, 1024, (2000, 2))})
    writer = SymbolWriter()
    write_positions(writer, TreeShape(1024, 1024, 8, 0), seeds_of(nodes))
    bound = np.sum(np.log2((1024**2 - np.arange(len(nodes))) / np.arange(1, len(nodes) + 1)))
    assert bound < writer.bits["rest"] < 1.04 * bound


def test_no_seeds_cost_one_root_flag_each_and_their_contexts() -> None:
    writer = SymbolWriter()
    write_positions(writer, TreeShape(4096, 4096, 6, 0), seeds_of([]))
    assert writer.bits["rest"] == 2 + 8  # the detail and two contexts, "never"


@pytest.mark.parametrize(
    "nodes",
    [[(1, 10, 0)], [(1, 0, 7)], [(1, -1, 0)], [(0, 0, 0)], [(4, 0, 0)], [(1, 0, 0), (1, 0, 0)]],
    ids=["right", "below", "left", "too small", "too large", "twice"],
)
def test_seeds_that_are_no_nodes_are_refused(nodes: list[Node]) -> None:
    with pytest.raises(UsageError):
        write_positions(SymbolWriter(), GOLDEN_SHAPE, seeds_of(nodes))


def test_seeds_off_their_grid_are_refused() -> None:
    with pytest.raises(UsageError):
        write_positions(SymbolWriter(), GOLDEN_SHAPE, (np.array([[1, 0]]), np.array([1])))


@pytest.mark.parametrize("values", [(0, 1, 1, 0), (1, 1 << 25, 1, 0), (1, 1, 1, 2), (1, 1, 17, 0), (1, 1, 0, -1)])
def test_shapes_that_no_tree_has_are_refused(values: tuple[int, int, int, int]) -> None:
    with pytest.raises(UsageError):
        TreeShape(*values)


def test_more_seeds_than_allowed_are_refused() -> None:
    nodes = [(1, x, 0) for x in range(8)]
    with pytest.raises(LimitError):
        read_seeds(SymbolReader(payload_of(GOLDEN_SHAPE, nodes)), GOLDEN_SHAPE, 7)
    with pytest.raises(LimitError):
        read_seeds(SymbolReader(payload_of(TreeShape(8, 8, 1, 1), nodes[:4])), TreeShape(8, 8, 1, 1), 3)
    with pytest.raises(LimitError):
        write_positions(SymbolWriter(), TreeShape(1 << 20, 1 << 20, 1, 0), seeds_of([]))


def test_a_small_payload_cannot_claim_a_large_tree() -> None:
    """Every context "always": a seed and four children in every node, for half a byte per context."""
    writer = SymbolWriter()
    writer.code_int(0, 2)
    writer.code_bits([15] * 400, 4)
    with pytest.raises(LimitError, match="more than 5000 seeds at level 9"):
        read_seeds(SymbolReader(writer.finish()), TreeShape(1 << 15, 1 << 15, 15, 0), 5000)


def test_a_split_node_without_seeds_below_is_corrupt() -> None:
    writer = SymbolWriter()
    writer.code_int(0, 2)
    writer.code_bits([15, 0], 4)  # the root is split and carries no seed
    writer.code_bits([0] * 400, 4)
    with pytest.raises(CorruptStreamError, match="split node of level 3"):
        read_seeds(SymbolReader(writer.finish()), TreeShape(8, 8, 3, 0), 10)


@settings(max_examples=examples(150))
@given(st.binary(max_size=60))
def test_any_bytes_decode_or_are_corrupt(data: bytes) -> None:
    try:
        reader = SymbolReader(data)
        read_seeds(reader, TreeShape(300, 200, 5, 0), 50)
        reader.finish()
    except (CorruptStreamError, LimitError):
        pass
