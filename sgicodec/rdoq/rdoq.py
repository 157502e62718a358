"""RDOQ as a whole: passes over seeds. Same bytes for any number of threads."""

from __future__ import annotations

from collections.abc import Callable

from sgicodec.bitstream.parts.tile import TileModel
from sgicodec.rdoq.coordinate_descent import descend
from sgicodec.rdoq.objective import Objective
from sgicodec.rdoq.settings import RdoqSettings

__all__ = ["searched"]


def searched(
    objective: Objective,
    model: TileModel,
    lmbda: float,
    settings: RdoqSettings,
    ending: Callable[[], bool] = lambda: False,
) -> TileModel:
    """The model that passes find, whose attributes lie where they will be coded. Nobody looks at what a pass costs: the
    last one is as good as the best, within 0.2 % (docs/notes/2026-11-rdoq.md).

    Ends early before a pass where `ending` says so.
    """
    if ending():
        return model
    residual = objective.residual(model)
    for done in range(settings.passes):
        if done and ending():
            break
        model, _ = descend(objective, model, residual, lmbda, settings)
    return model
