"""Bit allocation: which of several codings to take of each tile, so that all together stay within a limit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

__all__ = ["Option", "allocate"]

LMBDA_MAX_OF_ALLOCATION = 1e30
HALVINGS = 100


class Option(NamedTuple):
    """One coding of a tile: the limit is on the sum of `spent`, the sum of `cost` is to be least."""

    spent: float
    cost: float


def allocate(tiles: Sequence[Sequence[Option]], limit: float) -> list[int]:
    """Index of the option of each tile such that the sum of costs is about the least with which the sum of what is
    spent stays within `limit`; the cheapest option of each tile if even these exceed it.

    One Lagrange multiplier λ for all tiles (Everett 1963, "Generalized Lagrange multiplier method"), then changes of
    single tiles that fit into the rest.
    """
    low, high = 0.0, 1.0
    while _spent(tiles, _best_at(tiles, high)) > limit and high < LMBDA_MAX_OF_ALLOCATION:
        high *= 4.0
    chosen = _best_at(tiles, high)
    if _spent(tiles, chosen) > limit:
        return [min(range(len(options)), key=lambda i: options[i]) for options in tiles]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        tried = _best_at(tiles, middle)
        if _spent(tiles, tried) > limit:
            low = middle
        else:
            high, chosen = middle, tried
    return _filled(tiles, chosen, limit)


def _best_at(tiles: Sequence[Sequence[Option]], lmbda: float) -> list[int]:
    """The option of each tile with the least cost + λ · spent."""
    return [
        min(range(len(options)), key=lambda i: (options[i].cost + lmbda * options[i].spent, options[i].spent))
        for options in tiles
    ]


def _spent(tiles: Sequence[Sequence[Option]], chosen: Sequence[int]) -> float:
    return sum(options[index].spent for options, index in zip(tiles, chosen, strict=True))


def _filled(tiles: Sequence[Sequence[Option]], chosen: list[int], limit: float) -> list[int]:
    """The same with changes of single tiles, the greatest savings first, that cost less and still fit."""
    left = limit - _spent(tiles, chosen)
    changes = sorted(
        (option.cost - options[chosen[tile]].cost, tile, index)
        for tile, options in enumerate(tiles)
        for index, option in enumerate(options)
        if option.cost < options[chosen[tile]].cost
    )
    changed: set[int] = set()
    for _, tile, index in changes:
        more = tiles[tile][index].spent - tiles[tile][chosen[tile]].spent
        if tile not in changed and more <= left:
            left -= more
            chosen[tile] = index
            changed.add(tile)
    return chosen
