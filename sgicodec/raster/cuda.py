"""The CUDA back end: numpy arrays in and out, the work on a GPU."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from sgicodec.arrays import F32
from sgicodec.cuda.gpu import Gpu, GpuArray
from sgicodec.cuda.tiles import MAX_CHANNELS, CudaView, TilePasses
from sgicodec.errors import UsageError
from sgicodec.raster.backend import DEFAULT_CUTOFF, Errors, Loss
from sgicodec.raster.cpu import MAX_PAIRS

Gaussians = tuple[F32, F32, F32]


class CudaRasterizer:
    """Additive splatting on a GPU, a `Backend` of float32 numpy arrays. Same input, same bytes, on one GPU.

    What lies beyond `cutoff` standard deviations is left out. More than `most_pairs` pairs of tile and Gaussian, about
    60 bytes each, raise OverflowError; more than 4 channels raise UsageError. Not safe for use by two threads at once.
    """

    def __init__(self, gpu: Gpu, cutoff: float = DEFAULT_CUTOFF, most_pairs: int = MAX_PAIRS) -> None:
        self.gpu, self.cutoff, self.most_pairs = gpu, cutoff, most_pairs
        self._held: dict[str, GpuArray] = {}
        self._passes: tuple[tuple[CudaView, int, int, bool], TilePasses] | None = None

    @property
    def device_name(self) -> str:
        """The GPU's."""
        return self.gpu.name

    def forward(
        self, means: F32, covariances: F32, colours: F32, width: int, height: int, origin: tuple[int, int] = (0, 0)
    ) -> F32:
        """As in `Backend`."""
        return self._image((means, covariances, colours), CudaView(width, height, *origin)).download()

    def error(
        self,
        means: F32,
        covariances: F32,
        colours: F32,
        target: F32,
        loss: Loss = "squared",
        weight: float = 1.0,
        weights: F32 | None = None,
        origin: tuple[int, int] = (0, 0),
    ) -> tuple[Errors, Gaussians]:
        """As in `Backend`, of target [C, H, W], without storing the image."""
        passes = self._binned((means, covariances, colours), CudaView(target.shape[2], target.shape[1], *origin))
        by_pixel = 0 if weights is None else self._put("weights", weights).address
        passes.set(target=self._put("target", target).address, weight=weight, weights=by_pixel)
        gradients = self._gradients(passes, "error" if loss == "squared" else "absolute_error")
        squared, found = passes.errors.download().sum(axis=0).tolist()
        return Errors(found, squared), gradients

    def _image(self, gaussians: Gaussians, view: CudaView) -> GpuArray:
        passes = self._binned(gaussians, view, differentiates=False)
        image = self.gpu.array((passes.channels, view.height, view.width))
        passes.set(image=image.address)
        passes.over_tiles("forward")
        return image

    def _binned(self, gaussians: Gaussians, view: CudaView, differentiates: bool = True) -> TilePasses:
        """Passes over the tiles of these Gaussians, with room for all pairs."""
        channels = gaussians[2].shape[1]
        if channels > MAX_CHANNELS:
            raise UsageError(f"{channels} channels; a GPU draws up to {MAX_CHANNELS}")
        self.gpu.use()
        kind = view, len(gaussians[0]), channels, differentiates
        held = {name: self._put(name, array).address for name, array in zip(_INPUTS, gaussians, strict=True)}
        if self._passes is None or self._passes[0] != kind:
            self._passes = None  # its memory is free before there is more
            fields = {"cutoff": self.cutoff}
            self._passes = kind, TilePasses(self.gpu, *kind[:3], fields, differentiates, self.most_pairs)
        passes = self._passes[1]
        passes.set(**held)
        passes.bin_all()
        return passes

    def _put(self, name: str, values: NDArray[Any]) -> GpuArray:
        """An array on the GPU, where that of this name and shape was before."""
        if name not in self._held or self._held[name].shape != values.shape:
            self._held[name] = self.gpu.array(values.shape)
        self._held[name].upload(values)
        return self._held[name]

    def _gradients(self, passes: TilePasses, kernel: str) -> Gaussians:
        shapes = ((passes.gaussians, 2), (passes.gaussians, 3), (passes.gaussians, passes.channels))
        out = [self.gpu.array(shape) for shape in shapes]
        passes.set(**{f"grad_{name}": array.address for name, array in zip(_INPUTS, out, strict=True)})
        passes.over_tiles(kernel)
        passes.reduce()
        means, covariances, colours = (array.download() for array in out)
        return means, covariances, colours


_INPUTS = ("means", "covariances", "colours")
