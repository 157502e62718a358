"""Adds the streams that lie here and that the manifest lacks: `python tests/conformance/golden/add_golden.py`.

Those that it has stay as they are. How they were made is in the history of `make_golden.py`.
"""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from sgicodec.decoder.stream import open_stream
from sgicodec.device import ONE_THREAD, Device

HERE = Path(__file__).parent
sys.path.append(str(HERE.parents[2]))

from tests.conformance.suite import SAMPLES, TYPES, Case, cases  # noqa: E402


def entry(path: Path) -> dict[str, Any]:
    """What the manifest says of a stream."""
    with open_stream(path) as stream:
        survey = stream.survey()
        found: dict[str, Any] = {
            "sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
            "picture": [stream.width, stream.height, stream.header.channels],
            "sample_type": stream.header.sample_type,
            "seeds": survey.seeds,
            "symbol_crc": f"{survey.symbol_crc:08x}",
        }
        if stream.has_overview:
            found["overview_crc"] = f"{stream.overview.symbol_crc:08x}"
        if stream.header.spec.texture:
            found["texture_cells"] = {str(side): count for side, count in survey.texture_cells.items()}
    return found


def samples(case: Case, device: Device = ONE_THREAD) -> bytes:
    """What this package decodes for a case of the conformance suite."""
    kind = next(name for name, short in TYPES.items() if short == case.type)
    region, size = (case.x, case.y, case.width, case.height), (case.columns, case.rows)
    with open_stream(HERE / f"{case.stream}.sgi", device) as stream:
        stream.exact, stream.dither = True, False
        return np.ascontiguousarray(stream.picture(region, size=size, dtype=kind).pixels).tobytes()


def main() -> None:
    """Writes what the manifest lacks, and the samples of its cases."""
    manifest_path = HERE / "manifest.json"
    manifest, known = json.loads(manifest_path.read_text()), json.loads(SAMPLES.read_text())
    for path in sorted(HERE.glob("*.sgi")):
        name = path.stem
        if name not in manifest:
            found = manifest[name] = entry(path)
            stated = cases(name, *found["picture"][:2], TYPES[found["sample_type"]])
            known[name] = {case.key: hashlib.sha256(samples(case)).hexdigest() for case in stated}
    SAMPLES.write_text(json.dumps(known, indent=1, sort_keys=True) + "\n")
    manifest_path.write_text(json.dumps(manifest, indent=2) + "\n")


if __name__ == "__main__":
    main()
