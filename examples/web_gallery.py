"""A web gallery: photographs become streams, and a page shows them by <sgi-image>, each with a link to the viewer.

python web_gallery.py *.jpg --out gallery
python -m http.server --directory gallery        # any static server does
"""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from html import escape
from pathlib import Path
from urllib.parse import quote

import sgicodec
from sgicodec.server.viewer import missing_decoder, viewer_folder

PAGE = """<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Gallery</title>
<script type="module" src="viewer/element.js"></script>
<style>
  body {{ margin: 1rem; display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(240px, 1fr)); }}
  sgi-image {{ width: 100%; }}
</style>
{figures}
</html>
"""
FIGURE = '<a href="viewer/?file={link}"><sgi-image src="{src}" alt="{alt}"></sgi-image></a>'


def main(arguments: Sequence[str] | None = None) -> None:
    """Writes OUT/streams, OUT/viewer and OUT/index.html."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pictures", nargs="+", type=Path, metavar="PICTURE")
    parser.add_argument("--out", type=Path, default=Path("gallery"))
    parser.add_argument("--quality", type=float, default=65, help="60 to 70 suits the web")
    options = parser.parse_args(arguments)
    viewer = viewer_folder()
    if viewer is None or (note := missing_decoder(viewer)):
        raise sgicodec.SgiError("this installation has no viewer" if viewer is None else note)
    streams = encoded(options.pictures, options.out / "streams", options.quality)
    shutil.copytree(viewer, options.out / "viewer", dirs_exist_ok=True)
    (options.out / "index.html").write_text(page(streams), "utf-8")
    print(f"{options.out / 'index.html'}: {len(streams)} pictures")
    if len(streams) < len(options.pictures):
        raise sgicodec.SgiError(
            f"{len(options.pictures) - len(streams)} of {len(options.pictures)} pictures are missing"
        )


def encoded(pictures: Sequence[Path], folder: Path, quality: float) -> list[Path]:
    """The streams of these pictures; one that cannot be read is named, and left out."""
    folder.mkdir(parents=True, exist_ok=True)
    streams = []
    for picture in pictures:
        stream = folder / f"{picture.name}.sgi"  # with the suffix: a.png and a.jpg are two pictures
        try:
            sgicodec.imwrite(stream, picture, quality=quality, effort=2)
        except sgicodec.SgiError as error:
            print(f"web_gallery: {error}", file=sys.stderr)
            continue
        print(f"{stream}: {stream.stat().st_size:,} bytes of {picture.stat().st_size:,}")
        streams.append(stream)
    return streams


def page(streams: Sequence[Path]) -> str:
    """The gallery's page, which lies beside the folder of the streams."""
    figures = []
    for stream in streams:
        src = f"streams/{quote(stream.name)}"
        name = stream.name.removesuffix(".sgi")
        figures.append(FIGURE.format(link=quote(f"../{src}"), src=escape(src), alt=escape(name)))
    return PAGE.format(figures="\n".join(figures))


if __name__ == "__main__":
    try:
        main()
    except sgicodec.SgiError as failure:
        sys.exit(f"web_gallery: {failure}")
