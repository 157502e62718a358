"""Networks of the paper profile on a GPU: layers over rows of what seeds have, and sums over seeds."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from sgicodec.arrays import F32
from sgicodec.cuda import sources
from sgicodec.cuda.gpu import Gpu, GpuArray
from sgicodec.cuda.structures import structures
from sgicodec.model.context import network_shapes
from sgicodec.model.gaussians import decoder_shapes
from sgicodec.model.spec import ModelSpec

DECODERS = ("colour", "shape")
"""MLP_c and MLP_Σ; MLP_p is `context`."""

_SIZES = sources.constants("cuda/fit/rows.hpp")
_SUM_THREADS, _SUM_SIDE = _SIZES["kSumThreads"], _SIZES["kSumSide"]
_PRODUCT_THREADS, _PRODUCT_ROWS = _SIZES["kProductThreads"], _SIZES["kProductRows"]
_MAX_CHUNKS, _MIN_CHUNK = 64, 128
"""Rows of sums over seeds, and of how many seeds one is at least."""


class _Layer(NamedTuple):
    """Where W [rows, columns] and its bias begin among all weights, and the sums of their gradients among all sums."""

    rows: int
    columns: int
    weights_at: int
    bias_at: int


class Activations(NamedTuple):
    """Of one network, rows [.., N]: what it sees, its hidden values, what it says, the gradients of the last two, and
    those of what it sees, which are added to the array's values if `adds`; without the first `skipped` rows.
    """

    inputs: GpuArray
    hidden: GpuArray
    said: GpuArray
    up: GpuArray
    hidden_slopes: GpuArray
    slopes: GpuArray
    adds: bool = False
    skipped: int = 0


class DeviceNetworks:
    """MLP_c, MLP_Σ and MLP_p of `count` seeds. Their weights lie in the order of `FeatureOutputs.sums`."""

    def __init__(self, gpu: Gpu, spec: ModelSpec, count: int) -> None:
        self.gpu, self.count = gpu, count
        context = network_shapes(spec, 0)
        shapes = decoder_shapes(spec) | {f"context.{name}": context[name] for name in ("b1", "w2", "b2", "w1")}
        ends = np.cumsum([math.prod(shape) for shape in shapes.values()]).tolist()
        starts = dict(zip(shapes, [0, *ends], strict=False))
        self._layers = {}
        for name in (*DECODERS, "context"):
            sizes = [(shapes[f"{name}.w{n}"], starts[f"{name}.w{n}"], starts[f"{name}.b{n}"]) for n in (1, 2)]
            self._layers[name] = [_Layer(rows, columns, w, b) for (rows, columns), w, b in sizes]
        self._chunk = _MIN_CHUNK * -(-count // (_MIN_CHUNK * _MAX_CHUNKS))
        self._chunks = -(-count // self._chunk)
        self._weights: GpuArray | None = None

    def load(self, weights: F32) -> None:
        """Takes the weights of the decoders, and with or without those of MLP_p behind them."""
        if self._weights is None or self._weights.shape != weights.shape:
            self._weights, self._total = self.gpu.array(weights.shape), self.gpu.array(weights.shape)
            self._partials = self.gpu.array((self._chunks, len(weights)))
        self._weights.upload(weights)

    def forward(self, name: str, rows: Activations) -> None:
        """Hidden values and what a network says."""
        first, second = self._layers[name]
        self._multiply(first, rows.inputs, rows.hidden, clips=1)
        self._multiply(second, rows.hidden, rows.said)

    def backward(self, name: str, rows: Activations) -> None:
        """Gradients of what a network sees, and those of its weights for `sums`, from those of what it says."""
        first, second = self._layers[name]
        self._sum(second, rows.up, rows.hidden)
        self._multiply_turned(second, rows.up, rows.hidden_slopes, passes=rows.hidden.address)
        self._sum(first, rows.hidden_slopes, rows.inputs)
        self._multiply_turned(first, rows.hidden_slopes, rows.slopes, rows.skipped, adds=int(rows.adds))

    def sums(self) -> F32:
        """Gradients of all weights, after the way back of each network."""
        given = self._summed(rows=0)
        self.gpu.launch("sum_partials", -(-given.width // _PRODUCT_THREADS), _PRODUCT_THREADS, given)
        return self._total.download()

    def _multiply(self, layer: _Layer, given: GpuArray, out: GpuArray, clips: int = 0) -> None:
        steps = {"row_step": layer.columns, "column_step": 1}
        bias = self._address(layer.bias_at)
        self._product(layer.rows, layer.columns, layer.weights_at, given, out, bias=bias, clips=clips, **steps)

    def _multiply_turned(self, layer: _Layer, given: GpuArray, out: GpuArray, skipped: int = 0, **how: int) -> None:
        steps = {"row_step": 1, "column_step": layer.columns}
        self._product(layer.columns - skipped, layer.rows, layer.weights_at + skipped, given, out, **steps, **how)

    def _product(self, rows: int, columns: int, at: int, given: GpuArray, out: GpuArray, **how: int) -> None:
        arguments = structures()["ProductArguments"](
            weights=self._address(at),
            input=given.address,
            out=out.address,
            rows=rows,
            columns=columns,
            count=self.count,
            **how,
        )
        blocks = -(-self.count // _PRODUCT_THREADS) * -(-rows // _PRODUCT_ROWS)
        self.gpu.launch("multiply_rows", blocks, _PRODUCT_THREADS, arguments)

    def _sum(self, layer: _Layer, up: GpuArray, given: GpuArray) -> None:
        arguments = self._summed(up=up.address, input=given.address, row_step=layer.columns, **layer._asdict())
        blocks = self._chunks * -(-layer.rows // _SUM_SIDE) * -(-(layer.columns + 1) // _SUM_SIDE)
        self.gpu.launch("sum_products", blocks, _SUM_THREADS, arguments)

    def _summed(self, **fields: int) -> Any:
        return structures()["SumArguments"](
            partials=self._partials.address,
            sums=self._total.address,
            width=self._total.shape[0],
            count=self.count,
            chunk=self._chunk,
            chunks=self._chunks,
            **fields,
        )

    def _address(self, at: int) -> int:
        assert self._weights is not None
        return self._weights.address + 4 * at
