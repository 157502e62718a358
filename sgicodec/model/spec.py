"""The model specification: what encoder and decoder must share, and the groups of seed attributes."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

Layout = Literal["adaptive", "uniform"]


@dataclass(frozen=True)
class Group:
    """Attributes of a seed that are coded together: `start` and `size` are columns of the attribute matrix."""

    name: str
    start: int
    size: int

    @property
    def columns(self) -> slice:
        """Where the group sits in the attribute matrix [N, d_A]."""
        return slice(self.start, self.start + self.size)


@dataclass(frozen=True)
class ContextSpec:
    """What MLP_p may see, and where its weights come from.

    `prior` is the number of a network that ships with the package, or 0 for weights that travel in the stream.
    `steps` lists the groups that each evaluation of MLP_p predicts; later steps see what earlier ones decoded.
    `neighbours` is how many seeds of earlier passes a seed sees (0 codes all seeds in one pass). The hash grid has one
    entry of `hash_features` signs per vertex of every resolution in `hash_resolutions`, at most 2^`hash_log2_entries`.
    """

    prior: int
    steps: tuple[tuple[str, ...], ...]
    hidden: int
    neighbours: int = 0
    hash_resolutions: tuple[int, ...] = ()
    hash_features: int = 4
    hash_log2_entries: int = 13


@dataclass(frozen=True)
class ModelSpec:
    """The architecture (paper, section 3.1, with the design's choices as settings).

    `features` is D, `per_seed` is K, `hidden` the width of MLP_c and MLP_Σ. With the adaptive layout K is 1, D is C + 3
    and there are no MLPs: the features are a colour and a log-covariance. With the uniform one
    seeds also carry the scales s_o and s_a, and MLP_Σ says rotations. `base_cell` is the side in pixels of the base
    layer's cells, 0 for none. `texture` says whether tiles may hold a texture layer,
    `luma_space` whether channels are those of luma space, `restoration` whether tiles may name a network that
    restores what is rendered.
    """

    channels: int
    layout: Layout
    per_seed: int
    features: int
    hidden: int
    base_cell: int
    context: ContextSpec = field(repr=False)
    texture: bool = False
    luma_space: bool = False
    restoration: bool = False

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """The attribute groups in coding order; their sizes sum to d_A (paper: D + 4 + 2K)."""
        held = [("colour", self.channels), ("shape", 3)] if self.plain else [("feature", self.features), ("scales", 4)]
        sizes = [*held, ("offset", 2 * self.per_seed)]
        starts = [sum(size for _, size in sizes[:i]) for i in range(len(sizes))]
        return tuple(Group(name, start, size) for start, (name, size) in zip(starts, sizes, strict=True))

    @property
    def plain(self) -> bool:
        """Whether seeds hold their Gaussian as it is: colour, log-covariance, offset; no decoders, no scales."""
        return self.layout == "adaptive"

    def group(self, name: str) -> Group:
        """The group called `name`."""
        return next(group for group in self.groups if group.name == name)

    @property
    def attributes(self) -> int:
        """d_A: attributes per seed."""
        return sum(group.size for group in self.groups)
