"""The libraries of the extra `bench`, and the message where one is missing."""

from __future__ import annotations

from importlib.util import find_spec

from sgicodec.errors import MissingExtraError

__all__ = ["INSTALL", "require"]

_PACKAGES = {"PIL": "pillow"}
"""Where a module is not called as its package."""

INSTALL = "pip install 'sgicodec[bench]'"


def require(user: str, *modules: str) -> None:
    """Raise MissingExtraError, before a long measurement begins, if one of the modules cannot be imported."""
    if missing := [_PACKAGES.get(name, name) for name in modules if find_spec(name) is None]:
        raise MissingExtraError(f"{user} needs {', '.join(missing)}: {INSTALL}")
