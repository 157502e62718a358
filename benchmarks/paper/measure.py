"""Measures jobs: every figure is that of a file on disk and of the picture that it decodes to, but for exact fits."""

from __future__ import annotations

import hashlib
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks._sized import best_within
from benchmarks._turns import median_seconds
from benchmarks.paper.jobs import REDUCTION, Job, Method
from benchmarks.paper.rows import PaperRow
from sgicodec import NullListener, encode_picture
from sgicodec.bench.codec import Pixels8
from sgicodec.bench.peers import PEERS
from sgicodec.bench.run import Sample
from sgicodec.bench.sgi import Run, SgiCodec, run_timed
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.errors import SgiError
from sgicodec.fit.trainer import Progress
from sgicodec.metrics.learned import learned_distance, network
from sgicodec.metrics.scores import scores
from sgicodec.picture import Picture
from sgicodec.profiles.paper import paper_parts

_DECODES = 3
"""Decodes of a stream by either clock, of which the median counts."""


class Coded(NamedTuple):
    """A file on disk, and what it took to make."""

    path: Path
    made: Run


class _LastStep(NullListener):
    psnr = 0.0

    def step(self, progress: Progress) -> bool:
        self.psnr = progress.psnr
        return True


@dataclass
class Bench:
    """Measures pictures, and keeps what it writes in a folder. quick: whether the default profile is at effort 1.

    Encodes are commands of their own, so that their seconds and their memory are not the benchmark's.
    """

    folder: Path
    threads: int
    quick: bool = False
    version: str = field(default_factory=lambda: SgiCodec().version())
    coded: dict[str, Coded] = field(default_factory=dict)

    def row(self, job: Job, sample: Sample, beside: PaperRow | None = None) -> PaperRow:
        """Measures a job. beside: the row whose bytes or PSNR are the goal, for the methods that have one.

        Raises SgiError if a command fails, or if the goal is missing.
        """
        if job.method is Method.EXACT:
            return self._exact(job, sample)
        if job.factor:
            return self._enlarged(job, sample)
        if job.method is Method.PAPER:
            return self._stream_row(job, sample, job.fit.options())
        if beside is None or beside.bytes is None:
            raise SgiError("there is no stream of the paper profile to compare with")
        if job.method is Method.JPEG:
            return self._jpeg(job, sample, beside.bytes)
        goal = ("--size", f"{beside.bytes}") if job.method is Method.DEFAULT_BYTES else ("--psnr", f"{beside.psnr:.3f}")
        effort = ("-e", "1") if self.quick else ()
        return self._stream_row(job, sample, (*goal, *effort, "--tune", "psnr", "--tile", "0"))

    def _exact(self, job: Job, sample: Sample) -> PaperRow:
        """A fit at λ = 0, where the profile draws no noise; its PSNR is of samples that are not rounded or clipped."""
        picture, last = Picture(sample.pixels, "rgb", (0.0, 255.0)), _LastStep()
        settings = replace(job.fit, lmbda=0.0).settings()
        began, cpu_began = time.monotonic(), time.process_time()
        encode_picture(picture, settings, progress=last, device=Device(self.threads))
        seconds, cpu = time.monotonic() - began, time.process_time() - cpu_began
        row = self._bare(job, sample, sample.pixels)
        return replace(row, psnr=last.psnr, fit_seconds=seconds, cpu_seconds=cpu)

    def _stream_row(self, job: Job, sample: Sample, options: Sequence[str]) -> PaperRow:
        coded = self._encoded(sample.pixels, options)
        return self._of_stream(self._compared(job, sample, sample.pixels, self._decoded(coded.path)), coded)

    def _enlarged(self, job: Job, sample: Sample) -> PaperRow:
        """A picture that was reduced, brought back to a larger size, beside the original reduced to that size."""
        height, width = (side // REDUCTION * REDUCTION for side in sample.pixels.shape[:2])
        original = reduced(sample.pixels[:height, :width], REDUCTION // job.factor)
        small = reduced(sample.pixels[:height, :width], REDUCTION)
        if job.method is Method.BILINEAR:
            return self._compared(job, sample, original, bilinear(small, job.factor))
        coded = self._encoded(small, job.fit.options())
        decoded = self._decoded(coded.path, float(job.factor))
        return self._of_stream(self._compared(job, sample, original, decoded), coded)

    def _jpeg(self, job: Job, sample: Sample, size: int) -> PaperRow:
        """JPEG at the best quality that takes no more bytes; at its least where even that takes more."""
        jpeg, pixels = PEERS["jpeg"], sample.pixels
        quality = best_within(jpeg.scale, lambda quality: len(jpeg.encode(pixels, quality)), size)
        path = self._path(pixels, f"jpeg {quality}").with_suffix(".jpg")
        began, cpu_began = time.perf_counter(), time.process_time()
        path.write_bytes(jpeg.encode(pixels, jpeg.scale[0] if quality is None else quality))
        made = Run(time.perf_counter() - began, None, time.process_time() - cpu_began)
        row = self._compared(job, sample, pixels, jpeg.decode(path.read_bytes()))
        return replace(row, bytes=path.stat().st_size, fit_seconds=made.seconds, cpu_seconds=made.cpu)

    def _encoded(self, pixels: Pixels8, options: Sequence[str]) -> Coded:
        """The stream that `sgi encode` makes with these options, once for each picture and options."""
        from PIL import Image

        path = self._path(pixels, " ".join(options))
        if path.name not in self.coded:
            source = path.with_suffix(".png")
            Image.fromarray(pixels).save(source, compress_level=1)
            command = [sys.executable, "-m", "sgicodec", "encode", str(source), str(path), *options]
            made = run_timed([*command, "-f", "--quiet", "--no-verify", "--threads", str(self.threads)])
            source.unlink()
            self.coded[path.name] = Coded(path, made)
        return self.coded[path.name]

    def _path(self, pixels: Pixels8, options: str) -> Path:
        """Where a stream lies, by what decides it."""
        digest = hashlib.sha256(f"{pixels.shape} {options} ".encode() + pixels.tobytes())
        return self.folder / f"{digest.hexdigest()[:16]}.sgi"

    def _decoded(self, path: Path, scale: float | None = None) -> Pixels8:
        with open_stream(path, Device(self.threads)) as stream:
            return np.asarray(stream.read(scale=scale))

    def _bare(self, job: Job, sample: Sample, original: Pixels8) -> PaperRow:
        """A row of nothing measured."""
        seeds = job.fit.seeds if job.method in (Method.PAPER, Method.EXACT) else 0
        height, width = original.shape[:2]
        return PaperRow(
            *job.key(sample.name, sample.crc),
            width=width,
            height=height,
            seeds=seeds,
            gaussians=seeds * job.fit.per_seed,
            steps=job.fit.steps,
            bytes=None,
            psnr=0.0,
            version=self.version,
        )

    def _compared(self, job: Job, sample: Sample, original: Pixels8, decoded: Pixels8) -> PaperRow:
        found = scores(original, decoded)
        return replace(
            self._bare(job, sample, original),
            psnr=found.psnr,
            ssim=found.ssim,
            lpips=learned_distance("lpips", original, decoded) if network("lpips") else None,
        )

    def _of_stream(self, row: PaperRow, coded: Coded) -> PaperRow:
        """A row with the bytes of a stream, its parts and its times."""
        with open_stream(coded.path) as stream:
            survey, is_paper = stream.survey(), stream.header.profile == "paper"
        decode = partial(self._decoded, coded.path)
        seconds, cpu = (
            median_seconds([decode], _DECODES, clock)[0] for clock in (time.perf_counter, time.process_time)
        )
        parts = paper_parts(survey.part_bytes) if is_paper else survey.part_bytes
        return replace(
            row,
            bytes=coded.path.stat().st_size,
            seeds=survey.seeds,
            fit_seconds=coded.made.seconds,
            cpu_seconds=coded.made.cpu,
            decode_seconds=seconds,
            decode_cpu_seconds=cpu,
            peak_mib=coded.made.peak,
            parts=";".join(f"{name}={size:.1f}" for name, size in parts.items()),
        )


def reduced(pixels: Pixels8, factor: int) -> Pixels8:
    """The picture in small: rounded means of squares. Sides are multiples of the factor."""
    height, width, channels = pixels.shape
    squares = pixels.reshape(height // factor, factor, width // factor, factor, channels)
    return np.asarray(np.rint(squares.mean(axis=(1, 3))), np.uint8)


def bilinear(pixels: Pixels8, factor: int) -> Pixels8:
    """The picture enlarged by bilinear interpolation."""
    from PIL import Image

    size = (pixels.shape[1] * factor, pixels.shape[0] * factor)
    return np.asarray(Image.fromarray(pixels).resize(size, Image.Resampling.BILINEAR))
