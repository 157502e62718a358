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
    from sgicodec.decoder import Stream, open_stream
    from sgicodec.encode_settings import EncodeSettings
    from sgicodec.encoder import encode
    from sgicodec.encoding import Encoded
    from sgicodec.image import Picture, read, write

__all__ = [
    "EncodeSettings",
    "Encoded",
    "Picture",
    "SgiError",
    "Stream",
    "__version__",
    "encode",
    "open_stream",
    "read",
    "write",
]

_HOMES = {
    "EncodeSettings": "encode_settings",
    "Encoded": "encoding",
    "encode": "encoder",
    "Stream": "decoder",
    "open_stream": "decoder",
    "Picture": "image",
    "read": "image",
    "write": "image",
}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f"sgicodec.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'sgicodec' has no attribute {name!r}")
