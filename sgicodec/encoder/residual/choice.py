"""How tiles and a residual layer share a picture: which of the ways there are is taken."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from sgicodec.encoder.input.windows import Windows
from sgicodec.encoder.plan import Plan
from sgicodec.encoder.progress import NullListener
from sgicodec.encoder.residual.below_layer import with_layer, without_loss
from sgicodec.encoder.residual.classes import bands_of_classes, lost_bands
from sgicodec.encoder.residual.division import Division, has_all_samples
from sgicodec.encoder.residual.graphics import exact_instead, with_graphics
from sgicodec.encoder.residual.layer import ResidualLayer


def way_to_divide(windows: Windows, plan: Plan, listener: NullListener) -> Callable[[Windows, Plan], Division]:
    """How tiles and a residual layer share the picture. The listener gets to know of classes that change."""
    settings, max_error = plan.settings, plan.settings.max_error
    if max_error == 0:
        return with_layer
    bands = bands_of_classes(windows, plan)
    if bands and max_error is None and settings.without_target().is_quality_asked:
        return lambda windows, plan: _with_classes(windows, plan, bands)
    _note_changes(bands, plan, listener)
    return _by_graphics if max_error is None else with_layer


def _note_changes(bands: Sequence[int], plan: Plan, listener: NullListener) -> None:
    """Tells of bands of classes that change, and of those of which an error may leave nothing."""
    max_error, count = plan.settings.max_error, plan.header.spec.channels
    if len(bands) == count:
        how = "change" if max_error is None else f"may change by {max_error:g}"
        listener.note(f"its few values, as of classes, {how}: use --lossless")
    elif bands:
        what = "few values or runs of equal ones, as of classes and numbered areas,"
        listener.note(f"{what} change in {_named(bands)}: encode them apart, or use --lossless")
    if max_error is not None and len(bands) < count and (lost := lost_bands(plan, max_error)):
        what = f"an error of {max_error:g} either way spans all samples of {_named(lost)}"
        listener.note(f"{what}: nothing of them need remain")


def _named(bands: Sequence[int]) -> str:
    """Bands, from 0 on, as messages call them."""
    return f"band{'s' * (len(bands) > 1)} {', '.join(str(band + 1) for band in bands)}"


def _by_graphics(windows: Windows, plan: Plan) -> Division:
    return with_graphics(windows, plan) if plan.settings.is_quality_asked else Division(windows, plan)


def _with_classes(windows: Windows, plan: Plan, bands: tuple[int, ...]) -> Division:
    """A layer that shows these bands, in every view where it can, unless it takes no more to show all."""
    if len(bands) == windows.shape.bands:
        return without_loss(windows, plan)
    has_views = has_all_samples(plan.header)
    exact = exact_instead(windows, plan) if plan.settings.is_quality_asked else None
    shown = replace(plan, exact_bands=bands) if has_views else plan
    return Division(windows, shown, ResidualLayer.exact(windows, exact_views=has_views, bands=bands), exact)


def fixed_division(windows: Windows, plan: Plan) -> Division:
    """A layer where an error or classes ask for one, and for nothing else: for those who promise a shape."""
    if plan.settings.max_error is not None:
        return Division(windows, plan, ResidualLayer(windows, plan.settings.max_error))
    bands = bands_of_classes(windows, plan) if plan.settings.is_quality_asked else ()
    return _with_classes(windows, plan, bands) if bands else Division(windows, plan)
