"""The label and the macro of a slide, which `sgi encode --associated` writes beside the stream."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import click

from sgicodec.cli.paths import STANDARD, check_output, display
from sgicodec.errors import PictureError, UsageError, require

if TYPE_CHECKING:
    from sgicodec.picture import Picture

__all__ = ["Associated", "associated_pictures", "write_associated"]

Associated = list[tuple[str, "Picture"]]
"""Where each goes, and what it shows."""


def associated_pictures(source: str, target: str, force: bool, by_default: bool) -> Associated:
    """Those of the slide `source`, as OUT.label.png, OUT.macro.png. Raises UsageError, MissingExtraError, PictureError
    for what is no slide, OutputExistsError.
    """
    require("openslide", "--associated", "slides")
    from sgicodec.image.origin import naming, on_disk
    from sgicodec.image.slide_reader import associated

    if STANDARD in (source, target):
        raise UsageError("--associated goes with files, not with stdin or stdout")
    stem = os.path.splitext(target)[0]
    try:
        with naming(source), on_disk(source) as slide:
            found = [(f"{stem}.{name}.png", picture) for name, picture in associated(slide).items()]
    except PictureError as error:
        raise PictureError(f"{error}; --associated takes the label and the macro of slides") from error
    for path, _ in found:
        check_output(path, source, force, by_default=by_default)
    return found


def write_associated(pictures: Associated, source: str, tells: bool) -> None:
    """Writes them, and tells which there are, or that there are none. Raises PictureError."""
    from sgicodec.image.writer import write

    for path, picture in pictures:
        write(picture, path)
        if tells:
            click.echo(f"{display(path)}: {picture.width}×{picture.height} pixels, {os.path.getsize(path):,} bytes")
    if tells and not pictures:
        click.echo(f"sgi: {display(source)}: the slide has no label and no macro for --associated to write", err=True)
