"""The page that lists a folder: its streams, and where other programs find them."""

from __future__ import annotations

from html import escape
from urllib.parse import quote

from sgicodec.server.catalog import Listing

__all__ = ["listing_page"]

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<meta name="color-scheme" content="light dark"><title>{title}</title>
<style>body{{font:1rem/1.6 system-ui,sans-serif;margin:2rem auto;max-width:60rem;padding:0 1rem}}
td{{padding-right:1.5rem}}</style></head>
<body><h1>{title}</h1><table>{rows}</table>{more}</body></html>
"""


def listing_page(name: str, listing: Listing, root: str, has_viewer: bool) -> str:
    """The page of the folder `name`; "" is the top. root: the path before those of the server."""
    inside = f"{name}/" if name else ""
    rows = [] if not name else ['<tr><td><a href="../">..</a></td></tr>']
    rows += [f'<tr><td><a href="{quote(folder)}/">{escape(folder)}/</a></td></tr>' for folder in listing.folders]
    rows += [_row(inside + stream, stream, root, has_viewer) for stream in listing.streams]
    more = "<p>There are more than these.</p>" if listing.cut else ""
    return _PAGE.format(title=escape(f"/{name}"), rows="\n".join(rows), more=more)


def _row(name: str, stream: str, root: str, has_viewer: bool) -> str:
    path, identifier = quote(name), quote(name, safe="")
    links = {"file": f"{root}/files/{path}", "IIIF": f"{root}/iiif/3/{identifier}/info.json"}
    links |= {"manifest": f"{root}/iiif/3/{identifier}/manifest.json", "Deep Zoom": f"{root}/dzi/{path}.dzi"}
    if has_viewer:
        links = {"view": f"{root}/viewer/?file={quote(links['file'], safe='')}"} | links
    cells = (f'<td><a href="{escape(url)}">{text}</a></td>' for text, url in links.items())
    return f"<tr><td>{escape(stream)}</td>{''.join(cells)}</tr>"
