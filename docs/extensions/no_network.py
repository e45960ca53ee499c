"""The pages load nothing from a network: a script, style, image or frame with an address of its own is a warning."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from sphinx.util import logging

LOADED = re.compile(
    r"<(?:script|img|iframe|source)\b[^>]*\bsrc=\"(?:https?:)?//[^\"]+|<link\b(?![^>]*rel=\"canonical)[^>]*href=\"(?:https?:)?//[^\"]+"
)
"""Parts of a page that a browser loads by itself."""

IMPORTED = re.compile(r"(?:@import|url\()\s*[\"']?(?:https?:)?//[^\"')]+")
"""Parts of a style sheet that a browser loads by itself."""


def check(app: Any, error: Exception | None) -> None:
    """Warn of everything that the pages and style sheets of the site would load."""
    if error is not None:
        return
    log = logging.getLogger(__name__)
    for suffix, pattern in ((".html", LOADED), (".css", IMPORTED)):
        for path in sorted(Path(app.outdir).rglob(f"*{suffix}")):
            for found in pattern.findall(path.read_text(encoding="utf-8")):
                log.warning("%s loads from a network: %s", path.relative_to(app.outdir), found)


def setup(app: Any) -> dict[str, Any]:
    app.connect("build-finished", check)
    return {"parallel_read_safe": True}
