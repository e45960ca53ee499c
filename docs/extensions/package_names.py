"""Cross-references and symbols in docstrings of the package.

Docstrings name objects by the file that defines them. The reference shows public names. A reference to an object that
the reference shows under another name becomes a link to it. A name that exists, but is not shown, stays plain text; a
number then shows its value. Any other name is a warning.

Docstrings also have plain formulas, such as ``|ds|``. Their bars, stars and underscores are no markup.
"""

from __future__ import annotations

import importlib
import re
import sys
from typing import Any

from docutils import nodes
from sphinx.domains.python import PyObject
from sphinx.ext import autosummary

LITERAL = re.compile(r"(``.*?``|:\w+:`.*?`)")
"""Parts of a docstring that are markup on purpose."""

OTHERS = ("dask", "distributed", "matplotlib", "numpy", "pandas", "pylife", "scipy", "xarray")
"""Packages of others, some of them optional. Links to their sites would need a network."""

LARGE = 1e6
"""Numbers from here on are shown with a power of ten."""


def find(name: str) -> Any:
    """The object of a dotted name. Raises LookupError if there is none."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:count]))
        except ImportError:
            continue
        try:
            for part in parts[count:]:
                found = getattr(found, part)
        except AttributeError as error:
            raise LookupError(name) from error
        return found
    raise LookupError(name)


def resolve(app: Any, env: Any, node: Any, contnode: Any) -> Any:
    """The link or the plain text of a reference that Sphinx does not know."""
    if node.get("refdomain") != "py":
        return None
    target = node["reftarget"].lstrip(".~")
    objects = env.domains["py"].objects
    shown = nearest(target, objects, node["refdoc"]) or same_object(target, objects)
    if shown is not None:
        entry = objects[shown]
        uri = app.builder.get_relative_uri(node["refdoc"], entry.docname)
        return nodes.reference("", "", contnode, refuri=f"{uri}#{entry.node_id}", internal=True)
    for found in objects_named(target):
        if isinstance(found, (int, float)) and not isinstance(found, bool):
            value = f"{found:,}" if abs(found) < LARGE else f"{found:g}"
            return nodes.inline("", "", contnode, nodes.Text(f" ({value})"))
        return contnode
    # Words of the types in "Parameters", such as "optional": Sphinx looks each of them up.
    return contnode if node.get("refspecific") or target.partition(".")[0] in OTHERS else None


def nearest(target: str, objects: dict[str, Any], page: str) -> str | None:
    """The shown object whose name ends in a target: on this page, or else the one with the shortest name."""
    kinds = ("class", "exception", "function", "data")
    found = [name for name in objects if name.endswith(f".{target}") and objects[name].objtype in kinds]
    return min(found, key=lambda name: (objects[name].docname != page, len(name)), default=None)


def same_object(target: str, objects: dict[str, Any]) -> str | None:
    """The name under which the reference shows the object that a full name means."""
    try:
        meant = find(target)
    except (LookupError, ValueError):
        return None
    last = target.rpartition(".")[2]
    for name in objects:
        if name.rpartition(".")[2] == last:
            try:
                if find(name) is meant:
                    return name
            except LookupError:
                continue
    return None


def objects_named(target: str) -> list[Any]:
    """The object of a full name, or all objects of this name in the files of the package."""
    try:
        return [find(target)]
    except (LookupError, ValueError):
        pass
    first, *rest = target.split(".")
    found = []
    for name in [name for name in sys.modules if name.startswith("fastpin.")]:
        value = vars(sys.modules[name]).get(first)
        for part in rest:
            value = getattr(value, part, None)
        if value is not None:
            found.append(value)
    return found


def escape_symbols(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Escape bars, stars and underscores of formulas."""
    for place, line in enumerate(lines):
        if line.lstrip().startswith((">>>", "...", ":")):
            continue
        parts = LITERAL.split(line)
        parts[::2] = [re.sub(r"\||(?<=\w)\*(?!\*)|(?<=\w)_(?!\w)", r"\\\g<0>", part) for part in parts[::2]]
        lines[place] = "".join(parts)


def part_remarks(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Part the remarks behind the last section from the section: napoleon would take them for one more error."""
    inside, place = False, 0
    while place < len(lines):
        if re.fullmatch(r"-{3,}", lines[place]):
            inside = lines[place - 1] in ("Raises", "Returns")
        elif inside and not lines[place - 1] and re.match(r"[A-Z`:](?:\S* ){4}", lines[place]):
            lines[place:place] = ["Notes", "-----"]
            inside = False
        place += 1


def join_sentence(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Join the first sentence of a property: napoleon takes the words before a colon for its type."""
    place = next((place for place, line in enumerate(lines) if line.startswith(":type: ")), None)
    if what in ("attribute", "property") and place is not None:
        lines[0] = f"{lines.pop(place).removeprefix(':type: ')}: {lines[0]}"


def setup(app: Any) -> dict[str, Any]:
    app.connect("missing-reference", resolve)
    # Before napoleon, which makes fields of the sections.
    app.connect("autodoc-process-docstring", part_remarks, priority=300)
    app.connect("autodoc-process-docstring", escape_symbols, priority=400)
    app.connect("autodoc-process-docstring", join_sentence, priority=600)
    # A summary does not end at these.
    autosummary.WELL_KNOWN_ABBREVIATIONS += ("Appl.", "Exp.", "J.", "Mech.", "Phys.")
    for field in PyObject.doc_field_types:
        if field.name == "variable":
            field.label = "Attributes"
    return {"parallel_read_safe": True}
