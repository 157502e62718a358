"""Makes the golden streams that do not exist yet: `python tests/conformance/golden/make_golden.py`.

Overwrites none, and makes none anew that is lost.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from sgicodec import EncodeSettings, Picture, encode, open_stream, read, write

HERE = Path(__file__).parent
CROP = (slice(160, 288), slice(80, 272))


def pictures() -> dict[str, tuple[Picture, EncodeSettings]]:
    """What each stream holds: the profiles, the channel layouts and the sample types of the format."""
    photo = read(HERE.parents[1] / "data" / "kodim23.png")
    crop = replace(photo, pixels=np.ascontiguousarray(photo.pixels[CROP]))
    small = np.ascontiguousarray(crop.pixels[:64, :96])
    luma = small.astype(np.uint16) @ np.array([77, 150, 29], np.uint16)  # 16 bits
    quick = EncodeSettings(quality=50, steps=150, prior=1)
    coarse_first = replace(quick, prior=2)  # made before places were predicted, which they are now
    predicted = replace(quick, prior=2)
    paper = EncodeSettings(profile="paper", seeds=60, per_seed=3, features=12, steps=80)
    alpha = np.concatenate([small, 255 - small[..., :1]], axis=2)
    return {
        "rgb8": (crop, quick),
        "rgb8-own-context": (crop, replace(quick, prior=0)),
        "rgb8-two-per-seed": (crop, replace(quick, per_seed=2)),
        "gray16": (Picture(luma[..., None], "gray", (0.0, 65535.0)), quick),
        "gray8-alpha": (Picture(np.ascontiguousarray(alpha[..., 2:]), "gray+alpha", (0.0, 255.0)), quick),
        "rgba8": (Picture(alpha, "rgba", (0.0, 255.0)), quick),
        "float": (Picture((luma / 8192.0).astype(np.float32)[..., None], "gray", (-1.0, 8.5)), quick),
        "multi8": (Picture(np.concatenate([alpha, small[..., 1:2]], axis=2), "multi", (0.0, 255.0)), quick),
        "paper-rgb8": (Picture(small, "rgb", (0.0, 255.0)), paper),
        "rgb8-coarse-first": (crop, coarse_first),
        "gray16-coarse-first": (Picture(luma[..., None], "gray", (0.0, 65535.0)), coarse_first),
        "rgb8-prior3": (crop, replace(quick, prior=3)),
        "rgb8-predicted-seeds": (crop, predicted),
        "gray16-predicted-seeds": (Picture(luma[..., None], "gray", (0.0, 65535.0)), predicted),
        "rgb8-tiles": (crop, replace(quick, prior=3, tile=100, overview=True)),
        "one-pixel": (Picture(small[:1, :1], "rgb", (0.0, 255.0)), quick),
    }


def main() -> None:
    """Writes the streams that do not exist yet, what they decode to, and the manifest."""
    manifest_path = HERE / "manifest.json"
    manifest = json.loads(manifest_path.read_text()) if manifest_path.exists() else {}
    for name, (picture, settings) in pictures().items():
        path = HERE / f"{name}.sgi"
        if path.exists():
            continue
        if name in manifest:
            raise SystemExit(f"{path} is lost: take it from the history, for a new one would prove nothing")
        path.write_bytes(encode(picture, settings).data)
        reference = "png" if picture.channels != "multi" and picture.pixels.dtype != np.float32 else "tif"
        with open_stream(path) as stream:
            write(stream.picture(), HERE / f"{name}.{reference}")
            manifest[name] = {
                "sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
                "picture": [stream.width, stream.height, stream.header.channels],
                "sample_type": stream.header.sample_type,
                "seeds": stream.survey().seeds,
                "symbol_crc": f"{stream.symbol_crc:08x}",
                "reference": reference,
            }
            if settings.overview:
                manifest[name]["overview_crc"] = f"{stream.overview.symbol_crc:08x}"
    manifest_path.write_text(json.dumps(manifest, indent=2) + "\n")


if __name__ == "__main__":
    main()
