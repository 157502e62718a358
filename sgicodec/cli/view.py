"""`sgi view`: streams in the browser, from a server on this machine that serves nothing else."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from urllib.parse import quote, urlencode

import click

from sgicodec.bitstream.recognition import looks_like_stream
from sgicodec.cli.command import HelpfulCommand
from sgicodec.cli.options import FILE, threads_option
from sgicodec.cli.paths import STANDARD, display
from sgicodec.device import Device
from sgicodec.errors import StreamError, UsageError, require
from sgicodec.remote.url import file_name, is_url

_HOST = "127.0.0.1"


@click.command(
    cls=HelpfulCommand,
    short_help="Show a stream in the browser.",
    common=("no_browser", "port"),
    examples=(
        ("sgi view photo.sgi", "pan and zoom; Ctrl-C ends the server"),
        ("sgi view photo.sgi photo.png", "beside another stream or picture, with a slider"),
        ("sgi view https://example.org/city.sgi", "only the bytes that are looked at are fetched"),
    ),
)
@click.argument("source", metavar="FILE|URL", type=FILE)
@click.argument("other", metavar="[OTHER]", required=False, type=FILE)
@click.option("--no-browser", is_flag=True, help="Print the address, and open nothing.")
@click.option("--port", default=0, type=click.IntRange(0, 65535), help="Port to listen on.  [default: any free one]")
@threads_option
def view(source: str, other: str | None, no_browser: bool, port: int, threads: int) -> None:
    """Show the stream in FILE, or at URL, in the browser; OTHER is compared with it. The server answers this machine
    alone, and serves these files alone.
    """
    for library in ("starlette", "uvicorn"):
        require(library, "sgi view", "serve")
    from sgicodec.server.app import Settings, application
    from sgicodec.server.catalog import ListedFiles
    from sgicodec.server.run import address_of, listening, serve
    from sgicodec.server.viewer import missing_decoder, viewer_folder

    viewer = viewer_folder()
    if viewer is None:
        raise UsageError("this installation has no viewer")
    files: dict[str, Path] = {}
    urls: dict[str, str] = {}
    query = {"file": _file_parameter(source, files, urls)}
    if not is_url(source) and not looks_like_stream(source):
        raise StreamError(f"{display(source)}: it is no stream; a picture can be OTHER")
    query |= {"other": _file_parameter(other, files, urls)} if other else {}
    hosts = (_HOST, "localhost")
    settings = Settings(device=Device(threads), public=False, hosts=hosts, viewer=viewer, max_age=0, remote=urls)
    app = application(ListedFiles(files), settings)
    listener = listening(_HOST, port)
    address = f"{address_of(listener)}/viewer/?{urlencode(query)}"

    def show() -> None:
        click.echo(address)
        if note := missing_decoder(viewer):
            click.echo(f"sgi: {note}", err=True)
        if not no_browser and not webbrowser.open(address):
            click.echo("sgi: there is no browser to open; open the address above", err=True)

    serve(app, listener, show, quiet=True)


def _file_parameter(source: str, files: dict[str, Path], urls: dict[str, str]) -> str:
    """What the viewer's page calls a file or a URL, which is added to what is served."""
    if is_url(source):
        require("fsspec", "sgi view of a URL", "remote")
        name = f"{len(urls)}-{file_name(source)}"
        urls[name] = source
        return f"/remote/{quote(name, safe='')}"
    if source == STANDARD:
        raise UsageError("sgi view shows files and URLs, not stdin; name a file")
    path = Path(source)
    if not path.is_file():
        folder = "it is a folder; name a stream in it, or show all with sgi serve"
        raise StreamError(f"{display(source)}: {folder if path.is_dir() else 'there is no such file'}")
    name = path.name if path.name not in files else f"{len(files)}-{path.name}"
    files[name] = path
    return f"/files/{quote(name)}"
