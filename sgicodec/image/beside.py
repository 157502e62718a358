"""Files beside a picture that say more of it, which are not read: its place, nodata, a mask, edits."""

from __future__ import annotations

import os
from pathlib import Path

__all__ = ["files_beside"]

_SAYS_MORE = (b"<GeoTransform", b"<SRS", b"<GCPList", b"<NoDataValue")
"""In GDAL's `.aux.xml`, which holds statistics alone beside most pictures."""
_MAX_AUX = 1 << 20


def files_beside(path: Path) -> list[str]:
    """Their names: world files (`.tfw`, `.tifw`, `.wld`), `.prj`, `.aux.xml` that says more than statistics, `.msk`,
    `.xmp`.
    """
    ending = path.suffix[1:]
    own = [f"{ending[0]}{ending[-1]}w", f"{ending}w", "wld", "prj", "xmp"] if ending else []
    names = [path.with_suffix(f".{name}") for name in own]
    names += [path.with_name(f"{path.name}{more}") for more in (".msk", ".xmp")]
    aux = path.with_name(f"{path.name}.aux.xml")
    found = [name for name in names if name.is_file()] + [aux] * _says_more(aux)
    return [os.fsencode(name.name).decode("utf-8", "replace") for name in found]


def _says_more(aux: Path) -> bool:
    try:
        with aux.open("rb") as file:
            text = file.read(_MAX_AUX)
    except OSError:
        return False
    return any(word in text for word in _SAYS_MORE)
