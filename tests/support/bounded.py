"""Opens a stream in a process that may take little more memory than its libraries have."""

from __future__ import annotations

import json
from pathlib import Path

from little_memory import printed

__all__ = ["PROMISED", "within"]

PROMISED = 64 << 20
"""Bytes beyond the interpreter and its libraries that a look at a hostile stream may take (docs/security.md)."""

READER = """
import json, resource, sys
from pathlib import Path
from sgicodec.decoder.stream import open_stream
from sgicodec.device import Device
from sgicodec.errors import SgiError
looks = {{
    "survey": lambda stream: stream.survey().seeds,
    "region": lambda stream: stream.picture((5, 5, 40, 30)).pixels.shape,
    "scale": lambda stream: stream.picture(size=(12, 9)).pixels.shape,
    "enlarged": lambda stream: stream.picture(size=(9000, 9000)).pixels.shape,
    "overview": lambda stream: stream.overview.has_overview,
}}
with open_stream(Path({warm!r}).read_bytes(), Device(1)) as stream:
    looks["survey"](stream), looks["region"](stream), looks["scale"](stream)
pages = int(Path("/proc/self/statm").read_text().split()[0])
most = pages * resource.getpagesize() + {more}
resource.setrlimit(resource.RLIMIT_AS, (most, most))
found = {{}}
for name in {names!r}:
    try:
        with open_stream(Path({path!r}), Device(1)) as stream:
            found[name] = looks[name](stream)
    except SgiError as error:
        found[name] = f"{{type(error).__name__}}: {{error}}"
    except MemoryError:
        found[name] = "MemoryError"
print(json.dumps(found))
"""


def within(path: Path, warm: Path, *names: str, more: int = PROMISED) -> dict[str, object]:
    """What became of each look at a stream, within `more` bytes beyond what a look at the sound stream `warm` took."""
    code = READER.format(path=str(path), warm=str(warm), names=names, more=more)
    result: dict[str, object] = json.loads(printed(code))
    return result
