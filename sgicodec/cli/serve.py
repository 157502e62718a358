"""`sgi serve`: a folder of streams for viewers of large pictures, by HTTP."""

from __future__ import annotations

from pathlib import Path

import click

from sgicodec.cli.command import HelpfulCommand
from sgicodec.cli.options import FOLDER, threads_option
from sgicodec.device import Device
from sgicodec.errors import require


@click.command(
    cls=HelpfulCommand,
    short_help="Serve streams to viewers: IIIF, Deep Zoom, files.",
    common=("host", "port", "quiet"),
    examples=(
        ("sgi serve pictures", "to programs on this machine"),
        ("sgi serve pictures --host 0.0.0.0", "to the network"),
        ("sgi serve pictures --url https://example.org", "behind a proxy"),
    ),
)
@click.argument("folder", metavar="DIR", type=FOLDER)
@click.option("--host", default="127.0.0.1", show_default=True, metavar="ADDRESS", help="Address to listen on.")
@click.option("--port", default=8000, show_default=True, type=click.IntRange(0, 65535), help="0: any free one.")
@click.option(
    "--url", metavar="URL", help="How others reach this server, path and all.  [default: as the request says]"
)
@click.option(
    "--max-pixels",
    default=1 << 24,
    show_default=True,
    type=click.IntRange(1),
    metavar="N",
    help="Refuse to draw more pixels in one answer.",
)
@click.option("--jobs", default=2, show_default=True, type=click.IntRange(1, 256), help="Pictures drawn at a time.")
@click.option("--streams", default=8, show_default=True, type=click.IntRange(1), help="Streams that stay open.")
@click.option(
    "--max-age",
    default=3600,
    show_default=True,
    type=click.IntRange(0),
    metavar="S",
    help="Seconds that browsers may keep an answer.",
)
@threads_option
@click.option("--quiet", is_flag=True, help="Log failures only.")
def serve(
    folder: str,
    host: str,
    port: int,
    url: str | None,
    max_pixels: int,
    jobs: int,
    streams: int,
    max_age: int,
    threads: int,
    quiet: bool,
) -> None:
    """Serve the streams in folder DIR, and in its subfolders, until Ctrl-C: as files with ranges, by IIIF Image API 3
    and as Deep Zoom. Nothing outside DIR is served.
    """
    for library in ("starlette", "uvicorn"):
        require(library, "sgi serve", "serve")
    from sgicodec.server.app import Settings, application
    from sgicodec.server.catalog import Folder
    from sgicodec.server.public_address import checked_address
    from sgicodec.server.run import address_of, listening
    from sgicodec.server.run import serve as run
    from sgicodec.server.viewer import missing_decoder, viewer_folder

    viewer = viewer_folder()
    settings = Settings(
        most_pixels=max_pixels,
        jobs=jobs,
        device=Device(threads),
        streams=streams,
        max_age=max_age,
        address=None if url is None else checked_address(url),
        viewer=viewer,
    )
    app = application(Folder(Path(folder)), settings)
    listener = listening(host, port)
    lines = [f"serving {folder} at {address_of(listener)}/ (Ctrl-C ends it)"]
    if viewer is not None and (note := missing_decoder(viewer)):
        lines.append(f"sgi: {note}")
    run(app, listener, lambda: click.echo("\n".join(lines), err=True), quiet)
