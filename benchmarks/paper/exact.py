"""The PSNR that a fit of the paper profile reaches where nothing is quantised and no bit counts: λ = 0."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from benchmarks.paper.jobs import PaperFit
from sgicodec import NullListener, encode_picture
from sgicodec.bench.codec import Pixels8
from sgicodec.device import Device
from sgicodec.fit.trainer import Progress
from sgicodec.picture import Picture

__all__ = ["ExactFit", "exact_fit"]


@dataclass(frozen=True)
class ExactFit:
    """psnr: in dB, after the last step, of samples that are not rounded or clipped; seconds: by the clock,
    cpu_seconds: of all processors.
    """

    psnr: float
    seconds: float
    cpu_seconds: float


class _LastStep(NullListener):
    psnr = 0.0

    def step(self, progress: Progress) -> bool:
        self.psnr = progress.psnr
        return True


def exact_fit(pixels: Pixels8, fit: PaperFit, threads: int) -> ExactFit:
    """Fits a picture [H, W, 3] at λ = 0, where the profile draws no noise."""
    picture, last = Picture(pixels, "rgb", (0.0, 255.0)), _LastStep()
    began, cpu_began = time.monotonic(), time.process_time()
    encode_picture(picture, replace(fit, lmbda=0.0).settings(), progress=last, device=Device(threads))
    return ExactFit(last.psnr, time.monotonic() - began, time.process_time() - cpu_began)
