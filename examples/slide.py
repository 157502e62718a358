"""A slide: encode it, look at it at several magnifications, and give it to programs that read slides by OpenSlide.

python slide.py slide.svs                        # needs the extra slides, for what OpenSlide reads
python slide.py scan.tif --out scan --microns 250
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import sgicodec
from sgicodec.plugins.openslide import Slide


def main(arguments: Sequence[str] | None = None) -> None:
    """Writes OUT.sgi, and OUT-LEVEL.png for the middle of the slide at each of its levels."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("slide", type=Path)
    parser.add_argument("--out", type=Path, help="without suffix; by default the slide's own name")
    parser.add_argument("--quality", type=float, default=70, help="for looking at; --lossless is for diagnosis")
    parser.add_argument("--lossless", action="store_true")
    parser.add_argument("--microns", type=float, default=100, help="side of the field of view at the first level")
    options = parser.parse_args(arguments)
    out = options.out or options.slide.with_suffix("")
    target = out.with_name(f"{out.name}.sgi")
    settings = {"max_error": 0} if options.lossless else {"quality": options.quality}
    sgicodec.imwrite(target, options.slide, effort=2, **settings)
    print(f"{target}: {target.stat().st_size:,} bytes of {options.slide.stat().st_size:,}")
    with Slide(target) as slide:
        microns = float(slide.properties.get("openslide.mpp-x", "nan"))
        known = f"{microns:g} µm a pixel" if microns == microns else "the size of a pixel is not stated"
        print(f"{slide.dimensions[0]}×{slide.dimensions[1]} pixels, {slide.level_count} levels; {known}")
        save_views(slide, out, side=round(options.microns / microns) if microns == microns else 400)


def save_views(slide: Slide, out: Path, side: int) -> None:
    """The slide's middle, `side` pixels across, at each level: half the magnification, and twice the field of view."""
    for level, downsample in enumerate(slide.level_downsamples):
        reach = side * downsample / 2
        corner = tuple(max(0, round(length / 2 - reach)) for length in slide.dimensions)
        size = tuple(min(side, length) for length in slide.level_dimensions[level])
        path = out.with_name(f"{out.name}-{level}.png")
        slide.read_region(corner, level, size).convert("RGB").save(path)
        print(f"{path}: {size[0]}×{size[1]} pixels from ({corner[0]}, {corner[1]}) on, level {level}")


if __name__ == "__main__":
    try:
        main()
    except sgicodec.SgiError as failure:
        sys.exit(f"slide: {failure}")
