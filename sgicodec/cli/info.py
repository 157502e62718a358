"""`sgi info`: what a stream holds and where its bytes went, on one screen."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import click

from sgicodec.cli.options import json_option
from sgicodec.cli.parts import all_parts, print_parts
from sgicodec.cli.paths import display, opened_stream
from sgicodec.cli.place import place_facts, place_lines

if TYPE_CHECKING:
    from sgicodec.bitstream.header import Header
    from sgicodec.decoder.stream import Stream

__all__ = ["info"]

_DEPTHS = {"uint8": "8 bits", "uint16": "16 bits", "float32": "32-bit float"}


@click.command(short_help="Show what a stream holds.")
@click.argument("source", metavar="IN")
@json_option
def info(source: str, as_json: bool) -> None:
    """Print what stream IN holds and how many bytes each part takes; - stands for stdin."""
    from sgicodec.profiles import PROFILES

    with opened_stream(source) as stream:
        facts = _facts(stream)
        parts = all_parts(stream.part_bytes, stream.chunk_bytes, stream.size)
    profile = PROFILES[facts["profile"]]
    if as_json:
        table = {f"{profile.name}_parts": profile.shown_parts(parts)} if profile.parts else {}
        click.echo(json.dumps({"input": display(source)} | facts | {"parts": parts} | table, ensure_ascii=False))
        return
    click.echo(f"{display(source)}")
    for name, text in _lines(stream, facts).items():
        click.echo(f"  {name:<12}{text}")
    click.echo()
    print_parts(profile.shown_parts(parts))


def _facts(stream: Stream) -> dict[str, Any]:
    """What `--json` prints besides the parts."""
    header, survey = stream.header, stream.survey()
    seeds = survey.seeds
    pixels = stream.width * stream.height
    return {
        "width": stream.width,
        "height": stream.height,
        "channels": header.channels,
        "channel_count": header.spec.channels,
        "sample_type": header.sample_type,
        "sample_range": header.sample_range,
        "bytes": stream.size,
        "bpp": 8 * stream.size / pixels,
        "profile": header.profile,
        "tiles": stream.grid.count,
        "overview": [stream.overview.width, stream.overview.height] if stream.has_overview else None,
        "seeds": seeds,
        "gaussians": seeds * header.spec.per_seed,
        "texture_cells": survey.texture_cells if header.spec.texture else None,
        **place_facts(stream),
        "settings": _settings(header),
        "encoder": stream.software,
        "symbol_crc": f"{stream.symbol_crc:08x}",
    }


def _settings(header: Header) -> dict[str, Any]:
    spec, context = header.spec, header.spec.context
    return {
        "layout": spec.layout,
        "shape": spec.shape,
        "per_seed": spec.per_seed,
        "features": spec.features,
        "decoder_width": spec.hidden,
        "base_cell": spec.base_cell,
        "prior": context.prior,
        "context_width": context.hidden,
        "neighbours": context.neighbours,
        "hash_levels": len(context.hash_resolutions),
        "tile": header.tile,
        "apron": header.apron,
        "masked": header.masked,
    }


def _lines(stream: Stream, facts: Mapping[str, Any]) -> dict[str, str]:
    """What is printed above the table."""
    channels, count = facts["channels"], facts["channel_count"]
    depth = _DEPTHS[facts["sample_type"]]
    if facts["sample_type"] == "float32":
        depth += " from {:g} to {:g}".format(*facts["sample_range"])
    settings = facts["settings"]
    context = "network in the file" if not settings["prior"] else f"network {settings['prior']} of the package"
    context += f", {settings['neighbours']} neighbours" if settings["neighbours"] else ""
    context += f", {settings['hash_levels']} hash levels" if settings["hash_levels"] else ""
    base = f", base layer of {settings['base_cell']}-pixel cells" if settings["base_cell"] else ""
    tiles = {}
    if stream.grid.count > 1:
        grid = stream.grid
        what = f"{grid.count} ({grid.across.count}×{grid.down.count}) of up to {grid.tile} pixels a side"
        tiles["tiles"] = f"{what}, fading over {2 * grid.apron}"
    if facts["overview"] is not None:
        tiles["overview"] = "{}×{}".format(*facts["overview"])
    texture = {}
    if facts["texture_cells"] is not None:
        cells = (f"{n:,} cells of {side}×{side} pixels" for side, n in sorted(facts["texture_cells"].items()) if n)
        texture["texture"] = ", ".join(cells) or "none"
    return {
        "picture": f"{stream.width}×{stream.height}, {count if channels == 'multi' else channels}"
        + f"{' bands' if channels == 'multi' else ''}, {depth}",
        "size": f"{facts['bytes']:,} bytes, {facts['bpp']:.3f} bpp",
        **place_lines(facts),
        **tiles,
        "seeds": f"{facts['seeds']:,} × {settings['per_seed']} = {facts['gaussians']:,} Gaussians",
        **texture,
        "profile": f"{facts['profile']}: {settings['layout']} layout, D = {settings['features']}{base}",
        "context": context,
        "encoder": facts["encoder"] or "unknown",
    }
