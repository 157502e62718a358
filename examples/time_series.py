"""A satellite time series: the dates of one place become streams, an index, and a page that leafs through them.

    python time_series.py 2026-05-01=may.tif 2026-06-02=june.tif --out series
    python -m http.server --directory series

`index.json` has for each date the stream, its bytes, the size of a pixel, and the bounds in the files' coordinates.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from collections.abc import Sequence
from datetime import date
from pathlib import Path

import sgicodec
from sgicodec.metadata.georeference import georeference
from sgicodec.server.viewer import missing_decoder, viewer_folder

PAGE = """<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>Time series</title>
<script type="module" src="viewer/element.js"></script>
<style>body { margin: 1rem; font-family: system-ui, sans-serif } sgi-image { width: min(100%, 720px) }</style>
<p><input type="range" id="when" min="0" value="0" aria-label="Date"> <a id="date"></a></p>
<sgi-image id="picture" alt="The place at the chosen date"></sgi-image>
<script type="module">
  const dates = await (await fetch("index.json")).json();
  const [when, link, picture] = ["when", "date", "picture"].map((id) => document.getElementById(id));
  const show = () => {
    const { date, stream, bytes } = dates[when.value];
    link.textContent = `${date}, ${(bytes / 1000).toFixed(1)} kB`;
    link.href = `viewer/?file=${encodeURIComponent(`../${stream}`)}`;
    picture.src = stream;
  };
  when.max = dates.length - 1;
  when.addEventListener("input", show);
  show();
</script>
</html>
"""


def main(arguments: Sequence[str] | None = None) -> None:
    """Writes OUT/DATE.sgi, OUT/index.json, OUT/viewer and OUT/index.html."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", type=scene, metavar="DATE=FILE")
    parser.add_argument("--out", type=Path, default=Path("series"))
    parser.add_argument("--quality", type=float, default=70)
    options = parser.parse_args(arguments)
    viewer = viewer_folder()
    if viewer is None or (note := missing_decoder(viewer)):
        raise sgicodec.SgiError("this installation has no viewer" if viewer is None else note)
    options.out.mkdir(parents=True, exist_ok=True)
    rows = [encoded(day, path, options.out, options.quality) for day, path in sorted(options.scenes)]
    if len({(row["width"], row["height"], str(row["bounds"])) for row in rows}) > 1:
        print("the dates have other sizes or bounds: cut them to one place first", file=sys.stderr)
    shutil.copytree(viewer, options.out / "viewer", dirs_exist_ok=True)
    (options.out / "index.json").write_text(json.dumps(rows, indent=1), "utf-8")
    (options.out / "index.html").write_text(PAGE, "utf-8")
    print(f"{options.out / 'index.html'}: {len(rows)} dates, {sum(row['bytes'] for row in rows):,} bytes")


def scene(text: str) -> tuple[date, Path]:
    """What DATE=FILE names."""
    day, separator, path = text.partition("=")
    if not separator:
        raise argparse.ArgumentTypeError(f"{text!r} is no DATE=FILE, as 2026-05-01=may.tif is")
    try:
        return date.fromisoformat(day), Path(path)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"{day!r} is no date: {error}") from error


def encoded(day: date, path: Path, folder: Path, quality: float) -> dict[str, object]:
    """Encodes a date. Returns its row of the index."""
    target = folder / f"{day}.sgi"
    sgicodec.imwrite(target, path, quality=quality, effort=2)
    with sgicodec.open(target) as stream:
        found = georeference(stream.metadata.geo, stream.width, stream.height)
        return {
            "date": day.isoformat(),
            "stream": target.name,
            "bytes": stream.size,
            "width": stream.width,
            "height": stream.height,
            "epsg": found and found.epsg,
            "bounds": found and found.bounds,
            "pixel_size": found and found.pixel_size,
        }


if __name__ == "__main__":
    try:
        main()
    except sgicodec.SgiError as failure:
        sys.exit(f"time_series: {failure}")
