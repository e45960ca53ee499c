"""Cross-references of docstrings to names of the package.

Docstrings name objects by the file that defines them. The reference shows public names. A reference to an object that
the reference shows under another name becomes a link to it. A name that exists, but is not shown, stays plain text; a
number then shows its value. Any other name is a warning.
"""

from __future__ import annotations

import contextlib
import importlib
from typing import Any

from docutils import nodes


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


def candidates(node: Any) -> list[str]:
    """Full names that a reference may mean, the nearest first."""
    target, module, owner = node["reftarget"].lstrip(".~"), node.get("py:module") or "", node.get("py:class") or ""
    names = [target]
    if owner:
        names.append(f"{module}.{owner}.{target}")
    if module:
        names.append(f"{module}.{target}")
        # A docstring also names its neighbours in the file that defines the object.
        shown = f"{module}.{owner or node.get('fastpin:object', '')}".rstrip(".")
        with contextlib.suppress(LookupError):
            names.append(f"{getattr(find(shown), '__module__', module)}.{target}")
    return names


def resolve(app: Any, env: Any, node: Any, contnode: Any) -> Any:
    """The link or the plain text of a reference that Sphinx does not know."""
    if node.get("refdomain") != "py":
        return None
    for name in candidates(node):
        try:
            found = find(name)
        except (LookupError, ValueError):
            continue
        shown = public_names(env).get(id(found))
        if shown is not None:
            domain = env.domains["py"]
            entry = domain.objects[shown]
            builder = app.builder
            uri = builder.get_relative_uri(node["refdoc"], entry.docname)
            return nodes.reference("", "", contnode, refuri=f"{uri}#{entry.node_id}", internal=True)
        if isinstance(found, (int, float)) and not isinstance(found, bool):
            return nodes.inline("", "", contnode, nodes.Text(f" ({found:,})" if abs(found) < 1e6 else f" ({found:g})"))
        return contnode
    # Words of the types in "Parameters", such as "optional": Sphinx looks each of them up.
    return contnode if node.get("refspecific") else None


def public_names(env: Any) -> dict[int, str]:
    """The names that the reference shows, by the object."""
    shown = {}
    for name, entry in env.domains["py"].objects.items():
        if entry.objtype in ("class", "exception", "function", "module", "method", "property", "data"):
            try:
                found = find(name)
            except LookupError:
                continue
            if not isinstance(found, (int, float, str, tuple)):
                shown[id(found)] = name
    return shown


def setup(app: Any) -> dict[str, Any]:
    app.connect("missing-reference", resolve)
    return {"parallel_read_safe": True}
