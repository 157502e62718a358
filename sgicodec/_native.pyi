"""The compiled extension (sgicodec/raster/cpp/module.cpp). Arrays are C-contiguous and on the CPU."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

F32 = NDArray[np.float32]
I8 = NDArray[np.int8]
I16 = NDArray[np.int16]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]
F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]

class Rasterizer:
    def __init__(self, isa: str, threads: int, most_pairs: int) -> None: ...
    def forward(
        self, means: F32, covariances: F32, colours: F32, image: F32, x0: int, y0: int, cutoff: float, /
    ) -> None: ...
    def draw(
        self,
        means: F32,
        covariances: F32,
        colours: F32,
        out: NDArray[Any],
        x0: int,
        y0: int,
        cutoff: float,
        lines: F32,
        top: I32,
        down: F32,
        low: F32,
        span: F32,
        clip: bool,
        /,
    ) -> None: ...
    def backward(
        self,
        means: F32,
        covariances: F32,
        colours: F32,
        grad: F32,
        x0: int,
        y0: int,
        grad_means: F32,
        grad_covariances: F32,
        grad_colours: F32,
        /,
    ) -> None: ...
    def squared_error(
        self,
        means: F32,
        covariances: F32,
        colours: F32,
        target: F32,
        x0: int,
        y0: int,
        cutoff: float,
        weight: float,
        grad_means: F32,
        grad_covariances: F32,
        grad_colours: F32,
        /,
    ) -> float: ...
    @property
    def isa(self) -> str: ...
    @property
    def pairs(self) -> int: ...

def nearest_neighbours(points: I32, queries: I32, out: I32, threads: int, /) -> None: ...
def nearest_among(points: I32, among: I64, members: I64, out: I32, threads: int, /) -> None: ...
def fma_peak(threads: int, isa: str, /) -> float: ...
def resolve_threads(threads: int, /) -> int: ...

MOST_NEIGHBOURS: int

class SeedFit:
    def __init__(self, isa: str, threads: int, per_seed: int, hidden: int, opponent: F32) -> None: ...
    def set_layout(
        self, centre: F32, cell: F32, log_size: F32, level: I32, neighbour: I32, offset: F32, level_inputs: F32
    ) -> None: ...
    def forward(
        self,
        colour: F32,
        shape: F32,
        offset: F32,
        first: F32,
        rest: F32,
        steps: F32,
        rounding: int,
        key: int,
        mirrored: bool,
        refresh: bool,
        trains_first: bool,
        means: F32,
        covariances: F32,
        colours: F32,
    ) -> float: ...
    def backward(
        self,
        means: F32,
        covariances: F32,
        colours: F32,
        lmbda: float,
        colour: F32,
        shape: F32,
        offset: F32,
        sums: F32,
    ) -> None: ...
    def bits(self, out: F32, /) -> None: ...
    @property
    def sums(self) -> int: ...

def evaluate_network(
    w1: I64,
    b1: I64,
    w2: I64,
    b2: I64,
    shift: int,
    predicted: int,
    inputs: I16,
    threads: int,
    isa: str,
    out: I64,
    /,
) -> None: ...
def seed_inputs(
    half_pixels: I32,
    log_size: I8,
    neighbours: I32,
    summary: I16,
    members: I64,
    quality: int,
    threads: int,
    out: I16,
    /,
) -> None: ...
def summarise(
    attributes: I64,
    per_seed: int,
    channels: int,
    colour: int,
    shape: int,
    members: I64,
    threads: int,
    summary: I16,
    amplitude: I32,
    /,
) -> None: ...
def own_inputs(summary: I16, step: int, first: int, threads: int, out: I16, /) -> None: ...
def quantisers(
    base: I64,
    columns: I64,
    gamma: int,
    amplitude: I32 | None,
    mean: I64,
    scale: I64,
    refine: I64,
    log_size: I8,
    threads: int,
    out_mean: I64,
    out_step: I64,
    out_scale: I16,
    /,
) -> None: ...

class SymbolModels:
    def __init__(self, frequency: I64, start: I64, /) -> None: ...

class RangeDecoder:
    def __init__(self, payload: bytes, /) -> None: ...
    def decode(self, models: SymbolModels, start: I64, out: I32, /) -> bool: ...
    def decode_uniform(self, bits: int, out: I32, /) -> bool: ...
    def maybe_exhausted(self) -> bool: ...

def group_by_key(keys: I16, order: I32, start: I64, /) -> None: ...
def ungroup_symbols(
    indices: I32, order: I32, tables: I16, support: I32, start: I64, bits: F64, symbols: I32, /
) -> tuple[float, int]: ...
def ungroup_categorical(indices: I32, order: I32, keys: I16, alphabets: I32, bits: F64, symbols: I32, /) -> float: ...
def dequantise(symbols: I32, mean: I64, step: I64, members: I64, first: int, threads: int, decoded: I64, /) -> None: ...
def add_predictions(plane: I64, predictor: int, most: int, /) -> bool: ...
def tree_input_count(child: int, /) -> int: ...
def base_detail(base: I64, out: I16, /) -> None: ...
def children_inside(parents: tuple[I32, I32, I32, I16], level: int, width: int, height: int, exists: U8, /) -> None: ...
def begin_batch(exists: U8, occupied: U8, child: int, members: I32, needed: U8, /) -> int: ...
def end_batch(members: I32, child: int, split: U8, seed: U8, flags: I16, occupied: U8, /) -> None: ...

class TreeNetwork:
    def __init__(self, w1: I64, b1: I64, w2: I64, b2: I64, shift: int, child: int, isa: str, /) -> None: ...
    def rows(
        self,
        parents: tuple[I32, I32, I32, I16],
        slots: tuple[U8, I16],
        detail: I16,
        cell: int,
        head: I16,
        level: int,
        members: I32,
        shift: int,
        most: int,
        threads: int,
        out: I16,
        /,
    ) -> None: ...

def tree_inputs(
    parents: tuple[I32, I32, I32, I16],
    slots: tuple[U8, I16],
    detail: I16,
    cell: int,
    head: I16,
    level: int,
    child: int,
    members: I32,
    out: I16,
    /,
) -> None: ...
def split_children(
    parents: tuple[I32, I32, I32, I16],
    slots: tuple[U8, I16],
    found: I32,
    number: I32,
    x: I32,
    y: I32,
    neighbour: I32,
    above: I16,
    /,
) -> None: ...
def base_lines(grid: F64, first: int, left: I64, across: F64, threads: int, lines: F32, /) -> None: ...
def png_filter(rows: U8, above: U8, step: int, out: U8, /) -> None: ...

WINDOW_PADDING: int

class SymbolSearch:
    def __init__(
        self, support: I32, start: I64, bits: F64, first: int, opponent: F32, threads: int, isa: str, /
    ) -> None: ...
    def set_group(
        self,
        group: int,
        w1: I64,
        b1: I64,
        w2: I64,
        b2: I64,
        shift: int,
        predicted: int,
        base: I64,
        columns: I64,
        gamma: int,
        /,
    ) -> None: ...
    def search(
        self,
        residual: F32,
        inputs: I16,
        values: F64,
        centre: F32,
        cell: F32,
        log_size: I8,
        decoded: I64,
        symbols: I32,
        scale: I16,
        change: F64,
        lmbda: float,
        cutoff: float,
        deep: int,
        rounds: int,
        /,
    ) -> None: ...

def search_base(
    planes: I64,
    predictor: I32,
    weights: I32,
    table: I32,
    support: I32,
    start: I64,
    bits: F64,
    down: F64,
    across: F64,
    pull: F64,
    step: float,
    lmbda: float,
    sweeps: int,
    /,
) -> int: ...
def drop_gaussians(
    residual: F32,
    means: F32,
    covariances: F32,
    colours: F32,
    worth: F32,
    cutoff: float,
    threads: int,
    isa: str,
    dropped: NDArray[np.bool_],
    /,
) -> None: ...
