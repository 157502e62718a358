"""The label and the macro of a slide, which `sgi encode --associated` writes beside the stream."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from sgicodec.cli.paths import STANDARD, check_output
from sgicodec.errors import UsageError

if TYPE_CHECKING:
    from sgicodec.picture import Picture

__all__ = ["Associated", "associated_pictures", "write_associated"]

Associated = list[tuple[str, "Picture"]]
"""Where each goes, and what it shows."""


def associated_pictures(source: str, target: str, force: bool, by_default: bool) -> Associated:
    """Those of the slide `source`, as OUT.label.png, OUT.macro.png. Raises UsageError, PictureError for what is no
    slide, OutputExistsError.
    """
    from sgicodec.image.origin import naming, on_disk
    from sgicodec.image.slide_reader import associated

    if STANDARD in (source, target):
        raise UsageError("--associated goes with files, not with stdin or stdout")
    stem = os.path.splitext(target)[0]
    with naming(source), on_disk(source) as slide:
        found = [(f"{stem}.{name}.png", picture) for name, picture in associated(slide).items()]
    for path, _ in found:
        check_output(path, source, force, by_default=by_default)
    return found


def write_associated(pictures: Associated) -> None:
    """Writes them. Raises PictureError."""
    from sgicodec.image import write

    for path, picture in pictures:
        write(picture, path)
