from collections.abc import Sequence
from typing import Annotated, overload

import numpy
import numpy.typing
from numpy.typing import NDArray


def neighbours_by_pass(ranks: int, corner: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], log_size: Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> list[tuple[Annotated[NDArray[numpy.int64], dict(shape=(None,))], Annotated[NDArray[numpy.int32], dict(shape=(None, None))]]]:
    """
    The seeds of each pass [n], and their nearest seeds of earlier passes [n, ranks]: nearest first, -1 where there
    is none.
    """

def quantise_attributes(header: bytes, corner: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], log_size: Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu', writable=False)], plan: Sequence[tuple[Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], int]], networks: Sequence[tuple[Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], int]], signs: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu', writable=False)], values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], leans: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], with_inputs: bool, threads: int, isa: str) -> tuple[Annotated[NDArray[numpy.int64], dict(shape=(None, None))], list[tuple[int, Annotated[NDArray[numpy.int32], dict(shape=(None, None))], Annotated[NDArray[numpy.int16], dict(shape=(None, None))], Annotated[NDArray[numpy.int64], dict(shape=(None, None))], Annotated[NDArray[numpy.int16], dict(shape=(None, None))]]]]:
    """
    What values [N, d_A] decode to, in 2^-24, and in coding order numbers of groups, symbols, tables, steps and, if
    they are asked for, inputs of their network.
    """

def keep_freed_memory() -> None: ...

def resolve_threads(threads: int) -> int: ...

def instruction_set(isa: str) -> str: ...

FRACTION_BITS: int = ...

INPUT_BITS: int = ...

MEAN_BITS: int = ...

GAMMA_BITS: int = ...

PER_OCTAVE: int = ...

STEP_ZERO: int = ...

STEP_COUNT: int = ...

SCALE_ZERO: int = ...

REFINE_LIMIT: int = ...

AMPLITUDE_ZERO: int = ...

OCTAVE_LIMIT: int = ...

LEVELS: int = ...

SUMMARY: int = ...

MAX_NEIGHBOURS: int = ...

NEIGHBOUR_INPUTS: int = ...

COLOUR_GAIN_BITS: int = ...

LOUDNESS_ZERO: int = ...

OFFSET_LIMIT: int = ...

INPUT_LIMIT: int = ...

HIDDEN_LIMIT: int = ...

WINDOW_PADDING: int = ...

TEXTURE_ROOT_LOG: int = ...

TEXTURE_MIN_LOG: int = ...

CONTRAST_LIMIT: int = ...

DEAD_ZONE: float = ...

DEAD_ZONE_LIMIT: float = ...

MIN_VARIANCE: float = ...

PIXEL_VARIANCE: float = ...

SHAPE_LIMIT: float = ...

MIN_MASS: float = ...

def neighbour_weight(rank: int) -> int:
    """Sixteenths that a seed's neighbour of this rank counts, nearest first."""

def own_input_count(step: int) -> int:
    """Inputs that a seed's own earlier groups add at a coding step."""

class Stream:
    def __init__(self, source: object, threads: int, isa: str, cache_bytes: int, block_samples: int = ..., checked: bool = ..., painter: object | None = ...) -> None:
        """painter: draws in the processor's place (sgicodec.raster.painter)."""

    @property
    def size(self) -> int: ...

    @property
    def blobs(self) -> dict: ...

    @property
    def chunk_bytes(self) -> dict: ...

    @property
    def max_error(self) -> float:
        """-1 where nothing is said of all samples."""

    @property
    def graphics_error(self) -> float:
        """-1 where nothing is said of text alone."""

    @property
    def has_exact_views(self) -> bool: ...

    @property
    def has_overview(self) -> bool: ...

    @property
    def overview(self) -> Stream: ...

    @property
    def overview_bytes(self) -> bytes: ...

    def tiles(self) -> tuple[int, int, int]:
        """
        Decoded ones that are kept; decoded so far, to be drawn; of these before they were drawn.
        """

    def tile(self, number: int) -> bytes:
        """The payload of its chunk."""

    def set_blank(self, sample: float) -> None: ...

    def prepare(self, view: tuple[float, float, float, float, int, int], exact: bool) -> None: ...

    def draw(self, view: tuple[float, float, float, float, int, int], top: int, rows: int, sample_type: str, mapped: bool, exact: bool, dither: bool, lossy: bool) -> numpy.typing.NDArray:
        """
        Samples [rows, columns, C] of a view (x, y, sx, sy, columns, rows) from its row `top` on. numpy is not needed before they are drawn.
        """

    def survey(self) -> tuple[int, list[float], int, int, list[int]]:
        """
        Seeds, bytes of parts in their order, bytes of masks, checksum, cells of texture.
        """

def levels(width: int, height: int) -> list:
    """Width, height and downsampling of the levels of a pyramid."""

def overview_size(width: int, height: int) -> tuple[int, int]:
    """Columns and rows of a picture's overview."""

def inner_view(view: tuple[float, float, float, float, int, int], width: int, height: int) -> tuple[tuple[float, float, float, float, int, int], int, int]:
    """
    The part of a view in a picture of this size, and its first column and row.
    """

def overview_view(view: tuple[float, float, float, float, int, int], width: int, height: int) -> tuple[float, float, float, float, int, int] | None:
    """
    What of the overview of a picture a view shows; None for more than it holds.
    """

def adam_step(value: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu')], gradient: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], mean: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu')], square: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu')], beta1: float, beta2: float, rate: float, root_correction: float, epsilon: float, threads: int, isa: str) -> None: ...

def sign_slope(positive: int, count: int, lmbda: float) -> float: ...

class SeedFit:
    def __init__(self, isa: str, threads: int, hidden: int, opponent: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> None: ...

    def set_layout(self, half_pixels: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], log_size: Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu', writable=False)], neighbour: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], quality: int) -> None: ...

    def forward(self, colour: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], shape: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], offset: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], first: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], rest: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], steps: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], rounding: int, key: int, negative: bool, reuse: int, trains_first: bool, means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')]) -> float: ...

    def backward(self, means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], lmbda: float, colour: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], shape: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], offset: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], sums: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu')]) -> None: ...

    def bits(self, out: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu')]) -> None: ...

    @property
    def sums(self) -> int: ...

class FeatureFit:
    def __init__(self, isa: str, threads: int, per_seed: int, channels: int, features: int, hidden: int, context_hidden: int, hash_resolutions: Sequence[int], hash_features: int, hash_log2_entries: int) -> None: ...

    def set_layout(self, half_pixels: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], quality: int, width: int, height: int) -> None: ...

    def forward(self, feature: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], scales: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], offset: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], decoders: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], first: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], rest: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], tables: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], steps: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], rounding: int, priced: bool, key: int, negative: bool, scale: float, share: float, means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')]) -> float: ...

    def backward(self, means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], price: float, lmbda: float, feature: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], scales: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], offset: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], sums: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu')], tables: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu')]) -> None: ...

    def bits(self, out: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu')]) -> None: ...

    def sums(self, priced: bool) -> int: ...

FORMAT_VERSION: int = ...

MAX_SIDE: int = ...

MAX_CHANNELS: int = ...

MAX_TILES: int = ...

MIN_TILE: int = ...

MAX_APRON: int = ...

def decode_header(payload: bytes) -> dict:
    """The fields of chunk H by their paths, such as spec.context.prior."""

def encode_header(header: object) -> bytes:
    """The payload of chunk H of a header with these fields."""

def png_filter(rows: Annotated[NDArray[numpy.uint8], dict(shape=(None, None), order='C', device='cpu', writable=False)], above: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu', writable=False)], step: int, out: Annotated[NDArray[numpy.uint8], dict(shape=(None, None), order='C', device='cpu')], isa: str = ...) -> None: ...

def local_variance(plane: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], radius: int, out: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]) -> None: ...

class Drain:
    def __init__(self, source: int, target: int) -> None: ...

    def error(self) -> int: ...

    def join(self) -> int: ...

class VisualReference:
    def __init__(self, original: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], threads: int, isa: str) -> None: ...

    def score(self, decoded: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)]) -> float: ...

    def gradient(self, decoded: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], out: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu')]) -> float: ...

class ButteraugliReference:
    def __init__(self, original: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], threads: int, isa: str) -> None: ...

    def distance(self, decoded: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], map: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')]) -> float: ...

    def gradient(self, decoded: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], map: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], out: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu')]) -> float: ...

def cell_sums(detail: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], weights: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)] | None, root_log: int, threads: int) -> tuple:
    """
    Sums over cells of 2 pixels that fill whole roots: values [C, rows, columns], squares and weights.
    """

def from_luma_space(channels: int) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None))]:
    """[C, C]; takes samples of luma space to red, green, blue."""

def nearest_among(points: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], among: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], members: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], out: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu')], threads: int, isa: str) -> None: ...

def seed_gaussians(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], half_pixels: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], log_size: Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu', writable=False)], opponent: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], threads: int, isa: str, means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')]) -> None: ...

def evaluate_network(w1: Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], b1: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], w2: Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], b2: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], shift: int, predicted: int, inputs: Annotated[NDArray[numpy.int16], dict(shape=(None, None), device='cpu', writable=False)], threads: int, isa: str, out: Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu')]) -> None: ...

class Rasterizer:
    def __init__(self, isa: str, threads: int, most_pairs: int) -> None: ...

    def forward(self, means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], image: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu')], x0: int, y0: int, cutoff: float) -> None: ...

    def draw(self, means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], out: Annotated[NDArray, dict(shape=(None, None, None), device='cpu')], x0: int, y0: int, cutoff: float, lines: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], top: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], down: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], planes: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)] | None, low: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], span: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], clip: bool) -> None: ...

    def backward(self, means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], grad: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], x0: int, y0: int, grad_means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], grad_covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], grad_colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')]) -> None: ...

    def error(self, means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], target: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], x0: int, y0: int, cutoff: float, absolute: bool, weight: float, weights: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)] | None, grad_means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], grad_covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')], grad_colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu')]) -> tuple[float, float]: ...

    @property
    def isa(self) -> str: ...

    @property
    def pairs(self) -> int: ...

def search_seeds(header: bytes, corner: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], log_size: Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu', writable=False)], plan: Sequence[tuple[Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], int]], networks: Sequence[tuple[Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], int]], values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], support: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], start: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], bits: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], opponent: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], residual: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu')], weights: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)] | None, lmbda: float, cutoff: float, deep: int, rounds: int, threads: int, isa: str) -> tuple[Annotated[NDArray[numpy.int64], dict(shape=(None, None))], Annotated[NDArray[numpy.int32], dict(shape=(None, None))], Annotated[NDArray[numpy.int16], dict(shape=(None, None))], Annotated[NDArray[numpy.float64], dict(shape=(None,))]]:
    """
    Attributes [N, C + 5] in 2^-24, their symbols and scale indices, and the change of cost [N]; `residual` becomes
    what they leave.
    """

def prune_gaussians(residual: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu')], weights: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)] | None, means: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], covariances: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], colours: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], price: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], cutoff: float, threads: int, isa: str, pruned: Annotated[NDArray[numpy.bool_], dict(shape=(None,), order='C', device='cpu')]) -> None: ...

def search_base(planes: Annotated[NDArray[numpy.int64], dict(shape=(None, None, None), order='C', device='cpu')], predictor: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], weights: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], table: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], support: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], start: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], bits: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], down: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], across: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], gram: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None, None), order='C', device='cpu', writable=False)] | None, pull: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], step: float, lmbda: float, passes: int) -> int: ...

def restoration_correction(drawn: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], network: int, step: int, threads: int, isa: str) -> Annotated[NDArray[numpy.float32], dict(shape=(None, None, None))]:
    """
    What restoration adds to a tile drawn as [C, H, W]. Raises UnsupportedStreamError for an unknown network.
    """

CHUNK_KINDS: tuple = ...

MAX_PAYLOAD: int = ...

SIGNATURE: bytes = ...

def summarize(source: object) -> tuple:
    """
    Of a stream's start: payloads by letter, bytes of all chunks by letter, and of the file. No tile is read.
    """

def shipped(kind: str, number: int) -> bytes:
    """
    Tables, positions, prior or texture, or the restoration of this number, empty where there is none.
    """

def tile_segments(length: int, count: int, apron: int, start: float, scale: float, first: int, n: int) -> list:
    """
    First and last pixel, tile and the next one's share, or None, of each run of output pixels along an axis.
    """

RESIDUAL_BLOCK: int = ...

RESIDUAL_CELL: int = ...

MAX_GRID_STEPS: int = ...

MAX_PALETTE: int = ...

def code_residual(samples: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], drawn: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], header: bytes, form: bytes, cells: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> tuple[Annotated[NDArray[numpy.int32], dict(shape=(None,))], Annotated[NDArray[numpy.int32], dict(shape=(None,))], int]:
    """
    Bits of a block [h, w, C] of a residual layer that begins with `form`, their P(1) in 2^-16, the CRC-32 of the samples that a reader finds. cells: 1 for those that are coded, row by row; all where the form has no cells.
    """

class SymbolReader:
    """
    Reads a payload group by group, part by part: the decoder's own reader.
    """

    def __init__(self, payload: bytes) -> None: ...

    def read(self, tables: Annotated[NDArray[numpy.int16], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.int32], dict(shape=(None,))]:
        """Zero-centred integers [n], each with its own table."""

    def read_categorical(self, frequencies: Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], rows: Annotated[NDArray[numpy.int16], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.int32], dict(shape=(None,))]:
        """Symbols [n] under rows of frequencies [rows, A]."""

    def read_bits(self, n_bits: int, count: int) -> Annotated[NDArray[numpy.uint32], dict(shape=(None,))]:
        """Equally likely integers [count] of 0 to 32 bits."""

    def read_weights(self, count: int) -> Annotated[NDArray[numpy.int64], dict(shape=(None,))]:
        """A tensor of so many integers, flat."""

    def read_signs(self, counts: Sequence[int]) -> Annotated[NDArray[numpy.uint8], dict(shape=(None,))]:
        """The hash grid's signs, 0 or 1, level after level."""

    def read_base(self, channels: int, rows: int, columns: int) -> Annotated[NDArray[numpy.int64], dict(shape=(None, None, None))]:
        """Planes [C, rows, columns] of the base layer."""

    def read_positions(self, size: tuple[int, int], most: int) -> tuple[Annotated[NDArray[numpy.int32], dict(shape=(None, None))], Annotated[NDArray[numpy.int8], dict(shape=(None,))]]:
        """
        Corners [N, 2] and log2 of the sides [N] of at most so many seeds of one pixel.
        """

    def read_predicted_positions(self, size: tuple[int, int], base: Annotated[NDArray[numpy.int64], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], cell: int, quality: int, most: int, threads: int, isa: str) -> tuple[Annotated[NDArray[numpy.int32], dict(shape=(None, None))], Annotated[NDArray[numpy.int8], dict(shape=(None,))]]:
        """The same of a quadtree whose flags are predicted."""

    def read_texture(self, size: tuple[int, int], channels: int) -> tuple[tuple[int, list[int], tuple[int, int], tuple[int, int, int], bool, tuple[int, int, int]], Annotated[NDArray[numpy.uint8], dict(shape=(None, None))], Annotated[NDArray[numpy.int8], dict(shape=(None, None))], Annotated[NDArray[numpy.int16], dict(shape=(None, None, None))]] | None:
        """
        Steps, log_size, contrast and symbols of a tile's texture, None for none.
        """

    def finish(self) -> None:
        """
        Raises CorruptStreamError unless the symbols are those written and the payload ends with them.
        """

    @property
    def crc(self) -> int:
        """CRC-32 of all symbols."""

    @property
    def count(self) -> int:
        """Of symbols."""

    @property
    def ends(self) -> bool:
        """Whether an encoder may have ended here."""

    @property
    def bits(self) -> float:
        """Information content of all symbols."""

def draw_texture(corner: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], log_size: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu', writable=False)], amplitudes: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], mix: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)] | None, threads: int, isa: str, planes: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu')]) -> None: ...

class TextureModels:
    @overload
    def __init__(self) -> None: ...

    @overload
    def __init__(self, state: bytes) -> None: ...

    @staticmethod
    def shipped() -> TextureModels:
        """Those with which every layer begins."""

    def state(self) -> bytes: ...

    def settle(self, most: int) -> None: ...

    def learn(self, log_size: Annotated[NDArray[numpy.uint8], dict(shape=(None, None), order='C', device='cpu', writable=False)], contrast: Annotated[NDArray[numpy.int8], dict(shape=(None, None), order='C', device='cpu', writable=False)], symbols: Annotated[NDArray[numpy.int16], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], size: tuple[int, int], has_contrast: bool) -> None: ...

    def write(self, log_size: Annotated[NDArray[numpy.uint8], dict(shape=(None, None), order='C', device='cpu', writable=False)], contrast: Annotated[NDArray[numpy.int8], dict(shape=(None, None), order='C', device='cpu', writable=False)], symbols: Annotated[NDArray[numpy.int16], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], size: tuple[int, int], has_contrast: bool) -> tuple[Annotated[NDArray[numpy.int32], dict(shape=(None,))], Annotated[NDArray[numpy.int32], dict(shape=(None,))], Annotated[NDArray[numpy.int32], dict(shape=(None,))], float]:
        """
        Bits, their P(1) in 2^-16, all symbols in coding order, information content.
        """

    def search(self, amplitudes: TextureAmplitudes, contrast: Annotated[NDArray[numpy.int8], dict(shape=(None, None), order='C', device='cpu', writable=False)], steps: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], slope: tuple[float, float], lmbda: float, has_contrast: bool, doubt: float, division: Annotated[NDArray[numpy.uint8], dict(shape=(None, None), order='C', device='cpu', writable=False)] | None) -> tuple[tuple[Annotated[NDArray[numpy.uint8], dict(shape=(None, None))], Annotated[NDArray[numpy.int8], dict(shape=(None, None))], Annotated[NDArray[numpy.int16], dict(shape=(None, None, None))]], float, list[float], list[float], Annotated[NDArray[numpy.float32], dict(shape=(None, None))]]:
        """
        log_size, contrast and symbols; bits; by magnitude 1, 2 and more the symbols and the sum of their excess; cost of each root in squared steps.
        """

class TextureAmplitudes:
    def __init__(self, planes: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], size: tuple[int, int], threads: int, colours: Sequence[int]) -> None:
        """planes [C, 32 h, 32 w] in opponent colours."""

    def move(self, gradient: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], contrast: Annotated[NDArray[numpy.int8], dict(shape=(None, None), order='C', device='cpu', writable=False)], steps: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], slope: tuple[float, float], mean: float, most: float, division: Annotated[NDArray[numpy.uint8], dict(shape=(None, None), order='C', device='cpu', writable=False)] | None = ...) -> None:
        """
        Moves them up a gradient, [C, 32 h, 32 w] of the roots, in the mean by `mean` of a step, at most by `most`; with log2 of the sides of a layer's cells [4 h, 4 w], those alone.
        """

    def shown(self, log_size: Annotated[NDArray[numpy.uint8], dict(shape=(None, None), order='C', device='cpu', writable=False)], symbols: Annotated[NDArray[numpy.int16], dict(shape=(None, None, None), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float32], dict(shape=(None, None, None))]:
        """
        Those for which a layer has symbols that are not 0 [C, 32 h, 32 w], where its cells have their pixels.
        """

def texture_cells(log_size: Annotated[NDArray[numpy.uint8], dict(shape=(None, None), order='C', device='cpu', writable=False)], contrast: Annotated[NDArray[numpy.int8], dict(shape=(None, None), order='C', device='cpu', writable=False)], symbols: Annotated[NDArray[numpy.int16], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], steps: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], slope: tuple[float, float], excess: Sequence[float], colours: Sequence[int]) -> tuple[Annotated[NDArray[numpy.int32], dict(shape=(None, None))], Annotated[NDArray[numpy.uint8], dict(shape=(None,))], Annotated[NDArray[numpy.float32], dict(shape=(None,))]]:
    """Corners, log2 of sides, amplitudes in opponent colours."""

def cheapest_colours(planes: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], contrast: Annotated[NDArray[numpy.int8], dict(shape=(None, None), order='C', device='cpu', writable=False)], steps: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], slope: tuple[float, float], lmbda: float, threads: int) -> tuple[int, int, int]:
    """
    Indices of the colours in which texture that shows these planes, in opponent colours, costs least, about.
    """

class TileModel:
    """A tile's model as it was read; arrays are views of it."""

    @property
    def corner(self) -> NDArray[numpy.int32]:
        """[N, 2] pixels"""

    @property
    def log_size(self) -> NDArray[numpy.int8]:
        """[N]"""

    @property
    def decoded(self) -> NDArray[numpy.int64]:
        """[N, d_A] attributes in units of 2^-24"""

    @property
    def base(self) -> NDArray[numpy.int64]:
        """[C, rows, columns] in steps of index `base_step`"""

    @property
    def base_step(self) -> int: ...

    @property
    def decoders(self) -> dict[str, NDArray[numpy.int64]]:
        """Weights in units of 2^-decoder_shift, by name."""

    @property
    def decoder_shift(self) -> int:
        """Of the decoders' weights; 0 where there are none."""

    @property
    def plan(self) -> list[tuple[str, NDArray[numpy.int64], int]]:
        """
        By group its name, base steps [U, 8] and the exponent of the amplitude.
        """

    @property
    def networks(self) -> list[tuple[NDArray[numpy.int64], NDArray[numpy.int64], NDArray[numpy.int64], NDArray[numpy.int64], int, int]]:
        """By coding step W1, b1, W2, b2, shift and the number of predictions."""

    @property
    def signs(self) -> NDArray[numpy.uint8]:
        """Those of the hash grid, 0 or 1, level after level."""

    @property
    def texture(self) -> tuple[tuple[int, list[int], tuple[int, int], tuple[int, int, int], bool, tuple[int, int, int]], Annotated[NDArray[numpy.uint8], dict(shape=(None, None))], Annotated[NDArray[numpy.int8], dict(shape=(None, None))], Annotated[NDArray[numpy.int16], dict(shape=(None, None, None))]] | None:
        """Steps, log_size, contrast and symbols of the layer; None for none."""

    @property
    def restoration(self) -> tuple[int, int] | None:
        """
        Numbers of network and step, and by layer what is added to it; None for none.
        """

    @property
    def bits(self) -> dict[str, float]:
        """Information content of the parts, by name."""

    @property
    def crc(self) -> int:
        """CRC-32 of all symbols: equal on every machine."""

def check_model(header: bytes) -> None:
    """
    Raises LimitError for a tile of this header that would be refused whatever it holds.
    """

def max_seeds(header: bytes, payload_bytes: int) -> int:
    """The most seeds that a tile may have, given the bytes of its payload."""

def check_texture(channels: int, width: int, height: int) -> None:
    """Raises LimitError for a tile that is too large to have texture."""

def read_tile(header: bytes, payload: bytes, threads: int, isa: str, checked: bool = ...) -> TileModel:
    """
    The model of a payload; `header` is the payload of chunk H that the tile would have as a picture of its own.
    Without `checked` the checksum of symbols is not compared.
    """

PRIOR: int = ...

def load_prior(header: bytes) -> list[tuple[NDArray[numpy.int64], NDArray[numpy.int64], NDArray[numpy.int64], NDArray[numpy.int64], int, int]]:
    """The networks of the prior that a header names, as TileModel.networks."""

class MaskTree:
    """
    Which pixels of a tile hold nothing, as the quadtree that the stream codes.
    """

    def __init__(self, width: int, height: int) -> None:
        """That of a tile in which no pixel holds anything."""

    @property
    def nbytes(self) -> int: ...

    def at(self, rows: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], columns: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.bool_], dict(shape=(None, None))]:
        """
        The mask [rows, columns] where ascending rows and columns of pixels meet.
        """

def decode_tile_chunk(header: bytes, payload: bytes) -> tuple[int, bool, list[tuple[bool, MaskTree]], list[tuple[int, float]], bytes]:
    """
    Of the payload of a chunk T: the tile's number; whether no pixel of it holds anything; masks, one for all bands
    or one for each (whether it holds nothing, and its tree or None), none where all pixels hold something; exact
    samples (place, value); the payload of its model.
    """

def flag_frequencies() -> Annotated[NDArray[numpy.int64], dict(shape=(None, None))]:
    """Frequencies [rows, 2] of the flags of a tree of seeds."""

def position_flags(size: tuple[int, int], base: Annotated[NDArray[numpy.int64], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], cell: int, quality: int, corner: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], log_size: Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu', writable=False)], threads: int, isa: str) -> list[tuple[Annotated[NDArray[numpy.uint8], dict(shape=(None,))], Annotated[NDArray[numpy.int16], dict(shape=(None,))]]]:
    """
    The flags of the tree of these seeds and the rows of their frequencies, in groups as they are coded.
    """

def tree_examples(size: tuple[int, int], base: Annotated[NDArray[numpy.int64], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], cell: int, quality: int, corner: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu', writable=False)], log_size: Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu', writable=False)], child: int) -> list[tuple[int, Annotated[NDArray[numpy.int16], dict(shape=(None, None))], Annotated[NDArray[numpy.uint8], dict(shape=(None,))], Annotated[NDArray[numpy.uint8], dict(shape=(None,))], Annotated[NDArray[numpy.uint8], dict(shape=(None,))]]]:
    """
    Of each level's nodes of a child number: the level, what a prediction sees [n, inputs] in 1/64, which are
    split and which carry seeds, and which must not be empty.
    """
