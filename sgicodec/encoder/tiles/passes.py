"""A pass over the tiles of a picture: what is not there yet is done."""

from __future__ import annotations

from collections.abc import Sequence

from sgicodec.encoder.progress import PassReporter
from sgicodec.encoder.tile.writing import EncodedTile
from sgicodec.encoder.tiles.runner import TileRunner
from sgicodec.encoder.tiles.store import Store, Version
from sgicodec.encoder.tiles.tasks import Task

__all__ = ["tile_pass"]


def tile_pass(
    name: str,
    index: int,
    task: Task[EncodedTile],
    numbers: Sequence[int],
    runner: TileRunner,
    store: Store,
    reporter: PassReporter,
) -> list[Version]:
    """Has a task done to these tiles; the codings of pass `index` are kept in `store`. A pass follows from the results
    of earlier ones alone, so that workers, order and interruptions do not matter. Raises TileFailedError; the store
    then has what was finished.
    """
    chosen = [Version(number, index) for number in numbers]
    reporter.begin(name, numbers, {of.tile: store.tiles[of] for of in chosen if of in store.tiles})
    missing = [of.tile for of in chosen if of not in store.tiles]
    for number, tile in runner(task, missing) if missing else ():
        store.add(Version(number, index), tile)
        reporter.done(number, tile)
    return chosen
