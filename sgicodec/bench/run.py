"""The measurement: every picture by every codec at every point, written down as it comes."""

from __future__ import annotations

import dataclasses
import os
import time
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sgicodec.bench.codec import Pixels8
from sgicodec.bench.peers import Peer
from sgicodec.bench.published import PublishedCurves
from sgicodec.bench.rows import Key, Results, Row
from sgicodec.bench.sgi import SgiCodec
from sgicodec.bench.summary import Summary, summarise
from sgicodec.errors import PictureError, SgiError, UsageError
from sgicodec.metrics.perceptual import Perceived, perceived
from sgicodec.metrics.psnr import Pixels
from sgicodec.metrics.scores import scores

Codec = Peer | SgiCodec
"""At a ladder of qualities, by rising rate; the scale of `quality` is the codec's own."""

_SUFFIXES = {
    ".png",
    ".tif",
    ".tiff",
    ".ppm",
    ".pgm",
    ".bmp",
    ".jpg",
    ".jpeg",
    ".webp",
    ".tga",
    ".exr",
    ".pfm",
}


@dataclass(frozen=True)
class Sample:
    """One picture as every codec gets it."""

    name: str
    crc: str
    pixels: Pixels8

    @classmethod
    def of(cls, name: str, pixels: Pixels8) -> Sample:
        """With the checksum of its size and samples."""
        return cls(name, checksum(pixels), pixels)


def checksum(pixels: Pixels) -> str:
    """The CRC-32 of size and samples, in hexadecimal."""
    return f"{zlib.crc32(pixels.tobytes(), zlib.crc32(f'{pixels.shape[1]}x{pixels.shape[0]}:'.encode())):08x}"


def name_of(path: Path) -> str:
    """A file's name in rows: a tab, a line break or bytes that are no text would break them."""
    return " ".join(os.fsencode(path.name).decode("utf-8", "replace").split())


def find_pictures(places: Sequence[Path]) -> list[Path]:
    """The picture files among `places`, where a folder stands for those inside it in order of name.

    Raises UsageError for a folder without pictures and for a place that does not exist.
    """
    pictures: list[Path] = []
    for place in places:
        if place.is_dir():
            inside = sorted(path for path in place.iterdir() if path.suffix.lower() in _SUFFIXES)
            if not inside:
                raise UsageError(f"{place} holds no pictures")
            pictures += inside
        elif place.exists():
            pictures.append(place)
        else:
            raise UsageError(f"{place} does not exist")
    return pictures


def to_rgb(pixels: Pixels8) -> Pixels8:
    """The RGB picture [H, W, 3] that every codec can code, from samples [H, W, C].

    One or two channels are gray; channels after the third (alpha, infrared) are left out.
    """
    colours = np.repeat(pixels[..., :1], 3, axis=2) if pixels.shape[2] < 3 else pixels[..., :3]
    return np.ascontiguousarray(colours)


def run_bench(
    pictures: Sequence[Path],
    codecs: Sequence[Codec],
    out_dir: Path,
    *,
    published: Sequence[PublishedCurves] = (),
    report: Callable[[str], None] = lambda line: None,
) -> Summary:
    """Measure what `out_dir/results.tsv` does not hold yet; return what follows from this run's points.

    `published` curves are added to the summary where they have the picture.
    A point that a codec fails on is reported and listed in the summary; the run goes on. `report` gets one
    line for each picture and each failure. Raises UsageError for an unusable results file or a missing
    codec, and PictureError for an unreadable picture.
    """
    out_dir.mkdir(parents=True, exist_ok=True)
    results = Results(out_dir / "results.tsv")
    versions = {codec.name: codec.version() for codec in codecs}
    if len(versions) < len(codecs):
        raise UsageError("two codecs have the same name; give each setting once")
    chosen: list[Row] = []
    failures: list[str] = []
    for number, path in enumerate(pictures, 1):
        sample = load_sample(path)
        start, measured = time.perf_counter(), 0
        points = list(_points(sample, codecs, versions))
        missing = [point for point in points if not _is_complete(results.rows.get(point[0]))]
        for key, codec, quality in missing:
            try:
                row = _measure(sample, codec, quality, key)
            except SgiError as error:
                failures.append(f"{sample.name}, {codec.name}, {codec.settings(quality)}: {error}")
                report(failures[-1])
                continue
            measured += 1
            results.append(row)
        chosen += [results.rows[key] for key, _, _ in points if key in results.rows]
        height, width = sample.pixels.shape[:2]
        for curves in published:
            chosen += curves.rows(sample.name, sample.crc, width, height)
        report(
            f"{number}/{len(pictures)} {sample.name} {width}x{height}: {measured} points measured, "
            f"{len(points) - len(missing)} already there, {time.perf_counter() - start:.1f} s"
        )
    known = {row.codec for row in chosen}
    names = [codec.name for codec in codecs] + [curves.name for curves in published if curves.name in known]
    return summarise(chosen, names, failures)


def _is_complete(row: Row | None) -> bool:
    """Whether a row is there and has all that this machine can measure."""
    if row is None:
        return False
    return all(getattr(row, name) is not None for name in Perceived.available(min(row.width, row.height)))


def load_sample(path: Path) -> Sample:
    """The picture in a file. Raises PictureError if it cannot be read."""
    from sgicodec.image.reader import read
    from sgicodec.picture import convert

    return Sample.of(name_of(path), to_rgb(convert(read(path), 8).pixels))


def _points(sample: Sample, codecs: Sequence[Codec], versions: dict[str, str]) -> Iterator[tuple[Key, Codec, float]]:
    for codec in codecs:
        for quality in codec.ladder:
            key = (codec.name, versions[codec.name], codec.settings(quality), sample.name, sample.crc)
            yield key, codec, quality


def _measure(sample: Sample, codec: Codec, quality: float, key: Key) -> Row:
    trip = codec.round_trip(sample.pixels, quality)
    if trip.pixels.shape != sample.pixels.shape:
        raise PictureError(f"{codec.name} gave back an array of shape {trip.pixels.shape}")
    height, width = sample.pixels.shape[:2]
    found, seen = scores(sample.pixels, trip.pixels), perceived(sample.pixels, trip.pixels)
    return Row(
        *key,
        width=width,
        height=height,
        quality=quality,
        bytes=len(trip.data),
        bpp=8 * len(trip.data) / (width * height),
        encode_seconds=trip.encode_seconds,
        decode_seconds=trip.decode_seconds,
        memory_mib=trip.peak_mib,
        **(dataclasses.asdict(found) | dataclasses.asdict(seen)),
    )
