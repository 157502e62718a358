"""Files beside a picture that say more of it, which are not read: its place, nodata, a mask, edits."""

from __future__ import annotations

import os
import re
from pathlib import Path

_IDLE = re.compile(
    rb"""<Metadata\s+domain="IMAGE_STRUCTURE".*?</Metadata>|<MDI\s+key="(?:STATISTICS_|AREA_OR_POINT")""", re.DOTALL
)
_SAYS_MORE = re.compile(
    rb"<(GeoTransform|SRS|GCPList|NoDataValue|Scale|Offset|UnitType|Description|CategoryNames|ColorTable"
    rb"|GDALRasterAttributeTable|MDI|Metadata[^>]*\sformat)\b"
)
"""In GDAL's `.aux.xml`: what says nothing of the picture itself, beside most pictures statistics alone; what does."""
_MAX_AUX = 1 << 20
_OWN, _AUX = (".wld", ".prj", ".xmp", "_rpc.txt", ".rpb", ".clr"), ".aux.xml"
"""What follows the name without its ending, besides world files; what follows the whole name."""


def files_beside(path: Path) -> list[str]:
    """Their names, in any case: world files (`.tfw`, `.tifw`, `.wld`), `.prj`, `.xmp`, `_RPC.TXT`, `.rpb`, `.clr`,
    `.msk`, `.vat.dbf`, `.aux.xml` that says more than statistics.
    """
    stem, ending = path.stem, path.suffix[1:]
    own = [f".{ending[0]}{ending[-1]}w", f".{ending}w", *_OWN] if ending else []
    wanted = [
        *(f"{stem}{more}" for more in own),
        *(f"{path.name}{more}" for more in (".msk", ".xmp", ".vat.dbf", _AUX)),
    ]
    lowered = {name.lower() for name in wanted}
    try:
        names = sorted(name for name in os.listdir(path.parent) if name.lower() in lowered)
    except OSError:  # a folder whose files can be opened, not listed
        names = wanted
    files = [path.with_name(name) for name in names]
    found = [file for file in files if file.is_file() and (file.suffix.lower() != ".xml" or _says_more(file))]
    return [os.fsencode(file.name).decode("utf-8", "replace") for file in found]


def _says_more(aux: Path) -> bool:
    try:
        with aux.open("rb") as file:
            text = file.read(_MAX_AUX)
    except OSError:
        return False
    return _SAYS_MORE.search(_IDLE.sub(b"", text)) is not None
