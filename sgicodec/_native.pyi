"""The compiled extension (native/bindings/module.cpp). Arrays are C-contiguous and on the CPU."""

from collections.abc import Callable
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

FRACTION_BITS: int
INPUT_BITS: int
MEAN_BITS: int
GAMMA_BITS: int
PER_OCTAVE: int
STEP_ZERO: int
STEP_COUNT: int
SCALE_ZERO: int
SCALE_COUNT: int
REFINE_LIMIT: int
AMPLITUDE_ZERO: int
OCTAVE_LIMIT: int
LEVELS: int
SUMMARY: int
LEVEL_INPUTS: int
NEIGHBOUR_INPUTS: int
COLOUR_GAIN_BITS: int
LOUDNESS_ZERO: int
OFFSET_LIMIT: int
INPUT_LIMIT: int
HIDDEN_LIMIT: int
WINDOW_PADDING: int
DEAD_ZONE: float
DEAD_ZONE_LIMIT: float
MIN_VARIANCE: float
SHAPE_LIMIT: float
LEAST_MASS: float
NEIGHBOUR_WEIGHTS: tuple[int, ...]
OWN_INPUTS: tuple[int, ...]

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
    def weighted_squared_error(
        self,
        means: F32,
        covariances: F32,
        colours: F32,
        target: F32,
        weights: F32,
        x0: int,
        y0: int,
        cutoff: float,
        grad_means: F32,
        grad_covariances: F32,
        grad_colours: F32,
        /,
    ) -> tuple[float, float]: ...
    @property
    def isa(self) -> str: ...
    @property
    def pairs(self) -> int: ...

def nearest_among(points: I32, among: I64, members: I64, out: I32, threads: int, /) -> None: ...
def fma_peak(threads: int, isa: str, /) -> float: ...
def resolve_threads(threads: int, /) -> int: ...
def adam_step(
    value: F32,
    gradient: F32,
    mean: F32,
    square: F32,
    beta1: float,
    beta2: float,
    rate: float,
    root_correction: float,
    epsilon: float,
    threads: int,
    isa: str,
) -> None: ...

class SeedFit:
    def __init__(self, isa: str, threads: int, per_seed: int, hidden: int, opponent: F32) -> None: ...
    def set_layout(self, half_pixels: I32, log_size: I8, neighbour: I32, quality: int, /) -> None: ...
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
        negative: bool,
        reuse: int,
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

def seed_gaussians(
    values: F64,
    half_pixels: I32,
    log_size: I8,
    per_seed: int,
    opponent: F32,
    threads: int,
    isa: str,
    means: F32,
    covariances: F32,
    colours: F32,
    /,
) -> None: ...
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

class TreeNetwork:
    def __init__(self, w1: I64, b1: I64, w2: I64, b2: I64, shift: int, child: int, isa: str, /) -> None: ...

class TreeScenery:
    def __init__(self, width: int, height: int, base: I64, cell: int, quality: int, /) -> None: ...

class TreeBatch:
    """Nodes of one level and child number that are coded together."""

    @property
    def level(self) -> int: ...
    @property
    def child(self) -> int: ...
    def __len__(self) -> int: ...
    @property
    def needed(self) -> NDArray[np.bool_]:
        """Which [n] must not be empty, being the last of their parent's children where the others are."""

    @property
    def codes(self) -> I64:
        """Morton codes [n] at their level."""

    @property
    def inputs(self) -> I16:
        """What a prediction sees [n, inputs], in 1/64."""

    def rows(self, network: TreeNetwork, shift: int, most: int, threads: int, /) -> I16:
        """What the network of this child number says [n, 3]: log-odds in units of 2^(shift − 8), clipped to ±most and
        moved by `most`.
        """

    def seed_rows(self, rows: I16, split: U8, certain: int, /) -> I16:
        """The row of every seed flag [n]: `certain` where it is needed."""

def walk_tree(
    scenery: TreeScenery, max_seeds: int, code: Callable[[TreeBatch], tuple[U8, U8]], /
) -> list[tuple[I64, int]]: ...
def read_tree(
    decoder: RangeDecoder,
    scenery: TreeScenery,
    max_seeds: int,
    networks: tuple[TreeNetwork, ...],
    models: SymbolModels,
    symbol: I32,
    bits: F64,
    shift: int,
    most: int,
    threads: int,
    /,
) -> tuple[bool, list[tuple[I64, int]], I32, float]:
    """Whether they decode, codes as of `walk_tree`, all flags in coding order and their information content."""

class ZeroCentredTables:
    def __init__(
        self, models: SymbolModels, support: I32, start: I64, bits: F64, exponents: SymbolModels, most: int, /
    ) -> None: ...

def read_zero_centred(
    decoder: RangeDecoder, tables: ZeroCentredTables, keys: I16, symbols: I32, /
) -> tuple[int, float]:
    """0, or 1 where the payload does not decode, 2 where a symbol is too large; information content."""

class AttributeModel:
    def __init__(
        self,
        attributes: int,
        per_seed: int,
        channels: int,
        colour: int,
        shape: int,
        quality: int,
        neighbours: int,
        first_table: int,
        /,
    ) -> None: ...
    def add_step(self, w1: I64, b1: I64, w2: I64, b2: I64, shift: int, predicted: int, isa: str, /) -> None: ...
    def add_group(
        self,
        base: I64,
        columns: I64,
        gamma: int,
        follows_amplitude: bool,
        prediction: int,
        units: int,
        refinement: int,
        first: int,
    ) -> None: ...
    def read(
        self,
        decoder: RangeDecoder,
        tables: ZeroCentredTables,
        half_pixels: I32,
        log_size: I8,
        members: I64,
        start: I64,
        threads: int,
        decoded: I64,
        /,
    ) -> tuple[int, I32, list[float]]:
        """As of `read_zero_centred`, all symbols in coding order, information content by group."""

def base_lines(grid: F64, first: int, left: I64, across: F64, threads: int, lines: F32, /) -> None: ...
def png_filter(rows: U8, above: U8, step: int, out: U8, /) -> None: ...

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
        weights: F32 | None,
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
    gram: F64 | None,
    pull: F64,
    step: float,
    lmbda: float,
    passes: int,
    /,
) -> int: ...
def prune_gaussians(
    residual: F32,
    weights: F32 | None,
    means: F32,
    covariances: F32,
    colours: F32,
    price: F32,
    cutoff: float,
    threads: int,
    isa: str,
    pruned: NDArray[np.bool_],
    /,
) -> None: ...
