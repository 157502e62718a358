"""What an encode may be asked for."""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass, replace
from numbers import Integral, Real
from typing import Any, Literal

from sgicodec.bitstream.header import MAX_APRON, MAX_SIDE, MIN_TILE
from sgicodec.encoder.effort import DEFAULT_EFFORT, Effort, Tune, effort_of, steps_of
from sgicodec.errors import UsageError
from sgicodec.model.spec import ModelSpec
from sgicodec.model.tile_grid import TileGrid
from sgicodec.profiles.default import DEFAULT_QUALITY, default_settings, default_spec, lmbda_of_quality
from sgicodec.profiles.fit_settings import FitSettings
from sgicodec.profiles.paper import PAPER_STEPS, paper_settings, paper_spec
from sgicodec.rate_control.target import TARGETS, RateTarget

TILE, _MAX_PIXELS_OF_ONE, _MAX_SIDE_OF_ONE = 1024, 1 << 22, 1 << 14
"""Pixels of a tile's side, where nothing else is asked for, and those of the largest picture that is then one tile, and
of its longer side: the base layer is fitted by a solve that takes the cube of it."""

APRON = 4
"""Pixels that a tile reaches over its neighbours, where nothing else is asked for: 8 take 0.5 to 1 % more bytes of
large pictures, 0 show seams (docs/notes/2026-11-large-pictures.md, "Half the overlap")."""

_MAX_LMBDA = 1e18
"""More than the squared error that any picture can have."""

_KINDS: dict[str, tuple[type, str]] = {
    "int": (Integral, "an integer"),
    "float": (Real, "a number"),
    "bytes": (bytes, "the bytes of a file"),
    "Tune": (str, "a name"),
    "Literal": (str, "a name"),
}
"""What settings are, by their annotations, and how a message says so."""

_OF_ONE_PROFILE = dict.fromkeys(("prior", "restoration"), "default")
_OF_ONE_PROFILE |= dict.fromkeys(("seeds", "per_seed", "features", "levels"), "paper")
"""Settings that no other profile has."""


@dataclass(frozen=True)
class EncodeSettings:
    """What an encode may be asked for. None means what the profile says, or what suits the picture."""

    quality: float | None = None
    """1 to 100, by which λ follows in the default profile: 50, but with `max_error` as little as can be where exact
    pixels show the picture at every scale, and 98 or somewhat less where it was a JPEG file.
    """
    lmbda: float | None = None
    """λ itself: squared error, samples in 0..1, that one bit must save."""
    effort: int = DEFAULT_EFFORT
    """1 to 9: steps of the fit, and what follows from them (`effort.py`), in the default profile."""
    profile: Literal["default", "paper"] = "default"
    """Which model, and how it is fitted."""
    seeds: int | None = None
    """Number of seeds, in the paper profile."""
    per_seed: int | None = None
    """K: Gaussians of each seed, 1 to 64, in the paper profile."""
    features: int | None = None
    """D: features of each seed, 1 to 512, in the paper profile."""
    levels: int | None = None
    """M: levels of the pyramid that it is fitted at, 1 to 4, in the paper profile."""
    steps: int | None = None
    """Optimisation steps of the whole fit, instead of an effort."""
    rdoq: bool = True
    """Whether RDOQ follows the fit, where it knows the model."""
    texture: bool = True
    """Whether the default profile lays cosines over its seeds where that is cheaper."""
    restoration: bool | None = None
    """Whether a shipped network restores pixels with texture where that is nearer to the picture; None: yes, but below
    exact samples, where it takes a twelfth of a decode and saves 0.2 % (docs/notes/2026-11-residual-layer.md)."""
    network: bytes | None = None
    """The file of a network that restores pixels instead of a shipped one, which then travels in the stream."""
    prior: bytes | None = None
    """The file of the networks of the context model instead of the shipped ones, in the default profile; each tile
    takes them along."""
    tune: Tune | None = None
    """Least squared error or the eye; None for the eye, but for squared error towards a PSNR or under a residual
    layer, which then is smaller."""
    seed: int = 0
    """Of all random numbers."""
    metadata: bool = True
    """Whether ICC, EXIF, XMP and the place on earth are kept."""
    psnr: float | None = None
    """dB to end at, in the default profile, as the three that follow."""
    ssimulacra2: float | None = None
    """Score up to 100 to end at, for a picture in one tile with texture."""
    size: float | None = None
    """Bytes to end at."""
    bpp: float | None = None
    """Bits per pixel to end at."""
    tile: int | None = None
    """Pixels of the largest side of a tile, 0 for a single one."""
    apron: int | None = None
    """Pixels that a tile reaches over its neighbours."""
    overview: bool | None = None
    """Whether a stream of several tiles carries the picture in small."""
    max_error: float | None = None
    """Levels by which no sample may be off, alpha by none; floats by so much: a residual layer sees to it. 0 is without
    loss; None for no layer, but for text, line art and screens that take no more bytes so.
    """

    def spec(self, channels: int) -> ModelSpec:
        """The model of a picture with so many channels."""
        if self.profile == "paper":
            return paper_spec(channels, self.per_seed or 10, self.features or 50)
        spec = replace(default_spec(channels, self.texture), restoration=self.texture and self.restores)
        return spec if self.prior is None else replace(spec, context=replace(spec.context, prior=0))

    def fit_settings(self) -> FitSettings:
        """How each tile is fitted."""
        if self.profile == "paper":
            lmbda = 0.001 if self.lmbda is None else self.lmbda
            fit = paper_settings(lmbda, self.levels or 3, self.steps or PAPER_STEPS)
            return replace(fit, seeds=self.seeds, seed=self.seed)
        lmbda = lmbda_of_quality(self.chosen_quality) if self.lmbda is None else self.lmbda
        return replace(default_settings(max(lmbda, 1e-9), self.fit_steps, self.texture), seed=self.seed)

    @property
    def fit_steps(self) -> int:
        """Steps of the whole fit in the default profile: stated, or the effort's."""
        return self.steps or steps_of(self.effort, self.tuned_for, self.texture)

    @property
    def chosen_effort(self) -> Effort:
        """What is done to each tile, and how often."""
        has_texture = self.texture and self.profile == "default"
        return effort_of(self.fit_settings().steps, self.tuned_for, has_texture)

    @property
    def tuned_for(self) -> Tune:
        """What is asked for, or else follows from the other settings."""
        if self.tune is not None:
            return self.tune
        if self.profile == "paper":
            return "psnr"
        if self.target is not None:
            return TARGETS[self.target].tune
        return "visual" if self.max_error is None else "psnr"

    @property
    def restores(self) -> bool:
        """What is asked for of `restoration`, or else follows from the other settings."""
        if self.restoration is not None:
            return self.restoration
        return self.max_error != 0 or self.network is not None

    def grid(self, width: int, height: int) -> TileGrid:
        """The tiles of a picture."""
        tile = self.tile
        if tile is None:
            large = width * height > _MAX_PIXELS_OF_ONE or max(width, height) > _MAX_SIDE_OF_ONE
            tile = TILE if large else 0
        if not tile or max(width, height) <= tile:
            return TileGrid(width, height, 0, 0)
        return TileGrid(width, height, tile, min(APRON, tile // 4) if self.apron is None else self.apron)

    @property
    def chosen_quality(self) -> float:
        """The quality, whether it is asked for or not."""
        return DEFAULT_QUALITY if self.quality is None else self.quality

    @property
    def is_quality_asked(self) -> bool:
        """Whether a quality says what the picture is to look like, named or not."""
        return self.profile == "default" and self.lmbda is None and self.target is None

    @property
    def target(self) -> str | None:
        """Which of the targets is asked for, if one is."""
        return next((name for name in TARGETS if getattr(self, name) is not None), None)

    @property
    def target_label(self) -> str:
        """The target in a word, empty without one."""
        if self.target is None:
            return ""
        return f"{self.target}{'-' * self.target[-1].isdigit()}{getattr(self, self.target):g}"

    def rate_target(self, pixels: int) -> RateTarget | None:
        """The rate target of a picture of `pixels` pixels, if there is one."""
        if self.target is None:
            return None
        return TARGETS[self.target].rate_target(getattr(self, self.target), pixels)

    def without_target(self, **changes: Any) -> EncodeSettings:
        """The same without a target, and with changes."""
        none: dict[str, Any] = dict.fromkeys(TARGETS)
        return replace(self, **none, **changes)

    def __post_init__(self) -> None:
        for name, kind in self.__annotations__.items():
            value, needed = getattr(self, name), _KINDS.get(kind.removesuffix(" | None").partition("[")[0])
            if needed is None or (value is None and kind.endswith("None")):
                continue
            if isinstance(value, bool) or not isinstance(value, needed[0]):
                raise UsageError(f"{name} {value!r}; it must be {needed[1]}")
        for sound, message in self._ranges():
            if not sound:
                raise UsageError(message)
        self._check_choices()

    def _ranges(self) -> list[tuple[bool, str]]:
        """Whether each setting lies where it must, and what to say if not."""
        return [
            (1 <= self.chosen_quality <= 100, f"quality {self.chosen_quality:g}; it runs from 1 to 100"),
            (
                self.lmbda is None or 0 <= self.lmbda <= _MAX_LMBDA,
                f"lmbda {self.lmbda}; it must not be negative, nor above {_MAX_LMBDA:g}",
            ),
            (1 <= self.effort <= 9, f"effort {self.effort}; it runs from 1 to 9"),
            (self.profile in ("default", "paper"), f"profile {self.profile}; there are default and paper"),
            (self.tune in (None, "psnr", "visual"), f"tune {self.tune}; there are psnr and visual"),
            (self.per_seed is None or 1 <= self.per_seed <= 64, f"per-seed {self.per_seed}; 1 to 64"),
            (self.features is None or 1 <= self.features <= 512, f"features {self.features}; 1 to 512"),
            (self.seeds is None or self.seeds >= 1, f"seeds {self.seeds}; at least 1"),
            (self.steps is None or self.steps >= 1, f"steps {self.steps}; at least 1"),
            (self.levels is None or 1 <= self.levels <= 4, f"levels {self.levels}; 1 to 4"),
            (self.seed >= 0, f"seed {self.seed}; it must not be negative"),
            *(
                (value is None or target.is_sound(value), f"{name} {value}; {target.rule}")
                for name, target in TARGETS.items()
                for value in [getattr(self, name)]
            ),
            (
                self.max_error is None or 0 <= self.max_error < math.inf,
                f"max-error {self.max_error}; it must not be negative, nor infinite",
            ),
            (
                not self.tile or MIN_TILE <= self.tile <= MAX_SIDE,
                f"tile {self.tile}; 0 (one tile) or {MIN_TILE} to {MAX_SIDE} pixels",
            ),
            (
                self.apron is None or 0 <= self.apron <= min(MAX_APRON, (self.tile or 4 * MAX_APRON) // 4),
                f"apron {self.apron}; at most a quarter of the tile, and {MAX_APRON} pixels",
            ),
        ]

    def _check_choices(self) -> None:
        """Raises UsageError for settings that exclude each other, or that the profile does not have."""
        targets = [name for name in TARGETS if getattr(self, name) is not None]
        refuse_several_goals([*targets, *(["lmbda"] if self.lmbda is not None else [])])
        if targets and self.max_error is not None:
            raise UsageError(f"{targets[0]} and max-error exclude each other: a residual layer takes what it takes")
        if self.restoration and not self.texture:
            raise UsageError("restoration restores texture, and there is none")
        if self.tune == "visual" and self.profile == "paper":
            raise UsageError("the paper profile is not tuned for the eye")
        if targets and self.profile == "paper":
            raise UsageError(f"{targets[0]} is a setting of the default profile")
        for name, profile in _OF_ONE_PROFILE.items():
            if profile != self.profile and getattr(self, name) is not None:
                raise UsageError(f"{name} is a setting of the {profile} profile; add --profile {profile}")


def refuse_several_goals(given: Collection[str], prefix: str = "") -> None:
    """Raises UsageError if more than one of these settings is a quality, λ or a target; `prefix` goes before names."""
    choices = [prefix + name for name in ("quality", "lmbda", *TARGETS) if name in given]
    if len(choices) > 1:
        raise UsageError(f"{choices[0]} and {choices[1]} exclude each other")
