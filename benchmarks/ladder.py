"""What each effort takes and gives beside AVIF and JPEG XL: seconds a megapixel, bytes at equal SSIMULACRA 2."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from statistics import fmean

import click
import numpy as np
from numpy.typing import NDArray

from benchmarks._turns import median_seconds
from sgicodec import EncodeSettings, Picture, encode_picture, read
from sgicodec._native import keep_freed_memory
from sgicodec.bench.codec import Pixels8
from sgicodec.bench.peers import PEERS, Peer
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.encoder.progress import NullListener
from sgicodec.metrics.visual_score import VisualReference


@dataclass(frozen=True)
class Point:
    """One encode. cpu, wall: seconds a megapixel of all processors and by the clock; decode: milliseconds a megapixel
    of all processors; stages: cpu by stage.
    """

    bytes: int
    score: float
    cpu: float
    wall: float
    decode: float
    stages: dict[str, float] = field(default_factory=dict)


class Stages(NullListener):
    """Processor seconds of each stage of an encode."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self._name, self._since = "start", time.process_time()

    def stage(self, name: str) -> None:
        """The last one ends."""
        now = time.process_time()
        self.seconds[self._name] += now - self._since
        self._name, self._since = name, now


@dataclass(frozen=True)
class Rung:
    """A codec at one setting: it makes of a picture at a quality its bytes, and pixels of these."""

    name: str
    qualities: tuple[float, ...]
    encode: Callable[[Picture, float, Stages], bytes]
    decode: Callable[[bytes], Pixels8]


def sgi_rung(effort: int, qualities: tuple[float, ...], device: Device) -> Rung:
    """sgi at an effort."""

    def encode(picture: Picture, quality: float, stages: Stages) -> bytes:
        settings = EncodeSettings(quality=quality, effort=effort)
        return encode_picture(picture, settings, progress=stages, device=device).data

    def decode(data: bytes) -> Pixels8:
        with open_stream(data, device) as stream:
            return np.asarray(stream.picture().pixels, np.uint8)

    return Rung(f"sgi -e {effort}", qualities, encode, decode)


def peer_rung(peer: Peer) -> Rung:
    """A peer at the middle of its ladder."""

    def encode(picture: Picture, quality: float, stages: Stages) -> bytes:
        return peer.encode(np.asarray(picture.pixels, np.uint8), quality)

    return Rung(peer.name, tuple(peer.ladder[2:-1]), encode, peer.decode)


def measure(rung: Rung, picture: Picture, reference: VisualReference, repeat: int) -> list[Point]:
    """A picture at each quality of a rung. Decodes are the median of `repeat`, after one that finds memory."""
    megapixels = picture.width * picture.height / 1e6
    points = []
    for quality in rung.qualities:
        stages = Stages()
        cpu, wall = time.process_time(), time.perf_counter()
        data = rung.encode(picture, quality, stages)
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
        stages.stage("end")
        (decoding,) = median_seconds([partial(rung.decode, data)], repeat, time.process_time)
        score = reference.score(_planes(rung.decode(data)))
        by_stage = {name: seconds / megapixels for name, seconds in stages.seconds.items() if seconds > 0}
        decode = 1e3 * decoding / megapixels
        points.append(Point(len(data), score, cpu / megapixels, wall / megapixels, decode, by_stage))
    return points


def _planes(pixels: Pixels8) -> NDArray[np.float32]:
    """Samples [C, H, W] in 0..1 of the colours of pixels [H, W, C]."""
    return np.ascontiguousarray(pixels[..., :3].transpose(2, 0, 1), np.float32) / np.float32(255)


def bytes_at(points: Sequence[Point], score: float) -> float:
    """Bytes for a score, by straight lines of the logarithm over scores; beyond the points by the nearest line."""
    known = sorted((point.score, float(np.log(point.bytes))) for point in points)
    scores, logs = np.array([score for score, _ in known]), np.array([log for _, log in known])
    at = int(np.clip(np.searchsorted(scores, score), 1, len(scores) - 1))
    part = (score - scores[at - 1]) / max(scores[at] - scores[at - 1], 1e-9)
    return float(np.exp(logs[at - 1] + part * (logs[at] - logs[at - 1])))


@click.command()
@click.argument("pictures", nargs=-1, required=True, type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--efforts", default="1,2,3,4,5", show_default=True, help="Of sgi, the first is compared with.")
@click.option("--qualities", default="50,65", show_default=True, help="Of sgi, two at least.")
@click.option("--threads", default=1, show_default=True, type=click.IntRange(1))
@click.option("--repeat", default=3, show_default=True, type=click.IntRange(1), help="Decodes; medians are printed.")
@click.option("--peers/--no-peers", default=True, show_default=True, help="AVIF and JPEG XL as well.")
@click.option("--stages", is_flag=True, help="Print what stages take, too.")
def main(
    pictures: tuple[Path, ...], efforts: str, qualities: str, threads: int, repeat: int, peers: bool, stages: bool
) -> None:
    """Encode 8-bit colour PICTURES with every effort and print, as Markdown, bytes at the mean score of the first
    effort, and how many bytes a doubling of the seconds saves.
    """
    keep_freed_memory()  # as the command does
    wanted = tuple(float(quality) for quality in qualities.split(","))
    device = Device(threads)
    rungs = [sgi_rung(int(effort), wanted, device) for effort in efforts.split(",")]
    rungs += [peer_rung(PEERS["avif-iq"]), peer_rung(PEERS["jxl"])] if peers else []
    found: dict[str, dict[str, list[Point]]] = {rung.name: {} for rung in rungs}
    scores: dict[str, float] = {}
    for path in pictures:
        picture = read(path)
        reference = VisualReference(_planes(np.asarray(picture.pixels, np.uint8)), device)
        for rung in rungs:
            found[rung.name][path.stem] = measure(rung, picture, reference, repeat)
        scores[path.stem] = fmean(point.score for point in found[rungs[0].name][path.stem])
    _print_ladder(found, scores)
    if stages:
        _print_stages(found)


def _print_ladder(found: dict[str, dict[str, list[Point]]], scores: dict[str, float]) -> None:
    """A row for each rung: means over pictures, then bytes of each picture next to the first rung's."""
    names = list(scores)
    titles = ["", "processor s/MP", "wall s/MP", "decode ms/MP", "bytes", "of a doubling", *names]
    click.echo("| " + " | ".join(titles) + " |\n|---|" + "---:|" * (len(titles) - 1))
    first = next(iter(found.values()))
    before: tuple[float, float] | None = None
    for name, by_picture in found.items():
        points = [point for some in by_picture.values() for point in some]
        cpu, wall, decode = (fmean(getattr(point, kind) for point in points) for kind in ("cpu", "wall", "decode"))
        logs = [float(np.log(bytes_at(by_picture[p], scores[p]) / bytes_at(first[p], scores[p]))) for p in names]
        log, doubling = fmean(logs), "–"
        if name.startswith("sgi"):
            if before is not None and cpu > before[0]:
                doubling = _percent((log - before[1]) / float(np.log2(cpu / before[0])))
            before = cpu, log
        cells = [name, f"{cpu:.2f}", f"{wall:.2f}", f"{decode:.0f}", _percent(log), doubling, *map(_percent, logs)]
        click.echo("| " + " | ".join(cells) + " |")
    click.echo("\nAt SSIMULACRA 2 of " + ", ".join(f"{score:.1f} ({name})" for name, score in scores.items()) + ".")


def _print_stages(found: dict[str, dict[str, list[Point]]]) -> None:
    """Processor seconds of stages, means over pictures."""
    stages = list(dict.fromkeys(s for one in found.values() for some in one.values() for p in some for s in p.stages))
    click.echo("\n| processor s/MP | " + " | ".join(stages) + " |\n|---|" + "---:|" * len(stages))
    for name, by_picture in found.items():
        points = [point for some in by_picture.values() for point in some]
        if name.startswith("sgi"):
            cells = [f"{fmean(point.stages.get(stage, 0.0) for point in points):.2f}" for stage in stages]
            click.echo(f"| {name} | " + " | ".join(cells) + " |")


def _percent(log: float) -> str:
    return f"{100 * (float(np.exp(log)) - 1):+.1f} %".replace("-", "−")
