"""A reader of attributes that was written from docs/format.md, "Context model": every number of it is a Python int."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

SIXTHS = (1099511627776, 1234160073853, 1385297844439, 1554944255988, 1745365914583, 1959106999532)
WEIGHTS = (4, 3, 3, 2, 2, 2)
Read = Callable[[Sequence[int]], list[int]]
"""Reads zero-centred symbols under these tables."""


class Seed(NamedTuple):
    """A cell: its corner in pixels and log2 of its side."""

    x: int
    y: int
    k: int

    @property
    def centre(self) -> tuple[int, int]:
        """In half pixels."""
        return 2 * self.x + (1 << self.k), 2 * self.y + (1 << self.k)


class Coded(NamedTuple):
    """A symbol: of which group, seed and attribute of the group; its step in 2^-24 and its table."""

    group: str
    seed: int
    place: int
    symbol: int
    step: int
    table: int


def clip(value: int, low: int, high: int) -> int:
    return min(max(value, low), high)


def step_of(e: int) -> int:
    s = 32 - e // 6
    return (SIXTHS[e % 6] + (1 << (s - 1))) >> s


def amplitude_of(values: list[int]) -> int:
    energy = max(1, sum(clip(v >> 12, -(2**20), 2**20) ** 2 for v in values))
    cube, thirds = energy**3, 0  # ⌊3 log2 E⌋ = ⌊log2 E³⌋
    while cube >> (thirds + 1):
        thirds += 1
    return thirds - 72


class PageAttributes:
    """Section "Passes" and what it rests on. `read_all` gives the attributes of every seed.

    plan: by group name, base steps [U][8] and γ. networks: of each step W1, b1, W2, b2 and the shift. signs: of the
    hash grid, 0 or 1, level after level.
    """

    def __init__(self, header: Any, seeds: list[Seed], plan: dict[str, tuple[Any, int]], networks: Any, signs: Any):
        self.spec, self.colour_step, self.family = header.spec, header.colour_step, header.family
        self.size = header.width, header.height
        self.seeds, self.plan, self.networks, self.signs = seeds, plan, networks, [int(s) for s in signs]
        k, c, d = self.spec.per_seed, self.spec.channels, self.spec.features
        held = [("colour", c), ("shape", 3)] if self.spec.plain else [("feature", d), ("scales", 4)]
        self.groups = [*held, ("offset", 2 * k)]
        self.values: list[dict[str, list[int]]] = [{} for _ in seeds]
        self.done: list[int] = []  # seeds of earlier passes
        self.coded: list[Coded] = []  # one after the other

    def read_all(self, read: Read) -> list[list[int]]:
        """Attributes of all seeds in the order of groups."""
        names = [name for name, _ in self.groups]
        for members in self.passes():
            for step, groups in enumerate([[name] for name in names] if self.spec.plain else [names]):
                inputs = [self.inputs(i, step) for i in members]
                outputs = [self.evaluate(step, row) for row in inputs]
                first = 0
                for number, name in enumerate(groups):
                    first += self.read_group(read, name, members, outputs, first, number, len(groups))
            self.done = sorted(self.done + members)
        return [[value for name in names for value in held[name]] for held in self.values]

    def passes(self) -> list[list[int]]:
        """The seeds of each."""
        everyone = list(range(len(self.seeds)))
        if not self.spec.context.neighbours:
            return [everyone]
        order = [(0, 0), (1, 1), (1, 0), (0, 1)]
        parity = [order.index((s.x >> s.k & 1, s.y >> s.k & 1)) for s in self.seeds]
        size = [clip(s.k, 1, 5) for s in self.seeds]
        found = [[i for i in everyone if (size[i], parity[i]) == (at, p)] for at in (5, 4, 3, 2, 1) for p in range(4)]
        return [members for members in found if members]

    def read_group(
        self, read: Read, name: str, members: list[int], outputs: list[list[int]], first: int, number: int, groups: int
    ) -> int:
        """Reads a group of these seeds; how many predictions it has."""
        size, spec = dict(self.groups)[name], self.spec
        own = {"colour": 3, "shape": 3, "offset": 2}.get(name, size) if spec.plain else size
        base, gamma = self.plan[name]
        units, known, tables = (len(outputs[0]) - groups) // 2 if outputs else 0, [], []
        for i, y in zip(members, outputs, strict=True):
            level = min(self.seeds[i].k, 7)
            refinement, fall = clip(y[2 * units + number], -24, 24), 0
            if spec.plain and name != "colour":
                fall = gamma * (amplitude_of(self.values[i]["colour"]) + 20) >> 4
            for j in range(size):
                use = j % own
                if spec.plain and name == "colour":
                    channel = j % spec.channels
                    use = channel if spec.channels >= 3 and channel < 3 else 0
                b = int(base[use][level])
                e = clip(b + refinement - fall, 0, 102)
                mean = clip(y[first + use], -(2**20), 2**20) * step_of(b) >> 8
                known.append((mean, step_of(e)))
                tables.append(64 * self.family + clip(24 + y[units + first + use] + b - e, 0, 63))
        symbols = read(tables)
        columns = [(i, j) for i in members for j in range(size)]
        self.coded += [
            Coded(name, *at, *one)
            for at, *one in zip(columns, symbols, [step for _, step in known], tables, strict=True)
        ]
        decoded = [mean + step * n for (mean, step), n in zip(known, symbols, strict=True)]
        for place, i in enumerate(members):
            self.values[i][name] = decoded[place * size : (place + 1) * size]
        return own

    def evaluate(self, step: int, inputs: list[int]) -> list[int]:
        """What the network of a step says."""
        w1, b1, w2, b2, shift = self.networks[step]
        x = np.array([clip(value, -(2**13), 2**13) for value in inputs], object)
        hidden = np.clip((w1.astype(object) @ x + 64 * b1.astype(object)) >> shift, 0, 2**15)
        y = w2.astype(object) @ hidden + 64 * b2.astype(object)
        groups = 1 if self.spec.plain else len(self.groups)
        units = (len(y) - groups) // 2
        return [v >> (shift - 2) for v in y[:units]] + [6 * v >> (6 + shift) for v in y[units:]]

    def summary(self, i: int) -> list[int]:
        """The seven numbers of a seed, of what is decoded."""
        spec, held = self.spec, self.values[i]
        numbers = [0] * 7
        if "colour" in held:
            for c in range(3 if spec.channels >= 3 else 1):
                numbers[c] = held["colour"][c] >> 14
            numbers[3] = amplitude_of(held["colour"]) * 64 // 6 + 384
        if "shape" in held:
            numbers[4:] = [value >> 18 for value in held["shape"]]
        return [number if j == 3 else clip(number, -(2**13), 2**13) for j, number in enumerate(numbers)]

    def inputs(self, i: int, step: int) -> list[int]:
        """All four of the page, of a seed at a step."""
        seed = self.seeds[i]
        found = [64 * (min(seed.k, 7) == k) for k in range(8)] + [self.colour_step * 64 // 12]
        if self.spec.context.neighbours:
            found += self.of_neighbours(seed)
        found += self.of_grid(seed)
        if step >= 1:
            own = self.summary(i)
            found += own[:3] + [abs(v) for v in own[:3]] + [own[3]]
            if step >= 2:
                found += own[4:] + [abs(v) for v in own[5:]]
        return found

    def of_neighbours(self, seed: Seed) -> list[int]:
        def distance(i: int) -> tuple[int, int]:
            (x, y), (u, v) = seed.centre, self.seeds[i].centre
            return (x - u) ** 2 + (y - v) ** 2, i

        near = sorted(self.done, key=distance)[: self.spec.context.neighbours]
        seen = [(w, self.summary(i), self.seeds[i]) for w, i in zip(WEIGHTS, near, strict=False)]
        found = [sum(64 * w for w, _, _ in seen) >> 4]
        found += [sum(w * own[j] for w, own, _ in seen) >> 4 for j in range(7)]
        found += [sum(w * abs(own[j]) for w, own, _ in seen) >> 4 for j in (0, 1, 2, 5, 6)]
        found += [sum(64 * w * (other.k - seed.k) for w, _, other in seen) >> 4]
        if not seen:
            return [*found, *[0] * 9]
        away = (b - a for a, b in zip(seed.centre, seen[0][2].centre, strict=True))
        return [*found, *seen[0][1], *(clip(d * 64 >> (seed.k + 1), -512, 512) for d in away)]

    def of_grid(self, seed: Seed) -> list[int]:
        context, found, first = self.spec.context, [], 0
        longer, height = 2 * max(self.size), self.size[1]
        for resolution in context.hash_resolutions:
            across = resolution + 1
            rows = across * 2 * height // longer + 2
            size = min(across * rows, 1 << context.hash_log2_entries)
            px, py = (resolution * 64 * v // longer for v in seed.centre)
            sums = [0] * context.hash_features
            for dx in (0, 1):
                for dy in (0, 1):
                    x, y = (px >> 6) + dx, (py >> 6) + dy
                    entry = (y * across + x if across * rows <= size else x ^ (y * 2654435761)) % size
                    weight = (px & 63 if dx else 64 - (px & 63)) * (py & 63 if dy else 64 - (py & 63))
                    for f in range(context.hash_features):
                        sums[f] += weight * (2 * self.signs[first + entry * context.hash_features + f] - 1)
            found += [total >> 6 for total in sums]
            first += size * context.hash_features
        return found
