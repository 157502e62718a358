"""What the options of `sgi encode` say of one picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from sgicodec.cli.progress import Mode

if TYPE_CHECKING:
    from sgicodec.device import Device
    from sgicodec.encoder.settings import EncodeSettings

__all__ = ["Job"]


@dataclass(frozen=True)
class Job:
    """What the options say besides the settings of the stream. target: a path, or - for stdout."""

    source: str
    target: str
    settings: EncodeSettings
    float_range: tuple[float, float] | None
    verify: bool
    progress: Mode
    force: bool
    as_json: bool
    quiet: bool
    verbose: bool
    resume: bool
    max_memory: float | None
    cluster: str | None
    source_at: str | None
    send_pixels: bool
    batch: bool
    started: float
    device: Device
