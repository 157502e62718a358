"""sgicodec: pictures as structured 2D Gaussians.

    import sgicodec
    data = sgicodec.encode(pixels, quality=60)              # an array, an image of Pillow, a path
    pixels = sgicodec.decode(data)                          # [H, W, C]
    with sgicodec.open("photo.sgi") as stream:
        detail = stream.read(region=(100, 50, 256, 256), scale=4)

Names load on first use, so that decoding never imports what only encoding needs.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from sgicodec.errors import SgiError
from sgicodec.version import __version__

if TYPE_CHECKING:
    from sgicodec.decoder.one_call import decode, imread
    from sgicodec.decoder.stream import Stream
    from sgicodec.decoder.stream import open_stream as open
    from sgicodec.device import Device
    from sgicodec.encoder.one_call import encode, imwrite
    from sgicodec.encoder.pipeline import Encoded, encode_picture
    from sgicodec.encoder.progress import NullListener
    from sgicodec.encoder.settings import EncodeSettings
    from sgicodec.encoder.tiles.checkpoint import Checkpoint
    from sgicodec.executors.dask import open_cluster
    from sgicodec.executors.processes import ProcessExecutor
    from sgicodec.image.reader import read
    from sgicodec.image.source import open_source
    from sgicodec.image.writer import write
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
    "decode",
    "encode",
    "encode_picture",
    "imread",
    "imwrite",
    "open",
    "open_cluster",
    "open_source",
    "read",
    "write",
]

_HOMES = {
    "Checkpoint": "encoder.tiles.checkpoint.Checkpoint",
    "Device": "device.Device",
    "EncodeSettings": "encoder.settings.EncodeSettings",
    "Encoded": "encoder.pipeline.Encoded",
    "NullListener": "encoder.progress.NullListener",
    "Picture": "picture.Picture",
    "ProcessExecutor": "executors.processes.ProcessExecutor",
    "Stream": "decoder.stream.Stream",
    "decode": "decoder.one_call.decode",
    "encode": "encoder.one_call.encode",
    "encode_picture": "encoder.pipeline.encode_picture",
    "imread": "decoder.one_call.imread",
    "imwrite": "encoder.one_call.imwrite",
    "open": "decoder.stream.open_stream",
    "open_cluster": "executors.dask.open_cluster",
    "open_source": "image.source.open_source",
    "read": "image.reader.read",
    "write": "image.writer.write",
}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        module, _, attribute = _HOMES[name].rpartition(".")
        return getattr(import_module(f"sgicodec.{module}"), attribute)
    if name == "_native":  # asked for before the import system looks for the module
        return _extension()
    raise AttributeError(f"module 'sgicodec' has no attribute {name!r}")


def _extension() -> Any:
    """The compiled part. Raises ImportError that says what to do where this folder holds the sources alone."""
    try:
        return import_module("sgicodec._native")
    except ModuleNotFoundError as error:
        if error.name != "sgicodec._native":
            raise
        from pathlib import Path

        clone = Path(__file__).resolve().parents[1]
        raise ImportError(
            f"the sgicodec in {clone} is not compiled: run pip install -e . there; or pip install . and start Python "
            "in another folder, since there the sources hide what is installed"
        ) from None


def __dir__() -> list[str]:
    return sorted(__all__)
