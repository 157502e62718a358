"""Where the page of the viewer lies."""

from __future__ import annotations

from pathlib import Path

__all__ = ["viewer_folder"]


def viewer_folder() -> Path | None:
    """The folder of the viewer's page: in an installed package, or in a clone of the repository; None without one."""
    folders = (Path(__file__).parent / "web", Path(__file__).parents[2] / "viewer" / "src")
    return next((folder for folder in folders if (folder / "index.html").is_file()), None)
