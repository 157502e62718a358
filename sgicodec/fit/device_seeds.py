"""Seeds that come and go while a fit's arrays stay on a GPU: what decides is fetched, what trains is not."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgicodec.cuda import sources
from sgicodec.cuda.gpu import Gpu, GpuArray
from sgicodec.cuda.structures import structures
from sgicodec.model.layout import ROOT_LOG

__all__ = ["Trained", "energy_of", "moved", "residual_sums"]

F32 = NDArray[np.float32]

THREADS = sources.constants("cuda/fit/seeds.hpp")["kRowThreads"]
CELL = sources.constants("native/model/cell_sums.hpp")["kSmallestCell"]


class Trained(NamedTuple):
    """All that trains, and what it stands on, by the names of a step's arguments; the moments by the names of
    `Parameters.trained`. pairs: of tile and Gaussian, for which there was room.
    """

    held: dict[str, GpuArray]
    moments: dict[str, tuple[GpuArray, GpuArray]]
    pairs: int


def energy_of(gpu: Gpu, covariances: GpuArray, colours: GpuArray, seeds: int) -> F32:
    """`SeedSet.energy` of Gaussians [N, 3] and [N, C]: 4 bytes a seed come back."""
    energy = gpu.array(seeds)
    given = structures()["EnergyArguments"](
        covariances=covariances.address,
        colours=colours.address,
        energy=energy.address,
        count=seeds,
        channels=colours.shape[1],
    )
    gpu.launch("measure_energy", -(-seeds // THREADS), THREADS, given)
    return energy.download()


def residual_sums(image: GpuArray, target: GpuArray, weights: GpuArray | None) -> F32:
    """Σ w (target − image) over cells of two pixels, which fill whole root cells [C, rows, columns]: a quarter of the
    picture's samples come back.
    """
    gpu, (channels, height, width) = image.gpu, image.shape
    rows, columns = (-(-side >> ROOT_LOG) * ((1 << ROOT_LOG) // CELL) for side in (height, width))
    sums = gpu.array((channels, rows, columns))
    given = structures()["ResidualArguments"](
        image=image.address,
        target=target.address,
        weights=weights.address if weights is not None else None,
        sums=sums.address,
        **{"channels": channels, "height": height, "width": width, "rows": rows, "columns": columns},
    )
    gpu.launch("sum_residual", -(-channels * rows * columns // THREADS), THREADS, given)
    return sums.download()


def moved(trained: Trained, rows: NDArray[np.int32], fresh: dict[str, F32]) -> Trained:
    """What trains of other seeds: those of `rows` [M], and for −1 − i row i of `fresh`, with moments of zero."""
    gpu = next(iter(trained.held.values())).gpu
    index = gpu.put(rows)
    held, moments = dict(trained.held), dict(trained.moments)
    for name, values in fresh.items():
        new = gpu.put(values) if len(values) else None
        held[name] = _moved(trained.held[name], index, new)
        mean, square = trained.moments[name]
        moments[name] = _moved(mean, index, None), _moved(square, index, None)
        gpu.wait()  # `new` goes
    return trained._replace(held=held, moments=moments)


def _moved(array: GpuArray, index: GpuArray, fresh: GpuArray | None) -> GpuArray:
    width = array.shape[1]
    to = array.gpu.array((len_of(index), width))
    given = structures()["RowArguments"](
        source=array.address,
        fresh=fresh.address if fresh is not None else None,
        to=to.address,
        rows=index.address,
        count=len_of(index),
        width=width,
    )
    array.gpu.launch("move_rows", -(-len_of(index) * width // THREADS), THREADS, given)
    return to


def len_of(array: GpuArray) -> int:
    """Of its first axis."""
    return array.shape[0]
