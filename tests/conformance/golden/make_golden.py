"""Makes the golden streams that do not exist yet: `python tests/conformance/golden/make_golden.py`.

Overwrites none, and makes none anew that is lost.
"""

from __future__ import annotations

import hashlib
import io
import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

from sgicodec import EncodeSettings, Picture, encode_picture, read
from sgicodec.bitstream.header import Header
from sgicodec.bitstream.parts.tile import TileModel, write_tile
from sgicodec.bitstream.rewriting import rewrite_stream
from sgicodec.decoder.stream import open_stream
from sgicodec.device import ONE_THREAD, Device
from sgicodec.encoder.input.windows import windows_of
from sgicodec.encoder.residual import form
from sgicodec.encoder.residual.layer import ResidualLayer, residual_payload
from sgicodec.model.texture_symbols import SAME_COLOURS
from sgicodec.rdoq.objective import with_values

HERE = Path(__file__).parent
sys.path += [str(HERE.parents[1] / "support"), str(HERE.parents[2])]

from image_files import was_jpeg  # noqa: E402
from restoration_reader import another_network  # noqa: E402
from surgery import join, split  # noqa: E402
from textures import random_symbols  # noqa: E402

from tests.conformance.suite import SAMPLES, TYPES, Case, cases  # noqa: E402

CROP = (slice(160, 288), slice(80, 272))


def pictures() -> dict[str, tuple[Picture, EncodeSettings]]:
    """What each stream holds: the profiles, the channel layouts and the sample types of the format."""
    photo = read(HERE.parents[1] / "data" / "kodim23.png")
    crop = replace(photo, pixels=np.ascontiguousarray(photo.pixels[CROP]))
    small = np.ascontiguousarray(crop.pixels[:64, :96])
    grey = small.astype(np.uint16) @ np.array([77, 150, 29], np.uint16)  # 16 bits
    quick = EncodeSettings(quality=50, steps=150, texture=False, tune="psnr")
    paper = EncodeSettings(profile="paper", seeds=60, per_seed=3, features=12, steps=200, lmbda=0.0001)
    textured = EncodeSettings(quality=75, steps=60, texture=True, restoration=False, tune="psnr")
    luma = replace(textured, tune="visual")  # of three colours, in luma space
    restored = replace(luma, restoration=True)
    restored_psnr = replace(textured, restoration=True)
    forest = np.ascontiguousarray(read(HERE.parents[1] / "data" / "kodim13.png").pixels[CROP])
    few = forest[:75, :109]
    dark = few.astype(np.uint16) @ np.array([77, 150, 29], np.uint16)
    leaves = forest.astype(np.uint16) @ np.array([77, 150, 29], np.uint16)
    alpha = np.concatenate([small, 255 - small[..., :1]], axis=2)
    crop_with_alpha = Picture(np.concatenate([crop.pixels, forest[..., :1]], axis=2), "rgba", (0.0, 255.0))
    return {
        "rgb8": (crop, quick),
        "gray16": (Picture(grey[..., None], "gray", (0.0, 65535.0)), quick),
        "gray8-alpha": (Picture(np.ascontiguousarray(alpha[..., 2:]), "gray+alpha", (0.0, 255.0)), quick),
        "rgba8": (Picture(alpha, "rgba", (0.0, 255.0)), quick),
        "float": (Picture((grey / 8192.0).astype(np.float32)[..., None], "gray", (-1.0, 8.5)), quick),
        "multi8": (Picture(np.concatenate([alpha, small[..., 1:2]], axis=2), "multi", (0.0, 255.0)), quick),
        "paper-rgb8": (Picture(small, "rgb", (0.0, 255.0)), paper),
        "rgb8-tiles": (crop, replace(quick, tile=100, overview=True)),
        "rgb8-texture": (Picture(forest, "rgb", (0.0, 255.0)), textured),
        "gray16-texture": (Picture(dark[..., None], "gray", (0.0, 65535.0)), textured),
        "rgba8-texture": (
            Picture(np.concatenate([few, 255 - few[..., :1]], axis=2), "rgba", (0.0, 255.0)),
            textured,
        ),
        "rgb8-tiles-texture": (Picture(forest, "rgb", (0.0, 255.0)), replace(textured, tile=100, overview=True)),
        "rgb8-any-texture": (Picture(small, "rgb", (0.0, 255.0)), textured),
        "rgb8-luma": (Picture(forest, "rgb", (0.0, 255.0)), luma),
        "rgba8-tiles-luma": (crop_with_alpha, replace(luma, quality=40, tile=100, overview=True)),
        "rgb8-restored": (Picture(forest, "rgb", (0.0, 255.0)), restored),
        "rgb8-restored-psnr": (Picture(forest, "rgb", (0.0, 255.0)), restored_psnr),
        "rgb8-tiles-own-network": (crop, replace(luma, restoration=True, tile=100, network=another_network())),
        "rgb8-any-colours": (Picture(small, "rgb", (0.0, 255.0)), luma),
        "rgba8-tiles-colours": (crop_with_alpha, replace(restored_psnr, quality=60, tile=100, overview=True)),
        "gray16-restored": (Picture(leaves[..., None], "gray", (0.0, 65535.0)), restored_psnr),
        "rgba8-tiles-restored": (crop_with_alpha, replace(restored, quality=50, tile=100, overview=True)),
        "multi16-bands": (bare_bands(small), textured),
        "gray16-tiles-nodata": (hole_in_twelve_bits(dark), replace(restored_psnr, tile=48, overview=True)),
        "float-tiles-exact": (bare_floats(small[:48, :64]), replace(luma, tile=32, overview=True)),
        "rgb8-tiles-lossless": (crop, replace(textured, quality=40, tile=100, overview=True, max_error=0)),
        "rgba8-near": (Picture(alpha, "rgba", (0.0, 255.0)), replace(quick, max_error=2)),
        "multi16-bands-lossless": (bare_bands(small), replace(textured, max_error=0)),
        "gray16-lossless-blocks": (
            Picture(np.rint(photo.pixels[100:120, :600, 1:2] * 25.7).astype(np.uint16), "gray", (0.0, 65535.0)),
            replace(quick, max_error=0),
        ),
        "rgb8-drawing-lossless": (drawing(), EncodeSettings(max_error=0)),
        "rgb8-mixed": (beside_text(forest, 6), replace(luma, quality=60)),
        "rgb8-tiles-mixed": (beside_text(forest, 99), replace(luma, quality=70, tile=100, overview=True)),
        "float-tiles-lossless": (bare_floats(small[:48, :64], curved=True), replace(quick, tile=32, max_error=0)),
        "float-near": (bare_floats(small[:48, :64], curved=True), replace(quick, max_error=0.01)),
        "rgba8-sharp": (cut_out(forest), replace(luma, quality=40)),
        "rgba8-tiles-sharp": (cut_out(forest), replace(luma, quality=40, tile=100, overview=True)),
        "rgba8-drawing": (cut_out(drawing().pixels), EncodeSettings(quality=70)),
        "rgba8-alpha-alone": (cut_out(forest, is_hard=True), replace(luma, quality=40)),
        "gray16-near-nodata": (hole_in_twelve_bits(dark), replace(quick, max_error=3)),
        "gray8-tiles-bare": (bare_gray(photo.pixels), replace(textured, quality=30, tile=340, apron=8)),
        "paper-rgb8-tiles": (Picture(small, "rgb", (0.0, 255.0)), replace(paper, seeds=30, tile=64, apron=0)),
        "rgb8-odd-tiles": (Picture(forest[:83, :101], "rgb", (0.0, 255.0)), replace(quick, tile=45, apron=7)),
        "multi16-held-lossless": (held_bands(), replace(quick, max_error=0)),
        "rgb8-page-lossless": (page(), EncodeSettings(max_error=0)),
        "rgb8-boxes-mixed": (boxes_of_text(forest), replace(luma, quality=30)),
        "rgb8-jpeg": (Picture(was_jpeg(forest, 75)[3:, 5:], "rgb", (0.0, 255.0)), replace(luma, quality=90)),
        "rgb8-tiles-jpeg": (
            Picture(np.hstack([was_jpeg(forest, 75)[:, :96], forest[:, 96:]]), "rgb", (0.0, 255.0)),
            replace(restored_psnr, quality=85, tile=100, overview=True),
        ),
        "gray16-any-separate": (Picture(grey[..., None], "gray", (0.0, 65535.0)), textured),
        "multi8-classes": (beside_classes(small), replace(textured, quality=40)),
        "multi16-tiles-classes": (
            Picture(beside_classes(small).pixels.astype(np.uint16) * 200, "multi", (0.0, 51000.0), blank=0.0),
            replace(textured, quality=40, tile=48, overview=True),
        ),
        "rgb8-some-nodata": (some_nodata(small), quick),
        "multi16-tiles-some-near": (some_holes(dark), replace(quick, tile=48, overview=True)),
        "float-some-bits": (some_floats(small[:48, :64]), quick),
        "one-pixel": (Picture(small[:1, :1], "rgb", (0.0, 255.0)), quick),
    }


def drawing() -> Picture:
    """Squares and lines of a few colours, over and over."""
    y, x = np.mgrid[:90, :130]
    pixels = np.stack([x // 9 * y // 7 % 2 * 90, (x + y) // 11 % 2 * 255, (x // 17 + y // 5) % 2 * 60], axis=2)
    return Picture(np.ascontiguousarray(pixels.astype(np.uint8)), "rgb", (0.0, 255.0))


def beside_classes(photo: np.ndarray) -> Picture:
    """Bands of a photograph, of which every second one is a map of classes, or has one value."""
    y, x = np.mgrid[: photo.shape[0], : photo.shape[1]]
    pixels = np.dstack([(x * x + 9 * y) // 700 % 5, photo[..., 0], (x + y) // 20 % 2 * 255, photo[..., 1], 0 * x + 77])
    return Picture(np.ascontiguousarray(pixels.astype(np.uint8)), "multi", (0.0, 255.0))


def some_nodata(photo: np.ndarray) -> Picture:
    """Colours of which red lacks some."""
    pixels = np.maximum(photo, 40)
    pixels[10:30, 20:50, 0] = pixels[::9, ::7, 0] = 37
    return Picture(pixels, "rgb", (40.0, 255.0), blank=37.0)


def some_holes(dark: np.ndarray) -> Picture:
    """Twelve bits in sixteen with nodata in the middle of their range, and unlike bands."""
    bands = np.dstack([dark >> 4, 900 + (dark >> 6), 4095 - (dark >> 4)])
    bands[bands == 2000] = 2001
    bands[20:33, 40:60] = 2000
    return Picture(bands, "multi", (0.0, 4095.0), blank=2000.0)


def some_floats(photo: np.ndarray) -> Picture:
    """Two bands of which no grid tells."""
    noise = np.random.default_rng(5).normal(0, 9, photo.shape).astype(np.float32)
    pixels = photo + noise * np.array([1, 0, 1], np.float32)
    pixels[5, 7, 0] = np.inf
    return Picture(pixels, "multi", (-30.0, 290.0), exact=True)


LAYERS = {
    "rgb8-some-nodata": ((1, 2), 0.0),
    "multi16-tiles-some-near": ((0, 2), 3.0),
    "float-some-bits": ((0, 1), 0.0),
}
"""Bands and greatest error of layers that no encode writes."""


def with_layer(data: bytes, picture: Picture, bands: tuple[int, ...], max_error: float) -> bytes:
    """The stream with a residual layer of some bands, without tables, which small pictures of floats have."""
    whole = io.BytesIO()
    with open_stream(data) as stream, mock.patch.object(form, "with_table", return_value=None):
        layer = residual_payload(stream, ResidualLayer(windows_of(picture), max_error, bands=bands), ONE_THREAD)
    rewrite_stream(io.BytesIO(data), whole, layer)
    return whole.getvalue()


def cut_out(colours: np.ndarray, is_hard: bool = False) -> Picture:
    """Rings of it, whose edges are sharp; hard: alpha is 0 or 255, but for a pixel here and there."""
    y, x = np.mgrid[: colours.shape[0], : colours.shape[1]]
    slope = 1e9 if is_hard else 300
    alpha = np.clip(128 + slope * np.sin(np.hypot(x - 40, y - 30) / 6), 0, 255).astype(np.uint8)
    alpha[::19, ::23] //= 2
    return Picture(np.dstack([colours, alpha]), "rgba", (0.0, 255.0))


def beside_text(photo: np.ndarray, colours: int) -> Picture:
    """A photograph with lines of letters in so many colours to its right and below, on light ground."""
    height, width = photo.shape[0] + 40, photo.shape[1] + 100
    rng = np.random.default_rng(8)
    letters = rng.choice([0, 0, 0, 0, 1, 0.7, 0.4, 0.2], (9, 8, 6))
    letters[:, :, 5:] = letters[:, 7:] = 0
    lines = (
        letters[rng.integers(0, 9, (height // 8, width // 6 + 1))].transpose(0, 2, 1, 3).reshape(height // 8 * 8, -1)
    )
    ink = rng.integers(0, 160, (colours, 3))[np.arange(height // 8 * 8)[:, None] // 8 * 7 % colours]
    page = np.rint(240 + (ink - 240) * lines[..., None])[:height, :width].astype(np.uint8)
    page[: photo.shape[0], : photo.shape[1]] = photo
    return Picture(page, "rgb", (0.0, 255.0))


def letters_on(ground: np.ndarray, left: int, top: int, rows: int, columns: int, ink: tuple[int, int, int]) -> None:
    """Draws so many rows of letters onto pixels, on white."""
    rng = np.random.default_rng(rows + columns)
    font = rng.random((20, 9, 6)) < 0.4
    font[:, :, 5:] = font[:, 7:] = False
    text = font[rng.integers(0, 20, (rows, columns))].transpose(0, 2, 1, 3).reshape(9 * rows, 6 * columns)
    ground[top : top + 9 * rows, left : left + 6 * columns] = np.where(text[..., None], ink, 255)


def page() -> Picture:
    """A page of single lines in eight colours, most of it white."""
    pixels = np.full((560, 700, 3), 255, np.uint8)
    for line in range(30):
        letters_on(pixels, 20 + 13 * line, 2 + 18 * line, 1, 24, (0, 0, line % 8 * 30))
    return Picture(pixels, "rgb", (0.0, 255.0))


def boxes_of_text(photo: np.ndarray) -> Picture:
    """A photograph with two boxes of letters that no cell begins with."""
    pixels = np.ascontiguousarray(np.tile(photo, (2, 2, 1)))
    letters_on(pixels, 37, 21, 9, 25, (0, 0, 60))
    letters_on(pixels, 131, 149, 7, 33, (90, 0, 0))
    return Picture(pixels, "rgb", (0.0, 255.0))


def held_bands() -> Picture:
    """Bands of noise, in one of which some of it is nodata, and below it steps without any."""
    rng, (y, x) = np.random.default_rng(3), np.mgrid[:70, :64]
    pixels = np.stack([1000 + 300 * ((x // 9 + y // 7 + band) % 3) + x // 20 * 17 for band in range(3)], axis=2)
    pixels[:8] = rng.integers(900, 2000, (8, 64, 3))
    pixels[:8, :40, 2] = 0
    return Picture(pixels.astype(np.uint16), "multi", (900.0, 2000.0), blank=0.0)


def bare_gray(photo: np.ndarray) -> Picture:
    """Gray with nodata within its range: a disc, and the right part, in which a tile lies as a whole."""
    pixels = photo[100:400, :640, 1].copy()
    pixels[pixels == 128] = 129
    y, x = np.mgrid[:300, :640]
    pixels[((y - 140) ** 2 + (x - 120) ** 2 < 90**2) | (x >= 256)] = 128
    return Picture(pixels[..., None], "gray", (0.0, 255.0), blank=128.0)


def bare_bands(photo: np.ndarray) -> Picture:
    """Bands of unlike range, with nodata of their own and hot pixels."""
    pixels = (photo[..., [0, 1, 2, 0]] * np.array([3, 5, 7, 40]) + 100).astype(np.uint16)
    pixels[:20, :30] = pixels[40:, 60:80, 1] = pixels[40:, 60:80, 2] = 0
    pixels[30, 31], pixels[50, 10, 2] = 65535, 40000
    return Picture(
        pixels, "multi", ((100.0, 100.0, 100.0, 0.0), (900.0, 1400.0, 1900.0, 11000.0)), blank=0.0, exact=True
    )


def hole_in_twelve_bits(photo: np.ndarray) -> Picture:
    """Twelve bits in sixteen with nodata in the middle of the range: a hole over several tiles, and single pixels."""
    pixels = photo >> 4
    y, x = np.mgrid[: pixels.shape[0], : pixels.shape[1]]
    pixels[pixels == 2000] = 2001
    pixels[(y - 40) ** 2 + (x - 52) ** 2 < 24**2] = pixels[::17, ::13] = 2000
    return Picture(np.ascontiguousarray(pixels[..., None]), "gray", (0.0, 4095.0), blank=2000.0)


def bare_floats(photo: np.ndarray, curved: bool = False) -> Picture:
    """Floats with blanks, not-a-number and infinity; curved: that are no multiples of a step, of blue many."""
    pixels = photo.astype(np.float32) / 8 - 5
    if curved:
        pixels = pixels * np.abs(pixels) / np.float32(30)
        pixels[..., 2] += np.sin(np.arange(pixels[..., 2].size)).reshape(pixels.shape[:2]) / np.float32(99)
    pixels[20:40, 30:50], pixels[40, 55], pixels[10, 10, 1] = -9999, np.inf, np.nan
    return Picture(pixels, "rgb", (-5.0, 27.0), blank=-9999.0, exact=True)


def with_any_texture(header: Header, model: TileModel, seed: int = 2) -> TileModel:
    """The model with texture that no search finds: contrasts, large symbols, cells of all sizes."""
    texture = random_symbols(header.spec.channels, header.width, header.height, seed)
    np.multiply(texture.symbols, 100, out=texture.symbols, where=np.abs(texture.symbols) == 5)
    steps = replace(texture.steps, step=250, has_contrast=True, colours=SAME_COLOURS)
    return replace(model, texture=replace(texture, steps=steps))


def with_any_colours(header: Header, model: TileModel) -> TileModel:
    """The same in colours that no search finds."""
    model = with_any_texture(header, model)
    if model.texture is None:
        raise SystemExit("there is no texture")
    return replace(model, texture=replace(model.texture, steps=replace(model.texture.steps, colours=(63, 0, 15))))


def with_separate_cells(header: Header, model: TileModel) -> TileModel:
    """The same in cells that do not lap over."""
    return with_any_texture(header, model, seed=63)


ANY = {"colours": with_any_colours, "separate": with_separate_cells}


def with_any(data: bytes, alter: Callable[[Header, TileModel], TileModel]) -> bytes:
    """The stream of a single tile with an altered model."""
    with open_stream(data) as stream:
        header, model = stream.header, stream.model
        model = with_values(header.spec, model, model.decoded_values)
    payload, _ = write_tile(header, replace(alter(header, model), decoded=None))
    return join([(letter, payload if letter == "T" else chunk) for letter, chunk in split(data)])


def made(name: str, picture: Picture, settings: EncodeSettings) -> dict[str, Any]:
    """Writes a stream; its entry in the manifest."""
    path = HERE / f"{name}.sgi"
    data = encode_picture(picture, settings).data
    if "-any-" in name:
        data = with_any(data, ANY.get(name.rpartition("-")[2], with_any_texture))
    if name in LAYERS:
        data = with_layer(data, picture, *LAYERS[name])
    path.write_bytes(data)
    with open_stream(path) as stream:
        survey = stream.survey()
        entry: dict[str, Any] = {
            "sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
            "picture": [stream.width, stream.height, stream.header.channels],
            "sample_type": stream.header.sample_type,
            "seeds": survey.seeds,
            "symbol_crc": f"{survey.symbol_crc:08x}",
        }
        if settings.overview:
            entry["overview_crc"] = f"{stream.overview.symbol_crc:08x}"
        if stream.header.spec.texture:
            entry["texture_cells"] = {str(side): count for side, count in survey.texture_cells.items()}
    return entry


def samples(case: Case, device: Device = ONE_THREAD) -> bytes:
    """What this package decodes for a case of the conformance suite."""
    kind = next(name for name, short in TYPES.items() if short == case.type)
    region, size = (case.x, case.y, case.width, case.height), (case.columns, case.rows)
    with open_stream(HERE / f"{case.stream}.sgi", device) as stream:
        stream.exact, stream.dither = True, False
        return np.ascontiguousarray(stream.picture(region, size=size, dtype=kind).pixels).tobytes()


def main() -> None:
    """Writes the streams that do not exist yet, their samples, and the manifest."""
    manifest_path = HERE / "manifest.json"
    manifest = json.loads(manifest_path.read_text()) if manifest_path.exists() else {}
    known = json.loads(SAMPLES.read_text()) if SAMPLES.exists() else {}
    for name, (picture, settings) in pictures().items():
        path = HERE / f"{name}.sgi"
        if path.exists():
            continue
        if name in manifest:
            raise SystemExit(f"{path} is lost: take it from the history, for a new one would prove nothing")
        entry = manifest[name] = made(name, picture, settings)
        stated = cases(name, *entry["picture"][:2], TYPES[entry["sample_type"]])
        known[name] = {case.key: hashlib.sha256(samples(case)).hexdigest() for case in stated}
    SAMPLES.write_text(json.dumps(known, indent=1, sort_keys=True) + "\n")
    manifest_path.write_text(json.dumps(manifest, indent=2) + "\n")


if __name__ == "__main__":
    main()
