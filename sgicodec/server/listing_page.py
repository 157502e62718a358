"""The page that lists a folder: its streams, and where other programs find them."""

from __future__ import annotations

from html import escape
from urllib.parse import quote

from sgicodec.server.catalog import ListedStream, Listing

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<meta name="color-scheme" content="light dark"><title>{title}</title>
<style>body{{font:1rem/1.6 system-ui,sans-serif;margin:2rem auto;max-width:60rem;padding:0 1rem}}
td{{padding-right:1.5rem}}
td.number{{text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums}}img{{display:block;margin:auto}}</style>
</head>
<body><h1>{title}</h1><table>{rows}</table>{more}</body></html>
"""


_SIDE = 128
"""Pixels of a thumbnail's longer side."""

_MAX_DECODED = 1 << 23
"""Pixels of a picture that is decoded whole for its thumbnail; larger ones have one if they carry an overview."""


def listing_page(name: str, listing: Listing, root: str, has_viewer: bool) -> str:
    """The page of the folder `name`; "" is the top. root: the path before those of the server."""
    inside = f"{name}/" if name else ""
    rows = [] if not name else ['<tr><td><a href="../">..</a></td></tr>']
    rows += [f'<tr><td><a href="{quote(folder)}/">{escape(folder)}/</a></td></tr>' for folder in listing.folders]
    rows += [_row(inside + stream.name, stream, root, has_viewer) for stream in listing.streams]
    more = "<p>There are more than these.</p>" if listing.cut else ""
    return _PAGE.format(title=escape(f"/{name}"), rows="\n".join(rows), more=more)


def _row(name: str, stream: ListedStream, root: str, has_viewer: bool) -> str:
    path, identifier = quote(name), quote(name, safe="")
    links = {"file": f"{root}/files/{path}", "IIIF": f"{root}/iiif/3/{identifier}/info.json"}
    links |= {"manifest": f"{root}/iiif/3/{identifier}/manifest.json", "Deep Zoom": f"{root}/dzi/{path}.dzi"}
    if has_viewer:
        links = {"view": f"{root}/viewer/?file={quote(links['file'], safe='')}"} | links
    cells = (f'<td><a href="{escape(url)}">{text}</a></td>' for text, url in links.items())
    shown = f'<a href="{escape(links.get("view", links["file"]))}">{_thumbnail(identifier, stream, root)}</a>'
    pixels = "damaged" if stream.size is None else f"{stream.size[0]} × {stream.size[1]}"
    numbers = "".join(f'<td class="number">{text}</td>' for text in (pixels, _bytes(stream.bytes)))
    return f"<tr><td>{shown}</td><td>{escape(stream.name)}</td>{numbers}{''.join(cells)}</tr>"


def _thumbnail(identifier: str, stream: ListedStream, root: str) -> str:
    """The picture in small, fetched once it is nearly in view; nothing where that takes long to decode."""
    if stream.size is None or not (stream.has_overview or stream.size[0] * stream.size[1] <= _MAX_DECODED):
        return ""
    factor = min(1.0, _SIDE / max(stream.size))
    width, height = (max(1, round(length * factor)) for length in stream.size)
    url = f"{root}/iiif/3/{identifier}/full/!{_SIDE},{_SIDE}/0/default.jpg"
    return f'<img src="{escape(url)}" width="{width}" height="{height}" loading="lazy" alt="">'


def _bytes(count: int) -> str:
    """A number of bytes for people."""
    exponent = 0 if count < 1000 else 1 if count < 1_000_000 else 2 if count < 1_000_000_000 else 3
    return f"{count / 1000**exponent:.{min(exponent, 1)}f} {('B', 'kB', 'MB', 'GB')[exponent]}"
