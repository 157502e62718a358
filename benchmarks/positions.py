"""What seeds' places cost as stated and as predicted probabilities: python -m benchmarks.positions STREAM…

Both codings of each stream's tree are written and read back.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import mean

import numpy as np

from sgicodec.bitstream.entropy.symbol_coder import SymbolCoder, SymbolReader, SymbolWriter
from sgicodec.bitstream.parts.positions import code_positions
from sgicodec.bitstream.parts.predicted_positions import code_predicted_positions
from sgicodec.bitstream.parts.predicted_tree import LEVELS, TreeContext
from sgicodec.bitstream.parts.seed_tree import Seeds, TreeShape
from sgicodec.decoder.stream import open_stream

__all__ = ["Cost", "costs", "main"]

Coder = Callable[[SymbolCoder, Seeds | None], Seeds]


@dataclass(frozen=True)
class Cost:
    """bits of the seeds' places and seconds that reading them takes."""

    bits: float
    seconds: float


def costs(path: Path, repeat: int = 5) -> tuple[int, Cost, Cost]:
    """Number of seeds of a stream of one tile with an adaptive tree, and what stated and predicted places cost."""
    with open_stream(path) as stream:
        header, model = stream.header, stream.model
    shape = TreeShape(header.width, header.height, LEVELS[0], LEVELS[-1])
    scenery = TreeContext(model.base, header.spec.base_cell, header.quality)
    seeds, most = (model.layout.corner, model.layout.log_size), len(model.layout)

    def stated(walk: SymbolCoder, given: Seeds | None) -> Seeds:
        return code_positions(walk, shape, given, most)

    def predicted(walk: SymbolCoder, given: Seeds | None) -> Seeds:
        return code_predicted_positions(walk, shape, scenery, given, most)

    return most, _cost(stated, seeds, repeat), _cost(predicted, seeds, repeat)


def _cost(code: Coder, seeds: Seeds, repeat: int) -> Cost:
    writer = SymbolWriter()
    code(writer, seeds)
    payload, took = writer.finish(), []
    for _ in range(repeat):
        reader = SymbolReader(payload)
        start = time.perf_counter()
        found = code(reader, None)
        took.append(time.perf_counter() - start)
        if not np.array_equal(found[0], seeds[0]):
            raise ValueError("places differ from those that were written")
    return Cost(sum(bits for part, bits in writer.bits.items() if part != "check"), min(took))


def main(paths: list[str]) -> None:
    """Prints a line for each stream, and the mean of the changes."""
    changes = []
    print("| stream | seeds | bits a seed | predicted | change | of the file | read, ms | predicted |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    for path in map(Path, paths):
        seeds, stated, predicted = costs(path)
        change, size = predicted.bits / stated.bits - 1, 8 * path.stat().st_size
        changes.append(change)
        row = f"| {path.stem} | {seeds:,} | {stated.bits / seeds:.2f} | {predicted.bits / seeds:.2f} | {change:.1%} |"
        row += f" {(predicted.bits - stated.bits) / size:.2%} |"
        print(f"{row} {1e3 * stated.seconds:.1f} | {1e3 * predicted.seconds:.1f} |")
    print(f"\nmean change {mean(changes):.2%}")


if __name__ == "__main__":
    main(sys.argv[1:])
