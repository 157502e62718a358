"""The launches of a step of the fit on a GPU, and the memory of one layout of seeds."""

from __future__ import annotations

import ctypes
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.cuda import sources
from sgicodec.cuda.gpu import Gpu, GpuArray, Graph
from sgicodec.cuda.structures import structures
from sgicodec.cuda.tiles import CudaView, TilePasses
from sgicodec.fit.adam import Adam
from sgicodec.fit.device_seeds import Trained
from sgicodec.fit.noise import NoiseKey
from sgicodec.fit.step_sizes import base_counts, gamma_names
from sgicodec.model.context import LEVELS, SUMMARY
from sgicodec.model.gaussians import MIN_VARIANCE, colour_matrix
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec

__all__ = ["DeviceStep", "StepKind"]

F32 = NDArray[np.float32]

_SIZES = sources.constants("cuda/fit/state.hpp") | sources.constants("cuda/fit/update.hpp")
SEED_THREADS, REPORT_THREADS = (_SIZES[f"k{name}Threads"] for name in ("Seed", "Report"))
MOVE_THREADS = 256
MAX_CHUNKS = 512
"""Rows of sums over seeds: enough blocks for any GPU, few enough to be added by one thread for each sum."""


class StepKind(NamedTuple):
    """What makes two steps launch the same: rounding, whether MLP_p runs, what moves."""

    rounding: int
    predicts: bool
    moved: tuple[str, ...]


class DeviceStep:
    """Steps of N seeds at fixed places. Graphs are recorded when a kind of step is first run."""

    def __init__(
        self,
        gpu: Gpu,
        spec: ModelSpec,
        weights: tuple[F32, F32],
        layout: SeedLayout,
        neighbour: NDArray[np.int32],
        quality: int,
        cutoff: float,
    ) -> None:
        self.gpu, self.spec, self.cutoff, self.count = gpu, spec, cutoff, len(layout)
        opponent = np.array(colour_matrix(spec.channels), np.float32)
        self._chunk = SEED_THREADS * -(-self.count // (SEED_THREADS * MAX_CHUNKS))
        self._fixed: dict[str, Any] = {
            **{"count": self.count, "channels": spec.channels, "quality": quality},
            **{"hidden": spec.context.hidden, "neighbours": neighbour.shape[1], "chunk": self._chunk},
            "chunks": -(-self.count // self._chunk),
        }
        self._held = {
            "half_pixels": gpu.put(layout.half_pixels),
            "log_size": gpu.put(layout.log_size),
            "neighbour": gpu.put(neighbour),
            "opponent": gpu.put(opponent),
            **{name: gpu.put(part) for name, part in zip(("first", "rest"), weights, strict=True)},
            "numbers": gpu.array(ctypes.sizeof(structures()["StepNumbers"]), np.uint8),
            "report": gpu.array(ctypes.sizeof(structures()["StepReport"]), np.uint8),
            **{name: gpu.array(shape) for name, shape in self._shapes().items()},
        }
        self._moments: dict[str, tuple[GpuArray, GpuArray]] = {}
        self._passes: dict[float, TilePasses] = {}
        self._graphs: dict[tuple[StepKind, float], Graph] = {}

    def put(self, name: str, values: F32, mean: F32, square: F32) -> None:
        """Takes an array that trains, and its moments."""
        if name not in self._held:
            self._held[name] = self.gpu.array(values.shape)
        self._held[name].upload(values)
        if name in self._moments:
            for array, moment in zip(self._moments[name], (mean, square), strict=True):
                array.upload(moment)
        else:
            self._moments[name] = self.gpu.put(mean), self.gpu.put(square)

    def take(self, name: str) -> tuple[F32, F32, F32]:
        """An array that trains and its moments, as they are now."""
        mean, square = self._moments[name]
        return self._held[name].download(), mean.download(), square.download()

    def trained(self) -> Trained:
        """What trains, which another step may adopt."""
        return Trained({name: self._held[name] for name in self._moments}, self._moments, self._capacity)

    def adopt(self, trained: Trained) -> None:
        """Takes what trains of a step before, of as many seeds as this one has."""
        self._held |= trained.held
        self._moments, self._capacity = trained.moments, trained.pairs

    def exact_gaussians(self) -> tuple[GpuArray, GpuArray]:
        """Covariances and colours of the values as they are."""
        given = self._arguments(StepKind(0, False, ()))
        given.decoded = self._address("slopes")  # nobody reads it any more
        self.gpu.launch("forward_seeds", -(-self.count // SEED_THREADS), SEED_THREADS, given)
        return self._held["covariances"], self._held["colours"]

    def exact_image(self, level: dict[str, GpuArray]) -> GpuArray:
        """The picture of the values as they are, of a level at scale 1."""
        self.exact_gaussians()
        image = self.gpu.array(level["target"].shape)
        passes = self._passes_of(1.0, level)
        if passes.bin_all():
            self._note_room(passes)
        passes.set(image=image.address)
        passes.over_tiles("forward")
        return image

    def numbers(
        self, key: NoiseKey, lmbda: float, adam: Adam, corrected: list[tuple[float, float]]
    ) -> ctypes.Structure:
        """What a step is told; `corrected`: rate and root of the arrays that move, in their order."""
        numbers = structures()["StepNumbers"](
            key=key.key, mirror=0xFFFFFFFF if key.negative else 0, lmbda=lmbda, epsilon=adam.epsilon
        )
        numbers.beta1, numbers.beta2 = adam.betas
        for place, (rate, root) in enumerate(corrected):
            numbers.rate[place], numbers.root_correction[place] = rate, root
        return numbers

    def run(
        self, kind: StepKind, scale: float, level: dict[str, GpuArray], numbers: ctypes.Structure
    ) -> tuple[float, float]:
        """A step against a level of the pyramid: error and bits. One whose pairs have no room is repeated with more."""
        told = np.frombuffer(bytes(numbers), np.uint8)
        self._held["numbers"].upload(told, wait=False)
        while True:
            passes = self._passes_of(scale, level)
            self._launched(kind, scale, passes)
            report = structures()["StepReport"].from_buffer_copy(self._held["report"].download().tobytes())
            if passes.had_room(report.pairs):
                return float(report.error), float(report.bits)
            self._note_room(passes)

    _capacity = 0

    def _note_room(self, passes: TilePasses) -> None:
        """To be called when passes have more room: graphs have their memory of before."""
        self._graphs, self._capacity = {}, passes.capacity

    def _launched(self, kind: StepKind, scale: float, passes: TilePasses) -> None:
        """Launches a step: as a graph, but for the first of its kind, since the driver loads kernels on first use."""
        if kind not in self.gpu.launched:
            self.gpu.launched.add(kind)
            return self._launch(kind, passes)
        if (kind, scale) not in self._graphs:
            with self.gpu.recorded() as graph:
                self._launch(kind, passes)
            self._graphs[kind, scale] = graph
        return self._graphs[kind, scale].launch()

    def _launch(self, kind: StepKind, passes: TilePasses) -> None:
        """All kernels of a step, in their order."""
        given, seeds = self._arguments(kind, passes), -(-self.count // SEED_THREADS)
        if kind.predicts:
            self.gpu.launch("summarize_seeds", seeds, SEED_THREADS, given)
        self.gpu.launch("forward_seeds", seeds, SEED_THREADS, given)
        passes.bin()
        passes.over_tiles("error")
        passes.reduce()
        self.gpu.launch("descend_seeds", given.chunks, SEED_THREADS, given)
        if kind.rounding:
            steps = self._size_of("grad_steps")
            self.gpu.launch("sum_chunks", -(-steps // SEED_THREADS), SEED_THREADS, given)
        self._launch_adam(kind.moved, given)
        self.gpu.launch("report_step", 1, REPORT_THREADS, given)

    def _launch_adam(self, moved: tuple[str, ...], given: ctypes.Structure) -> None:
        adam = structures()["AdamArguments"](arrays=len(moved), capacity=given.capacity)
        adam.numbers, adam.pairs = given.numbers, given.pairs
        total = 0
        for place, name in enumerate(moved):
            adam.value[place], adam.gradient[place] = self._address(name), self._address(f"grad_{name}")
            adam.mean[place], adam.square[place] = (array.address for array in self._moments[name])
            adam.size[place] = self._size_of(name)
            total += adam.size[place]
        self.gpu.launch("move_arrays", -(-total // MOVE_THREADS), MOVE_THREADS, adam)

    def _arguments(self, kind: StepKind, passes: TilePasses | None = None) -> ctypes.Structure:
        fields: dict[str, Any] = {name: array.address for name, array in self._held.items()}
        if passes is not None:
            fields |= {"tiles": passes.view.tiles, "capacity": passes.capacity, "errors": passes.errors.address}
            fields["pairs"] = passes.slot_start.address + 4 * passes.gaussians
        return structures()["FitArguments"](
            **self._fixed, **fields, rounding=kind.rounding, predicts=int(kind.predicts)
        )

    def _passes_of(self, scale: float, level: dict[str, GpuArray]) -> TilePasses:
        if scale not in self._passes:
            names = ("means", "covariances", "colours")
            fields: dict[str, Any] = {name: self._address(name) for name in names}
            fields |= {f"grad_{name}": self._address(f"grad_{name}") for name in names}
            fields |= {name: array.address for name, array in level.items()}
            fields |= {"cutoff": self.cutoff, "scale": scale, "minimum": MIN_VARIANCE}
            _, height, width = level["target"].shape
            view = CudaView(width, height)
            self._passes[scale] = TilePasses(
                self.gpu, view, self.count, self.spec.channels, fields, capacity=self._capacity
            )
        return self._passes[scale]

    def _address(self, name: str) -> int:
        return self._held[name].address

    def _size_of(self, name: str) -> int:
        return math.prod(self._held[name].shape)

    def _shapes(self) -> dict[str, tuple[int, ...]]:
        """Of what a step writes."""
        n, channels, attributes = self.count, self.spec.channels, self.spec.channels + 5
        steps, units = sum(base_counts(self.spec)) + len(gamma_names(self.spec)), sum(base_counts(self.spec)) // LEVELS
        gaussians = {"means": (n, 2), "covariances": (n, 3), "colours": (n, channels)}
        values = {"colour": (n, channels), "shape": (n, 3), "offset": (n, 2)}
        return {
            **{"summary": (n, SUMMARY), "kept": (n, units, 3)},
            **{"decoded": (n, attributes), "slopes": (n, attributes), "bits": (n,)},
            **gaussians,
            **{f"grad_{name}": shape for name, shape in (gaussians | values).items()},
            **{"partials": (self._fixed["chunks"], steps), "grad_steps": (steps,)},
        }
