"""A step of the paper profile on a GPU: loss and gradients there, everything else as on the processor."""

from __future__ import annotations

import ctypes
from itertools import pairwise
from typing import Any

import numpy as np

from sgicodec import _native
from sgicodec.cuda import sources
from sgicodec.cuda.gpu import GpuArray
from sgicodec.cuda.structures import structures
from sgicodec.cuda.tiles import CudaView, TilePasses
from sgicodec.fit.device_networks import DECODERS, Activations, DeviceNetworks
from sgicodec.fit.feature_step import FeatureInputs, FeatureOutputs, FeatureStep
from sgicodec.fit.pyramid import PyramidLevel
from sgicodec.fit.seed_step import ROUNDINGS
from sgicodec.model.context import INPUT_BITS, hash_grid, level_inputs
from sgicodec.model.layout import SeedLayout
from sgicodec.model.spec import ModelSpec
from sgicodec.profiles.fit_settings import FitSettings
from sgicodec.raster.cuda import CudaRasterizer

_SEED_THREADS = sources.constants("cuda/fit/features.hpp")["kFeatureThreads"]
_GAUSSIANS = ("means", "covariances", "colours")


class DeviceFeatureStep(FeatureStep):
    """A `GradientStep` as `FeatureStep`, whose kernels run on the GPU of `raster`, with its cutoff. What trains goes
    there in each step, and gradients come back. Same input, same bytes, on one GPU.
    """

    def __init__(self, spec: ModelSpec, settings: FitSettings, raster: CudaRasterizer, size: tuple[int, int]) -> None:
        self.spec, self.settings, self.size = spec, settings, size
        self.gpu, self.cutoff = raster.gpu, raster.cutoff
        self._level: tuple[PyramidLevel, dict[str, GpuArray]] | None = None
        self._passes: TilePasses | None = None

    def set_layout(self, layout: SeedLayout, colour_step: int) -> None:
        """As `GradientStep.set_layout`."""
        self.gpu.use()
        self.count, self._passes = len(layout), None
        context = self.spec.context
        grid = hash_grid(context, *self.size)
        starts = np.concatenate([[0], np.cumsum(grid.counts)]) // context.hash_features
        entry, weight = grid.corners(layout.half_pixels)
        entry = (entry + starts[:-1, None]).astype(np.int32)
        constants = level_inputs(layout, colour_step).T.astype(np.float32) / np.float32(1 << INPUT_BITS)
        hashed = np.zeros((len(grid.counts) * context.hash_features, self.count), np.float32)
        self._constants, self._table_starts = len(constants), (starts * context.hash_features).tolist()
        fixed = {
            "half_pixels": layout.half_pixels,
            "entry": entry,
            "weight": (weight / (1 << 2 * INPUT_BITS)).astype(np.float32),
            "reads": np.argsort(entry, axis=None, kind="stable").astype(np.int32),
            "read_start": np.searchsorted(np.sort(entry, axis=None), np.arange(starts[-1] + 1)).astype(np.int32),
            "table_start": starts.astype(np.int32),
            "inputs": np.concatenate([constants, hashed]),
        }
        self._held = {name: self.gpu.put(np.ascontiguousarray(values)) for name, values in fixed.items()}
        self._held |= {name: self.gpu.array(shape) for name, shape in self._shapes(len(hashed)).items()}
        self._networks = DeviceNetworks(self.gpu, self.spec, self.count)

    def _evaluate(self, given: FeatureInputs, level: PyramidLevel) -> FeatureOutputs:
        self.gpu.use()
        arguments, networks = self._take(given, level.scale), self._networks
        if given.priced:
            self._over_seeds("read_hash", arguments)
            networks.forward("context", self._rows("context"))
        self._over_seeds("draw_features", arguments)
        for name in DECODERS:
            networks.forward(name, self._rows(name))
        self._over_seeds("write_feature_gaussians", arguments)
        error = self._error(level)
        self._over_seeds("read_feature_slopes", arguments)
        for name in DECODERS:
            networks.backward(name, self._rows(name))
        self._over_seeds("price_features", arguments)
        if given.priced:
            networks.backward("context", self._rows("context"))
            self.gpu.launch("descend_tables", -(-len(given.tables) // _SEED_THREADS), _SEED_THREADS, arguments)
        return self._outputs(given, error)

    def _take(self, given: FeatureInputs, scale: float) -> ctypes.Structure:
        """Uploads what trains; what the kernels for seeds are called with."""
        steps = np.exp2(given.steps)
        if not given.priced:
            steps[self.spec.group("offset").columns] *= np.float32(scale)
        taken = {"trained": np.concatenate([values.T for values in given.values]), "steps": steps}
        weights = [given.decoders]
        if given.priced:
            weights += [given.rest, given.first]
            taken |= {"theta": given.tables, "signs": np.where(given.tables >= 0, np.int8(1), np.int8(-1))}
            parts = [given.tables[a:b] for a, b in pairwise(self._table_starts)]
            slopes = [_native.sign_slope(int((part >= 0).sum()), len(part), given.price) for part in parts]
            taken["sign_slopes"] = np.array(slopes, np.float32)
        self._networks.load(np.concatenate(weights))
        for name, values in taken.items():
            if name not in self._held:
                self._held[name] = self.gpu.array(values.shape, values.dtype)
            self._held[name].upload(values)
        sizes = {"count": self.count, "per_seed": self.spec.per_seed, "channels": self.spec.channels}
        context = self.spec.context
        return structures()["FeatureArguments"](
            **sizes,
            features=self.spec.features,
            hidden=self.spec.hidden,
            context_hidden=context.hidden,
            resolutions=len(context.hash_resolutions),
            entry_features=context.hash_features,
            entries=self._table_starts[-1] // context.hash_features,
            rounding=ROUNDINGS[given.rounding],
            priced=int(given.priced),
            key=given.noise.key,
            mirror=0xFFFFFFFF if given.noise.negative else 0,
            scale=scale,
            share=given.share,
            price=given.price / given.share,
            **{name: array.address for name, array in self._held.items() if name not in _OF_NETWORKS},
        )

    def _error(self, level: PyramidLevel) -> float:
        """Squared error; the gradients of the mean absolute error in the Gaussians are there then."""
        passes = self._passes_of(level)
        passes.bin_all()
        passes.over_tiles("absolute_error")
        passes.reduce()
        return float(passes.errors.download()[:, 0].sum())

    def _outputs(self, given: FeatureInputs, error: float) -> FeatureOutputs:
        widths = np.cumsum([values.shape[1] for values in given.values[:-1]])
        parts = np.split(self._held["slopes"].download(), widths)
        feature, scales, offset = (np.ascontiguousarray(part.T) for part in parts)
        bits = float(self._held["bits"].download().sum(dtype=np.float64))
        tables = self._held["tables"].download() if given.priced else given.tables
        return FeatureOutputs(error, bits, (feature, scales, offset), self._networks.sums(), tables)

    def _over_seeds(self, kernel: str, arguments: ctypes.Structure) -> None:
        self.gpu.launch(kernel, -(-self.count // _SEED_THREADS), _SEED_THREADS, arguments)

    def _rows(self, name: str) -> Activations:
        """Of a network. Gradients of what the decoders see are added up."""
        hidden, said, up, slopes = (self._held[f"{part}_{name}"] for part in ("hidden", "said", "up", "hidden_slopes"))
        inputs, down, adds, skipped = self._held["drawn"], self._held["slopes"], name != DECODERS[0], 0
        if name == "context":
            inputs, down, adds, skipped = self._held["inputs"], self._held["hash_slopes"], False, self._constants
        return Activations(inputs, hidden, said, up, slopes, down, adds, skipped)

    def _passes_of(self, level: PyramidLevel) -> TilePasses:
        """Over the tiles of a level, whose samples and weights stay on the GPU until there is another."""
        if self._level is None or self._level[0] is not level:
            self._passes, held = None, {"target": self.gpu.put(level.samples)}
            if level.weights is not None:
                held["weights"] = self.gpu.put(level.weights)
            self._level = level, held
        if self._passes is None:
            names = (*_GAUSSIANS, *(f"grad_{name}" for name in _GAUSSIANS))
            fields: dict[str, Any] = {name: self._held[name].address for name in names}
            fields |= {name: array.address for name, array in self._level[1].items()}
            fields |= {"cutoff": self.cutoff, "weight": 1.0 / level.samples.size}
            _, height, width = level.samples.shape
            view, gaussians = CudaView(width, height), self.count * self.spec.per_seed
            self._passes = TilePasses(self.gpu, view, gaussians, self.spec.channels, fields)
        return self._passes

    def _shapes(self, hashed: int) -> dict[str, tuple[int, ...]]:
        """Of what a step writes; `hashed` inputs of MLP_p come from the hash grid."""
        n, attributes = self.count, self.spec.attributes
        colour, shape, context = self.spec.per_seed * self.spec.channels, 3 * self.spec.per_seed, 2 * attributes + 3
        hidden = {"colour": self.spec.hidden, "shape": self.spec.hidden, "context": self.spec.context.hidden}
        said = {"colour": colour, "shape": shape, "context": context}
        gaussians = {"means": 2, "covariances": 3, "colours": self.spec.channels}
        return {
            **{name: (attributes, n) for name in ("values", "drawn", "slopes")},
            **{f"{part}_{name}": (rows, n) for part in ("hidden", "hidden_slopes") for name, rows in hidden.items()},
            **{f"{part}_{name}": (rows, n) for part in ("said", "up") for name, rows in said.items()},
            **{name: (n * self.spec.per_seed, width) for name, width in gaussians.items()},
            **{f"grad_{name}": (n * self.spec.per_seed, width) for name, width in gaussians.items()},
            **{"hash_slopes": (hashed, n), "bits": (n,), "bit_rows": (3 * attributes + 3, n)},
            "tables": (self._table_starts[-1],),
        }


_OF_NETWORKS = {f"{part}_{name}" for part in ("hidden", "hidden_slopes") for name in (*DECODERS, "context")}
"""Rows that no kernel for seeds is told of."""
