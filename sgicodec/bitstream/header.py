"""The header chunk: what picture this is and what kind of model it holds (docs/format.md, "Header fields")."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

from sgicodec import _native
from sgicodec._native import FORMAT_VERSION, MAX_APRON, MAX_CHANNELS, MAX_SIDE, MAX_TILES, MIN_TILE
from sgicodec.metadata.layouts import SampleRange, alpha_index
from sgicodec.model.spec import ContextSpec, ModelSpec
from sgicodec.model.tile_grid import TileGrid

__all__ = [
    "COLOURED_LAYOUTS",
    "FORMAT_VERSION",
    "MAX_APRON",
    "MAX_CHANNELS",
    "MAX_SIDE",
    "MAX_TILES",
    "MIN_TILE",
    "Header",
    "Masked",
    "decode_header",
    "encode_header",
]

Masked = Literal["transparent", "nodata"]

COLOURED_LAYOUTS = ("rgb", "rgba")
"""Those that can be in luma space."""

_SAMPLE_BYTES = {"uint8": 1, "uint16": 2, "float32": 4}


@dataclass(frozen=True)
class Header:
    """width, height in pixels; channels: the layout's name; sample_type: numpy's name; sample_range: the colour samples
    that 0 and 1 of the model mean, two numbers, or two tuples with one for each band. colour_step: index of the base
    colour step; family: of the frequency tables. tile: largest side of a tile without its apron, 0 if there is one;
    apron: how far it reaches over its neighbours. masked: whether tiles say which pixels are "transparent", or "nodata"
    with the value `nodata`; has_band_masks: whether they may say so of each band; has_exact: whether they list samples
    that they state exactly. network: the file of the picture's own network of restoration, empty for none.
    """

    width: int
    height: int
    channels: str
    sample_type: str
    sample_range: SampleRange
    profile: str
    spec: ModelSpec
    colour_step: int
    family: int
    tile: int = 0
    apron: int = 0
    masked: Masked | None = None
    nodata: float = 0.0
    has_band_masks: bool = False
    has_exact: bool = False
    network: bytes = b""

    @property
    def colours(self) -> int:
        """Channels but for alpha."""
        return self.spec.channels - (alpha_index(self.channels) is not None)

    @property
    def blank(self) -> float | None:
        """The sample that means that nothing was measured, None for none."""
        return self.nodata if self.masked == "nodata" else None

    @property
    def grid(self) -> TileGrid:
        """Where the tiles are."""
        return TileGrid(self.width, self.height, self.tile, self.apron)

    @property
    def sample_bytes(self) -> int:
        """Of a sample."""
        return _SAMPLE_BYTES[self.sample_type]

    def of_tile(self, number: int) -> Header:
        """The header that a tile's model would have as a picture of its own."""
        _, _, width, height = self.grid.rect(number)
        return replace(self, width=width, height=height, tile=0, apron=0)


def encode_header(header: Header) -> bytes:
    """The payload of chunk H. Raises UsageError for negative fields; all else is for who reads to check."""
    return _native.encode_header(header)


def decode_header(payload: bytes) -> Header:
    """Reads chunk H. Raises UnsupportedStreamError for another version, LimitError for a field beyond its cap and
    CorruptStreamError for fields that contradict each other.
    """
    fields: dict[str, dict[str, Any]] = {"": {}, "spec": {}, "spec.context": {}}
    for path, value in _native.decode_header(payload).items():
        holder, _, name = path.rpartition(".")
        fields[holder][name] = value
    return Header(**fields[""], spec=_spec(fields["spec"], fields["spec.context"]))


def _spec(fields: dict[str, Any], context: dict[str, Any]) -> ModelSpec:
    """The specification with the coding steps, which follow from its groups."""
    spec = ModelSpec(**fields, context=ContextSpec(**context, steps=()))
    names = tuple(group.name for group in spec.groups)
    steps = tuple((name,) for name in names) if spec.plain else (names,)
    return replace(spec, context=replace(spec.context, steps=steps))
