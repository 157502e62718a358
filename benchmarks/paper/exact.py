"""The PSNR that a fit of the paper profile reaches where nothing is quantised and no bit counts."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from benchmarks.paper.jobs import PaperFit
from sgicodec.bench.codec import Pixels8
from sgicodec.device import Device
from sgicodec.encoder.plan import Shape, stream_plan
from sgicodec.encoder.tile_encoder import Encoding
from sgicodec.errors import SgiError
from sgicodec.fit.trainer import Progress
from sgicodec.picture import Picture
from sgicodec.profiles.fit_settings import FitSettings, Phase

__all__ = ["ExactFit", "exact_fit", "without_quantisation"]


@dataclass(frozen=True)
class ExactFit:
    """psnr: in dB, at full size after the last step, of samples that are not rounded or clipped; seconds: by the clock,
    cpu_seconds: of all processors.
    """

    psnr: float
    seconds: float
    cpu_seconds: float


def without_quantisation(fit: FitSettings) -> FitSettings:
    """The same phases with exact values, and no price on bits."""
    phases = tuple(Phase(phase.steps, phase.level) for phase in fit.phases)
    return replace(fit, phases=phases, lmbda=0.0)


def exact_fit(pixels: Pixels8, fit: PaperFit, threads: int) -> ExactFit:
    """Fits a picture [H, W, 3] at λ = 0 without noise. Raises SgiError if the fit has no step at full size."""
    picture = Picture(pixels, "rgb", (0.0, 255.0))
    plan = stream_plan(Shape.of(picture), fit.settings())
    began, cpu_began, psnr = time.monotonic(), time.process_time(), None
    encoding = Encoding(picture, plan, began, Device(threads))
    encoding.fit = without_quantisation(encoding.fit)
    last = encoding.fit.phases[-1]

    def note(progress: Progress) -> bool:
        nonlocal psnr
        psnr = progress.psnr
        return True

    encoding.fitted(note)
    if psnr is None or last.level:
        raise SgiError("the fit ended before a step at full size")
    return ExactFit(psnr, time.monotonic() - began, time.process_time() - cpu_began)
