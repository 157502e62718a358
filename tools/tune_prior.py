"""Tunes a prior to what searches for symbols choose: its means and scales, under the steps that it gives.

    python -m tools.tune_prior PICTURES_DIR STREAMS_DIR OUT.bin --start prior2.bin --rounds 5

Training along with fits (`fit.train_prior`) teaches MLP_p what noisy values are like. Searched ones differ: they are
where bits are cheap. So every picture is encoded `rounds` times, mirrored and turned at random, at random λ; what each
stream holds of its seeds becomes the training set. The refinements r of the steps, which no finished stream can
teach, are held where they are. Streams that lie in STREAMS_DIR already are taken as they are.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec import read
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.attributes import quantise_attributes
from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.model.context import INPUT_BITS, LEVELS, nearest_by_pass, output_columns
from sgicodec.model.network import INPUT_LIMIT, IntNetwork
from sgicodec.model.quantization import FRACTION_BITS, PER_OCTAVE, STEP_ZERO
from tools.autograd.rate import bits_laplace
from tools.prior_file import parse_prior, write_prior

__all__ = ["Seen", "seen_in", "tune"]

LMBDA_RANGE = (8e-4, 6e-2)
BATCH = 4096
HOLD = 20.0
"""Bits that a refinement r costs for moving by an octave, squared."""


@dataclass(frozen=True)
class Seen:
    """What MLP_p sees of n seeds at one coding step, and what is coded: inputs [n, k] as it takes them; values and
    steps [n, size] in base steps.
    """

    inputs: NDArray[np.int16]
    values: NDArray[np.float32]
    steps: NDArray[np.float32]


def seen_in(header: Header, model: TileModel) -> list[Seen]:
    """The training examples of a decoded model, by coding step of a single group each."""
    spec, layout, values = header.spec, model.layout, model.decoded_values
    groups = {group.name: values[:, group.columns] for group in spec.groups}
    known = layout, model.plan, model.networks, model.hash_tables
    runs = iter(quantise_attributes(header, *known, groups, with_inputs=True).runs)
    parts: list[list[Seen]] = [[] for _ in spec.groups]
    for members, _ in nearest_by_pass(spec.context, layout):
        level = np.clip(layout.log_size[members].astype(np.int64), 0, LEVELS - 1)
        for part, group in zip(parts, spec.groups, strict=True):
            run, steps = next(runs), model.plan.base[group.name][output_columns(spec, group.name)][:, level].T
            base = 2.0 ** ((steps - STEP_ZERO) / PER_OCTAVE)
            decoded, step = values[members][:, group.columns] / base, np.ldexp(run.steps / base, -FRACTION_BITS)
            part.append(Seen(run.inputs, decoded.astype(np.float32), step.astype(np.float32)))
    return [
        Seen(*(np.concatenate([getattr(p, f) for p in part]) for f in ("inputs", "values", "steps"))) for part in parts
    ]


def tune(network: IntNetwork, examples: list[Seen], steps: int, rate: float) -> IntNetwork:
    """The network whose means and scales make the examples of many pictures cheaper, as integers like `network`'s.

    A picture of n seeds weighs as n^0.6: neither alike nor by its size.
    """
    inputs = torch.from_numpy(np.concatenate([e.inputs for e in examples])).clamp(-INPUT_LIMIT, INPUT_LIMIT)
    values, sizes = (torch.from_numpy(np.concatenate([getattr(e, f) for e in examples])) for f in ("values", "steps"))
    weight = torch.cat([torch.full((len(e.inputs),), len(e.inputs) ** -0.4) for e in examples])
    weight /= weight.mean()
    unit = 2.0**-network.shift
    arrays = (network.w1, network.b1, network.w2, network.b2)
    weights = [torch.tensor(array * unit, dtype=torch.float32) for array in arrays]
    start = [tensor.clone() for tensor in weights]
    for tensor in weights:
        tensor.requires_grad_()
    optimizer = torch.optim.Adam(weights, rate)
    generator = torch.Generator().manual_seed(1)
    for step in range(steps):
        optimizer.param_groups[0]["lr"] = rate * min(1.0, 1.5 * (1 - step / steps)) + 1e-5
        batch = torch.randint(0, len(inputs), (BATCH,), generator=generator)
        x = inputs[batch] * 2.0**-INPUT_BITS
        bits, refine = _predicted(weights, x, values[batch], sizes[batch], network.predicted)
        with torch.no_grad():
            _, held = _predicted(start, x, values[batch], sizes[batch], network.predicted)
        loss = (bits * weight[batch]).mean() + HOLD * ((refine - held) ** 2).mean()
        optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        optimizer.step()
        if step % 500 == 0 or step == steps - 1:
            print(f"step {step:5d}  {float(bits.detach().mean()):.3f} bits per seed", flush=True)
    w1, b1, w2, b2 = (np.rint(tensor.detach().numpy().astype(np.float64) / unit).astype(np.int64) for tensor in weights)
    return IntNetwork(w1, b1, w2, b2, network.shift, network.predicted)


def _predicted(weights: list[Tensor], x: Tensor, values: Tensor, steps: Tensor, units: int) -> tuple[Tensor, Tensor]:
    """Bits of each seed's values and refinements r, in octaves, of inputs x [n, k]."""
    w1, b1, w2, b2 = weights
    out = torch.addmm(b2, torch.relu(torch.addmm(b1, x, w1.T)), w2.T)
    scale = torch.maximum(torch.exp2(out[:, units : 2 * units].clamp(-12, 12)), steps * 2.0**-4)
    return bits_laplace(values - out[:, :units], steps, scale).sum(dim=1), out[:, 2 * units :]


def _make_streams(pictures: Path, streams: Path, rounds: int, steps: int, threads: int) -> None:
    """Encodes every picture `rounds` times; what is there already stays."""
    rng = np.random.default_rng(11)
    paths = sorted(pictures.glob("*.png"))
    for number in range(rounds):
        for path in paths:
            lmbda, turn = float(np.exp(rng.uniform(*np.log(LMBDA_RANGE)))), int(rng.integers(8))
            out = streams / f"{path.stem}-{number}.sgi"
            if out.exists():
                continue
            picture = read(path)
            pixels = picture.pixels[:: -1 if turn & 2 else 1, :: -1 if turn & 1 else 1]
            turned = np.ascontiguousarray(pixels.swapaxes(0, 1) if turn & 4 else pixels)
            encoded = encode_picture(
                replace(picture, pixels=turned), EncodeSettings(lmbda=lmbda, steps=steps), device=Device(threads)
            )
            out.write_bytes(encoded.data)
            print(f"{out.name}  {len(encoded.data)} bytes  {encoded.seeds} seeds", flush=True)


def _examples(streams: Path) -> Iterator[list[Seen]]:
    for path in sorted(streams.glob("*.sgi")):
        with open_stream(path) as stream:
            if len(stream.model.layout) >= LEVELS:
                yield seen_in(stream.header, stream.model)


def main() -> None:
    """The command line of this module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", type=Path)
    parser.add_argument("streams", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--start", type=Path, required=True, help="the prior that streams were made with")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--fit-steps", type=int, default=300)
    parser.add_argument("--steps", type=int, default=6000)
    parser.add_argument("--rate", type=float, default=0.002)
    parser.add_argument("--threads", type=int, default=2)
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    arguments.streams.mkdir(parents=True, exist_ok=True)
    _make_streams(arguments.pictures, arguments.streams, arguments.rounds, arguments.fit_steps, arguments.threads)
    by_step = list(zip(*_examples(arguments.streams), strict=True))
    start = parse_prior(arguments.start.read_bytes())
    tuned = tuple(
        tune(net, list(seen), arguments.steps, arguments.rate) for net, seen in zip(start, by_step, strict=True)
    )
    print("sha256", write_prior(tuned, arguments.out))


if __name__ == "__main__":
    main()
