"""The README's picture: a detail of the original, of sgi, and of JPEG in as many bytes.

python -m benchmarks.figure tests/data/kodim23.png demo-out/kodim23.sgi docs/images/before-after.png
"""

from __future__ import annotations

import argparse
import io
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sgicodec.decoder.stream import open_stream
from sgicodec.image import read
from sgicodec.metrics.psnr import psnr

__all__ = ["jpeg_of_size", "main"]

Pixels = NDArray[np.uint8]


def jpeg_of_size(pixels: Pixels, size: int) -> bytes:
    """The best progressive 4:2:0 JPEG of at most `size` bytes; the smallest there is if none fits."""
    from PIL import Image

    best = b""
    for quality in range(1, 96):
        buffer = io.BytesIO()
        Image.fromarray(pixels).save(buffer, "JPEG", quality=quality, optimize=True, progressive=True, subsampling=2)
        if buffer.tell() > size and best:
            break
        best = buffer.getvalue()
    return best


def main() -> None:
    """The command line of this module."""
    from PIL import Image, ImageDraw

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("picture", type=Path)
    parser.add_argument("stream", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--region", type=int, nargs=4, default=(60, 130, 280, 210), metavar=("X", "Y", "W", "H"))
    arguments = parser.parse_args()
    original = read(arguments.picture).pixels
    size = arguments.stream.stat().st_size
    with open_stream(arguments.stream) as stream:
        ours = stream.picture().pixels
    data = jpeg_of_size(original, size)
    theirs = np.asarray(Image.open(io.BytesIO(data)))
    raw = original.size
    panels = [
        (original, f"original, {raw:,} bytes"),
        (ours, f"sgi, {size:,} bytes, {psnr(original, ours):.2f} dB"),
        (theirs, f"JPEG, {len(data):,} bytes, {psnr(original, theirs):.2f} dB"),
    ]
    x, y, width, height = arguments.region
    sheet = Image.new("RGB", (3 * width + 16, height + 20), "white")
    draw = ImageDraw.Draw(sheet)
    for index, (pixels, label) in enumerate(panels):
        left = index * (width + 8)
        sheet.paste(Image.fromarray(pixels[y : y + height, x : x + width]), (left, 20))
        draw.text((left + 2, 4), label, fill="black")
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    sheet.save(arguments.out, optimize=True)
    print("\n".join(label for _, label in panels))


if __name__ == "__main__":
    main()
