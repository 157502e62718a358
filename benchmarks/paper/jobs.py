"""What each of the paper's tables takes: fits, and what they are measured beside."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from benchmarks.paper.rows import Key
from sgicodec.encoder.settings import EncodeSettings

RATES = {"low": 1800.0, "medium": 13300.0, "high": 43000.0}
"""Seeds per megapixel at K = 10: 50,000, 370,000 and 1.2 million Gaussians on a 2K picture. The paper prints no numbers
for DIV2K; these are its sizes there divided by its bytes for a Gaussian on FGF2 and ICB.
"""

CURVE = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Seeds of the points of a rate–distortion curve, in those of the low rate."""

REDUCTION, FACTORS = 8, (2, 4, 8)
"""How many times smaller the picture is that super-resolution starts from, and how many times it is enlarged."""

EXACT_GAUSSIANS, QUICK_GAUSSIANS = (10_000, 50_000), (100, 500)
"""Of the fits without quantisation."""

_FEATURES_PER_GAUSSIAN = 5
"""D and the width of the MLPs follow K, as in the paper, which prints no value; its authors take D = 50 for K = 10."""


class Method(StrEnum):
    """What made a row."""

    PAPER = "paper profile"
    EXACT = "paper profile, fit without quantisation"
    JPEG = "JPEG, equal bytes"
    DEFAULT_BYTES = "default profile, equal bytes"
    DEFAULT_PSNR = "default profile, equal PSNR"
    BILINEAR = "bilinear"


@dataclass(frozen=True)
class PaperFit:
    """A fit of the paper profile, whole picture: N, steps, K, λ, M. D follows K."""

    seeds: int
    steps: int
    per_seed: int = 10
    lmbda: float = 0.001
    levels: int = 3

    @property
    def features(self) -> int:
        """D."""
        return _FEATURES_PER_GAUSSIAN * self.per_seed

    def options(self) -> tuple[str, ...]:
        """Of `sgi encode`."""
        options = ((f"--{name.replace('_', '-')}", value) for name, value in self._choices().items())
        return tuple(str(word) if isinstance(word, str | int) else f"{word:g}" for pair in options for word in pair)

    def settings(self) -> EncodeSettings:
        """The same for the library."""
        return EncodeSettings(**self._choices())

    def _choices(self) -> dict[str, Any]:
        choices = {"profile": "paper", "tile": 0, "seeds": self.seeds, "steps": self.steps, "per_seed": self.per_seed}
        return choices | {"features": self.features, "levels": self.levels, "lmbda": self.lmbda}


@dataclass(frozen=True)
class Job:
    """A row to measure. fit: what it measures, or what gives the bytes or the PSNR that it is measured at. factor: how
    many times the decoded picture is enlarged, of the picture reduced by `REDUCTION`; 0 for the picture as it is.
    """

    table: str
    setting: str
    fit: PaperFit
    method: Method = Method.PAPER
    factor: int = 0

    def key(self, picture: str, crc: str) -> Key:
        """That of its row."""
        enlarged = f" reduced={REDUCTION} enlarged={self.factor}" if self.factor else ""
        return (picture, crc, self.table, self.setting, self.method, " ".join(self.fit.options()) + enlarged)

    def beside(self) -> Job | None:
        """The job whose bytes or PSNR are the goal, for the methods that have one."""
        has_goal = self.method in (Method.JPEG, Method.DEFAULT_BYTES, Method.DEFAULT_PSNR)
        return Job(self.table, self.setting, self.fit) if has_goal else None


@dataclass(frozen=True)
class Scope:
    """What a run measures. seeds: at K = 10, in the tables that follow the low rate; None for as many as suit the
    picture's pixels. rates: of the comparison.
    """

    steps: int
    seeds: int | None = None
    rates: Sequence[str] = tuple(RATES)
    quick: bool = False

    def fit(
        self, pixels: int, share: float = 1.0, per_seed: int = 10, lmbda: float = 0.001, levels: int = 3
    ) -> PaperFit:
        """A fit with as many Gaussians as the low rate has, times `share`."""
        seeds = _rounded(RATES["low"] * pixels / 1e6) if self.seeds is None else self.seeds
        return PaperFit(max(1, round(seeds * share * 10 / per_seed)), self.steps, per_seed, lmbda, levels)


def _rounded(value: float) -> int:
    """To two digits, so that pictures of about the same size have the same number."""
    return max(1, int(float(f"{value:.2g}")))


def _comparison(pixels: int, scope: Scope) -> list[Job]:
    fits = {rate: PaperFit(_rounded(RATES[rate] * pixels / 1e6), scope.steps) for rate in scope.rates}
    methods = (Method.PAPER, Method.JPEG, Method.DEFAULT_BYTES, Method.DEFAULT_PSNR)
    return [Job("comparison", rate, fit, method) for rate, fit in fits.items() for method in methods]


def _per_seed(pixels: int, scope: Scope) -> list[Job]:
    return [Job("per-seed", f"{k}", scope.fit(pixels, per_seed=k)) for k in (5, 10, 15, 20)]


def _lambda(pixels: int, scope: Scope) -> list[Job]:
    fits = {f"{lmbda:g}": scope.fit(pixels, lmbda=lmbda) for lmbda in (0.0, 0.0005, 0.001, 0.003)}
    return [Job("lambda", "0", fits["0"], Method.EXACT), *(Job("lambda", name, fit) for name, fit in fits.items())]


def _levels(pixels: int, scope: Scope) -> list[Job]:
    return [Job("levels", f"{levels}", scope.fit(pixels, levels=levels)) for levels in (1, 2, 3, 4)]


def _components(pixels: int, scope: Scope) -> list[Job]:
    shares = {"1": 1.0, "2": 2.0, "2.86": 20 / 7}
    return [Job("components", name, scope.fit(pixels, share)) for name, share in shares.items()]


def _rate_distortion(pixels: int, scope: Scope) -> list[Job]:
    fits = {f"{share:g}": scope.fit(pixels, share) for share in CURVE}
    return [
        Job("rate-distortion", share, fit, method)
        for share, fit in fits.items()
        for method in (Method.PAPER, Method.JPEG)
    ]


def _super_resolution(pixels: int, scope: Scope) -> list[Job]:
    fit, methods = scope.fit(pixels), (Method.PAPER, Method.BILINEAR)
    return [Job("super-resolution", f"×{factor}", fit, method, factor) for factor in FACTORS for method in methods]


def _decode(pixels: int, scope: Scope) -> list[Job]:
    return [Job("decode", "low", scope.fit(pixels))]


def _exact(pixels: int, scope: Scope) -> list[Job]:
    counts = QUICK_GAUSSIANS if scope.quick else EXACT_GAUSSIANS
    fits = {f"{count:,}": PaperFit(count // 10, scope.steps, lmbda=0.0) for count in counts}
    return [Job("exact", name, fit, Method.EXACT) for name, fit in fits.items()]


TABLES: dict[str, Callable[[int, Scope], list[Job]]] = {
    "comparison": _comparison,
    "per-seed": _per_seed,
    "lambda": _lambda,
    "levels": _levels,
    "components": _components,
    "rate-distortion": _rate_distortion,
    "super-resolution": _super_resolution,
    "decode": _decode,
    "exact": _exact,
}
"""By the name on the command line and in results: the jobs for a picture of so many pixels."""


def jobs(table: str, pixels: int, scope: Scope) -> list[Job]:
    """What a table takes of a picture; what others are measured beside comes first."""
    return TABLES[table](pixels, scope)
