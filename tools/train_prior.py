"""Trains a prior, the networks of the context model, on the seeds of many streams.

    python -m tools.train_prior PICTURES_DIR STREAMS_DIR OUT.bin

Each picture is encoded `--rounds` times, every other time turned, at qualities drawn by chance; streams that lie in
STREAMS_DIR already are taken as they are. Training goes on from the prior that they name. It moves means and scales
towards fewer bits; how far the networks change steps stays, since streams do not tell what a coarser step would cost
the pictures.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from sgicodec import EncodeSettings, encode_picture, read
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.decoder.stream import open_stream
from sgicodec.device import ONE_THREAD
from sgicodec.fit.context_weights import float_weights
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.step_sizes import flat_steps
from sgicodec.model.network import IntNetwork
from sgicodec.model.spec import ModelSpec
from tests.support.prior_file import prior_file
from tests.support.torch_step.context_net import ContextNet
from tests.support.torch_step.quantization_proxy import QuantizationProxy

QUALITIES = (22.0, 78.0)
FEWEST_SEEDS = 32
HOLD = 20.0
"""Bits that a step costs for moving by an octave, squared."""
NOTHING = NoiseKey(0, negative=False)
"""Of noise where values are rounded."""


class TrainingNet(ContextNet):
    """Networks that train. drift: squared octaves by which they move steps away from those that they began with, the
    mean of what was asked since it was set to 0.
    """

    def __init__(self, spec: ModelSpec, networks: tuple[IntNetwork, ...]) -> None:
        super().__init__(spec, float_weights(networks, 0.0))
        self.start = ContextNet(spec, float_weights(networks, 0.0))
        self.trained = [weights.requires_grad_() for layer in self.layers for weights in layer]
        self.drift = torch.zeros(())

    def forward(self, stage: int, inputs: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """As that of any network."""
        mean, scale, refine = super().forward(stage, inputs)
        with torch.no_grad():
            held = self.start.forward(stage, inputs)[2]
        self.drift = self.drift + ((refine - held) ** 2).mean()
        return mean, scale, refine

    def integers(self, networks: tuple[IntNetwork, ...]) -> tuple[IntNetwork, ...]:
        """The networks in the units of these."""
        found = []
        for layer, old in zip(self.layers, networks, strict=True):
            w1, b1, w2, b2 = (np.rint(w.detach().numpy() * 2.0**old.shift).astype(np.int64) for w in layer)
            found.append(IntNetwork(w1, b1, w2, b2, old.shift, old.predicted))
        return tuple(found)


class Seeds:
    """The seeds of a stream in one tile."""

    def __init__(self, header: Header, model: TileModel) -> None:
        self.spec, self.networks, self.count = header.spec, model.networks, len(model.layout)
        self.proxy = QuantizationProxy(header.spec, header.family)
        self.proxy.set_layout(model.layout, header.colour_step, header.width, header.height)
        self.steps = torch.from_numpy(flat_steps(header.spec, model.plan))
        decoded = torch.from_numpy(model.decoded_values).float()
        self.values = {group.name: decoded[:, group.columns] for group in header.spec.groups}

    def bits(self, net: ContextNet) -> Tensor:
        """Of each seed [N], values rounded to what the predictions of `net` let a stream hold."""
        return self.proxy.sample(self.values, net, self.steps, "round", NOTHING).bits


def train(streams: list[Seeds], steps: int, rate: float) -> tuple[IntNetwork, ...]:
    """Networks that make the seeds of streams cheaper. A stream weighs as the root of its seeds: neither all alike nor
    by their numbers.
    """
    networks = streams[0].networks
    net = TrainingNet(streams[0].spec, networks)
    weights = np.array([seeds.count**0.5 for seeds in streams])
    rng = np.random.default_rng(1)
    optimizer = torch.optim.Adam(net.trained, rate)
    for step in range(steps):
        optimizer.param_groups[0]["lr"] = rate * min(1.0, 1.5 * (1 - step / steps)) + 1e-5
        chosen = rng.choice(len(streams), 8, p=weights / weights.sum())
        net.drift = torch.zeros(())
        bits = torch.stack([streams[number].bits(net).mean() for number in chosen]).mean()
        optimizer.zero_grad()
        (bits + HOLD * net.drift / len(chosen)).backward()  # type: ignore[no-untyped-call]
        optimizer.step()
        if step % 100 == 0 or step == steps - 1:
            print(f"step {step:5d}  {float(bits.detach()):.3f} bits per seed", flush=True)
    return net.integers(networks)


def _make_streams(pictures: Path, streams: Path, rounds: int) -> None:
    rng = np.random.default_rng(5)
    for path in sorted(pictures.iterdir()):
        picture = read(path)
        for number in range(rounds):
            quality, out = float(rng.uniform(*QUALITIES)), streams / f"{path.stem}-{number}.sgi"
            if out.exists():
                continue
            pixels = picture.pixels if number % 2 == 0 else np.ascontiguousarray(picture.pixels[:, ::-1].swapaxes(0, 1))
            settings = EncodeSettings(quality=quality, tile=0)
            out.write_bytes(encode_picture(replace(picture, pixels=pixels), settings, device=ONE_THREAD).data)


def seeds_in(streams: Path) -> list[Seeds]:
    """The streams of a folder that have some seeds."""
    found = []
    for path in sorted(streams.glob("*.sgi")):
        with open_stream(path) as stream:
            if len(stream.model.layout) >= FEWEST_SEEDS:
                found.append(Seeds(stream.header, stream.model))
    return found


def main() -> None:
    """The command line of this module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", type=Path)
    parser.add_argument("streams", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--rounds", type=int, default=4)
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--rate", type=float, default=0.002)
    arguments = parser.parse_args()
    arguments.streams.mkdir(parents=True, exist_ok=True)
    _make_streams(arguments.pictures, arguments.streams, arguments.rounds)
    arguments.out.write_bytes(prior_file(train(seeds_in(arguments.streams), arguments.steps, arguments.rate)))


if __name__ == "__main__":
    main()
