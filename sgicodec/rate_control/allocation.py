"""Which of several codings to take of each tile, so that all together stay within a limit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

__all__ = ["Option", "choose"]


class Option(NamedTuple):
    """One coding of a tile: `spent` is what the limit is on, `cost` what is to become least."""

    spent: float
    cost: float


def choose(tiles: Sequence[Sequence[Option]], limit: float) -> list[int]:
    """The option of each tile whose costs together are about the least among those that together spend no more than
    `limit`; the thriftiest of each tile if even these exceed it.

    One price of what is spent for all tiles (Everett 1963, "Generalized Lagrange multiplier method"), then single
    tiles that what is left can pay for.
    """
    low, high = 0.0, 1.0
    while _spent(tiles, _at(tiles, high)) > limit and high < _DEAREST:
        high *= 4.0
    chosen = _at(tiles, high)
    if _spent(tiles, chosen) > limit:
        return [min(range(len(options)), key=lambda i: options[i]) for options in tiles]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        tried = _at(tiles, middle)
        if _spent(tiles, tried) > limit:
            low = middle
        else:
            high, chosen = middle, tried
    return _filled(tiles, chosen, limit)


_DEAREST, _HALVINGS = 1e30, 100


def _at(tiles: Sequence[Sequence[Option]], price: float) -> list[int]:
    """What is best of each tile at a price."""
    return [
        min(range(len(options)), key=lambda i: (options[i].cost + price * options[i].spent, options[i].spent))
        for options in tiles
    ]


def _spent(tiles: Sequence[Sequence[Option]], chosen: Sequence[int]) -> float:
    return sum(options[index].spent for options, index in zip(tiles, chosen, strict=True))


def _filled(tiles: Sequence[Sequence[Option]], chosen: list[int], limit: float) -> list[int]:
    """The same with those tiles changed, the greatest savings first, whose change costs less and still fits."""
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
