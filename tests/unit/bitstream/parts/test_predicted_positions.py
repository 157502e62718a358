"""Predicted positions against a decoder written from docs/format.md that visits one node at a time."""

from __future__ import annotations

import math
from importlib.resources import files

import numpy as np
import pytest
from examples import examples
from hypothesis import given, settings
from hypothesis import strategies as st

from sgicodec._native import SymbolReader
from sgicodec.bitstream.entropy.symbol_writer import SymbolWriter
from sgicodec.bitstream.entropy.tables import TOTAL
from sgicodec.bitstream.parts.positions import Seeds
from sgicodec.bitstream.parts.predicted_positions import TreeContext, write_predicted_positions
from sgicodec.device import ONE_THREAD, Device
from sgicodec.errors import CorruptStreamError, LimitError, UsageError

Node = tuple[int, int, int]  # level, column, row


def seeds_of(nodes: list[Node]) -> Seeds:
    table = np.array(nodes, np.int64).reshape(-1, 3)
    return (table[:, 1:] << table[:, :1]).astype(np.int32), table[:, 0].astype(np.int8)


def nodes_of(seeds: Seeds) -> list[Node]:
    return [(int(k), int(x) >> int(k), int(y) >> int(k)) for (x, y), k in zip(*seeds, strict=True)]


def read_seeds(reader: SymbolReader, scenery: TreeContext, most: int, device: Device = ONE_THREAD) -> Seeds:
    return reader.read_predicted_positions(*scenery, most, device.threads, device.isa)


@st.composite
def trees(draw: st.DrawFn) -> tuple[TreeContext, list[Node]]:
    """Seeds that crowd in places, over a base layer of any kind."""
    width, height = draw(st.integers(1, 300)), draw(st.integers(1, 200))
    count = draw(st.one_of(st.integers(0, 5), st.integers(0, 150)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    level = rng.integers(1, 1 + draw(st.integers(1, 6)), count)
    x = (width * rng.random(count) ** draw(st.integers(1, 3))).astype(int) >> level
    y = (height * rng.random(count) ** draw(st.integers(1, 3))).astype(int) >> level
    cell = draw(st.sampled_from([0, 7, 32]))
    across, down = (-(-side // cell) if cell else 0 for side in (width, height))
    spread = draw(st.sampled_from([0, 3, 100, 2**20]))
    base = rng.integers(-spread, spread + 1, (draw(st.integers(1, 4)), down, across))
    scenery = TreeContext((width, height), base, cell, draw(st.integers(0, 255)))
    return scenery, sorted(set(zip(level.tolist(), x.tolist(), y.tolist(), strict=True)))


class ReferenceDecoder:
    """docs/format.md, section "Predicted flags", one flag at a time over a dictionary of nodes."""

    def __init__(self, scenery: TreeContext, payload: bytes) -> None:
        self.scenery, self.walk = scenery, SymbolReader(payload)
        self.width, self.height = scenery.size
        self.split: dict[Node, int] = {}
        self.seed: dict[Node, int] = {}
        self.networks = self.read_networks()
        self.counts = {k: {"split": [0, 0], "seed": [0, 0]} for k in range(1, 8)}

    @staticmethod
    def read_networks() -> list[tuple[np.ndarray, ...]]:
        data = np.frombuffer(files("sgicodec.bitstream.parts").joinpath("positions1.bin").read_bytes(), "<i2").astype(
            object
        )
        networks, at = [], 0
        for _ in range(4):
            inputs, hidden, outputs, _, shift = data[at : at + 5]
            at += 5
            parts = []
            for shape in ((hidden, inputs), (hidden,), (outputs, hidden), (outputs,)):
                size = int(np.prod(shape))
                parts.append(data[at : at + size].reshape(shape))
                at += size
            networks.append((*parts, shift))
        assert at == len(data)
        return networks

    def exists(self, node: Node) -> bool:
        return node in self.split

    def rate(self, level: int, name: str) -> list[int]:
        n, ones = self.counts[level + 1][name] if level < 6 else (0, 0)
        before = (64 * ones + 32) // (n + 1)
        n, ones = self.counts[level][name]
        return [2 * before, 2 * ((64 * ones + 16 * before) // (n + 16))]

    def base_numbers(self, node: Node) -> list[int]:
        if not self.scenery.cell:
            return [0] * 5
        level, x, y = node
        planes, rows, columns = self.scenery.base.shape

        def value(c: int, i: int, j: int) -> int:
            return int(self.scenery.base[c, min(max(i, 0), rows - 1), min(max(j, 0), columns - 1)])

        j = min((2 * x + 1 << level >> 1) // self.scenery.cell, columns - 1)
        i = min((2 * y + 1 << level >> 1) // self.scenery.cell, rows - 1)
        slope, bend, most = [0, 0], [0, 0], 0
        for c in range(planes):
            here, w, e, n, s = (value(c, i + a, j + b) for a, b in ((0, 0), (0, -1), (0, 1), (-1, 0), (1, 0)))
            slope[c > 0] += abs(e - w) + abs(s - n)
            bend[c > 0] += abs(w + e + n + s - 4 * here)
            most += max(abs(value(c, i + a, j + b) - here) for a in (-1, 0, 1) for b in (-1, 0, 1))
        result = []
        for v in (*slope, *bend, most):
            e = (v + 1).bit_length() - 1
            result.append(2 * (8 * e + ((v + 1) * 8 >> e) - 8))
        return result

    def around(self, node: Node) -> list[int]:
        level, x, y = node
        near = [(level, x + dx, y + dy) for dy in (-1, 0, 1) for dx in (-1, 0, 1)]
        splits, seeds = (sum(flags.get(n, 0) for n in near) for flags in (self.split, self.seed))
        return [64 * self.seed.get(node, 0), 16 * splits, 16 * seeds]

    def inputs(self, node: Node, child: int) -> list[int]:
        level, x, y = node
        found = [64 * (level == k) for k in range(1, 7)]
        found += [self.scenery.quality, *self.rate(level, "split"), *self.rate(level, "seed")]
        found += self.base_numbers(node)
        parent = (level + 1, x >> 1, y >> 1)
        found.append(64 * self.seed[parent])
        for dy in (-1, 0, 1):
            for dx in (-1, 0, 1):
                if (dx, dy) != (0, 0):
                    near = (level + 1, parent[1] + dx, parent[2] + dy)
                    found += [64 * self.split.get(near, 0), 64 * self.seed.get(near, 0), 64 * self.exists(near)]
        for up in (2, 3):
            found += self.around((level + up, x >> up, y >> up)) if level + up <= 7 else [0, 0, 0]
        order = [0, 3, 1, 2]
        for dy in range(-2, 3):
            for dx in range(-2, 3):
                near = (level, x + dx, y + dy)
                if order.index((near[1] & 1) + 2 * (near[2] & 1)) < order.index(child):
                    found += [64 * self.split.get(near, 0), 64 * self.seed.get(near, 0)]
        return found

    def rows(self, node: Node, child: int) -> list[int]:
        w1, b1, w2, b2, shift = self.networks[child]
        x = np.array(self.inputs(node, child), object)
        hidden = np.clip((w1 @ x + 64 * b1) >> shift, 0, 1 << 15)
        odds = (w2 @ hidden + 64 * b2) >> (shift - 2)
        return [int(min(max((v + 32) >> 6, -24), 24)) for v in odds]

    def flags(self, rows: dict[Node, int]) -> dict[Node, int]:
        result = {}
        for row in sorted(set(rows.values())):
            one = 65536 if row > 24 else round(65536 / (1 + math.exp(-row / 4)))
            for node, own in rows.items():
                if own == row:
                    frequencies = np.array([[65536 - one, one]]) * (TOTAL // 65536)
                    coded = self.walk.read_categorical(frequencies, np.zeros(1, np.int16))
                    result[node] = int(coded[0])
        return result

    def siblings(self, node: Node) -> list[Node]:
        level, x, y = node
        near = [(level, x & ~1 | c & 1, y & ~1 | c >> 1) for c in range(4)]
        return [(k, i, j) for k, i, j in near if i << k < self.width and j << k < self.height]

    def batch(self, level: int, child: int, nodes: list[Node]) -> None:
        rows = {node: self.rows(node, child) for node in nodes}
        split = self.flags({n: rows[n][0] for n in nodes}) if level > 1 else dict.fromkeys(nodes, 0)
        of_seed = {}
        for node in nodes:
            others = [n for n in self.siblings(node) if n != node]
            empty = level < 6 and all(n in self.split and not self.split[n] and not self.seed[n] for n in others)
            of_seed[node] = rows[node][2] if split[node] else 25 if empty else rows[node][1]
        seed = self.flags(of_seed)
        self.split |= split
        self.seed |= seed
        for node in nodes:
            for name, flags, counted in (("split", split, level > 1), ("seed", seed, not split[node])):
                self.counts[level][name][0] += counted
                self.counts[level][name][1] += counted and flags[node]

    def decode(self) -> list[Node]:
        def path(node: Node) -> tuple[list[int], int]:
            level, x, y = node
            return [((y << level) >> i & 1) * 2 + ((x << level) >> i & 1) for i in range(12, -1, -1)], -level

        for y in range(-(-self.height // 128)):
            for x in range(-(-self.width // 128)):
                self.split[7, x, y], self.seed[7, x, y] = 1, 0
        for level in range(6, 0, -1):
            parents = sorted((n for n, split in self.split.items() if split and n[0] == level + 1), key=path)
            for child in (0, 3, 1, 2):
                nodes = [(level, 2 * x + (child & 1), 2 * y + (child >> 1)) for _, x, y in parents]
                self.batch(level, child, [n for n in nodes if n in self.siblings(n)])
        return sorted((n for n, seed in self.seed.items() if seed), key=path)


@settings(max_examples=examples(40))
@given(trees())
def test_the_reference_decoder_reads_the_same_tree(tree: tuple[TreeContext, list[Node]]) -> None:
    scenery, nodes = tree
    writer = SymbolWriter()
    write_predicted_positions(writer, scenery, seeds_of(nodes))
    crc = writer.crc
    decoder = ReferenceDecoder(scenery, writer.finish())
    found = decoder.decode()
    assert decoder.walk.read_bits(32, 1)[0] == crc  # it also stopped where the encoder did
    assert sorted(found) == nodes


@settings(max_examples=examples(80))
@given(trees(), st.sampled_from([Device(2), Device(1, "portable")]))
def test_round_trip_on_any_processor(tree: tuple[TreeContext, list[Node]], device: Device) -> None:
    scenery, nodes = tree
    writer = SymbolWriter()
    write_predicted_positions(writer, scenery, seeds_of(nodes))
    reader = SymbolReader(writer.finish())
    read = read_seeds(reader, scenery, len(nodes), device)
    reader.finish()
    assert sorted(nodes_of(read)) == nodes
    assert (read[0].dtype, read[1].dtype) == (np.int32, np.int8)


NOWHERE = TreeContext((64, 64), np.zeros((1, 0, 0), np.int64), 0, 50)


def test_more_seeds_than_allowed_are_refused() -> None:
    nodes = [(1, x, y) for x in range(32) for y in range(32)]
    writer = SymbolWriter()
    write_predicted_positions(writer, NOWHERE, seeds_of(nodes))
    payload = writer.finish()
    assert len(read_seeds(SymbolReader(payload), NOWHERE, len(nodes))[1]) == len(nodes)
    for most in (3, 200, 1023):
        with pytest.raises(LimitError, match=f"more than {most} seeds"):
            read_seeds(SymbolReader(payload), NOWHERE, most)


@pytest.mark.parametrize(
    ("corner", "level", "message"),
    [((64, 0), 1, "outside"), ((1, 0), 1, "off its grid"), ((0, 0), 7, "size"), ((0, 0), 0, "size")],
)
def test_seeds_that_are_no_nodes_are_refused(corner: tuple[int, int], level: int, message: str) -> None:
    seeds = np.array([corner], np.int32), np.array([level], np.int8)
    with pytest.raises(UsageError, match=message):
        write_predicted_positions(SymbolWriter(), NOWHERE, seeds)
    with pytest.raises(UsageError, match="share one node"):
        write_predicted_positions(SymbolWriter(), NOWHERE, seeds_of([(2, 0, 0), (2, 0, 0)]))


@settings(max_examples=examples(100))
@given(st.binary(max_size=60))
def test_any_bytes_decode_or_are_corrupt(data: bytes) -> None:
    try:
        reader = SymbolReader(data)
        read_seeds(reader, NOWHERE._replace(size=(300, 200)), 50)
        reader.finish()
    except (CorruptStreamError, LimitError):
        pass
