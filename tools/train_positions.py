"""Trains the networks that predict where seeds are (`predicted_positions.py`) on the trees of many streams.

    python -m tools.train_positions PICTURES_DIR STREAMS_DIR OUT.bin

Every picture is encoded at several qualities; streams that STREAMS_DIR has already are taken as they are. Trees are
also seen mirrored and transposed, where a mirrored picture has its nodes in the same places.
"""

from __future__ import annotations

import argparse
import hashlib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from sgicodec import read
from sgicodec._native import evaluate_network, tree_examples
from sgicodec.bitstream.parts.positions import Seeds
from sgicodec.bitstream.parts.predicted_positions import TreeContext
from sgicodec.decoder.stream import open_stream
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.model.network import IntNetwork

__all__ = ["Tree", "make_streams", "train"]

QUALITIES = (10.0, 90.0)
MIRRORED = 3
"""In how many ways each tree is seen, chosen at random out of eight or fewer."""
BATCH, RATE = 2048, 6e-3
ROOT_LOG, MIN_LOG = 6, 1
"""log2 of the sides of roots and of the smallest nodes, pixels."""
CHILDREN = 4
SHIFT = 8
"""Shipped weights are multiples of 2^-8."""


@dataclass(frozen=True)
class Tree:
    """The seeds of one stream and what is seen besides."""

    seeds: Seeds
    scenery: TreeContext

    @classmethod
    def of(cls, path: Path) -> Tree:
        with open_stream(path) as stream:
            header, model = stream.header, stream.model
        scenery = TreeContext((header.width, header.height), model.base, header.spec.base_cell, header.quality)
        return cls((model.layout.corner, model.layout.log_size), scenery)

    def mirrored(self, across: bool, down: bool, transposed: bool) -> Tree:
        """The tree of the picture turned so; sides that are mirrored must be multiples of the roots' side."""
        (corner, log_size), (width, height) = self.seeds, self.scenery.size
        side = np.int32(1) << log_size.astype(np.int32)
        x = width - side - corner[:, 0] if across else corner[:, 0]
        y = height - side - corner[:, 1] if down else corner[:, 1]
        base = self.scenery.base[:, :: -1 if down else 1, :: -1 if across else 1]
        if transposed:
            x, y, width, height, base = y, x, height, width, base.swapaxes(1, 2)
        scenery = self.scenery._replace(size=(width, height), base=np.ascontiguousarray(base))
        return Tree((np.stack([x, y], axis=1), log_size), scenery)

    def variants(self, rng: np.random.Generator, most: int) -> list[Tree]:
        """Some of the ways to turn it."""
        root, (width, height) = 1 << ROOT_LOG, self.scenery.size
        ways = [(bool(i & 1), bool(i & 2), bool(i & 4)) for i in range(8)]
        ways = [w for w in ways if not (w[0] and width % root) and not (w[1] and height % root)]
        return [self.mirrored(*ways[i]) for i in rng.permutation(len(ways))[:most]]


def make_streams(pictures: list[Path], folder: Path, rounds: int, steps: int) -> Iterator[Path]:
    """Encodes every picture `rounds` times, in each round at qualities that are spread evenly over the pictures."""
    rng = np.random.default_rng(5)
    for _ in range(rounds):
        shares = (np.arange(len(pictures)) + rng.random(len(pictures))) / len(pictures)
        for picture, share in zip(pictures, rng.permutation(shares), strict=True):
            quality = round(QUALITIES[0] + (QUALITIES[1] - QUALITIES[0]) * float(share), 1)
            path = folder / f"{picture.stem}_{quality:g}.sgi"
            if not path.exists():
                path.write_bytes(encode_picture(read(picture), EncodeSettings(quality=quality, steps=steps)).data)
            yield path


@dataclass(frozen=True)
class Examples:
    """inputs [n, inputs], flags [n, 2] (split, seed), which of them count [n, 2], weight of each example [n]."""

    inputs: torch.Tensor
    flags: torch.Tensor
    counted: torch.Tensor
    weight: torch.Tensor

    @classmethod
    def of(cls, trees: list[Tree], child: int) -> Examples:
        """Those of one child number. A tree weighs by the root of these nodes: large ones say more, but alike."""
        inputs, flags, counted, weight = [], [], [], []
        for tree in trees:
            levels = tree_examples(*tree.scenery, *tree.seeds, child)
            share = sum(len(seen) for _, seen, *_ in levels) ** -0.5
            for level, seen, split, seed, needed in levels:
                inputs.append(seen)
                flags.append(np.stack([split, seed], axis=1))
                known = np.full(split.shape, level > MIN_LOG), (needed == 0) | (split == 1)
                counted.append(np.stack(known, axis=1))
                weight.append(np.full(len(split), share, np.float32))
        flat = [torch.from_numpy(np.concatenate(parts)) for parts in (inputs, flags, counted, weight)]
        return cls(flat[0], flat[1], flat[2], flat[3] / flat[3].mean())

    def bits(self, odds: torch.Tensor, pick: torch.Tensor | slice) -> torch.Tensor:
        """What each of some examples costs under log-odds [n, 3]."""
        flags, counted = self.flags[pick], self.counted[pick]
        of_seed = torch.where(flags[:, 0] == 1, odds[:, 2], odds[:, 1])
        chosen = torch.stack([odds[:, 0], of_seed], dim=1)
        nats = torch.nn.functional.binary_cross_entropy_with_logits(chosen, flags.float(), reduction="none")
        bits: torch.Tensor = (nats * counted).sum(dim=1) / math.log(2)
        return bits


def train(examples: Examples, hidden: int, epochs: int, seed: int) -> IntNetwork:
    """One network in integers."""
    torch.manual_seed(seed)
    first, last = torch.nn.Linear(examples.inputs.shape[1], hidden), torch.nn.Linear(hidden, 3)
    net = torch.nn.Sequential(first, torch.nn.ReLU(), last)
    optimizer = torch.optim.AdamW(net.parameters(), RATE, weight_decay=0.0)
    count = len(examples.inputs)
    steps = epochs * -(-count // BATCH)
    schedule = torch.optim.lr_scheduler.LambdaLR(optimizer, lambda step: 1 - step / steps + 0.002)
    for _ in range(epochs):
        for pick in torch.split(torch.randperm(count), BATCH):  # type: ignore[no-untyped-call]
            odds = net(examples.inputs[pick].float() / 64)
            loss = (examples.bits(odds, pick) * examples.weight[pick]).mean()
            optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            optimizer.step()
            schedule.step()
    return _in_integers(first, last)


def _in_integers(first: torch.nn.Linear, last: torch.nn.Linear) -> IntNetwork:
    def whole(values: torch.Tensor) -> NDArray[np.int64]:
        scaled: NDArray[np.float64] = values.detach().double().numpy() * (1 << SHIFT)
        return np.rint(scaled).astype(np.int64)

    w1, b1, w2, b2 = (whole(values) for layer in (first, last) for values in (layer.weight, layer.bias))
    return IntNetwork(w1, b1, w2, b2, SHIFT, predicted=3)


def _report(network: IntNetwork, examples: Examples) -> str:
    out = np.empty((len(examples.inputs), 3), np.int64)
    evaluate_network(*network.arrays, network.shift, network.predicted, examples.inputs.numpy(), 1, "auto", out)
    odds = torch.from_numpy(out / 256)
    bits = examples.bits(odds, slice(None))
    return f"{len(bits):9,d} nodes  {float(bits.mean()):.4f} bits each"


def write_networks(networks: tuple[IntNetwork, ...], path: Path) -> str:
    """Writes the file that `bitstream.parts.prior` reads, in 16-bit integers, and returns its SHA-256."""
    blocks = []
    for network in networks:
        hidden, inputs = network.w1.shape
        head = [inputs, hidden, network.w2.shape[0], network.predicted, network.shift]
        parts = [np.array(head), network.w1, network.b1, network.w2, network.b2]
        values = np.concatenate([part.reshape(-1) for part in parts])
        if np.abs(values).max() > 32767:
            raise ValueError("a weight does not fit into 16 bits")
        blocks.append(values.astype("<i2"))
    data = np.concatenate(blocks).tobytes()
    path.write_bytes(data)
    return hashlib.sha256(data).hexdigest()


def main() -> None:
    """The command line of this module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", type=Path)
    parser.add_argument("streams", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--rounds", type=int, default=4, help="streams of each picture")
    parser.add_argument("--steps", type=int, default=400, help="of each fit")
    parser.add_argument("--hidden", type=int, default=32)
    parser.add_argument("--epochs", type=int, default=20)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    rng = np.random.default_rng(arguments.seed)
    pictures = sorted(arguments.pictures.glob("*.png"))
    streams = list(make_streams(pictures, arguments.streams, arguments.rounds, arguments.steps))
    trees = [tree for path in streams for tree in Tree.of(path).variants(rng, MIRRORED)]
    networks = []
    for child in range(CHILDREN):
        examples = Examples.of(trees, child)
        networks.append(train(examples, arguments.hidden, arguments.epochs, arguments.seed))
        print(f"child {child}  {_report(networks[-1], examples)}", flush=True)
    print("sha256", write_networks(tuple(networks), arguments.out))


if __name__ == "__main__":
    main()
