"""The application: what answers which URL."""

from __future__ import annotations

import hashlib
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from email.utils import formatdate
from pathlib import Path
from typing import TypeVar
from urllib.parse import quote

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, RedirectResponse, Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles

from sgicodec.decoder.stream import Stream
from sgicodec.device import ALL_CORES, Device
from sgicodec.errors import SgiError, StreamError, UsageError
from sgicodec.server import deepzoom, iiif
from sgicodec.server.access import LOG, Access
from sgicodec.server.catalog import Catalog
from sgicodec.server.conditional import RangedFile, unchanged
from sgicodec.server.drawing import FORMATS, Drawing, drawn
from sgicodec.server.listing_page import listing_page
from sgicodec.server.open_streams import OpenStreams, identity
from sgicodec.server.public_address import PublicAddress
from sgicodec.server.refusal import Refusal
from sgicodec.server.remote_files import RemoteFiles
from sgicodec.server.workers import Workers
from sgicodec.version import __version__

_Result = TypeVar("_Result")

_MEDIA_TYPES = {".sgi": "image/x-sgicodec"}
_SAMPLES = 4
"""Samples of a pixel that `most_pixels` counts with: of pictures with more bands fewer pixels are rendered."""


@dataclass(frozen=True)
class Settings:
    """How much is done at once, and for whom.

    most_pixels: of one answer. jobs: pictures that are rendered at a time, each by the threads of `device`. waiting:
    requests that may wait for that. streams: that stay open. max_age: seconds that answers may be kept elsewhere.
    public: whether pages of other sites may read. hosts: names under which the server answers. address: under
    which others reach it, with a path or without, if it is not that of the request. viewer: folder of the viewer's
    page. remote: URLs that are passed on, by their names.
    """

    most_pixels: int = 1 << 24
    jobs: int = 2
    device: Device = ALL_CORES
    waiting: int = 256
    streams: int = 8
    max_age: int = 3600
    public: bool = True
    hosts: tuple[str, ...] = ("*",)
    address: str | None = None
    viewer: Path | None = None
    remote: Mapping[str, str] = field(default_factory=dict)


def application(catalog: Catalog, settings: Settings) -> Starlette:
    """An ASGI application that serves what the catalog holds."""
    service = _Service(catalog, settings)

    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        yield
        service.close()

    routes: list[Route | Mount] = [
        Route("/", service.top),
        Route("/files/{name:path}", service.file),
        Route("/remote/{name}", service.remote),
        Route("/iiif/3/{name:path}/info.json", service.info),
        Route("/iiif/3/{name:path}/manifest.json", service.manifest),
        Route("/iiif/3/{name:path}/{region}/{size}/{rotation}/{quality}.{format}", service.image),
        Route("/iiif/3/{name:path}", service.base),
        Route("/dzi/{name:path}.dzi", service.description),
        Route("/dzi/{name:path}_files/{level:int}/{column:int}_{row:int}.{format}", service.tile),
    ]
    if settings.viewer is not None:
        routes.append(Mount("/viewer", StaticFiles(directory=settings.viewer, html=True)))
    middleware = [
        Middleware(Access, public=settings.public),
        Middleware(TrustedHostMiddleware, allowed_hosts=list(settings.hosts), www_redirect=False),
    ]
    if settings.address is not None:
        own = frozenset(route.path.split("/")[1] for route in routes)
        middleware.append(Middleware(PublicAddress, address=settings.address, own=own))
    handlers = {Refusal: _refused, FileNotFoundError: _gone, SgiError: _failed, MemoryError: _exhausted}
    return Starlette(routes=routes, middleware=middleware, exception_handlers=handlers, lifespan=lifespan)


class _Service:
    """The endpoints. Each raises Refusal or SgiError."""

    def __init__(self, catalog: Catalog, settings: Settings) -> None:
        self._catalog, self._settings = catalog, settings
        self._streams = OpenStreams(settings.streams, settings.device)
        self._workers = Workers(settings.jobs, settings.waiting)
        self._remote = RemoteFiles(settings.remote)

    def close(self) -> None:
        self._workers.close()
        self._remote.close()
        self._streams.close()

    async def top(self, request: Request) -> Response:
        return RedirectResponse(f"{_root(request)}/files/", 307)

    async def file(self, request: Request) -> Response:
        name = request.path_params["name"]
        if name.endswith("/") or not name:
            listing = await self._workers.run(
                lambda: self._catalog.listing(name.removesuffix("/")), request.is_disconnected
            )
            has_viewer = self._settings.viewer is not None
            return HTMLResponse(listing_page(name.removesuffix("/"), listing, _root(request), has_viewer))
        if self._catalog.has_folder(name):
            return RedirectResponse(f"{_root(request)}/files/{quote(name)}/", 307)
        path = self._catalog.find(name)
        response = RangedFile(path, media_type=_MEDIA_TYPES.get(path.suffix.lower()), stat_result=path.stat())
        response.headers["cache-control"] = "no-cache"  # ranges of two versions do not mix
        return unchanged(request, response.headers) or response

    async def remote(self, request: Request) -> Response:
        name, asked = request.path_params["name"], request.headers.get("range")
        data, content_range = await self._workers.run(lambda: self._remote.read(name, asked), request.is_disconnected)
        headers = {"content-range": content_range, "accept-ranges": "bytes", "cache-control": "no-store"}
        return Response(data, 206, headers, media_type="application/octet-stream")

    async def base(self, request: Request) -> Response:
        name = request.path_params["name"]
        self._catalog.find(name)
        return RedirectResponse(f"{self._iiif_address(request, name)}/info.json", 303)

    async def info(self, request: Request) -> Response:
        name = request.path_params["name"]
        path, address = self._catalog.find(name), self._iiif_address(request, name)

        def describe(stream: Stream) -> dict[str, object]:
            return iiif.info(self._image(stream), address, [(level.width, level.height) for level in stream.levels])

        found = await self._with_stream(request, path, describe)
        accept = request.headers.get("accept", "")
        plain = "application/ld+json" not in accept and ("application/json" in accept or "text/html" in accept)
        kind = "application/json" if plain else f'application/ld+json;profile="{iiif.CONTEXT}"'
        caching = self._caching(path, (address, kind))
        headers = caching | {"vary": "Accept", "link": f'<{iiif.LEVEL}>;rel="profile"'}
        return unchanged(request, headers) or JSONResponse(found, media_type=kind, headers=headers)

    async def manifest(self, request: Request) -> Response:
        name = request.path_params["name"]
        path, address = self._catalog.find(name), self._iiif_address(request, name)
        image = await self._with_stream(request, path, self._image)
        found = iiif.manifest(image, address, name.rpartition("/")[2])
        headers = self._caching(path, address)
        return unchanged(request, headers) or JSONResponse(found, headers=headers)

    async def image(self, request: Request) -> Response:
        parts = request.path_params
        name, path = parts["name"], self._catalog.find(parts["name"])

        def read(stream: Stream) -> tuple[Drawing, str]:
            image = self._image(stream)
            keys = ("region", "size", "rotation", "quality", "format")
            drawing = iiif.read_drawing(image, *(parts[key] for key in keys))
            return drawing, iiif.canonical(image, drawing)

        address = self._iiif_address(request, name)
        drawing, canonical = await self._with_stream(request, path, read)
        link = f'<{iiif.LEVEL}>;rel="profile", <{address}/{canonical}>;rel="canonical"'
        return await self._drawn(request, path, drawing, {"link": link})

    async def description(self, request: Request) -> Response:
        path = self._catalog.find(request.path_params["name"])
        width, height = await self._with_stream(request, path, lambda stream: (stream.width, stream.height))
        text = deepzoom.description(width, height)
        headers = self._caching(path, "dzi")
        return unchanged(request, headers) or Response(text, media_type=deepzoom.MEDIA_TYPE, headers=headers)

    async def tile(self, request: Request) -> Response:
        parts = request.path_params
        path = self._catalog.find(parts["name"])
        if parts["format"] not in FORMATS:
            raise Refusal(404, f"there are no tiles in the format {parts['format']!r}")

        def read(stream: Stream) -> Drawing:
            tile = (parts["level"], parts["column"], parts["row"])
            return deepzoom.tile_drawing(stream.width, stream.height, *tile, parts["format"])

        return await self._drawn(request, path, await self._with_stream(request, path, read), {})

    async def _drawn(self, request: Request, path: Path, drawing: Drawing, headers: dict[str, str]) -> Response:
        headers = headers | self._caching(path, drawing)
        if answer := unchanged(request, headers):
            return answer
        media_type = FORMATS[drawing.format]
        if request.method == "HEAD":
            response = Response(media_type=media_type, headers=headers)
            del response.headers["content-length"]  # which only drawing tells
            return response
        data = await self._with_stream(request, path, lambda stream: drawn(stream, drawing), admitted=True)
        return Response(data, media_type=media_type, headers=headers)

    async def _with_stream(
        self, request: Request, path: Path, work: Callable[[Stream], _Result], admitted: bool = False
    ) -> _Result:
        """What `work` makes of the opened stream, on a thread. admitted: as of `Workers.run`."""

        def run() -> _Result:
            try:
                with self._streams.opened(path) as stream:
                    return work(stream)
            except StreamError as error:
                raise error.__cause__ if isinstance(error.__cause__, FileNotFoundError) else error from None

        return await self._workers.run(run, request.is_disconnected, admitted)

    def _image(self, stream: Stream) -> iiif.Image:
        bands = stream.shape[2] if stream.ndim == 3 else 1
        return iiif.Image(stream.width, stream.height, self._settings.most_pixels * _SAMPLES // max(_SAMPLES, bands))

    def _iiif_address(self, request: Request, name: str) -> str:
        base = self._settings.address or str(request.base_url).rstrip("/")
        return f"{base}/iiif/3/{quote(name, safe='')}"

    def _caching(self, path: Path, what: object) -> dict[str, str]:
        """Headers that tell others how long they may keep an answer, and how to ask for it again."""
        found = identity(path)
        tag = hashlib.blake2b(repr((found, what, __version__)).encode(), digest_size=12).hexdigest()
        modified = formatdate(found[1] / 1e9, usegmt=True)
        age = f"{'public' if self._settings.public else 'private'}, max-age={self._settings.max_age}"
        return {"etag": f'"{tag}"', "last-modified": modified, "cache-control": age}


def _root(request: Request) -> str:
    """The path that stands before all paths of the server; empty without one."""
    return quote(request.scope.get("root_path", ""))


async def _refused(request: Request, error: Exception) -> Response:
    assert isinstance(error, Refusal)
    headers = {"retry-after": "1"} if error.status == 503 else None
    return PlainTextResponse(f"{error.text}\n", error.status, headers)


async def _gone(request: Request, error: Exception) -> Response:
    return PlainTextResponse("the file is gone\n", 404)


async def _failed(request: Request, error: Exception) -> Response:
    status = 400 if isinstance(error, UsageError) else 500
    LOG.warning("%s: %s", request.url.path.encode("unicode_escape").decode(), error)
    return PlainTextResponse(f"{error}\n", status)


async def _exhausted(request: Request, error: Exception) -> Response:
    return PlainTextResponse("there is not enough memory for this now; try again, or ask for less\n", 503)
