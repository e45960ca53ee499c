"""Outlines of figures, for tests that need their content. The tests of figures draw them.

Drawing a figure takes half a second, most of it for the layout of its words.
"""

import hashlib
import html
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.artist import Artist
from matplotlib.collections import Collection
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text

from fastpin.figures import style

OF_SOME_PLATES = {"outline", "stiffness", "strength"}
"""Kinds of figures of plates of any outline, and of laminates."""


def outline_figures(patch: pytest.MonkeyPatch) -> None:
    """Save each figure as an outline: a small file of its kind with its words and a digest of its numbers."""
    draw = style.Drawing.savefig

    def save(figure: Figure, target: Any, *arguments: Any, **options: Any) -> None:
        outline = OUTLINES.get(target.suffix) if isinstance(target, Path) else None
        if outline is None:
            draw(figure, target, *arguments, **options)
        else:
            words = [text.get_text() for text in figure.findobj(Text) if text.get_text()]
            target.write_bytes(outline(words, digest_of(figure), figure.get_size_inches() * 72.0))

    patch.setattr(style.Drawing, "savefig", save)


def legend_words(figure: Figure) -> list[str]:
    """The words of the legends of a figure, in order."""
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def plain(text: str) -> str:
    """A text of a figure on one line, with plain spaces."""
    return text.replace("\n", " ").replace("\N{NO-BREAK SPACE}", " ")


def digest_of(figure: Figure) -> str:
    """A digest of all that a figure shows. Equal figures have equal digests."""
    found = hashlib.sha256()
    for artist in figure.findobj():
        for part in _parts(artist):
            found.update(part.encode() if isinstance(part, str) else np.ascontiguousarray(part).tobytes())
    return found.hexdigest()


def _parts(artist: Artist) -> Iterator[str | np.ndarray]:
    yield type(artist).__name__
    if isinstance(artist, Text):
        yield artist.get_text()
    elif isinstance(artist, Line2D):
        yield from (artist.get_xydata(), str(artist.get_color()), str(artist.get_linestyle()))
    elif isinstance(artist, Patch):
        yield from (artist.get_path().vertices, str(artist.get_facecolor()))
    elif isinstance(artist, Collection):
        yield from (path.vertices for path in artist.get_paths())
        yield from (np.ma.filled(artist.get_offsets(), np.nan), artist.get_facecolor())
    elif isinstance(artist, AxesImage):
        yield np.ma.filled(artist.get_array(), np.nan)


def _svg(words: list[str], digest: str, size: np.ndarray) -> bytes:
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size[0]:g} {size[1]:g}">'
    lines = [f"<!-- {text.replace('--', '- -')} --><text>{html.escape(text)}</text>" for text in words]
    return "\n".join(['<?xml version="1.0"?>', head, *lines, f"<desc>{digest}</desc></svg>"]).encode()


def _png(words: list[str], digest: str, size: np.ndarray) -> bytes:
    def chunk(kind: bytes, content: bytes) -> bytes:
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    width, height = (int(points) for points in size)
    header = chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 1, 0, 0, 0, 0))
    rows = chunk(b"IDAT", zlib.compress(bytes(height * (1 + (width + 7) // 8))))
    text = chunk(b"tEXt", b"Comment\0" + digest.encode())
    return b"\x89PNG\r\n\x1a\n" + header + text + rows + chunk(b"IEND", b"")


def _pdf(words: list[str], digest: str, size: np.ndarray) -> bytes:
    return "\n".join(["%PDF-1.4", *words, digest]).encode()


OUTLINES = {".svg": _svg, ".png": _png, ".pdf": _pdf}
