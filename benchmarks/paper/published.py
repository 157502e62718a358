"""The figures that the paper prints, each with the table or figure that it stands in.

Its MB is 2²⁰ bytes: LIG stores 8 floats for each of 3.5 million Gaussians, which the paper gives as 106.81 MB. Minutes
are those of an NVIDIA A10.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Published:
    """A row of a comparison: PSNR in dB, minutes of optimisation, size in MiB."""

    method: str
    psnr: float
    ssim: float
    lpips: float
    minutes: float
    mib: float


@dataclass(frozen=True)
class Ablation:
    """A row of an ablation, by picture set (FGF2, ICB): PSNR in dB, size in MiB, minutes. None: not printed."""

    psnr: tuple[float, float]
    mib: tuple[float, float] | None = None
    minutes: tuple[float, float] | None = None


@dataclass(frozen=True)
class Exact:
    """PSNR of a fit that is not quantised, mean of a picture set; pixels: of its pictures, in the mean."""

    method: str
    pictures: str
    gaussians: int
    pixels: float
    psnr: float


COMPARISON = (
    Published("SIREN", 24.71, 0.6432, 0.5019, 28.37, 0.45),
    Published("GaussianImage", 35.22, 0.9327, 0.1469, 21.91, 3.07),
    Published("LIG", 44.87, 0.9904, 0.0113, 9.97, 15.26),
    Published("SGI, low", 28.69, 0.8206, 0.3163, 3.31, 0.33),
    Published("SGI, medium", 37.72, 0.9643, 0.0778, 6.80, 1.82),
    Published("SGI, high", 44.03, 0.9872, 0.0298, 15.64, 5.40),
)
"""Table A3: DIV2K, whose pictures have about 2.8 megapixels. It does not say how many Gaussians each rate has."""

WITHOUT_FIGURES = ("COIN",)
"""Methods that the paper draws in its rate–distortion curves (Figure 5) without a figure in print."""

PER_SEED = {
    "5": Ablation((31.29, 35.03), (18.48, 13.64), (44.27, 44.70)),
    "10": Ablation((31.24, 35.27), (16.33, 12.30), (48.43, 44.75)),
    "15": Ablation((30.61, 34.88), (15.32, 11.48), (55.33, 50.60)),
    "20": Ablation((30.62, 34.57), (14.83, 10.87), (56.02, 53.37)),
}
"""Table 3, Gaussians of a seed: 3.5 million Gaussians, FGF2 and ICB."""

LAMBDA = {
    "0": Ablation((32.36, 36.13), (104.08, 102.35)),
    "0.0005": Ablation((31.30, 35.48), (18.93, 14.90)),
    "0.001": Ablation((31.24, 35.27), (16.33, 12.30)),
    "0.003": Ablation((30.21, 33.51), (11.93, 8.34)),
}
"""Table 4, λ. λ = 0 is stored as floats, without entropy coding."""

LEVELS = {
    "1": Ablation((30.58, 35.02), minutes=(71.59, 70.63)),
    "2": Ablation((30.60, 35.06), minutes=(55.96, 49.90)),
    "3": Ablation((31.24, 35.27), minutes=(48.43, 44.75)),
    "4": Ablation((30.56, 33.78), minutes=(42.27, 37.67)),
}
"""Table 5, levels of the pyramid."""

COMPONENTS = {
    3_500_000: {"x_a": 0.9995, "f_a": 7.8689, "{s_o, s_a}": 1.5427, "δ": 5.7646, "H": 0.0293, "MLPs": 0.1273},
    7_000_000: {"x_a": 1.8360, "f_a": 15.5719, "{s_o, s_a}": 2.4960, "δ": 11.0664, "H": 0.0292, "MLPs": 0.1273},
    10_000_000: {"x_a": 2.4442, "f_a": 20.5720, "{s_o, s_a}": 3.3549, "δ": 15.2157, "H": 0.0298, "MLPs": 0.1273},
}
"""Table 6, MiB of each part by number of Gaussians, FGF2."""

JPEG_AT_LOW_RATE = {"JPEG": (0.296, 22.77), "SGI": (0.245, 26.09)}
"""Figure 4: bits per pixel and PSNR of a picture of ICB."""

SUPER_RESOLUTION = {
    "bilinear": {2: 28.40, 4: 27.24, 8: 26.86},
    "SGI": {2: 28.88, 4: 27.58, 8: 27.17},
}
"""Table A2: PSNR by factor, a picture of DIV2K that was reduced 8 times, 50,000 Gaussians."""

DECODE_MILLISECONDS = {"arithmetic coding": 80.0, "all": 88.0}
"""Appendix, "Analysis of Inference Time": 50,000 Gaussians on a 2K picture, on the A10."""

EXACT = (
    Exact("GaussianImage", "FGF2", 3_500_000, 51e6, 27.30),
    Exact("LIG", "FGF2", 3_500_000, 51e6, 32.10),
    Exact("SGI, λ = 0", "FGF2", 3_500_000, 51e6, 32.36),
    Exact("GaussianImage", "ICB", 3_500_000, 33.4e6, 31.09),
    Exact("LIG", "ICB", 3_500_000, 33.4e6, 36.40),
    Exact("SGI, λ = 0", "ICB", 3_500_000, 33.4e6, 36.13),
    Exact("LIG", "DIV2K", 500_000, 2.77e6, 44.87),
)
"""Tables 1, 4 and A3. GaussianImage is quantised, LIG and SGI at λ = 0 are not. How many Gaussians LIG has on DIV2K
follows from its 15.26 MB and 32 bytes for each.
"""
