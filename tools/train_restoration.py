"""Trains a network that restores pixels (docs/format.md, "Restoration"): for least squared error, or for the eye.

    python -m tools.train_restoration PICTURES_DIR STREAMS_DIR OUT.bin --tune psnr

A small network begins best as the pupil of a larger one: --teacher FILE has it learn what that one adds.

Every picture is encoded at some qualities; streams that lie in STREAMS_DIR already are taken as they are. They are
drawn without a correction, and the network learns what their pixels lack, in crops that are turned at random. In the
last part of the training it computes in the integers of its file.

For the eye, the loss is in logarithms of bytes: what SSIMULACRA 2 lacks, by the slope of each picture's own curve, and
a share of the logarithm of the squared error. Crops are large, for SSIMULACRA 2 scores small ones differently. The
network that is shipped for the eye began with Butteraugli as well (docs/notes/2026-11-restoration.md); commit 6df7d7c1
is the last that has its gradient.
"""

from __future__ import annotations

import argparse
import hashlib
import math
import random
from collections.abc import Callable
from dataclasses import dataclass, replace
from io import BytesIO
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from sgicodec import read
from sgicodec.bitstream.parts.tile import write_tile
from sgicodec.bitstream.parts.tile_chunk import encode_tile_chunk
from sgicodec.bitstream.stream_writer import write_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.device import ONE_THREAD, Device
from sgicodec.encoder.effort import Tune
from sgicodec.encoder.pipeline import encode_picture
from sgicodec.encoder.settings import EncodeSettings
from sgicodec.metrics.visual_score import VisualReference
from sgicodec.model.colours import to_channels
from sgicodec.rdoq.objective import with_values
from tools.restoration_file import RestorationNet, file_of, network_of

MIN_ERROR = 0.003
"""Squared error, in squared steps, that is added so that flat crops do not rule."""
MIN_MISSED = 1e-4
"""The same of what a pupil misses of its teacher's correction."""
MIN_SLOPE, MIN_SCORE = 2.0, -10.0
"""Of a picture's curve, points per unit of log bytes, and of a stream that still teaches something."""
REPORT = 100
"""Batches between lines of progress."""


@dataclass(frozen=True)
class Training:
    """How streams are made and learned from. side: of crops, in pixels, `batch` at a time; warming: share of the
    batches in which the rate rises; most_gradient: to which gradients are clipped.
    """

    qualities: tuple[int, ...]
    effort: int
    side: int
    batch: int
    rate: float
    warming: float
    most_gradient: float = math.inf


TRAININGS: dict[Tune, Training] = {
    "psnr": Training((30, 42, 54, 66), 2, 64, 16, 2e-3, 0.3),
    "visual": Training((45, 57, 70, 83), 4, 256, 2, 1e-3, 0.1, 0.5),
}


def of_pupils(training: Training) -> Training:
    """How a pupil learns from the streams of a training: in small crops."""
    return replace(training, side=64, batch=6, rate=4e-3, warming=0.2, most_gradient=math.inf)


@dataclass(frozen=True)
class Example:
    """A picture and what a stream without correction shows of it, or a crop of both [3, H, W], in samples of 0..1.

    channels [3, 3]: from samples to the channels that a network sees; step: the stream's; size: its bytes; score: its
    SSIMULACRA 2 and slope: how much that grows with the logarithm of bytes, where they are known.
    """

    name: str
    original: Tensor
    drawn: Tensor
    channels: Tensor
    step: float
    size: int
    score: float = 0.0
    slope: float = 1.0

    def crop(self, side: int, source: random.Random) -> Example:
        """A square of it, mirrored and turned at random."""
        top, left = (source.randrange(extent - side + 1) for extent in self.drawn.shape[1:])
        flips = [axis for axis in (1, 2) if source.random() < 0.5]
        turns = source.random() < 0.5

        def cut(planes: Tensor) -> Tensor:
            part = planes[:, top : top + side, left : left + side].flip(flips)
            return (part.transpose(1, 2) if turns else part).contiguous()

        return replace(self, original=cut(self.original), drawn=cut(self.drawn))


SQUARED = 0.15
"""What the squared error counts for the eye, in shares of what SSIMULACRA 2 counts."""

Loss = Callable[[Example, Tensor], Tensor]


def squared_loss(crop: Example, shown: Tensor) -> Tensor:
    """The logarithm of the squared error, in squared steps."""
    return torch.log(((shown - crop.original) / crop.step).square().mean() + MIN_ERROR)


def visual_loss(crop: Example, shown: Tensor, squared: float) -> Tensor:
    """What a crop as it is shown lacks for the eye, in logarithms of bytes."""
    pixels, original = shown.detach().contiguous(), crop.original.numpy()
    score, slopes = VisualReference(original, ONE_THREAD).gradient(pixels.numpy())
    loss = -(score + ((shown - pixels) * torch.from_numpy(slopes)).sum()) / crop.slope
    return loss + squared * torch.log((shown - crop.original).square().mean() + 1e-12)


def taught_loss(teacher: RestorationNet) -> Loss:
    """The logarithm of what a pupil misses of its teacher's correction, in squared steps."""
    teacher.rounds = True

    def loss(crop: Example, pupil: Tensor) -> Tensor:
        with torch.no_grad():
            (aim,) = shown(teacher, [crop])
        return torch.log(((pupil - aim) / crop.step).square().mean() + MIN_MISSED)

    return loss


def loss_of(tune: Tune, squared: float = SQUARED) -> Loss:
    """What a network of this tuning learns by."""
    if tune == "psnr":
        return squared_loss
    return lambda crop, shown: visual_loss(crop, shown, squared)


def without_correction(stream: bytes) -> bytes:
    """A stream of one tile that shows its pixels as they are drawn."""
    with open_stream(stream, ONE_THREAD) as opened:
        header, model = opened.header, opened.model
    if not header.spec.restoration:
        return stream
    model = replace(with_values(header.spec, model, model.decoded_values), restoration=None)
    header = replace(header, spec=replace(header.spec, restoration=False))
    payload, _ = write_tile(header, model)
    file = BytesIO()
    write_stream(file, header, b"", None, [encode_tile_chunk(header, 0, None, payload)])
    return file.getvalue()


def make_streams(pictures: Path, streams: Path, tune: Tune, training: Training, device: Device) -> None:
    """Encodes every picture at every quality; what is there already stays."""
    streams.mkdir(parents=True, exist_ok=True)
    for path in sorted(pictures.glob("*.png")):
        for quality in training.qualities:
            out = streams / f"{path.stem}-{quality}.sgi"
            if out.exists():
                continue
            settings = EncodeSettings(
                quality=quality, effort=training.effort, tune=tune, tile=0, metadata=False, overview=False
            )
            out.write_bytes(without_correction(encode_picture(read(path), settings, device=device).data))
            print(f"{out.name}  {out.stat().st_size} bytes", flush=True)


def examples_of(pictures: Path, streams: Path, device: Device) -> list[Example]:
    """All streams of colour pictures that have texture."""
    found: list[Example] = []
    for path in sorted(pictures.glob("*.png")):
        original: Tensor | None = None
        for file in sorted(streams.glob("*.sgi")):
            if file.stem.rpartition("-")[0] != path.stem:
                continue
            with open_stream(file, device) as stream:
                spec, texture = stream.header.spec, stream.model.texture
                if texture is None or spec.channels != 3:
                    continue
                drawn = _planes(stream.render())
            if original is None:
                picture = read(path)
                original = _planes(picture.pixels) / np.iinfo(picture.pixels.dtype).max
            step = float(texture.steps.of_channels.flat[0])
            channels = torch.from_numpy(to_channels(spec).astype(np.float32))
            found.append(Example(path.stem, original, drawn, channels, step, file.stat().st_size))
    return found


def _planes(samples: NDArray[Any]) -> Tensor:
    return torch.from_numpy(np.ascontiguousarray(samples.transpose(2, 0, 1), np.float32))


def with_slopes(examples: list[Example], device: Device) -> list[Example]:
    """The examples with their scores and slopes, without those that are worth nothing or the only one of a picture."""
    found: list[Example] = []
    for _, group in groupby(examples, lambda example: example.name):
        members = sorted(group, key=lambda example: example.size)
        if len(members) < 2:
            continue
        reference = VisualReference(members[0].original.numpy(), device)
        scores = [reference.score(member.drawn.numpy()) for member in members]
        slopes = np.gradient(scores, np.log([member.size for member in members]))
        known = zip(members, scores, np.maximum(slopes, MIN_SLOPE), strict=True)
        found += [replace(m, score=score, slope=float(slope)) for m, score, slope in known if score > MIN_SCORE]
    return found


def shown(network: RestorationNet, crops: list[Example]) -> list[Tensor]:
    """What crops of one size look like behind the network."""
    seen = [torch.tensordot(crop.channels, crop.drawn, 1) / crop.step for crop in crops]
    corrections = network(torch.stack(seen))
    return [
        crop.drawn + torch.tensordot(torch.linalg.inv(crop.channels), own * crop.step, 1)
        for crop, own in zip(crops, corrections, strict=True)
    ]


def train(
    network: RestorationNet, examples: list[Example], loss: Loss, training: Training, steps: int, rounds: float
) -> list[float]:
    """Trains a network in so many batches, the last part, from this share on, as it rounds. Returns by how much each
    batch's loss is larger without the correction. Raises ValueError where no example is large enough.
    """
    examples = [example for example in examples if min(example.drawn.shape[1:]) >= training.side]
    if not examples:
        raise ValueError(f"no stream with texture of a picture of {training.side} pixels or more")
    source = random.Random(0)
    optimizer = torch.optim.Adam(network.parameters(), training.rate)
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimizer, training.rate, total_steps=steps, pct_start=training.warming
    )
    gains: list[float] = []
    for step in range(steps):
        network.rounds = step >= rounds * steps
        crops = [source.choice(examples).crop(training.side, source) for _ in range(training.batch)]
        lost = torch.stack([loss(crop, own) for crop, own in zip(crops, shown(network, crops), strict=True)]).mean()
        with torch.no_grad():
            before = torch.stack([loss(crop, crop.drawn) for crop in crops]).mean()
        optimizer.zero_grad()
        lost.backward()  # type: ignore[no-untyped-call]
        torch.nn.utils.clip_grad_norm_(network.parameters(), training.most_gradient)
        optimizer.step()
        schedule.step()
        gains.append(float(before - lost.detach()))
        if step % REPORT == REPORT - 1 or step == steps - 1:
            print(f"batch {step + 1:5d}  loss lower by {float(np.mean(gains[-REPORT:])):.4f}", flush=True)
    return gains


def main() -> None:
    """The command line of this module."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", type=Path)
    parser.add_argument("streams", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--tune", choices=sorted(TRAININGS), required=True)
    parser.add_argument("--start", type=Path, help="a network to begin with")
    parser.add_argument("--teacher", type=Path, help="a network whose pupil it is")
    parser.add_argument("--channels", type=int, default=16, help="of hidden layers")
    parser.add_argument("--layers", type=int, default=4)
    parser.add_argument("--steps", type=int, default=5000, help="batches")
    parser.add_argument("--rate", type=float, help="of learning, at most")
    parser.add_argument("--rounds", type=float, default=0.4, help="share of the batches before it rounds")
    parser.add_argument("--squared", type=float, default=SQUARED, help="weight, for the eye")
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    torch.manual_seed(0)
    device, training = Device(options.threads), TRAININGS[options.tune]
    training = of_pupils(training) if options.teacher else training
    training = replace(training, rate=options.rate or training.rate)
    make_streams(options.pictures, options.streams, options.tune, training, device)
    examples = examples_of(options.pictures, options.streams, device)
    if options.tune == "visual":
        examples = with_slopes(examples, device)
    print(f"{len(examples)} streams", flush=True)
    fresh = options.start is None
    network = RestorationNet(options.channels, options.layers) if fresh else network_of(options.start.read_bytes())
    loss = loss_of(options.tune, options.squared)
    if options.teacher:
        loss = taught_loss(network_of(options.teacher.read_bytes()))
    train(network, examples, loss, training, options.steps, options.rounds)
    file = file_of(network)
    options.out.write_bytes(file)
    print("sha256", hashlib.sha256(file).hexdigest())


if __name__ == "__main__":
    main()
