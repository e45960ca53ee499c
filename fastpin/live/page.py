"""The HTML of the page and its files: as a server sends them, or all in one file.

The scripts are JavaScript modules that import one another as "live/NAME". An import map says where a module is: at the
server, or in the page itself.
"""

from __future__ import annotations

import base64
import hashlib
import json
from functools import lru_cache
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).with_name("static")
"""The folder of the page's files."""

STYLES = ("vendor/uPlot.min.css", "page.css")
CHARTS = "vendor/uPlot.iife.min.js"
"""The library of charts. It is no module: it defines the name ``uPlot``."""

LICENCE = "vendor/uPlot-LICENSE.txt"


@lru_cache
def page_text(name: str) -> str:
    """The text of one of the page's files."""
    return (FOLDER / name).read_text(encoding="utf-8")


def modules() -> list[str]:
    """The names of the modules, without suffix."""
    return sorted(path.stem for path in FOLDER.glob("*.js"))


def page_files() -> dict[str, tuple[bytes, str]]:
    """The files that a server sends: content and type by name. The page itself is not among them."""
    names = [*(f"{name}.js" for name in modules()), *STYLES, CHARTS, LICENCE]
    types = {".js": "text/javascript", ".css": "text/css", ".txt": "text/plain"}
    return {name: (page_text(name).encode(), types[Path(name).suffix]) for name in names}


def live_page() -> tuple[str, str]:
    """The page for a server, and the hash of its import map for the Content-Security-Policy."""
    imports = _import_map({name: f"./{name}.js" for name in modules()})
    scripts = [
        f'<script type="importmap">{imports}</script>',
        f'<script src="{CHARTS}"></script>',
        '<script type="module" src="main.js"></script>',
    ]
    styles = [f'<link rel="stylesheet" href="{name}">' for name in STYLES]
    digest = base64.b64encode(hashlib.sha256(imports.encode()).digest()).decode()
    return _filled(styles, scripts), f"'sha256-{digest}'"


def recorded_page(recording: dict[str, Any]) -> str:
    """The page with everything inside: it replays a recording without server and network."""
    data = json.dumps(recording, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    texts = {name: page_text(f"{name}.js").encode() for name in modules()}
    start = 'import "live/main";'
    chart = page_text(CHARTS)
    imports = _import_map(
        {name: f"data:text/javascript;base64,{base64.b64encode(text).decode()}" for name, text in texts.items()}
    )
    styles = [page_text(name) for name in STYLES]
    # A module that is imported has the nonce of the script that imports it.
    nonce = hashlib.sha256(data.encode()).hexdigest()[:32]
    allowed = f"default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src data: blob:"
    head = [f'<meta http-equiv="Content-Security-Policy" content="{allowed}">']
    head += [f'<style nonce="{nonce}">{style}</style>' for style in styles]
    scripts = [
        f'<script type="application/json" id="recording">{data}</script>',
        f'<script type="importmap" nonce="{nonce}">{imports}</script>',
        f'<script nonce="{nonce}">/*{page_text(LICENCE)}*/\n{chart}</script>',
        f'<script type="module" nonce="{nonce}">{start}</script>',
    ]
    return _filled(head, scripts)


def _import_map(places: dict[str, str]) -> str:
    return json.dumps({"imports": {f"live/{name}": place for name, place in places.items()}})


def _filled(head: list[str], scripts: list[str]) -> str:
    page = page_text("page.html")
    return page.replace("<!-- head -->", "\n".join(head)).replace("<!-- scripts -->", "\n".join(scripts))
