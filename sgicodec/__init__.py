"""sgicodec: pictures as structured 2D Gaussians.

    import sgicodec
    picture = sgicodec.read("photo.png")
    data = sgicodec.encode(picture, sgicodec.EncodeSettings(quality=60)).data
    with sgicodec.open_stream(data) as stream:
        thumbnail = stream.picture(scale=0.25)

Names load on first use, so that decoding never imports what only encoding needs.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from sgicodec.errors import SgiError
from sgicodec.version import __version__

if TYPE_CHECKING:
    from sgicodec.decoder.stream import Stream, open_stream
    from sgicodec.device import Device
    from sgicodec.encoder.checkpoint import Checkpoint
    from sgicodec.encoder.encoded import Encoded
    from sgicodec.encoder.listener import NullListener
    from sgicodec.encoder.pipeline import encode
    from sgicodec.encoder.settings import EncodeSettings
    from sgicodec.executors.dask import open_cluster
    from sgicodec.executors.processes import ProcessExecutor
    from sgicodec.image import open_source, read, write
    from sgicodec.picture import Picture

__all__ = [
    "Checkpoint",
    "Device",
    "EncodeSettings",
    "Encoded",
    "NullListener",
    "Picture",
    "ProcessExecutor",
    "SgiError",
    "Stream",
    "__version__",
    "encode",
    "open_cluster",
    "open_source",
    "open_stream",
    "read",
    "write",
]

_HOMES = {
    "Checkpoint": "encoder.checkpoint",
    "Device": "device",
    "EncodeSettings": "encoder.settings",
    "Encoded": "encoder.encoded",
    "NullListener": "encoder.listener",
    "Picture": "picture",
    "ProcessExecutor": "executors.processes",
    "Stream": "decoder.stream",
    "encode": "encoder.pipeline",
    "open_cluster": "executors.dask",
    "open_source": "image.source",
    "open_stream": "decoder.stream",
    "read": "image.reader",
    "write": "image.writer",
}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f"sgicodec.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'sgicodec' has no attribute {name!r}")
