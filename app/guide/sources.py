"""Where the guide's Markdown files and pictures are: in the wheel, or in the checkout."""

from __future__ import annotations

from importlib.resources import files
from importlib.resources.abc import Traversable

INDEX = "docs/README.md"
PAGES = {
    "tutorial": "docs/tutorial.md",
    "api": "docs/api.md",
    "tables": "docs/tables.md",
    "settings": "docs/settings.md",
    "operate": "docs/operate.md",
    "architecture": "docs/architecture.md",
    "security": "SECURITY.md",
    "changelog": "CHANGELOG.md",
}
"""Pages of the guide in the order of its menu: last part of the path -> file of the repository."""
PICTURES = {
    "page.png": "docs/page.png",
    "methods.svg": "docs/methods.svg",
    "postures.svg": "docs/postures.svg",
}
"""Pictures that the pages show: last part of the path -> file of the repository."""


def source_root() -> Traversable:
    """Return the folder that holds ``docs/``: ``sources`` in a wheel, else the checkout.

    ``hatch_build.py`` copies the files named here into a wheel.
    """
    packaged = files("app.guide") / "sources"
    return packaged if packaged.is_dir() else files("app") / ".."
