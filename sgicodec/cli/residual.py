"""`sgi refine` and `sgi strip`: the residual layer of a stream is added later, and taken off."""

from __future__ import annotations

from contextlib import ExitStack
from io import BytesIO
from typing import TYPE_CHECKING, Any

import click

from sgicodec.cli.command import HelpfulCommand
from sgicodec.cli.options import (
    FILE,
    alpha_option,
    force_option,
    page_option,
    quiet_option,
    threads_option,
)
from sgicodec.cli.paths import STANDARD, check_output, display, given, naming_stream, output_file
from sgicodec.device import Device
from sgicodec.errors import UsageError

if TYPE_CHECKING:
    from sgicodec.decoder.stream import Stream
    from sgicodec.image.opened import Alpha


@click.command(
    cls=HelpfulCommand,
    short_help="Add a residual layer: every sample exact, or near it.",
    common=("max_error",),
    examples=(("sgi refine photo.png photo.sgi exact.sgi", "the stream of a photograph becomes lossless"),),
)
@click.argument("picture", metavar="PICTURE", type=FILE)
@click.argument("source", metavar="IN", type=FILE)
@click.argument("target", metavar="OUT", type=FILE)
@click.option(
    "--max-error", type=click.FloatRange(0), default=0.0, show_default=True, metavar="N", help="As in encode."
)
@alpha_option
@page_option
@threads_option
@force_option
@quiet_option
def refine(
    picture: str,
    source: str,
    target: str,
    max_error: float,
    alpha: Alpha,
    page: int | None,
    threads: int,
    force: bool,
    quiet: bool,
) -> None:
    """Copy stream IN, made from PICTURE, into stream OUT with a residual layer: no sample is off by more than N.
    - stands for stdin or stdout.

    PICTURE is read as the encode read it: --alpha and --page are those of the encode. A residual layer that IN has
    is replaced. The rest of the stream stays as it is.
    """
    from sgicodec.cli.encode_listener import EncodeListener
    from sgicodec.decoder.stream import open_stream
    from sgicodec.encoder.input.windows import windows_of, without_needless_alpha
    from sgicodec.encoder.plan import check_clipped, stream_plan
    from sgicodec.encoder.residual.layer import ResidualLayer, residual_payload
    from sgicodec.encoder.settings import EncodeSettings
    from sgicodec.image.source import open_to_encode

    if picture == source == STANDARD:
        raise UsageError("stdin holds one file; name PICTURE or IN")
    settings = EncodeSettings(max_error=max_error)
    check_output(target, (picture, source), force, becomes="copy")
    device = Device(threads)
    with naming_stream(source):
        data = given(source, again=True)
    with ExitStack() as stack:
        listener = EncodeListener("off", quiet, on_cluster=False, source=picture)
        reading: dict[str, Any] = {"alpha": alpha, "page": page, "option": "--page"}
        opened = stack.enter_context(open_to_encode(given(picture), listener.note, **reading))
        stack.enter_context(naming_stream(source))
        stream = stack.enter_context(open_stream(data, device))
        check_below(stream)
        windows = windows_of(opened)
        check_clipped(windows.shape)
        if windows.shape.bands > stream.header.spec.channels:
            windows, _ = without_needless_alpha(windows, stream_plan(windows.shape, settings), listener)
        layer = residual_payload(stream, ResidualLayer(windows, max_error), device)
    _rewritten(data, source, target, layer, quiet)


@click.command(
    cls=HelpfulCommand,
    short_help="Take the residual layer off.",
    examples=(("sgi strip exact.sgi small.sgi", "the lossy picture alone"),),
)
@click.argument("source", metavar="IN", type=FILE)
@click.argument("target", metavar="OUT", type=FILE)
@force_option
@quiet_option
def strip(source: str, target: str, force: bool, quiet: bool) -> None:
    """Copy stream IN into stream OUT without its residual layer; the rest stays as it is. - stands for stdin
    or stdout.
    """
    from sgicodec.decoder.stream import open_stream

    check_output(target, (source,), force, becomes="copy")
    with naming_stream(source):
        data = given(source, again=True)
        with open_stream(data) as stream:
            check_below(stream)
    _rewritten(data, source, target, None, quiet)


def check_below(stream: Stream) -> None:
    """Raises UsageError where the residual layer of a stream shows what nothing below it does."""
    if stream.has_exact_views:
        bands = f"bands {', '.join(map(str, stream.exact_bands))} are" if stream.exact_bands else ""
        what = bands or ("alpha is" if stream.has_exact_alpha else "text and line art are")
        raise UsageError(f"its {what} in the residual layer alone")


def _rewritten(data: str | bytes, source: str, target: str, layer: bytes | None, quiet: bool) -> None:
    from sgicodec.bitstream.rewriting import rewrite_stream
    from sgicodec.decoder.stream import file_at

    with (
        naming_stream(source),
        BytesIO(data) if isinstance(data, bytes) else file_at(data) as stream,
        output_file(target) as file,
    ):
        size = rewrite_stream(stream, file, layer)
    if not quiet:
        of = "" if layer is None else f", of which {len(layer):,} are the residual layer"
        click.echo(f"{display(target, 'stdout')}: {size:,} bytes{of}", err=target == STANDARD)
