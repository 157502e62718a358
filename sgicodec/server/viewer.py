"""Where the page of the viewer lies."""

from __future__ import annotations

from pathlib import Path


def viewer_folder() -> Path | None:
    """The folder of the viewer's page: in an installed package, or in a clone of the repository; None without one."""
    folders = (Path(__file__).parent / "web", Path(__file__).parents[2] / "viewer" / "src")
    return next((folder for folder in folders if (folder / "index.html").is_file()), None)


def missing_decoder(folder: Path) -> str | None:
    """What the viewer lacks where its WebAssembly was not compiled, as a sentence; None where it was."""
    if all((folder / "wasm" / name).is_file() for name in ("sgi.wasm", "sgi-scalar.wasm")):
        return None
    return (
        "the viewer lacks its decoder (WebAssembly), so this server draws for it; in a clone, make viewer compiles it "
        "and pip install '.[serve]' then installs it"
    )
