"""Runs an application on a port until a signal ends it."""

from __future__ import annotations

import contextlib
import logging
import signal
import socket
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

from sgicodec.errors import UsageError
from sgicodec.server.access import LOG

if TYPE_CHECKING:
    from starlette.applications import Starlette

_LAST_ANSWERS = 10
"""Seconds that open requests have when the server is to end."""


def listening(host: str, port: int) -> socket.socket:
    """A socket that takes connections; port 0 is any free one. Raises UsageError."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        return socket.create_server((host, port), family=family, backlog=256)
    except (OSError, OverflowError, UnicodeError) as error:
        text = getattr(error, "strerror", None) or error
        raise UsageError(f"port {port} of {host} cannot be used: {text}") from error


def address_of(listener: socket.socket) -> str:
    """The URL of what listens there."""
    host, port = listener.getsockname()[:2]
    return f"http://{f'[{host}]' if ':' in host else host}:{port}"


def serve(app: Starlette, listener: socket.socket, started: Callable[[], None], quiet: bool = False) -> None:
    """Answers requests until SIGINT or SIGTERM; open requests are answered first. started: called when it begins."""
    import uvicorn

    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("%(asctime)s %(message)s", "%Y-%m-%d %H:%M:%S"))
    LOG.addHandler(handler)
    LOG.setLevel(logging.WARNING if quiet else logging.INFO)
    LOG.propagate = False
    config = uvicorn.Config(
        app,
        log_config=None,
        log_level="warning",
        access_log=False,
        server_header=False,
        ws="none",
        timeout_graceful_shutdown=_LAST_ANSWERS,
        limit_concurrency=1024,
    )
    before = signal.signal(signal.SIGTERM, lambda *_: None)  # uvicorn raises it once more when it is done
    try:
        with contextlib.suppress(KeyboardInterrupt):
            started()
            uvicorn.Server(config).run([listener])
    finally:
        signal.signal(signal.SIGTERM, before)
        LOG.removeHandler(handler)
        listener.close()
