"""What differs from profile to profile, as data and factories."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import FitSettings

__all__ = ["Choices", "Profile"]


class Choices(Protocol):
    """What a profile reads of the settings of an encode (`encoder.settings.EncodeSettings`); None: as it sees fit."""

    @property
    def chosen_quality(self) -> float: ...
    @property
    def lmbda(self) -> float | None: ...
    @property
    def steps(self) -> int | None: ...
    @property
    def per_seed(self) -> int | None: ...
    @property
    def seeds(self) -> int | None: ...
    @property
    def features(self) -> int | None: ...
    @property
    def levels(self) -> int | None: ...
    @property
    def seed(self) -> int: ...
    @property
    def texture(self) -> bool: ...
    @property
    def restores(self) -> bool: ...
    @property
    def prior(self) -> bytes | None: ...
    @property
    def fit_steps(self) -> int: ...
    @property
    def fits_beneath_texture(self) -> bool: ...


@dataclass(frozen=True)
class Profile:
    """One way to make a stream."""

    name: str
    """As settings and headers have it."""
    family: int
    """Of frequency tables, 0 for Gaussian, 1 for Laplace."""
    spec: Callable[[Choices, int], ModelSpec]
    """The model for a number of channels."""
    settings: Callable[[Choices], FitSettings]
    """How a tile is fitted."""
    own_choices: tuple[str, ...] = ()
    """Settings that no other profile has."""
    scales: Mapping[str, str] = field(default_factory=dict)
    """Settings on a scale of this profile alone, and which takes their place elsewhere."""
    has_targets: bool = False
    """Whether a size, a PSNR or a score can be asked for."""
    has_tunings: bool = False
    """Whether it can be tuned for the eye or for squared error."""
    has_overviews: bool = False
    """Whether a stream of several tiles may carry the picture in small."""
    parts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Names under which parts of a stream are shown together."""

    def fit_settings(self, choices: Choices) -> FitSettings:
        """How a tile is fitted, with the seed of random numbers."""
        return replace(self.settings(choices), seed=choices.seed)

    def shown_parts(self, parts: Mapping[str, float]) -> dict[str, float]:
        """Bytes of the parts of a stream under this profile's names; parts without one keep their own."""
        table = {name: sum(parts.get(part, 0.0) for part in members) for name, members in self.parts.items()}
        known = {part for members in self.parts.values() for part in members}
        return table | {name: size for name, size in parts.items() if name not in known}
