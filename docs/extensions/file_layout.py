"""The groups and arrays of a result file as Markdown tables, read from a file that is written for this purpose."""

from __future__ import annotations

import inspect
import re
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import h5py
from file_keys import table, words_of_docstring

import fastpin
import fastpin.wear_lives
from fastpin.model import About
from fastpin.states.cycles import Cycle
from fastpin.storage import layout
from fastpin.storage.stored_states import LEAST_STORED

GROUPS = re.compile(r"^``(/\w*)``\s+(.*)$", re.MULTILINE)
"""A group and what it holds, in the docstring of the layout."""


ABOUT = About("project", "author", "A", "2026-03-31")

WORDS = {
    "complete": "whether the run has followed its whole history",
    "created": "date and time, UTC",
    "error": "why the run ended early, if it did",
    "format": "the text that marks a result of fastpin",
    "format_version": "version of the layout",
    "host": "name of the machine",
    "platform": "its operating system",
    "run": "name of the run that has written the file",
    "title": "title of the case",
    "project": "project of the case, if it names one",
    "author": "author of the case, likewise",
    "revision": "revision of the case, likewise",
    "date": "date of the revision, likewise",
    "plane": '"strain" or "stress"',
    "units": "unit of each kind of quantity",
    "blocks": "a row for each block: corners, count, whether each time is a cycle, corners if cut, cycles inside",
    "corners": "loads of all blocks; NaN where a corner leaves a load out",
    "ends": "inner cycle that ends at a corner, counted from 1; 0 where none ends",
    "cycle_lengths": "corners of each cycle inside the blocks",
    "closed": "whether the nodes lie on the whole circle",
    "arc_chosen": "whether the solver chose the arc",
    "fractions": "fractions of each step at which states are kept",
    "save_after": "corners with a restart in the file",
    "load_name": "names of the columns of `loads`",
    "loads": "loads of each state",
    "residual_name": "names of the columns of `residuals`",
    "state": "numbers of the states",
    "old_borders": "marks of borders that earlier loads have left; for the cusps of later states",
    "names": "quantity and side of each extreme",
    "states": "number of states from which they were chosen",
    "place": "place of the state with the extreme, from 0",
    "value": "value of the quantity",
    "old_places": "places of these borders between the nodes",
}
"""Words for members that no docstring explains."""


WEAR_WORDS = {
    "law": "the law of wear",
    "tolerance": "largest error of the worn gap by fat cycles",
    "chosen": "cycles after which profile and states are kept",
    "coefficients": "wear coefficients of pin and plate at the nodes",
    "loses_contact": "whether the pin loses contact in the cycle",
    "jump": "the next jump; below 1 so many single cycles and one more come first",
    "pause": "single cycles after the next failure of control",
    "depth": "worn depth of pin and plate at the nodes, dimensionless",
}
"""Words for members of the group of a life of wear that no docstring explains."""


def wear_layout() -> str:
    """A table of the members of the group of a life of wear, and of the place from which it goes on."""
    parts = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "life.h5"
        pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
        problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.4)
        history = fastpin.LoadHistory([{"P": 2e6}]) + fastpin.LoadHistory([{"P": 1e6}, {"P": 2e6}]).repeated(2)
        fastpin.wear(problem, history, coefficient=1e-14, output=path, nodes=31)
        words = words_of_docstring(fastpin.wear_lives.WornCycle)
        with h5py.File(path) as file:
            for name in ("/wear", "/wear/place"):
                rows = list(_members(file[name], name, WEAR_WORDS | words if name == "/wear" else words | WEAR_WORDS))
                parts += [f"### {name}", "", table(("name", "kind", "shape", "unit", "meaning"), rows), ""]
    text = "\n".join(parts)
    return text.replace("(3, 31)", "(cycle, node)").replace("(3,)", "(cycle,)").replace("(2, 31)", "(body, node)")


def file_layout() -> str:
    """A table of the groups, and a table of the members of each group."""
    groups = GROUPS.findall(inspect.getdoc(layout) or "")
    parts = [table(("group", "holds"), ((f"`{name}`", words.replace("``", "`")) for name, words in groups)), ""]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "sample.h5"
        _write(path)
        with h5py.File(path) as file:
            for name, _ in groups:
                rows = list(_members(file[name], name))
                parts += [f"## {name}", "", table(("name", "kind", "shape", "unit", "meaning"), rows), ""]
    return "\n".join(parts)


OPTIONS: dict[str, Any] = {"slip_sums": True, "error_bars": True, "save_after": [1]}
"""Options that add parts to a file."""


def _write(path: Path) -> None:
    """Write a file with everything that a file may hold: cycles, sums of slip, error bars, restarts, extremes."""
    pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
    problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.4, thickness=5e-3)
    cycles = fastpin.LoadHistory([{"Q": 6e5}, {"Q": -6e5}]).repeated(LEAST_STORED // 2)
    history = fastpin.LoadHistory([{"P": 2.4e6}]) + cycles
    fastpin.record(problem, history, path, title="sample", about=ABOUT, nodes=101, **OPTIONS)


def _members(group: h5py.Group, where: str, given: Mapping[str, str] = WORDS) -> Iterator[tuple[str, ...]]:
    """Rows for attributes, arrays and groups of a group. `given`: words for those that no docstring explains."""
    words = {"/states": words_of_docstring(fastpin.State), "/cycles": words_of_docstring(Cycle)}.get(where, {})
    words |= words_of_docstring(fastpin.Problem) if where == "/problem" else {}
    words |= words_of_docstring(fastpin.SolveOptions) if where == "/solver" else {}
    words, said = {**given, **words}, {}
    for name in group.attrs:
        yield f"`{name}`", "attribute", "", "", _once(words.get(name) or _version(name), name, said)
    for name, member in group.items():
        if isinstance(member, h5py.Group):
            if where != "/":
                yield f"`{name}/`", "group", "", "", ", ".join(f"`{key}`" for key in (*member.attrs, *member))
            continue
        unit = member.attrs.get("unit", "")
        units = unit if isinstance(unit, str) else ", ".join(dict.fromkeys(map(str, unit)))
        yield f"`{name}`", _kind(member), _shape(member, where), units, _once(words.get(name, ""), name, said)


def _once(words: str, name: str, said: dict[str, str]) -> str:
    """The words; or, where another member has the same words, its name."""
    first = said.setdefault(words, name)
    return words if first == name or not words else f"see `{first}`"


def _version(name: str) -> str:
    """Words for the versions of the libraries."""
    return f"version of {name.removeprefix('version_')}" if name.startswith("version_") else ""


def _kind(member: h5py.Dataset) -> str:
    names = {"i": "whole number", "f": "number", "b": "true or false", "O": "text", "V": "table"}
    return names.get(member.dtype.kind, str(member.dtype))


def _shape(member: h5py.Dataset, where: str) -> str:
    """The names of the dimensions; the numbers where they have none."""
    found = [
        member.dims[place][0].name.rsplit("/", 1)[-1] if len(member.dims[place]) else "" for place in range(member.ndim)
    ]
    sizes = [
        name or ("cycle" if where == "/cycles" else str(size)) for name, size in zip(found, member.shape, strict=True)
    ]
    return "(" + ", ".join(sizes) + ("," if len(sizes) == 1 else "") + ")" if sizes else ""
