"""`sgi info`: what streams hold and where their bytes went, from their headers alone unless all is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import click

from sgicodec.cli.files import each_file
from sgicodec.cli.json_output import print_json
from sgicodec.cli.options import FILE, json_option
from sgicodec.cli.parts import all_parts, chunk_parts, metadata_bytes, print_parts, whole_bytes
from sgicodec.cli.paths import display, name_of, opened_stream
from sgicodec.metadata.layouts import range_text

if TYPE_CHECKING:
    from sgicodec.bitstream.header import Header
    from sgicodec.decoder.stream import Stream
    from sgicodec.decoder.survey import Survey

_NO_PLACE = {"place": None, "nodata": None, "magnification": None, "resolution": None}
_DEPTHS = {"uint8": "8 bits", "uint16": "16 bits", "float32": "32-bit float"}
_WHOLE_TYPE = {"uint8": (0.0, 255.0), "uint16": (0.0, 65535.0)}


@click.command(short_help="Show what streams hold.")
@click.argument("sources", metavar="IN...", nargs=-1, required=True, type=FILE)
@click.option("--survey", is_flag=True, help="Decode all tiles: seeds, texture, symbols, bytes of each part.")
@json_option
def info(sources: tuple[str, ...], survey: bool, as_json: bool) -> None:
    """Print what streams IN hold; - stands for stdin.

    Without --survey only headers are read: damage in tiles is found by `sgi verify`.
    """

    def show(source: str) -> None:
        if sources[0] != source and not as_json:
            click.echo()
        _show(source, survey, as_json)

    each_file(sources, show)


def _show(source: str, with_survey: bool, as_json: bool) -> None:
    with opened_stream(source) as stream:
        survey = stream.survey() if with_survey else None
        facts = _facts(stream, survey)
        parts = chunk_parts(stream.chunk_bytes, stream.size)
        if survey is not None:
            parts = all_parts(survey.part_bytes, stream.chunk_bytes, stream.size)
    table = parts
    if survey is not None and facts["profile"] == "paper":
        from sgicodec.profiles.paper import paper_parts

        table = paper_parts(parts)
    if as_json:
        own = {} if table is parts else {"paper_parts": whole_bytes(table)}
        print_json({"input": name_of(source)} | facts | {"parts": whole_bytes(parts)} | own)
        return
    click.echo(f"{display(source)}")
    for name, text in _lines(stream, facts).items():
        click.echo(f"  {name:<12}{text}")
    click.echo()
    print_parts(table)


def _facts(stream: Stream, survey: Survey | None) -> dict[str, Any]:
    """What `--json` prints besides the parts."""
    from sgicodec.decoder.view import overview_size

    header = stream.header
    texture = None if survey is None or not header.spec.texture else survey.texture_cells
    return {
        "width": header.width,
        "height": header.height,
        "channels": header.channels,
        "channel_count": header.spec.channels,
        "sample_type": header.sample_type,
        "sample_range": header.sample_range,
        "bytes": stream.size,
        "bpp": 8 * stream.size / (header.width * header.height),
        "profile": header.profile,
        "tiles": header.grid.count,
        "overview": overview_size(header.width, header.height) if stream.has_overview else None,
        "max_error": stream.max_error,
        "graphics_error": stream.graphics_error,
        "exact_bands": list(stream.exact_bands),
        "exact_views": stream.has_exact_views,
        "exact_alpha": stream.has_exact_alpha,
        "metadata": metadata_bytes(stream.chunk_bytes),
        **_place_facts(stream),
        "settings": _settings(header),
        "encoder": stream.software,
        "seeds": None if survey is None else survey.seeds,
        "gaussians": None if survey is None else survey.seeds * header.spec.per_seed,
        "texture_cells": texture,
        "symbol_crc": None if survey is None else f"{survey.symbol_crc:08x}",
    }


def _place_facts(stream: Stream) -> dict[str, Any]:
    if stream.metadata.geo is None and stream.metadata.exif is None and stream.header.blank is None:
        return _NO_PLACE
    from sgicodec.cli.place import place_facts  # loads numpy

    return place_facts(stream)


def _settings(header: Header) -> dict[str, Any]:
    spec, context = header.spec, header.spec.context
    return {
        "layout": spec.layout,
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
        "network_bytes": len(header.network),
    }


def _lines(stream: Stream, facts: Mapping[str, Any]) -> dict[str, str]:
    """What is printed above the table."""
    channels, count = facts["channels"], facts["channel_count"]
    depth = _DEPTHS[facts["sample_type"]]
    if facts["sample_range"] != _WHOLE_TYPE.get(facts["sample_type"]):
        depth += f" from {range_text(facts['sample_range'])}"
    layout = f"{count} bands" if channels == "multi" else channels
    lines = {
        "picture": f"{facts['width']}×{facts['height']}, {layout}, {depth}",
        "size": f"{facts['bytes']:,} bytes, {facts['bpp']:.3f} bpp",
    }
    if any(facts[name] is not None for name in _NO_PLACE):
        from sgicodec.cli.place import place_lines

        lines |= place_lines(facts)
    grid = stream.header.grid
    if grid.count > 1:
        what = f"{grid.count} ({grid.across.count}×{grid.down.count}) of up to {grid.tile} pixels a side"
        lines["tiles"] = f"{what}, fading over {2 * grid.apron}"
    if facts["overview"] is not None:
        lines["overview"] = "{}×{}".format(*facts["overview"])
    for name, of in (("max_error", ""), ("graphics_error", "text and line art ")):
        if facts[name] is not None:
            unit = "" if facts["sample_type"] == "float32" else " levels"
            error = f"at most {facts[name]:g}{unit} off" if facts[name] else "without loss"
            lines["samples"] = of + error + ", in all views" * facts["exact_views"]
    if facts["exact_bands"]:
        bands = facts["exact_bands"]
        lines["samples"] = f"band{'s' * (len(bands) > 1)} {', '.join(map(str, bands))} without loss"
        lines["samples"] += ", in all views" * facts["exact_views"]
    if facts["exact_alpha"]:
        lines["samples"] = "alpha without loss, in all views"
    if facts["metadata"]:
        lines["metadata"] = ", ".join(f"{name} {size:,} bytes" for name, size in facts["metadata"].items())
    if facts["seeds"] is not None:
        per_seed = facts["settings"]["per_seed"]
        lines["seeds"] = f"{facts['seeds']:,} × {per_seed} = {facts['gaussians']:,} Gaussians"
    if facts["texture_cells"] is not None:
        cells = (f"{n:,} cells of {side}×{side} pixels" for side, n in sorted(facts["texture_cells"].items()) if n)
        lines["texture"] = ", ".join(cells) or "none"
    return lines | _model_lines(facts)


def _model_lines(facts: Mapping[str, Any]) -> dict[str, str]:
    settings = facts["settings"]
    context = "network in the file" if not settings["prior"] else f"network {settings['prior']} of the package"
    context += f", {settings['neighbours']} neighbours" if settings["neighbours"] else ""
    context += f", {settings['hash_levels']} hash levels" if settings["hash_levels"] else ""
    base = f", base layer of {settings['base_cell']}-pixel cells" if settings["base_cell"] else ""
    own = {"restoration": f"by a network of its own, {settings['network_bytes']:,} bytes"}
    return {
        **(own if settings["network_bytes"] else {}),
        "profile": f"{facts['profile']}: {settings['layout']} layout, D = {settings['features']}{base}",
        "context": context,
        "encoder": facts["encoder"] or "unknown",
    }
